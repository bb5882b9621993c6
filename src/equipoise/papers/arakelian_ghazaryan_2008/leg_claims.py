"""Section 4, the leg orthosis, claim by claim."""

from __future__ import annotations

import math

import numpy as np

import equipoise as eq
from equipoise.claim import Claim, Source
from equipoise.papers.arakelian_ghazaryan_2008 import model
from equipoise.papers.arakelian_ghazaryan_2008.model import WIRE_S1, WIRE_S2, G, M

P = Source("arakelian-ghazaryan-2008")
WIRES = (WIRE_S1, WIRE_S2)
ROUNDING = 1e-9


def leg_claims() -> list[Claim]:
    """Every printed number and checkable sentence of section 4."""
    k = 522.0
    height = model.height(k)
    mass = 0.5 * float(WIRE_S1.of(k) + WIRE_S2.of(k))
    missing = (
        f"l_OB is not printed; {height:.6f} m gives it with D = 0.04 m and Eq. 7, "
        f"{(M + mass * math.sqrt(2)) * G / k:.6f} m with Eq. 45 as printed, {M * G / k:.6f} m without spring masses"
    )
    turns = "pi D n, at most the printed length of wire; with D = 0.4 m it would be {:.1f} m"
    left = model.leg().states(model.knee()).holding[:, 1]
    return [
        P.number("mass of shank and foot", "4", "4.08", 3.11 + 0.97, "kg", note="3.11 + 0.97"),
        P.between(
            "index D/d of spring S1, D = 0.4 m",
            "4",
            ("4", "15"),
            _index(WIRE_S1, 0.04, k),
            correction="D = 0.04 m",
            note=f"the range of section 3.1; as printed {_index(WIRE_S1, 0.4, k):.1f}",
        ),
        P.between(
            "index D/d of spring S2, D = 0.4 m",
            "4",
            ("4", "15"),
            _index(WIRE_S2, 0.04, k),
            correction="D = 0.04 m",
            note=f"the range of section 3.1; as printed {_index(WIRE_S2, 0.4, k):.1f}",
        ),
        P.at_most(
            "wire of spring S1, n = 66",
            "4",
            "8.6",
            math.pi * 0.04 * 66,
            "m",
            correction="D = 0.04 m",
            note=turns.format(math.pi * 0.4 * 66),
        ),
        P.at_most(
            "wire of spring S2, n = 62",
            "4",
            "7.8",
            math.pi * 0.04 * 62,
            "m",
            correction="D = 0.04 m",
            note=turns.format(math.pi * 0.4 * 62) + "; 9 mm remain, which makes no hooks",
        ),
        P.sentence(
            "Eq. 45 is Eq. 44 with Eq. 7",
            "4, Eq. 45",
            _eq_45(k, height, 2.0),
            lambda left: abs(left) < ROUNDING,
            "N",
            correction="sqrt(D^3 n / (2 G)): the 2 was lost",
            note=f"what Eq. 45 leaves where Eq. 44 holds; as printed {_eq_45(k, height, 1.0):.3f} N, the masses of the "
            "springs being sqrt(2) too large",
        ),
        P.underspecified("rate of spring S1", "4", "522", "N/m", note=missing),
        P.underspecified("rate of spring S2", "4", "-522", "N/m", note=missing),
        P.sentence(
            "the potential energy is constant for all postures",
            "4, Eqs. 38-44",
            _energy_span(k, height),
            lambda span: span < ROUNDING,
            "J",
            correction="with S2 as a device of negative rate and zero free length, which a coil is not",
            note="largest less smallest energy over 1024 postures with the links' own masses, D = 0.04 m, Eq. 7 and "
            f"l_OB = {height:.6f} m",
        ),
        P.sentence(
            "zero torques are required at hip and knee",
            "4",
            _effort(k, height),
            lambda torque: torque < ROUNDING,
            "N m",
            correction="with S2 as a device of negative rate and zero free length, which a coil is not",
            note="largest holding torque of either joint over 1024 postures",
        ),
        P.sentence(
            "a compression spring between hip and A has the rate k_S2 = -k that cancels k_S1",
            "4, Eq. 41",
            _without_lower(k, height),
            lambda torque: torque < ROUNDING,
            "N m",
            note="a passive coil pushing O and A apart stores +k2 (L2 - l)^2 / 2, whose l^2 term adds to that of S1; "
            f"this is the knee's torque without S2 over 0 to 60 deg (gravity alone {np.abs(left).max():.2f} N m there)",
        ),
    ]


def _index(wire: eq.WireMass, diameter: float, k: float) -> float:
    return diameter / (8 * diameter**3 * wire.coils * k / wire.shear_modulus) ** 0.25


def _eq_45(k: float, height: float, lost: float) -> float:
    """What Eq. 45 leaves, N, with `lost` before G under its roots."""
    wires = sum(
        w.density * w.wire_length * math.sqrt(w.diameter**3 * w.coils / (lost * w.shear_modulus)) for w in WIRES
    )
    return M * G + 0.5 * G * math.pi * math.sqrt(k) * wires - k * height


def _orthosis(k: float, height: float) -> list[eq.Spring]:
    return [model.upper(k, height), model.lower(eq.ZeroFreeLength(-k), k)]


def _postures() -> eq.States:
    turn = (-math.pi, math.pi, 32)
    return model.leg().states(eq.Sweep.grid(model.leg(), {"thigh_joint": turn, "shank_joint": turn}))


def _energy_span(k: float, height: float) -> float:
    states = _postures()
    parts = [spring.effort(states, "energy").b for spring in _orthosis(k, height)]
    total = model.leg().effort(states, "energy").b + sum(parts)
    return float(np.ptp(total))


def _effort(k: float, height: float) -> float:
    states = _postures()
    parts = [spring.effort(states, "hold").b for spring in _orthosis(k, height)]
    return float(np.abs(states.holding + sum(parts)).max())


def _without_lower(k: float, height: float) -> float:
    """Largest knee torque with S1 and the weight of S2, but without its force."""
    states = model.leg().states(model.knee())
    parts = [model.upper(k, height).effort(states, "hold").b, model.lower(eq.Constant(0.0), k).effort(states, "hold").b]
    return float(np.abs((states.holding + sum(parts))[:, 1]).max())
