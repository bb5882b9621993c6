"""How much room springs take: the line that a coil lies along, and its half width."""

from __future__ import annotations

from typing import Any

import numpy as np

from equipoise.balancers.laws.law import Law
from equipoise.balancers.paths import Cable, Line
from equipoise.balancers.spring import Spring
from equipoise.mechanism import Mechanism
from equipoise.parts import WindableSpring
from equipoise.parts.helical import Helical

NESTS = (1.0, 2.0, 1 + 2 / np.sqrt(3), 1 + np.sqrt(2), 2.7013, 3.0, 3.0)
"""Radius of the least circle about 1 to 7 circles of radius 1."""

FILLED = 0.66
"""Share of a circle that more circles of one size fill at least."""


def outside(law: Law) -> Any:
    """Outside diameter, m, of one coil; None where the law does not say it."""
    if isinstance(law, WindableSpring):
        return law.outside
    return law.diameter + law.wire if isinstance(law, Helical) else None


def side_by_side(law: Law) -> float:
    """How many coils act in parallel."""
    return float(np.real(getattr(law, "number", 1.0)))


def half_width(law: Law) -> Any:
    """Half the width, m, of all coils in parallel as one round bundle; 0 where the law does not say it.

    R = rho(n) (D + d) / 2,   rho the radius of the least circle about n circles of radius 1
    """
    one = outside(law)
    if one is None:
        return 0.0
    number = side_by_side(law)
    few = number <= len(NESTS)
    nest = np.interp(number, np.arange(1, len(NESTS) + 1), NESTS) if few else np.sqrt(number / FILLED)
    return nest * one / 2


def coil(spring: Spring, mechanism: Mechanism) -> Line | None:
    """The line from the far end to the guide of a coil that lies along a body behind a cable; None for others."""
    path = spring.path
    if not isinstance(path, Cable) or len(path.through) < 3:
        return None
    a, b = path.points[:2]
    groups = {int(mechanism.model.body_weldid[mechanism.body_id(point.body)]) for point in (a, b)}
    return Line(a, b) if len(groups) == 1 else None
