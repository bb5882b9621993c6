"""Section 2.2 as printed: sums over the grid, their square, and the cubic in z = sqrt(k)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equipoise.balancers.heavy import heavy
from equipoise.papers.arakelian_ghazaryan_2008.model import WIRE_2, coil, link, states

STEP = 5.0


@dataclass(frozen=True)
class Cubic:
    """z^3 + a z^2 + b z + c = 0 with Q and R of Eqs. 24 and 25; z^2 = k, N/m."""

    a: float
    b: float
    c: float

    @property
    def Q(self) -> float:  # noqa: N802 - the paper's letter
        """(a^2 - 3 b) / 9."""
        return (self.a**2 - 3 * self.b) / 9

    @property
    def R(self) -> float:  # noqa: N802 - the paper's letter
        """(2 a^3 - 9 a b + 27 c) / 54."""
        return (2 * self.a**3 - 9 * self.a * self.b + 27 * self.c) / 54

    @property
    def roots(self) -> tuple[float, float, float]:
        """Three real roots by Eqs. 26 to 28, with t = arccos(R / sqrt(Q^3)) / 3."""
        t = np.arccos(self.R / np.sqrt(self.Q**3)) / 3
        z = -2 * np.sqrt(self.Q) * np.cos(t + 2 * np.pi / 3 * np.array([0, 1, -1])) - self.a / 3
        return float(z[0]), float(z[1]), float(z[2])

    def single_root(self, A: float) -> float:
        """The real root A + B - a / 3 of Eqs. 31 and 32 from A of Eq. 30."""
        return A + (self.Q / A if A else 0.0) - self.a / 3

    def left(self, z: float) -> float:
        """What the cubic leaves at z."""
        return z**3 + self.a * z**2 + self.b * z + self.c


PRINTED = Cubic(-5.3, -989.7, 1748.8)
"""Eq. 34, from which the paper goes on."""


def sums() -> tuple[float, float, float]:
    """C1, C2, C3 of Eqs. 15 to 17 over 120, 125, ..., 180 deg: link, spring mass per sqrt(k), spring force per k."""
    rows = heavy(link(), [coil(1.0, WIRE_2)], states(STEP))
    return -float(rows.load.sum()), -float(rows.sag.sum()), -float(rows.pull.sum())


def squared_sum() -> Cubic:
    """Eqs. 20 to 22: the stationary points of the square of the summed moments, Eq. 14."""
    C1, C2, C3 = sums()
    return Cubic(3 * C2 / (2 * C3), (C2**2 + 2 * C1 * C3) / (2 * C3**2), C1 * C2 / (2 * C3**2))


def first_part(cubic: Cubic, *, mended: bool) -> float:
    """A of Eq. 30 to the letter, or with the cube root over the whole sum."""
    size, rest = abs(cubic.R), np.sqrt(cubic.R**2 - cubic.Q**3)
    return float(-np.sign(cubic.R) * (np.cbrt(size + rest) if mended else np.cbrt(size) + rest))
