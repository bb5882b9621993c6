"""The link of sections 2 and 3, and the leg of section 4, over the public interface."""

from __future__ import annotations

import functools
import math

import numpy as np

import equipoise as eq
from equipoise.affine import Array

G = 9.81
JOINT = "link_joint"
MASS, COM = 8.0, 0.183
R, Y_B, FREE_LENGTH = 0.3, 0.16, 0.3
WIRE_1 = eq.WireMass(diameter=0.04, coils=80, wire_length=10.38)
WIRE_2 = eq.WireMass(diameter=0.04, coils=80, wire_length=8.0)
LINE = eq.Line(eq.Point("world", (0.0, 0.0, Y_B)), eq.Point("link", (R, 0.0, 0.0)))


@functools.cache
def link() -> eq.Mechanism:
    """The rotating link of Fig. 1; its angle counts from straight up."""
    return eq.chain([eq.Link("link", length=R, mass=MASS, com=COM)], datum="up")


@functools.cache
def over(step: float) -> eq.Sweep:
    """120 to 180 deg in steps of `step` deg, ends included."""
    return eq.Sweep.grid(link(), {JOINT: (math.radians(120), math.radians(180), round(60 / step) + 1)})


@functools.cache
def states(step: float) -> eq.States:
    """The kinematics of a grid."""
    return link().states(over(step))


def zero_free_length(k: float | None, mass: float | eq.WireMass = 0.0) -> eq.Spring:
    """The spring of section 3.1."""
    return eq.Spring("s", LINE, eq.ZeroFreeLength(k), mass=mass)


def coil(k: float | None, mass: float | eq.WireMass = 0.0) -> eq.Spring:
    """The spring of section 3.2: free length 0.3 m, no initial tension."""
    return eq.Spring("s", LINE, eq.Coil(FREE_LENGTH, k=k, closed_length=FREE_LENGTH), mass=mass)


def moment(spring: eq.Spring | None = None, step: float = 0.1) -> Array:
    """Moment -dV/dphi (N,) of the link's weight and of a spring, N m."""
    held = states(step).holding
    if spring is not None:
        held = held + spring.effort(states(step), "hold").b
    return -held[:, 0]


def heavy_rate() -> float:
    """The rate of section 3.1 with the spring's own mass, Eqs. 8 to 10."""
    return eq.exact_rate_zero_free_length(MASS * COM / R, Y_B, WIRE_1, G)


@functools.cache
def best_rate() -> float:
    """The rate of section 3.2 with the least rms on the paper's grid, the spring's own mass included."""
    return eq.exact_rate(link(), [coil(1.0, WIRE_2)], states(5))


@functools.cache
def light_rate() -> float:
    """The rate of the weightless spring of section 3.1, by the convex program."""
    return eq.balance(link(), [zero_free_length(None)], over(5)).values["s.k"]


def rms(k: float) -> float:
    """Rms of the unbalanced moment on the paper's grid, the spring's own mass included, N m."""
    return float(np.sqrt(np.mean(moment(coil(k, WIRE_2), step=5) ** 2)))


def peak(k: float, mass: float | eq.WireMass = WIRE_2) -> float:
    """Largest unbalanced moment of section 3.2, N m."""
    return float(np.abs(moment(coil(k, mass))).max())


# The leg: thigh and shank with foot, hip and knee; A at the centre of the masses that turn about the knee.
THIGH, SHANK = 0.4322, 0.421
M_THIGH, M_SHANK = 7.39, 3.11 + 0.97
M = M_SHANK + M_THIGH * 0.41
S_M = M_SHANK * 0.44 * SHANK / M
WIRE_S1 = eq.WireMass(diameter=0.04, coils=66, wire_length=8.6)
WIRE_S2 = eq.WireMass(diameter=0.04, coils=62, wire_length=7.8)
HIP = eq.Point("world", (0.0, 0.0, 0.0))
A = eq.Point("shank", (S_M, 0.0, 0.0))


@functools.cache
def leg() -> eq.Mechanism:
    """The two links of Fig. 7 with their own masses."""
    return eq.chain(
        [
            eq.Link("thigh", length=THIGH, mass=M_THIGH, com=0.41 * THIGH),
            eq.Link("shank", length=SHANK, mass=M_SHANK, com=0.44 * SHANK),
        ]
    )


def upper(k: float, height: float) -> eq.Spring:
    """S1: zero free length, from B above the hip to A."""
    return eq.Spring("s1", eq.Line(eq.Point("world", (0.0, 0.0, height)), A), eq.ZeroFreeLength(k), mass=WIRE_S1)


def lower(law: eq.ZeroFreeLength | eq.Linear | eq.Constant, k: float) -> eq.Spring:
    """S2 from the hip to A, with the wire mass that belongs to the rate k."""
    return eq.Spring("s2", eq.Line(HIP, A), law, mass=float(WIRE_S2.of(k)))


def height(k: float) -> float:
    """l_OB of Eq. 44 for the rate k, m: what the paper does not print."""
    return (M + 0.5 * float(WIRE_S1.of(k) + WIRE_S2.of(k))) * G / k


def knee(high: float = 60.0) -> eq.Sweep:
    """Knee angles from straight to `high` deg in steps of 1 deg; the hip does not matter."""
    return eq.Sweep.grid(leg(), {"shank_joint": (0.0, np.radians(high), round(high) + 1)})
