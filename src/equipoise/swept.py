"""The room that a spring with its rods, cranks and cables takes as the mechanism moves."""

from __future__ import annotations

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.balancers.paths import Path
from equipoise.states import States

POSES = 32


def swept_box(path: Path, states: States) -> Array:
    """Corners (2, 3), m, of the box in world axes that spring, bars and cables of a path sweep.

    Judged at some tens of the states, those with the extreme lengths among them; widths of parts are not counted.
    """
    rows = telling(path, states)
    few = states.take(rows)
    points = [point for row in range(len(rows)) for point in path.sketch(few, row).points]
    return np.stack([np.min(points, axis=0), np.max(points, axis=0)])


def telling(path: Path, states: States, count: int = POSES) -> Indices:
    """Numbers of an even choice of the states and of those with the least and greatest length."""
    length = path.deform(states)[0]
    even = np.linspace(0, len(states) - 1, min(count, len(states))).astype(int)
    return np.unique([*even, int(length.argmin()), int(length.argmax())])
