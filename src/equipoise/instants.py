"""Peaks between the instants of a motion."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.mechanism import Mechanism
from equipoise.states import States
from equipoise.sweep import Sweep

HILLS = 6
GRID = np.linspace(0.0, 1.0, 9)
CLOSE = 1.0 / 32.0
VERTICES = 2
FAINT = 1e-12
TINY = 1e-300

Magnitudes = Callable[[States], Array]
"""states -> magnitudes (N, R), not negative."""


def between(mechanism: Mechanism, sweep: Sweep, sampled: Array, account: Magnitudes) -> Array:
    """Peaks (R,) of sampled magnitudes (N, R): the hills that may be the highest are searched between their neighbours.

    All hills together are sampled on one fine grid each, then at the vertex of the parabola through the three highest
    neighbours and close beside it, twice: the vertex is missed by far less than what it changes. Sweeps that are no
    motion in time keep their samples.
    """
    peaks = sampled.max(axis=0, initial=0.0)
    if sweep.instants is None or len(sampled) < 3 or not sampled.shape[1]:
        return peaks
    time = sweep.instants.time
    order = np.argsort(time, kind="stable")
    time = time[order]
    best, row = _hills(sampled[order], peaks)
    if not len(row):
        return peaks
    low, high = time[np.maximum(best - 1, 0)], time[np.minimum(best + 1, len(time) - 1)]
    which = np.arange(len(row))

    def seen(places: Array) -> Array:
        found = account(mechanism.states(sweep.at(places.reshape(-1, 1))))
        found = found.reshape(len(sweep.scenarios), len(row), places.shape[1], -1).max(axis=0)
        values = found[which, :, row]
        np.maximum.at(peaks, row, values.max(axis=1))
        return values

    places = low[:, None] + (high - low)[:, None] * GRID
    values = seen(places)
    middle = np.clip(values.argmax(axis=1), 1, len(GRID) - 2)[:, None] + np.arange(-1, 2)
    places, values = (np.take_along_axis(part, middle, axis=1) for part in (places, values))
    for _ in range(VERTICES):
        aside = CLOSE * (places[:, 2] - places[:, 0])
        vertex = np.clip(_vertex(places, values), low + aside, high - aside)
        places = vertex[:, None] + aside[:, None] * np.arange(-1, 2)
        values = seen(places)
    return peaks


def _hills(sampled: Array, peaks: Array) -> tuple[Indices, Indices]:
    """Samples (H,) that may stand beside the peak of a row, and the rows (H,).

    A parabola through a hill and its neighbours rises by (right - left)^2 / 8 fall, less than an eighth of what the
    hill falls to both: one that is lower than the highest by more than the whole fall is left out, the others are
    ranked by where the parabola ends.
    """
    loaded = np.flatnonzero(peaks > FAINT * peaks.max())
    sampled = sampled[:, loaded]
    padded = np.pad(sampled, ((1, 1), (0, 0)), mode="edge")
    hill = (sampled >= padded[:-2]) & (sampled >= padded[2:])
    fall = 2.0 * sampled - padded[:-2] - padded[2:]
    hill &= sampled + fall >= sampled.max(axis=0)
    top = sampled + (padded[2:] - padded[:-2]) ** 2 / (8.0 * np.maximum(fall, TINY))
    place, row = np.nonzero(hill)
    order = np.lexsort((-top[place, row], row))
    place, row = place[order], row[order]
    rank = np.arange(len(row)) - np.searchsorted(row, row)
    return place[rank < HILLS], loaded[row[rank < HILLS]]


def _vertex(places: Array, values: Array) -> Array:
    """Where parabolas through three places (H, 3) with values (H, 3) are highest; the highest place where none is."""
    left, right = places[:, 1] - places[:, 0], places[:, 2] - places[:, 1]
    rise, drop = (values[:, 1] - values[:, 0]) / left, (values[:, 1] - values[:, 2]) / right
    bend = rise + drop
    vertex = places[:, 1] + 0.5 * (rise * right - drop * left) / np.maximum(bend, TINY)
    top = places[np.arange(len(places)), values.argmax(axis=1)]
    return np.where(bend > 0, np.clip(vertex, places[:, 0], places[:, 2]), top)
