"""Branch and bound over boxes of joint positions, many cells at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array


@dataclass(frozen=True, eq=False)
class Judged:
    """What is known of cells (C,): upper bounds of |r|, values of |r| met inside, the joint to split along."""

    upper: Array
    met: Array
    split: NDArray[np.int_]


Enclose = Callable[[Array, Array], Judged]


@dataclass(frozen=True)
class Found:
    """The bound over the whole box, the largest value met, cells judged, whether the wanted gap was reached."""

    upper: float
    met: float
    cells: int
    complete: bool


def search(
    enclose: Enclose, box: Array, known: float, *, relative: float, absolute: float, budget: int, chunk: int
) -> Found:
    """Bound |r| over a box (n, 2), splitting the cells with the largest bounds first.

    enclose(centre (C, n), half (C, n)) judges cells; known is a value of |r| that is reached somewhere. Ends
    when no cell's bound exceeds the largest value met by more than `relative` of it and `absolute`, or after
    `budget` cells: the bound holds either way. Hand-written because all cells of a turn are judged in one batch.
    """
    centre, half = box.mean(axis=1)[None], np.ptp(box, axis=1)[None] / 2
    judged = enclose(centre, half)
    upper, split = judged.upper, judged.split
    met, settled, cells = max(known, float(judged.met[0])), -np.inf, 1
    while True:
        live = upper > max(met * (1 + relative), met + absolute)
        settled = max(settled, float(upper[~live].max(initial=-np.inf)))
        centre, half, upper, split = centre[live], half[live], upper[live], split[live]
        if not len(upper) or cells + 2 > budget:
            break
        count = min(len(upper), chunk, (budget - cells) // 2)
        pick = np.argpartition(-upper, count - 1)[:count]
        children = _halves(centre[pick], half[pick], split[pick])
        judged = enclose(*children)
        # A part cannot exceed the whole, whatever its own enclosure says.
        bound = np.minimum(judged.upper, np.tile(upper[pick], 2))
        met, cells = max(met, float(judged.met.max())), cells + 2 * count
        rest = np.ones(len(upper), dtype=bool)
        rest[pick] = False
        centre, half = np.vstack([centre[rest], children[0]]), np.vstack([half[rest], children[1]])
        upper, split = np.concatenate([upper[rest], bound]), np.concatenate([split[rest], judged.split])
    return Found(max(settled, float(upper.max(initial=-np.inf)), met), met, cells, not len(upper))


def _halves(centre: Array, half: Array, split: NDArray[np.int_]) -> tuple[Array, Array]:
    rows = np.arange(len(centre))
    shift = np.zeros_like(half)
    shift[rows, split] = half[rows, split] / 2
    small = half.copy()
    small[rows, split] /= 2
    return np.vstack([centre - shift, centre + shift]), np.vstack([small, small])
