"""Peaks between the instants of a motion."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from equipoise.affine import Array
from equipoise.mechanism import Mechanism
from equipoise.states import States
from equipoise.sweep import Sweep

HILLS = 6
ROUNDS = 4
POINTS = 9
FAINT = 1e-12

Magnitudes = Callable[[States], Array]
"""states -> magnitudes (N, R), not negative."""


def between(mechanism: Mechanism, sweep: Sweep, sampled: Array, account: Magnitudes) -> Array:
    """Peaks (R,) of sampled magnitudes (N, R): the highest hills of each are searched between their neighbours.

    The grid around a hill is refined until it is 1/256 of the sampling, where a parabola's error is out of sight.
    Sweeps that are no motion in time keep their samples.
    """
    peaks = sampled.max(axis=0, initial=0.0)
    if sweep.instants is None or len(sampled) < 3 or not sampled.shape[1]:
        return peaks
    time = sweep.instants.time
    order = np.argsort(time, kind="stable")
    time, ordered = time[order], sampled[order]
    loaded = np.flatnonzero(peaks > FAINT * peaks.max())
    if not len(loaded):
        return peaks
    ordered = ordered[:, loaded]
    padded = np.pad(ordered, ((1, 1), (0, 0)), constant_values=-np.inf)
    hill = (ordered >= padded[:-2]) & (ordered >= padded[2:])
    highest = np.argsort(np.where(hill, -ordered, np.inf), axis=0)[:HILLS]
    row = np.repeat(loaded[None], len(highest), axis=0).ravel()
    best = highest.ravel()
    low, high = time[np.maximum(best - 1, 0)], time[np.minimum(best + 1, len(time) - 1)]
    which = np.arange(len(best))
    for _ in range(ROUNDS):
        grid = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, POINTS)
        found = account(mechanism.states(sweep.at(grid.reshape(-1, 1))))
        found = found.reshape(len(sweep.scenarios), len(best), POINTS, -1).max(axis=0)
        values = found[which, :, row]
        top = values.argmax(axis=1)
        np.maximum.at(peaks, row, values[which, top])
        low, high = grid[which, np.maximum(top - 1, 0)], grid[which, np.minimum(top + 1, POINTS - 1)]
    return peaks
