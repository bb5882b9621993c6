"""Where no bound is at hand: the peak between the samples, estimated from local slopes and sampled curvature."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from equipoise.affine import Array
from equipoise.verification.boxes import Found, Judged, search

STEP = 1e-3
SAFETY = 1.5
SAMPLES = 128
WORK = 30_000
CHUNK = 512

Residual = Callable[[Array], Array]


def estimate(residual: Residual, box: Array, peak: float, *, relative: float, of_load: float, budget: int) -> Found:
    """An estimate of max |r| over a box (n, 2), by branch and bound with

        |r(y)| <= |r(c)| + sum_i |dr/dy_i(c)| h_i + sum_ik M_ik h_i h_k / 2

    slopes by central differences; M is 1.5 times the largest second derivative at random places, which is why this is
    no bound. residual maps places (N, n) to efforts (S, N) of one joint; peak is a value known to be reached. At most
    `budget` cells are judged, and about WORK efforts. Raises LoopError where loops do not close in the box.
    """
    local = _Local(residual, box)
    samples = box[:, 0] + np.random.default_rng(1).random((SAMPLES, len(box))) * np.ptp(box, axis=1)
    load = float(np.abs(residual(samples)).max())
    cost = len(residual(samples[:1])) * (2 * len(local.swept) + 1)
    few = max(4, WORK // (2 * cost * max(1, len(local.swept))))
    curvature = SAFETY * local.curvature(samples[:few])
    return search(
        lambda centre, half: local.judge(centre, half, curvature),
        box[local.swept],
        peak,
        relative=relative,
        absolute=of_load * load,
        budget=max(64, min(budget, WORK // cost)),
        chunk=CHUNK,
    )


class _Local:
    """Efforts of one joint with their slopes along the swept coordinates, by central differences."""

    def __init__(self, residual: Residual, box: Array) -> None:
        self.residual = residual
        self.middle = box.mean(axis=1)
        span = np.ptp(box, axis=1)
        self.swept = np.flatnonzero(span > 0)
        self.step = STEP * np.minimum(1.0, span[self.swept])
        shifts = np.zeros((len(self.swept), len(box)))
        shifts[np.arange(len(self.swept)), self.swept] = self.step
        self.shifts = shifts

    def __call__(self, y: Array) -> tuple[Array, Array]:
        """Efforts (S, N) and slopes (S, N, n) at places (N, n)."""
        moves = np.concatenate([np.zeros((1, y.shape[1])), self.shifts, -self.shifts])
        around = self.residual((y + moves[:, None]).reshape(len(moves) * len(y), y.shape[1]))
        around = around.reshape(len(around), len(moves), len(y))
        ahead, behind = np.split(around[:, 1:], 2, axis=1)
        return around[:, 0], np.moveaxis((ahead - behind) / (2 * self.step[:, None]), 1, -1)

    def curvature(self, y: Array) -> Array:
        """Largest second derivatives (n, n) over places (N, n)."""
        table = np.zeros((len(self.swept), len(self.swept)))
        for place, (shift, step) in enumerate(zip(self.shifts, self.step, strict=True)):
            change = self(y + shift)[1] - self(y - shift)[1]
            table[place] = np.abs(change).max(axis=(0, 1)) / (2 * step)
        return np.maximum(table, table.T)

    def judge(self, centre: Array, half: Array, curvature: Array) -> Judged:
        """Judge cells of the swept coordinates, (C, n) both."""
        y = np.tile(self.middle, (len(centre), 1))
        y[:, self.swept] = centre
        value, slope = self(y)
        linear = np.abs(slope) * half
        second = half * (half @ curvature) / 2
        upper = np.abs(value) + linear.sum(axis=-1) + second.sum(axis=-1)
        weight = linear.max(axis=0) + second
        split = weight.argmax(axis=1) if weight.shape[1] else np.zeros(len(centre), dtype=int)
        return Judged(upper.max(axis=0), np.abs(value).max(axis=0), split)
