"""Where no bound is at hand: the peak between the samples, estimated from local slopes and sampled curvature."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from equipoise.affine import Array
from equipoise.verification.boxes import Found, Judged, search

STEP = 1e-3
SAFETY = 1.5
SAMPLES = 128
WORK = 100_000
CHUNK = 512

Residual = Callable[[Array], Array]


def estimate(
    residual: Residual,
    box: Array,
    peaks: Sequence[float],
    *,
    relative: float,
    of_load: float,
    budget: int,
) -> list[Found]:
    """An estimate of max |r_j| over a box for each driven joint, by branch and bound with

        |r_j(q)| <= |r_j(c)| + sum_i |dr_j/dq_i(c)| h_i + sum_ik M_jik h_i h_k / 2

    slopes by central differences; M is 1.5 times the largest second derivative at random positions, which is
    why this is no bound. residual maps positions (N, nd) to efforts (S, N, nd); peaks are values known to be
    reached. Raises LoopError where loops do not close in the box.
    """
    local = _Local(residual, box)
    samples = box[:, 0] + np.random.default_rng(1).random((SAMPLES, len(box))) * np.ptp(box, axis=1)
    scenarios = len(residual(samples[:1]))
    cost = scenarios * (2 * len(local.swept) + 1)
    few = max(4, WORK // (2 * cost * max(1, len(local.swept))))
    curvature = SAFETY * local.curvature(samples[:few])
    loads = np.abs(residual(samples)).max(axis=(0, 1))
    return [
        search(
            lambda centre, half, row=row: local.judge(centre, half, row, curvature[row]),
            box[local.swept],
            peaks[row],
            relative=relative,
            absolute=of_load * float(loads[row]),
            budget=max(64, min(budget, WORK // (cost * len(peaks)))),
            chunk=CHUNK,
        )
        for row in range(len(peaks))
    ]


class _Local:
    """Efforts of all joints with their slopes along the swept joints, by central differences."""

    def __init__(self, residual: Residual, box: Array) -> None:
        self.residual = residual
        self.middle = box.mean(axis=1)
        span = np.ptp(box, axis=1)
        self.swept = np.flatnonzero(span > 0)
        self.step = STEP * np.minimum(1.0, span[self.swept])
        shifts = np.zeros((len(self.swept), len(box)))
        shifts[np.arange(len(self.swept)), self.swept] = self.step
        self.shifts = shifts

    def __call__(self, q: Array) -> tuple[Array, Array]:
        """Efforts (S, N, R) and slopes (S, N, R, n) at positions (N, nd)."""
        moves = np.concatenate([np.zeros((1, q.shape[1])), self.shifts, -self.shifts])
        around = self.residual((q + moves[:, None]).reshape(-1, q.shape[1]))
        around = around.reshape(len(around), len(moves), len(q), -1)
        ahead, behind = np.split(around[:, 1:], 2, axis=1)
        return around[:, 0], np.moveaxis((ahead - behind) / (2 * self.step[:, None, None]), 1, -1)

    def curvature(self, q: Array) -> Array:
        """Largest second derivatives (R, n, n) over positions (N, nd)."""
        table = np.zeros((len(self.middle), len(self.swept), len(self.swept)))
        for place, (shift, step) in enumerate(zip(self.shifts, self.step, strict=True)):
            change = self(q + shift)[1] - self(q - shift)[1]
            table[:, place] = np.abs(change).max(axis=(0, 1)) / (2 * step)
        return np.maximum(table, np.swapaxes(table, 1, 2))

    def judge(self, centre: Array, half: Array, row: int, curvature: Array) -> Judged:
        """Judge cells of the swept joints, (C, n) both, for one driven joint."""
        q = np.tile(self.middle, (len(centre), 1))
        q[:, self.swept] = centre
        value, slope = (part[:, :, row] for part in self(q))
        linear = np.abs(slope) * half
        second = half * (half @ curvature) / 2
        upper = np.abs(value) + linear.sum(axis=-1) + second.sum(axis=-1)
        weight = linear.max(axis=0) + second
        split = weight.argmax(axis=1) if weight.shape[1] else np.zeros(len(centre), dtype=int)
        return Judged(upper.max(axis=0), np.abs(value).max(axis=0), split)
