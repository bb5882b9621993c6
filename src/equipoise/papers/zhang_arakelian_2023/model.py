"""The compensator of Fig. 1 over the public interface, and the synthesis of section III."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import equipoise as eq
from equipoise.affine import Array

G = 9.81
JOINT = "link_joint"
K, FREE = 1000.0, 1.0
WEIGHT, S = 75.0, 0.84
MOMENT = WEIGHT * S
UPRIGHT = eq.Mount(eq.Point("world"), direction=(0.0, 0.0, 1.0), axis=(0.0, 1.0, 0.0))


@functools.cache
def link() -> eq.Mechanism:
    """The rotating link; its angle counts from straight up."""
    return eq.chain([eq.Link("link", length=S, mass=WEIGHT / G, com=S)], datum="up")


@functools.cache
def at(*degrees: float) -> eq.States:
    """The link at prescribed angles, deg."""
    return link().states(eq.Sweep.of_poses(link(), [{JOINT: float(np.radians(angle))} for angle in degrees]))


@functools.cache
def over(step: float = 1.0) -> eq.Sweep:
    """30 to 150 deg in steps of `step` deg, ends included."""
    return eq.Sweep.grid(link(), {JOINT: (float(np.radians(30)), float(np.radians(150)), round(120 / step) + 1)})


@functools.cache
def states(step: float = 1.0) -> eq.States:
    """The kinematics of that grid."""
    return link().states(over(step))


@dataclass(frozen=True)
class Dyad:
    """Crank r, rod l (m) and the crank's lag beta (rad) behind the link."""

    r: float
    l: float  # noqa: E741 - the paper's letter
    beta: float

    def spring(self, *, rate: float = K, free: float = FREE, mass: float = 0.0) -> eq.Spring:
        """The spring on the dyad's slider, which it pushes up."""
        path = eq.SliderCrank(eq.Angle(JOINT), crank=self.r, rod=self.l, phase=-self.beta, mount=UPRIGHT)
        return eq.Spring("s", path, eq.Coil(free, k=rate), mass=mass)

    def moment(self, states: eq.States, spring: eq.Spring | None = None) -> Array:
        """Unbalanced moment -dP/dphi (N,), N m."""
        held = states.holding + (spring or self.spring()).effort(states, "hold").b
        return -held[:, 0]

    def height(self, states: eq.States) -> Array:
        """The slider's height y (N,), m."""
        return self.spring().path.deform(states)[0]


def heights(states: eq.States, energy: float) -> Array:
    """Slider heights y_i (N,) that keep the energy constant, Eqs. 5 to 7 with the minus sign: the spring pushes."""
    gravity = MOMENT * (1 + np.cos(states.driven[:, 0]))
    return FREE - np.sqrt((2 * energy - 2 * gravity) / K)


def synthesis(positions: tuple[float, ...], energy: float) -> Dyad:
    """The dyad of section III for prescribed positions, deg."""
    prescribed = eq.Prescribed(tuple(np.radians(positions).tolist()), energy=energy)
    path = prescribed.apply(link(), Dyad(0.1, 0.5, 0.0).spring(), over()).path
    assert isinstance(path, eq.SliderCrank)
    assert path.crank is not None
    assert path.rod is not None
    return Dyad(path.crank, path.rod, -path.phase)


def largest(moment: Array) -> float:
    """max |M|."""
    return float(np.abs(moment).max())


def rms(moment: Array) -> float:
    """sqrt(mean M^2)."""
    return float(np.sqrt(np.mean(moment**2)))


def signed_sum(moment: Array) -> float:
    """|sum M|: what Eqs. 31 and 32 bring to zero."""
    return float(np.abs(moment.sum()))


@functools.cache
def best_energy(
    positions: tuple[float, ...], judge: Callable[[Array], float], step: float | None = None
) -> tuple[float, Dyad]:
    """The energy C, J, whose dyad makes judge(moments) least, and that dyad.

    Judged at the prescribed positions, or on 30 to 150 deg in steps of `step` deg.
    """
    from scipy.optimize import minimize_scalar

    where = at(*positions) if step is None else states(step)

    def cost(energy: float) -> float:
        return judge(synthesis(positions, energy).moment(where))

    scan = np.linspace(*ENERGIES, 13)
    best, width = min(scan.tolist(), key=cost), scan[1] - scan[0]
    found: Any = minimize_scalar(cost, bounds=(best - width, best + width), method="bounded", options={"xatol": 1e-8})
    return float(found.x), synthesis(positions, float(found.x))


ENERGIES = (140.0, 260.0)
THREE = (30.0, 90.0, 150.0)
PRINTED = (30.0, 60.0, 120.0)
MANY = tuple(float(angle) for angle in range(30, 151))


def design(positions: tuple[float, ...]) -> tuple[float, Dyad]:
    """Energy and dyad for prescribed positions by the least largest moment at them, which gives the paper's digits."""
    return best_energy(positions, largest)
