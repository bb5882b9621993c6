"""Arakelian & Ghazaryan 2008: springs that have mass, and a leg orthosis [arakelian_ghazaryan_2008]."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np

import equipoise as eq
from equipoise.affine import Array
from equipoise.balancers.laws import Law
from equipoise.claim import Claim, Reason, Source
from equipoise.papers.paper import Paper

SLUG = "arakelian-ghazaryan-2008"
P = Source(SLUG)

# The model: an 8 kg link, its angle counted from straight up, a spring from 0.16 m above its axis.
JOINT = "link_joint"
WIRE = {3.1: eq.WireMass(diameter=0.04, coils=80, wire_length=10.38), 3.2: eq.WireMass(0.04, 80, 8.0)}
LINE = eq.Line(eq.Point("world", (0, 0, 0.16)), eq.Point("link", (0.3, 0, 0)))
COIL = eq.Coil(free_length=0.3)


@functools.cache
def link() -> eq.Mechanism:
    """The rotating link of Fig. 1."""
    return eq.chain([eq.Link("link", length=0.3, mass=8.0, com=0.183)], datum="up")


def sweep(step: float = 1.0) -> eq.Sweep:
    """120 to 180 deg in steps of `step` deg, ends included."""
    ends = np.radians((120.0, 180.0))
    return eq.Sweep.grid(link(), {JOINT: (*ends, round(60 / step) + 1)})


def spring(law: Law, mass: float | eq.WireMass = 0.0) -> eq.Spring:
    """The spring from B to A."""
    return eq.Spring("s", LINE, law, mass=mass)


@functools.cache
def zero_free_length(heavy: bool) -> eq.Design:
    """Section 3.1: the exact rate, without and with the mass of the wire."""
    if not heavy:
        return eq.balance(link(), [spring(eq.ZeroFreeLength())], sweep())
    return eq.shape(link(), [spring(eq.ZeroFreeLength(300.0), WIRE[3.1])], sweep(), {"s.law.k": (100, 1000)}, starts=1)


def unbalanced(k: float, mass: float, step: float = 0.1) -> Array:
    """Unbalanced moment -dV/dphi of section 3.2 over the range, N m."""
    states = link().states(sweep(step))
    held = states.holding + spring(eq.Coil(0.3, k=k), mass).effort(states, "hold").b
    return -held[:, 0]


def sums() -> tuple[float, float, float]:
    """C1, C2, C3 of Eqs. 15 to 17: moments summed over 120, 125, ..., 180 deg."""
    states = link().states(sweep(5))
    pull = spring(COIL, WIRE[3.2].of(1.0)).effort(states, "hold")
    return -states.holding.sum(), -pull.b.sum(), -pull.A.sum()


def claims() -> Sequence[Claim]:
    """Every printed number and checkable sentence."""
    return [*_zero_free_length()]


def _zero_free_length() -> list[Claim]:
    light = zero_free_length(False).values["s.k"]
    heavy = zero_free_length(True).geometry["s.law.k"]
    shortest = float(spring(COIL).path.deform(link().states(sweep()))[0].min())
    mass = float(WIRE[3.1].of(heavy))
    closed = f"F0 = k l0 with l0 = {shortest:.6f} m, the shortest assembled length, which is not printed"
    rounded = math.pi / 4 * WIRE[3.1].density * WIRE[3.1].wire_length * 0.0036**2
    return [
        P.number("rate of the weightless spring of zero free length", "3.1", "299", light, "N/m"),
        P.number("its initial force", "3.1", "121", light * shortest, "N", note=closed),
        P.number(
            "rate with the spring's own mass in the equation",
            "3.1, Eqs. 8-10",
            "324.5",
            heavy,
            "N/m",
            correction=Reason(
                "the wire diameter is rounded to 3.6 mm before Eq. 4",
                (8 * 0.183 + 0.5 * rounded * 0.3) * 9.81 / (0.16 * 0.3),
            ),
        ),
        P.number("its initial force", "3.1", "131", heavy * shortest, "N", note=closed),
        P.number("mass of this spring", "3.1", "0.8", mass, "kg"),
    ]


PAPER = Paper(
    slug=SLUG,
    about="A link, or a leg, is balanced by springs whose own mass is part of what they carry.",
    given="m1 = 8 kg, s1 = 0.183 m, psi = 0, 120 to 180 deg, Y_B = 0.16 m, r = 0.3 m.",
    findings=(),
    claims=claims,
)
