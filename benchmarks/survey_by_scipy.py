"""The rows of a survey one by one: plain NumPy and SciPy, nothing of equipoise; what `ratios.py` compares with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

G = 9.81


@dataclass(frozen=True)
class Arm:
    """One hinge at the origin in x-z: a uniform link of a length, m, and mass, kg, over angles, rad."""

    length: float = 0.6
    mass: float = 4.0
    low: float = -1.0
    high: float = 1.2
    poses: int = 361

    @property
    def angles(self) -> np.ndarray:
        return np.linspace(self.low, self.high, self.poses)


BOUNDS = ((-0.3, 0.3), (0.1, 0.8), (0.05, 0.55), (-0.1, 0.1))
"""Fixed end x, z; moving end along and across the link, m."""


def best_geometry(
    arm: Arm, rate: float, rest: float, tension: float, longest: float, mass: float, starts: np.ndarray
) -> tuple[float, np.ndarray]:
    """Least rms torque, N m, of one spring over its four coordinates, its length kept in rest..longest: SLSQP."""
    q = arm.angles
    c, s = np.cos(q), np.sin(q)
    gravity = arm.mass * G * arm.length / 2 * c

    def turned(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        px, pz = x[2] * c - x[3] * s, x[2] * s + x[3] * c
        length = np.hypot(px - x[0], pz - x[1])
        arm_of = ((px - x[0]) * -pz + (pz - x[1]) * px) / length
        return length, arm_of, px

    def square(x: np.ndarray) -> float:
        length, lever, px = turned(x)
        r = gravity + (tension + rate * (length - rest)) * lever + mass / 2 * G * px
        return float(np.mean(r**2))

    def room(x: np.ndarray) -> np.ndarray:
        length = turned(x)[0]
        return np.concatenate([length - rest, longest - length])

    limit = {"type": "ineq", "fun": room}
    best, at = np.inf, starts[0]
    for start in starts:
        found = minimize(square, start, bounds=BOUNDS, constraints=limit, method="SLSQP", options={"maxiter": 200})
        if found.fun < best and room(found.x).min() > -1e-6:
            best, at = float(found.fun), found.x
    return float(np.sqrt(best)), at


def one_by_one(
    arm: Arm, rows: np.ndarray, starts: int, seed: int, say: Callable[[int], None] | None = None
) -> np.ndarray:
    """Rms (C,) of rows (C, 5): rate, rest, tension, longest, mass; inf where no start kept the limits."""
    rng = np.random.default_rng(seed)
    low, high = np.array(BOUNDS).T
    found = np.empty(len(rows))
    for index, row in enumerate(rows):
        found[index] = best_geometry(arm, *row, low + rng.random((starts, 4)) * (high - low))[0]
        if say:
            say(index + 1)
    return found
