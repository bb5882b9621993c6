"""Peaks between the samples: local ascent over the driven joints from the worst samples."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array, Indices

STARTS = 6
FINEST = 1e-6


@dataclass(frozen=True, eq=False)
class Peaks:
    """Per row the largest sampled value, the polished one, and the pose (R, nd) where it stands."""

    sample: Array
    value: Array
    pose: Array


def polish(evaluate: Callable[[Array], Array], poses: Array, magnitude: Array, box: Array | None) -> Peaks:
    """Climb |r| from the worst poses of every row inside a box.

    evaluate maps poses (M, nd) to magnitudes (M, R), the worst over payloads; poses (N, nd) and magnitude
    (N, R) are the samples; box (nd, 2) bounds the ascent, None leaves the samples as they are.
    Each point moves by a separable parabola through its neighbours at +-h on every joint, h shrinking to
    1e-6 of the joint's range.
    """
    worst = magnitude.argmax(axis=0)
    rows = np.arange(magnitude.shape[1])
    sample = magnitude[worst, rows]
    if box is None or not (box[:, 1] > box[:, 0]).any():
        return Peaks(sample, sample.copy(), poses[worst])
    count = min(STARTS, len(poses))
    start = np.argpartition(-magnitude, count - 1, axis=0)[:count]
    points = poses[start.T.ravel()]
    row = np.repeat(rows, count)
    value = magnitude[start.T.ravel(), row]
    points, value = _climb(evaluate, points, row, value, box)
    best = value.reshape(-1, count).argmax(axis=1) + rows * count
    return Peaks(sample, value[best], points[best])


def _climb(evaluate: Callable[[Array], Array], x: Array, row: Indices, f: Array, box: Array) -> tuple[Array, Array]:
    swept = np.flatnonzero(box[:, 1] > box[:, 0])
    span = (box[:, 1] - box[:, 0])[swept]
    step = np.full(len(x), 0.02)
    live = np.arange(len(x))
    x, f = x.copy(), f.copy()

    def at(points: Array, rows: Indices) -> Array:
        flat = points.reshape(-1, points.shape[-1])
        values = evaluate(flat).reshape(*points.shape[:-1], -1)
        return np.take_along_axis(values, rows.reshape(-1, *[1] * (values.ndim - 1)), axis=-1)[..., 0]

    for _ in range(60):
        h = step[live, None] * span
        around = np.repeat(x[live, None, None, :], 2, axis=1).repeat(len(swept), axis=2)
        index = np.arange(len(swept))
        around[:, 0, index, swept] = np.minimum(around[:, 0, index, swept] + h, box[swept, 1])
        around[:, 1, index, swept] = np.maximum(around[:, 1, index, swept] - h, box[swept, 0])
        ahead, behind = np.moveaxis(at(around, row[live]), 1, 0)
        here = f[live, None]
        slope, bend = (ahead - behind) / 2, ahead + behind - 2 * here
        jump = np.where(bend < 0, -slope / np.where(bend < 0, bend, -1.0), 2 * np.sign(slope))
        trial = x[live].copy()
        trial[:, swept] = np.clip(trial[:, swept] + np.clip(jump, -2, 2) * h, box[swept, 0], box[swept, 1])
        jumped = at(trial, row[live])
        near = np.concatenate([ahead, behind], axis=1)
        pick = near.argmax(axis=1)
        single = around[np.arange(len(live)), pick // len(swept), pick % len(swept)]
        best_single = near.max(axis=1)
        better = np.maximum(jumped, best_single)
        moved = np.where((jumped >= best_single)[:, None], trial, single)
        up = better > f[live]
        gain = better - f[live]
        x[live[up]], f[live[up]] = moved[up], better[up]
        small = ~up | (gain <= 1e-7 * np.maximum(f[live], 1e-12))
        step[live[small]] /= 10
        live = live[step[live] > FINEST]
        if not len(live):
            break
    return x, f
