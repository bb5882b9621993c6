"""Peaks between the samples: local ascent over the driven joints from bad samples far from each other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array, Indices

STARTS = 24
CANDIDATES = 256
FAINT = 1e-12
FINISHED = 6
TURNS = 15
LATER = 60
RENEW = 8
SHIFT = 1e-4
ROUNDING = 1e-13
FLATTEST = 1e-9
TINY = 1e-300
JITTER = 0.01
FIRST = 0.1
LONGEST = 0.5
FINEST = 1e-9
SETTLED = 1e-12

Flags = NDArray[np.bool_]
Probe = Callable[[Array, Indices], tuple[Array, Array]]
"""poses (M, nd), rows (M,) -> magnitude (M,) of each pose's row, the worst over payloads, and its slope (M, nd)."""


@dataclass(frozen=True, eq=False)
class Peaks:
    """Per row the largest sampled value, the polished one, and the pose (R, nd) where it stands.

    hills are all poses (H, nd) where an ascent ended, height (H,) what stands there.
    """

    sample: Array
    value: Array
    pose: Array
    hills: Array
    height: Array


def polish(probe: Probe, poses: Array, magnitude: Array, box: Array | None, starts: int = STARTS) -> Peaks:
    """Climb |r| of every row inside a box.

    poses (N, nd) and magnitude (N, R) are the samples; box (nd, 2) bounds the ascent, None leaves the samples
    as they are. Half of a row's `starts` are its worst samples, the others are bad ones far from all chosen
    before, distances counted in how much the row changes along each joint.
    """
    worst = magnitude.argmax(axis=0)
    sample = magnitude.max(axis=0)
    loaded = np.flatnonzero(sample > FAINT * sample.max(initial=0.0))
    if box is None or not (box[:, 1] > box[:, 0]).any() or not len(loaded):
        return Peaks(sample, sample.copy(), poses[worst], poses[:0], sample[:0])
    start, row, reach = _starts(probe, poses, magnitude, box, loaded, starts)
    moves = reach > FAINT * reach.max(axis=1, keepdims=True)
    hills, height = _climb(probe, start, row, box, moves, turns=TURNS)
    best = _best(row, height)
    hills[best], height[best] = _climb(probe, hills[best], row[best], box, moves[best], turns=LATER, renew=RENEW)
    value, pose = sample.copy(), poses[worst]
    for hill in np.argsort(height):
        if height[hill] > value[row[hill]]:
            value[row[hill]], pose[row[hill]] = height[hill], hills[hill]
    return Peaks(sample, value, pose, hills, height)


def _starts(
    probe: Probe, poses: Array, magnitude: Array, box: Array, rows: Indices, starts: int
) -> tuple[Array, Indices, Array]:
    """Poses to climb from, the row that each is for, and how much that row changes along each joint's range."""
    count = min(CANDIDATES, len(poses))
    order = np.argpartition(-magnitude[:, rows], count - 1, axis=0)[:count].T
    span = box[:, 1] - box[:, 0]
    some = order[:, :: max(1, count // starts)]
    # Samples may all lie on a ridge or saddle, where the slope along a joint vanishes: leave them by a hair.
    random = np.random.default_rng(0)
    beside = poses[some] + random.uniform(-JITTER, JITTER, (*some.shape, len(span))) * span
    beside = np.clip(beside, box[:, 0], box[:, 1]).reshape(-1, len(span))
    _, slope = probe(beside, np.repeat(rows, some.shape[1]))
    slope = slope.reshape(*some.shape, -1)
    reach = np.sqrt((slope**2).mean(axis=1)) * span
    chosen = [
        c[_spread(poses[c] / np.where(span > 0, span, 1.0) * w, magnitude[c, r], starts)]
        for r, c, w in zip(rows, order, reach, strict=True)
    ]
    start = np.concatenate([poses[np.append(c[0], c)] for c in chosen])
    place = np.repeat(np.arange(len(rows)), [len(c) + 1 for c in chosen])
    first = np.append(True, place[1:] != place[:-1])
    start[first] += random.uniform(-JITTER, JITTER, (len(rows), len(span))) * span
    return np.clip(start, box[:, 0], box[:, 1]), rows[place], reach[place]


def _spread(places: Array, magnitude: Array, count: int) -> Indices:
    """The worst candidates, and then others that are bad and far from the chosen ones."""
    chosen = np.argsort(-magnitude)[: (count + 1) // 2]
    rank = (magnitude - magnitude.min()) / (np.ptp(magnitude) or 1.0) + 0.1
    distance = np.linalg.norm(places[:, None] - places[chosen], axis=2).min(axis=1)
    while len(chosen) < count:
        further = int((rank * distance).argmax())
        if distance[further] == 0:
            break
        chosen = np.append(chosen, further)
        distance = np.minimum(distance, np.linalg.norm(places - places[further], axis=1))
    return chosen


def _best(row: Indices, height: Array) -> Indices:
    """The few highest hills of every row."""
    order = np.lexsort((-height, row))
    place = np.arange(len(order)) - np.searchsorted(row[order], row[order])
    return order[place < FINISHED]


def _climb(
    probe: Probe, pose: Array, row: Indices, box: Array, moves: Flags, *, turns: int, renew: int | None = None
) -> tuple[Array, Array]:
    """Ascend from poses (H, nd), each for its row, by quasi-Newton steps (BFGS, damped) within a trust region.

    moves (H, nd) are the joints that move the row; those at a bound that the slope pushes against are held. All
    ascents go on together. Every `renew` turns the curvature is measured: along the ridges of many joints BFGS
    alone creeps.
    """
    swept = np.flatnonzero(box[:, 1] > box[:, 0])
    low, span, moves = box[swept, 0], (box[:, 1] - box[:, 0])[swept], moves[:, swept]

    def at(place: Array, which: Indices) -> tuple[Array, Array]:
        full = pose[which]
        full[:, swept] = low + place * span
        value, slope = probe(full, row[which])
        return value, slope[:, swept] * span

    u = (pose[:, swept] - low) / span
    live = np.arange(len(u))
    f, g = at(u, live)
    steepest = np.abs(g).max(axis=1)
    bend = np.eye(len(swept)) * np.maximum(steepest / FIRST, TINY)[:, None, None]
    radius = np.full(len(u), FIRST)
    live = live[steepest > 0]
    for turn in range(turns):
        if not len(live):
            break
        here, slope = u[live], g[live]
        free = moves[live] & ~(((here <= 0) & (slope <= 0)) | ((here >= 1) & (slope >= 0)))
        if renew and turn % renew == 0 and free.any():
            bend[live] = _measured(at, here, slope, free, live)
        step = _step(slope, bend[live], free)
        longest = np.abs(step).max(axis=1)
        step *= np.minimum(1.0, radius[live] / np.maximum(longest, TINY))[:, None]
        there = np.clip(here + step, 0.0, 1.0)
        step = there - here
        value, after = at(there, live)
        bend[live] = _bent(bend[live], step, slope - after)
        up = value > f[live]
        size = np.abs(step).max(axis=1)
        hoped = (slope * step).sum(axis=1)
        radius[live] = np.where(up, np.clip(2 * size, radius[live], LONGEST), 0.3 * size)
        risen = live[up]
        u[risen], f[risen], g[risen] = there[up], value[up], after[up]
        live = live[(radius[live] > FINEST) & (np.abs(hoped) > SETTLED * f[live])]
    pose = pose.copy()
    pose[:, swept] = low + u * span
    return pose, f


def _step(slope: Array, bend: Array, free: Flags) -> Array:
    """The maximum of the quadratic model over the free joints."""
    place, there = _front(free)
    model = np.where(there[:, :, None] & there[:, None, :], _pick(bend, place), 0.0)
    index = np.arange(model.shape[1])
    push = np.where(there, np.take_along_axis(slope, place, axis=1), 0.0)
    steep = model[:, index, index]
    # At rounding level the curvature may vanish along a direction; no step needs to be as long as 1 / ROUNDING.
    ridge = ROUNDING * (np.abs(steep) + np.abs(push)).max(axis=1, keepdims=True) + TINY
    model[:, index, index] = np.where(there, steep + ridge, 1.0)
    step = np.zeros_like(slope)
    np.put_along_axis(step, place, np.linalg.solve(model, push[:, :, None])[:, :, 0], axis=1)
    return step


def _measured(
    at: Callable[[Array, Indices], tuple[Array, Array]], u: Array, slope: Array, free: Flags, which: Indices
) -> Array:
    """Curvatures (H, n, n) of -f among the free joints by differences of slopes, made positive definite.

    The size of negative ones counts, so that a saddle is left and not approached.
    """
    row, joint = np.nonzero(free)
    shift = np.where(u[row, joint] < 0.5, SHIFT, -SHIFT)
    moved = u[row]
    moved[np.arange(len(row)), joint] += shift
    _, there = at(moved, which[row])
    bend = np.zeros((*u.shape, u.shape[1]))
    bend[row, joint] = (slope[row] - there) / shift[:, None]
    place, kept = _front(free)
    small = np.where(kept[:, :, None] & kept[:, None, :], _pick(bend, place), 0.0)
    size, axes = np.linalg.eigh((small + np.swapaxes(small, 1, 2)) / 2)
    size = np.abs(size)
    size = np.maximum(size, FLATTEST * np.maximum(size.max(axis=1, initial=0.0), TINY)[:, None])
    index = np.arange(u.shape[1])
    bend[:] = 0.0
    bend[:, index, index] = size.max(axis=1, initial=TINY)[:, None]
    which_row = np.arange(len(u))[:, None, None]
    bend[which_row, place[:, :, None], place[:, None, :]] = (axes * size[:, None]) @ np.swapaxes(axes, 1, 2)
    return bend


def _front(free: Flags) -> tuple[Indices, Flags]:
    """Joints (H, m) with the free ones of each ascent in front, m the most that any has, and which are free."""
    most = max(1, int(free.sum(axis=1).max()))
    place = np.argsort(~free, axis=1, kind="stable")[:, :most]
    return place, np.take_along_axis(free, place, axis=1)


def _pick(matrix: Array, place: Indices) -> Array:
    """Rows and columns (H, m) of matrices (H, n, n)."""
    return matrix[np.arange(len(matrix))[:, None, None], place[:, :, None], place[:, None, :]]


def _bent(bend: Array, step: Array, fall: Array) -> Array:
    """The BFGS update of curvatures (H, n, n), damped (Powell) so that they stay positive definite."""
    push = (bend @ step[:, :, None])[:, :, 0]
    model, seen = (step * push).sum(axis=1), (step * fall).sum(axis=1)
    still = model <= 0
    model = np.where(still, 1.0, model)
    share = np.where(seen >= 0.2 * model, 1.0, 0.8 * model / np.maximum(model - seen, TINY))
    fall = share[:, None] * fall + (1 - share)[:, None] * push
    seen = (step * fall).sum(axis=1)
    still |= seen <= TINY  # at rounding level there is no curvature to see
    seen = np.where(still, 1.0, seen)
    change = fall[:, :, None] * fall[:, None, :] / seen[:, None, None]
    change = change - push[:, :, None] * push[:, None, :] / model[:, None, None]
    return bend + np.where(still[:, None, None], 0.0, change)
