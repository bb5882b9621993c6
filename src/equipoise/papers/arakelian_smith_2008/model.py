"""The 3-RRR of Table 1 over the public interface: one motion, and mass data that are exchanged upon it."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

import equipoise as eq
from equipoise.affine import Array
from equipoise.momentum import inertial_effort, momentum, pseudo_inertia, wrench

Datum = TypeVar("Datum")
LEGS = (1, 2, 3)
L = 0.18
SIDE = 0.1
HEIGHT = SIDE * math.sqrt(3) / 2
T = 0.3
PIVOTS = ((0.0, 0.0), (0.46, 0.0), (0.23, 0.23 * math.sqrt(3)))
PINS = ((-SIDE / 2, -HEIGHT / 3), (SIDE / 2, -HEIGHT / 3), (0.0, 2 * HEIGHT / 3))
START = (0.23, HEIGHT / 3, 0.0)
PRINTED = ((1 / 3, 4 / 3, 10 / 3), (1 / 6, -1 / 6, 1 / 12))
REGULAR = ((1 / 3, 4 / 3, 5 / 3), (1 / 6, -1 / 6, -1 / 12))
"""a_i and b_i of the drivers; of all elbows and signs that fit only these (and their mirror image) do."""
SAMPLES = 301
NORMAL = np.array([0.0, -1.0, 0.0])
PLATFORM = 3.0
TRUE_R3 = -L / 2.6
"""The distance that Eq. 13 asks for; Table 1 rounds it to 0.07."""


@dataclass(frozen=True)
class Masses:
    """Mass (kg), centre along the link (m) and central inertia (kg m^2) of links 2i and 3i; the platform's inertia.

    gears are the counter-rotating inertias (I4, I5), own those of the gears on links 3i and 2i, kg m^2.
    """

    crank: tuple[float, float, float] = (7.2, -0.09, 0.02)
    rod: tuple[float, float, float] = (2.6, TRUE_R3, 0.017)
    platform: float = 0.01
    gears: tuple[float, float] = (0.0, 0.0)
    own: tuple[float, float] = (0.0, 0.0)


SLENDER = Masses(crank=(0.5, 0.09, 0.00135), rod=(0.5, 0.09, 0.00135))
"""Uniform bars of 0.5 kg, to which counterweights can be added that give Table 1: the paper prints no bare links."""
EXACT = Masses()
TABLE = Masses(rod=(2.6, -0.07, 0.017))
LITERAL = Masses(crank=(7.2, 0.09, 0.02), rod=(2.6, 0.07, 0.017))
OWN = (0.00586, 0.00504)
"""What Eqs. 18 and 19 leave for the gears on the links, I_3GR and I_2GR, given Table 1's I4 and I5."""


def turned(masses: Masses) -> tuple[float, float]:
    """I4 and I5 of Eqs. 18 and 19, kg m^2."""
    (m2, r2, i2), (m3, r3, i3), mi = masses.crank, masses.rod, PLATFORM / 3
    gear3, gear2 = masses.own
    return gear3 + i3 + m3 * r3**2 + mi * L**2, gear2 + i2 + m2 * r2**2 + (m3 + mi) * L**2


def geared(masses: Masses) -> Masses:
    """With counter-rotations by Eqs. 18 and 19."""
    own = replace(masses, own=OWN)
    return replace(own, gears=turned(own))


COUNTER_ROTATED = geared(EXACT)
AS_PRINTED = replace(TABLE, own=OWN, gears=(0.068, 0.2))
WHEEL = replace(EXACT, platform=0.015)
WHEEL_INERTIA = 0.01


def thrice(value: Datum) -> tuple[Datum, Datum, Datum]:
    """The same for all three legs."""
    return value, value, value


@functools.cache
def manipulator() -> eq.Mechanism:
    """The geometry that closes at t = 0: x_P3 = X_O3 = 0.23, side 0.1; it lies flat."""
    return eq.rrr3(
        PIVOTS, PINS, thrice(L), thrice(L), pose=START, gravity=(0, 0, 0), platform_mass=PLATFORM, platform_inertia=0.01
    )


def sweep(drivers: tuple[tuple[float, ...], tuple[float, ...]] = REGULAR, samples: int = SAMPLES) -> eq.Sweep:
    """theta_i = a_i pi + b_i (2 pi t / T - sin(2 pi t / T))."""
    a, b = drivers
    law = {f"crank_{i}_joint": f"{a[i - 1]!r}*pi + {b[i - 1]!r}*(2*pi*t/T - sin(2*pi*t/T))" for i in LEGS}
    return eq.Sweep.motion(manipulator(), law, duration=T, samples=samples)


@functools.cache
def states() -> eq.States:
    """The motion, its kinematics shared by all mass data."""
    return manipulator().states(sweep())


@functools.cache
def time() -> Array:
    """The instants (N,), s."""
    instants = sweep().instants
    assert instants is not None
    return instants.time


def bodies(masses: Masses) -> dict[str, Array]:
    """Pseudo-inertia (4, 4) of every body."""

    def link(m: float, r: float, i: float) -> Array:
        return pseudo_inertia(m, (r, 0.0, 0.0), np.diag([i / 2, i, i / 2]))

    platform = pseudo_inertia(PLATFORM, (0.0, 0.0, 0.0), masses.platform * np.diag([0.5, 1.0, 0.5]))
    legs = {f"{kind}_{i}": link(*data) for i in LEGS for kind, data in (("crank", masses.crank), ("rod", masses.rod))}
    return legs | {"platform": platform}


def rotors(masses: Masses) -> list[eq.CounterRotor]:
    """The planetary pairs: I4 against link 3i, I5 against link 2i."""
    return [
        eq.CounterRotor(f"{kind}_{i}_gear", f"{kind}_{i}", inertia=inertia, gear_inertia=own)
        for kind, inertia, own in zip(("rod", "crank"), masses.gears, masses.own, strict=True)
        for i in LEGS
        if inertia
    ]


def base(masses: Masses, at: eq.States | None = None) -> tuple[Array, Array]:
    """Force (N, 3) and moment (N,) of the base on the manipulator; p and L at states of momenta."""
    at = states() if at is None else at
    total = np.sum([wrench(at.placement(body), J[None])[..., 0] for body, J in bodies(masses).items()], axis=0)
    moment = total[:, 3:] + sum((rotor.effort(at, "moment").b for rotor in rotors(masses)), np.zeros(3))
    return total[:, :3], moment @ NORMAL


def held(masses: Masses) -> tuple[Array, Array]:
    """Momentum (N, 3) and angular momentum (N,) about the origin."""
    total = np.sum([momentum(states().placement(b), J[None])[..., 0] for b, J in bodies(masses).items()], axis=0)
    spin = sum((rotor.effort(momenta(), "moment").b for rotor in rotors(masses)), np.zeros(3))
    return total[:, :3], (total[:, 3:] + spin) @ NORMAL


@functools.cache
def momenta() -> eq.States:
    """The same states with velocities for accelerations."""
    return states().momenta


def torques(masses: Masses) -> Array:
    """Input torques (N, 3)."""
    at = states()
    moved = [inertial_effort(at, body, J[None])[..., 0] for body, J in bodies(masses).items()]
    return np.sum([*moved, *(rotor.effort(at, "drive").b for rotor in rotors(masses))], axis=0)


@functools.cache
def angles() -> tuple[Array, Array, Array]:
    """Changes, rates and accelerations (N, 7) of theta_1..3, psi_1..3 and phi."""
    at, mechanism = states(), manipulator()
    cranks = [mechanism.joint_id(f"crank_{i}_joint") for i in LEGS]
    rods = [mechanism.joint_id(f"rod_{i}_joint") for i in LEGS]
    turn = mechanism.joint_id("platform_turn")
    assert at.rates is not None
    parts = (at.kin.q - at.kin.q[0], at.rates.velocity, at.rates.acceleration)
    return tuple(np.hstack([x[:, cranks], x[:, cranks] + x[:, rods], x[:, [turn]]]) for x in parts)  # type: ignore[return-value]


def factors(masses: Masses) -> Array:
    """K_i, K_i+3 and the platform's remainder (7,) of Eqs. 20 and 21, kg m^2."""
    plain = replace(masses, own=(0.0, 0.0))
    rest = masses.platform - PLATFORM * (SIDE / math.sqrt(3)) ** 2
    second, first = turned(plain)
    return np.array([first] * 3 + [second] * 3 + [rest])


@functools.cache
def law() -> eq.FlywheelLaw:
    """The flywheel's rotation for I_pl = 0.015 kg m^2, I* = 0.01 kg m^2."""
    moment, spin = base(WHEEL)[1], held(WHEEL)[1]
    wheel = eq.Flywheel("wheel", inertia=WHEEL_INERTIA)
    return wheel.law(time(), np.outer(moment, NORMAL), np.outer(spin, NORMAL))


def largest(values: Array) -> float:
    """The largest magnitude; of vectors the largest length."""
    return float(np.abs(values).max() if values.ndim == 1 else np.linalg.norm(values, axis=1).max())


def row(instant: float) -> int:
    """The sample at an instant, s."""
    return round(instant / T * (SAMPLES - 1))


def measure(pins: Array, elbows: Array) -> float:
    """Least singular value of [d_i, (q_i x d_i) / r], as `platform_measure`, from points (3, 2)."""
    along = (pins - elbows) / np.linalg.norm(pins - elbows, axis=1)[:, None]
    arm = pins - pins.mean(axis=0)
    lever = (arm[:, 0] * along[:, 1] - arm[:, 1] * along[:, 0]) / np.linalg.norm(arm, axis=1).mean()
    return float(np.linalg.svd(np.column_stack([along, lever]), compute_uv=False)[-1])


def elbow(leg: int, turns: float, pivots: tuple[tuple[float, float], ...] = PIVOTS) -> Array:
    """The elbow A_i at theta_i = turns pi."""
    return np.array(pivots[leg - 1]) + L * np.array([math.cos(turns * math.pi), math.sin(turns * math.pi)])
