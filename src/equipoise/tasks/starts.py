"""Many starts, each descending on few states, the best again on all."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from equipoise.affine import Array
from equipoise.solve.shape import Build, Freedom, Judge, Local, Optima, descend, distinct, screen, spread_out

PER_START = 24
"""Geometries that are screened for every start."""

NOTHING = 1e-8
"""Share of the load below which a start has found an exact balance, which no other can better."""

Progress = Callable[[int, int, float], None]


def descend_all(
    coarse: Build,
    fine: Build | None,
    freedoms: Sequence[Freedom],
    present: Array | None,
    load: float,
    *,
    rows: int,
    judge: Judge,
    starts: int,
    seed: int,
    progress: Progress | None,
) -> Optima:
    """All starts over few states, `rows` of them, the present geometry first; the best distinct ones again over all."""
    if present is not None and starts == 1:
        begin = present
    else:
        ranked, _ = screen(coarse, rows, freedoms, PER_START * starts, seed, 10 * load, judge)
        begin = spread_out(ranked, freedoms, starts)
        begin = begin if present is None else np.vstack([present, begin[: starts - 1]])
    found: list[Local] = []
    try:
        for done, gamma in enumerate(begin, 1):
            found.append(descend(coarse, freedoms, gamma, load, precision=1e-9 if fine is None else 1e-7))
            if progress:
                progress(done, len(begin), min(local.merit for local in found))
            if _settled(found, load):
                break
    except KeyboardInterrupt:
        if not found:
            raise
    found.sort(key=lambda local: local.merit)
    if fine is not None:
        finalists = _distinct(found, freedoms, 3)
        polished = [descend(fine, freedoms, local.gamma, load, radius=0.05) for local in finalists]
        rest = [local for local in found if local not in finalists]
        found = sorted(polished, key=lambda local: local.merit) + rest
    return Optima(tuple(found), seed)


def _settled(found: list[Local], load: float) -> bool:
    """Whether one start leaves nothing of the load, or all so far make it unlikely that an optimum is still unseen.

    n starts that ended in w optima let expect w (n - 1) / (n - w - 2) of them in all (Boender and Rinnooy Kan,
    unsourced); the search ends when that is less than half an optimum more than were seen.
    """
    if min(local.merit for local in found) <= NOTHING * load:
        return True
    n, w = len(found), distinct(found)
    return n > w + 2 and w * (n - 1) / (n - w - 2) < w + 0.5


def _distinct(found: list[Local], freedoms: Sequence[Freedom], count: int) -> list[Local]:
    """The best local optima that differ in value or place."""
    chosen: list[Local] = []
    for local in found:
        near = any(
            all(
                abs(a - b) <= 1e-2 * (f.upper - f.lower) for a, b, f in zip(local.gamma, o.gamma, freedoms, strict=True)
            )
            for o in chosen
        )
        if not near:
            chosen.append(local)
        if len(chosen) == count:
            break
    return chosen
