"""Inertias that MuJoCo refuses: the nearest one it takes, with the mass and its centre untouched."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from equipoise.affine import Array
from equipoise.models.notices import some

TOKEN_MASS = 1e-12
"""kg given to a moving link without mass: above MuJoCo's 1e-15, and 1e-11 N of weight."""

LEAST_INERTIA = 1e-12
"""kg m^2: MuJoCo refuses eigenvalues below 1e-14."""

_ROUNDING = 1e-8


@dataclass
class Repairs:
    """Names of links whose inertia was replaced, by reason, and of those that got a token mass."""

    triangle: list[str] = field(default_factory=list)
    sign: list[str] = field(default_factory=list)
    point: list[str] = field(default_factory=list)
    massless: list[str] = field(default_factory=list)

    def remarks(self) -> Iterator[str]:
        """One sentence per reason."""
        rest = "statics does not need it, dynamics must not trust it"
        if self.triangle:
            yield f"{_inertia(self.triangle)} not physical (A + B < C) and replaced; {rest}"
        if self.sign:
            yield f"{_inertia(self.sign)} not positive and replaced; {rest}"
        if self.point:
            yield f"{_inertia(self.point)} zero (a point mass) and set to {LEAST_INERTIA:g} kg m^2; {rest}"
        if self.massless:
            one = len(self.massless) == 1
            subject = f"moving link {self.massless[0]} has" if one else f"moving links {some(self.massless)} have"
            each = "" if one else " each"
            yield f"{subject} no mass in the file and got {TOKEN_MASS:g} kg{each}: check that no weight is missing"


def _inertia(names: list[str]) -> str:
    return f"inertia of link {names[0]} was" if len(names) == 1 else f"inertias of links {some(names)} were"


def valid_inertia(matrix: Array, name: str, repairs: Repairs) -> Array:
    """The inertia matrix (3, 3), kg m^2, shifted by the least multiple of the identity that makes it valid.

    Valid: eigenvalues A <= B <= C positive and A + B >= C. A shift keeps the principal axes.
    """
    least, middle, most = np.linalg.eigvalsh(matrix)
    floor = max(LEAST_INERTIA, 1e-9 * abs(most))
    # MuJoCo compares without tolerance: a plate printed to six digits fails at the last of them.
    gap = most * (1.0 + 1e-10) - least - middle
    lift = max(0.0, floor - least, gap)
    if not lift:
        return matrix
    scale = max(abs(least), abs(most))
    if scale < LEAST_INERTIA:
        repairs.point.append(name)
    elif least <= 0.0:
        repairs.sign.append(name)
    elif gap > _ROUNDING * scale:
        repairs.triangle.append(name)
    # What is left is a lift in the last printed digits, not worth a word.
    return matrix + lift * np.eye(3)
