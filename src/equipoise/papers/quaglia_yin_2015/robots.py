"""The two robots of the paper with Table 1's data, the poses it looks at, and how it measures what is left."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

import equipoise as eq
from equipoise.affine import Array

MASSES, LENGTHS, CENTRES, CRANK = (100.0, 40.0), (1.2, 1.0), (0.6, 0.5), 0.2
GRAVITY = (0.0, 0.0, -9.8)
LARGEST = (1058.4, 196.0)
"""(m1 r1 + m2 l1) g and m2 r2 g, N m: Eqs. 10 and 24."""
HALF, ELBOW = (-90.0, 90.0), (18.0, 162.0)
"""Ranges of th1 and of the elbow angle phi, deg."""
WORKSPACE = (ELBOW[0] - 270.0, ELBOW[1] - 90.0)
"""Range of th2 = phi + th1 - 180, deg."""
JOINT = eq.Angle("link_joint")
"""The angle of a link alone."""
TINY = 1e-9
"""Percent of the largest torque: rounding."""


@functools.cache
def first(others: tuple[float, float] = (0.0, 0.0)) -> eq.Mechanism:
    """Structure I: both motors on the base, the elbow driven through a parallelogram; links 3 and 4 may weigh, kg."""
    coms = ((CENTRES[0], 0.0), (CENTRES[1], 0.0), None, None)
    (a, b), (c, d) = np.radians((HALF, WORKSPACE)).tolist()
    limits = ((a, b), (c, d))
    return eq.parallelogram_robot(*LENGTHS, -0.4, masses=(*MASSES, *others), coms=coms, limits=limits, gravity=GRAVITY)


@functools.cache
def second() -> eq.Mechanism:
    """Structure II: motor 2 sits at the elbow; joint angles are relative."""
    links = [eq.Link(f"link{i + 1}", LENGTHS[i], MASSES[i], com=CENTRES[i]) for i in range(2)]
    return eq.chain(links, gravity=GRAVITY)


@functools.cache
def alone(link: int) -> eq.Mechanism:
    """One link with all that it carries, its angle absolute: in structure I the links do not see each other."""
    mass = (sum(MASSES), MASSES[1])[link - 1]
    carried = (MASSES[0] * CENTRES[0] + MASSES[1] * LENGTHS[0], MASSES[1] * CENTRES[1])[link - 1]
    return eq.chain([eq.Link("link", LENGTHS[link - 1], mass, com=carried / mass)], gravity=GRAVITY)


def pivoted(name: str, angle: Any, law: Any, alpha: Any = 90.0, ra: Any = 6.0) -> eq.Spring:
    """A spring from a fixed pivot at ra b and alpha deg to the pin of a crank b that turns with an angle."""
    return eq.Spring(name, eq.InvertedSliderCrank(angle, CRANK, ra * CRANK, -np.radians(alpha)), law)


def yoke(name: str, angle: Any, law: Any, phase: float = math.pi, **more: Any) -> eq.Spring:
    """A spring on a Scotch yoke whose crank b turns with an angle; at phase pi a pulling force lifts."""
    return eq.Spring(name, eq.ScotchYoke(angle, CRANK, phase, **more), law)


def at(degrees: Any) -> eq.Sweep:
    """A link alone at given angles to the horizontal, deg."""
    turn = np.radians(np.ravel(degrees))[:, None]
    return eq.Sweep(turn, np.ones(len(turn)), f"{len(turn)} angles")


@functools.cache
def along(low: float = HALF[0], high: float = HALF[1], count: int = 4001) -> eq.Sweep:
    """A link alone that turns evenly from low to high, deg, weighted by the trapezoidal rule."""
    weight = np.ones(count)
    weight[[0, -1]] = 0.5
    return eq.Sweep(np.radians(np.linspace(low, high, count))[:, None], weight, f"({low:g}, {high:g}) deg")


@functools.cache
def workspace(count: int = 6481) -> eq.Sweep:
    """Link 2 where th1 and phi cover their ranges evenly: the density of th2 is a trapezoid, the sweep's weights."""
    degrees = np.linspace(*WORKSPACE, count)
    low, high = np.maximum(HALF[0], degrees + 180.0 - ELBOW[1]), np.minimum(HALF[1], degrees + 180.0 - ELBOW[0])
    weight = np.maximum(high - low, 0.0)
    return eq.Sweep(np.radians(degrees)[:, None], weight, "the workspace of link 2")


def pairs(first_step: float, elbow_step: float) -> tuple[Array, Array]:
    """The same workspace as a grid, ends included: th1 and th2 of all its points, rad; steps in deg."""
    th1 = np.arange(HALF[0], HALF[1] + 1e-9, first_step)
    phi = np.arange(ELBOW[0], ELBOW[1] + 1e-9, elbow_step)
    a, b = (np.radians(axis.ravel()) for axis in np.meshgrid(th1, phi, indexing="ij"))
    return a, a + b - math.pi


def both(th1: Array, th2: Array) -> eq.Sweep:
    """Structure I with its links at given angles to the horizontal, rad."""
    return eq.Sweep(np.stack([th1, th2], axis=1), np.ones(len(th1)), "both links")


def matched(link: int, alpha: Any = 90.0, ra: Any = 6.0) -> Any:
    """The constant force of Eq. 11 (..., 1), N: the one that carries the link where it is level."""
    level = states(link, _LEVEL)
    pull = pivoted("s", JOINT, eq.Constant(), alpha, ra).effort(level, "hold")
    return -level.holding[:, 0] / pull.A[..., 0, 0]


_LEVEL = at(0.0)


def ideal(link: int, ra: float = 6.0, n: float = 1.0) -> eq.Linear:
    """Eqs. 17, 18 and 21: n times the ideal rate, and the same force at the length where the link is level."""
    level, k = CRANK * math.hypot(1.0, ra), LARGEST[link - 1] / (ra * CRANK**2)
    return eq.Linear(k=n * k, preload=(1 - n) * k * level)


def error(link: int, law: Any, sweep: eq.Sweep, alpha: Any = 90.0, ra: Any = 6.0) -> Array:
    """Eq. 19: torque of a pivoted spring less gravity's over the largest of gravity, in percent (..., N)."""
    return left(link, pivoted("s", JOINT, law, alpha, ra), sweep)


def constant_force(link: int, sweep: eq.Sweep, alpha: Any, ra: Any = 6.0) -> Array:
    """Error (..., N), percent, of the constant force of Eq. 11."""
    return error(link, eq.Constant(matched(link, alpha, ra)), sweep, alpha, ra)


def left(link: int, spring: eq.Spring, sweep: eq.Sweep) -> Array:
    """What a spring with a known law leaves of a link's weight, in percent of its largest torque (..., N)."""
    here = states(link, sweep)
    return -100.0 * (here.holding + spring.effort(here, "hold").b)[..., 0] / LARGEST[link - 1]


@functools.lru_cache(maxsize=16)
def states(link: int, sweep: eq.Sweep) -> eq.States:
    """Kinematics of a link alone, kept: the same few sweeps come again and again."""
    return alone(link).states(sweep)


def mean(values: Array, sweep: eq.Sweep) -> Any:
    """Weighted mean of the magnitude over the last axis."""
    return np.abs(values) @ sweep.weight / sweep.weight.sum()


def exact_mean(spring: eq.Spring) -> float:
    """Mean error, percent, of a spring with a known law on link 1 over (-90, 90) deg, by total variation of energy."""
    over = eq.Sweep.grid(alone(1), {"link_joint": (*np.radians(HALF).tolist(), 3)})
    return 100 * eq.exact_mean(eq.balance(alone(1), [spring], over)) / LARGEST[0]


def norms(values: Array, sweep: eq.Sweep) -> dict[str, float]:
    """Mean, root mean square and peak of the magnitude (N,)."""
    square = values**2 @ sweep.weight / sweep.weight.sum()
    return {"mean": float(mean(values, sweep)), "rms": math.sqrt(square), "peak": float(np.abs(values).max())}


def worst(here: eq.States, springs: Sequence[eq.Spring]) -> float:
    """Largest holding torque, N m, that springs with known laws leave."""
    total: Array = here.holding + sum(spring.effort(here, "hold").b for spring in springs)
    return float(np.abs(total).max())
