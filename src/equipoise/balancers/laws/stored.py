"""What a tendon can hold of a law: a cubic of the length, exact or the nearest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array

EXACT = 1e-12
ROUNDS = 30
DENSE = 2001


@dataclass(frozen=True)
class Stored:
    """f ~ c0 + c1 x + c2 x^2 + c3 x^3, x = l - rest; N and m, or N m and rad.

    error is the largest |f - cubic| between the lengths it was made for, zero where the law is such a cubic.
    """

    rest: float
    coefficients: tuple[float, float, float, float]
    error: float = 0.0

    @property
    def exact(self) -> bool:
        """Whether the tendon holds the law itself."""
        return self.error == 0.0

    def at(self, length: Array) -> Array:
        """Force at lengths (N,)."""
        x, (c0, c1, c2, c3) = length - self.rest, self.coefficients
        return c0 + x * (c1 + x * (c2 + x * c3))


def store(force: Callable[[Array], Array], low: float, high: float, degree: int | None) -> Stored:
    """The cubic that equals a force of degree <= 3, or else deviates least from it at its worst.

    A straight line with a rest length is written about it; everything else about the middle of [low, high].
    """
    if degree is not None and degree <= 1:
        intercept, total = force(np.array([0.0, 1.0]))
        slope = total - intercept
        if slope > 0 and intercept <= 0:
            return Stored(float(-intercept / slope), (0.0, float(slope), 0.0, 0.0))
        return Stored(0.0, (float(intercept), float(slope), 0.0, 0.0))
    middle, half = (low + high) / 2, max((high - low) / 2, 1e-9)
    scaled, error = nearest_cubic(lambda x: force(middle + half * x))
    exact = degree is not None and degree <= 3
    c0, c1, c2, c3 = (float(c) / half**power for power, c in enumerate(scaled))
    return Stored(middle, (c0, c1, c2, c3), 0.0 if exact else error)


def nearest_cubic(f: Callable[[Array], Array]) -> tuple[Array, float]:
    """Coefficients (4,) of the cubic nearest to f on [-1, 1] in the largest deviation, and that deviation.

    Remez exchange: the deviation takes equal values of alternating sign at five points.
    """
    nodes = -np.cos(np.pi * np.arange(5) / 4)
    x = -np.cos(np.pi * np.arange(DENSE) / (DENSE - 1))
    dense = f(x)
    best: tuple[Array, float] = np.zeros(4), np.inf
    for _ in range(ROUNDS):
        system = np.column_stack([np.vander(nodes, 4, increasing=True), (-1.0) ** np.arange(5)])
        solution = np.asarray(np.linalg.solve(system, f(nodes)), dtype=float)
        deviation = dense - np.polynomial.polynomial.polyval(x, solution[:4])
        worst = float(np.abs(deviation).max())
        if worst < best[1]:
            best = solution[:4], worst
        if worst <= abs(solution[4]) * (1 + 1e-6) + EXACT * np.abs(dense).max():
            break
        nodes = _alternation(x, deviation)
        if len(nodes) != 5:
            break
    return best


def _alternation(x: Array, deviation: Array) -> Array:
    """Five points where the deviation alternates in sign and is largest."""
    starts = np.flatnonzero(np.diff(np.sign(deviation), prepend=0.0))
    runs = [part for part in np.split(np.arange(len(x)), starts) if len(part)]
    peaks = np.array([part[np.abs(deviation[part]).argmax()] for part in runs])
    while len(peaks) > 5:
        ends = np.abs(deviation[peaks[[0, -1]]])
        peaks = peaks[1:] if ends[0] < ends[1] else peaks[:-1]
    return x[peaks]
