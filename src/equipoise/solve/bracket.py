"""Branch and bound over geometry: a lower bound on what any geometry within the bounds can reach."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.solve.jets import Jet
from equipoise.solve.program import Norm

BATCH = 256
SWEEPS = 30
ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class Enclosed:
    """r = b + sum_p A_p theta_p over boxes, as jets; rows whose lower bound is above zero cannot be kept in a box.

    b and A_p are jets of (C, N) stacked over the counted joints; weight (N,) sums to one over the states of each.
    """

    b: Jet
    A: tuple[Jet, ...]
    rows: tuple[Jet, ...] = ()


Enclose = Callable[[Array, Array], Enclosed]
"""(low, high) (C, G) -> the residual over every box."""


@dataclass(frozen=True)
class Bracket:
    """low <= the least value within the bounds <= high; boxes looked at, and whether the search was cut short."""

    low: float
    high: float
    boxes: int
    stopped: bool = False

    @property
    def gap(self) -> float:
        """How far low is below high, as a share of high."""
        return 1.0 - self.low / self.high if self.high > 0 else 0.0


def bracket(
    enclose: Enclose,
    bounds: Array,
    high: float,
    *,
    norm: Norm,
    weight: Array,
    theta: Array,
    share: float = 0.01,
    most: int = 200_000,
    progress: Callable[[int, float, float], None] | None = None,
) -> Bracket:
    """Bound the least norm over a box of geometry (G, 2) from below, down to a share of a value that is reached.

        N(r(gamma, theta)) >= y . r_c - sum_j h_j |y . dr_c/dx_j| - |y| . e,   N*(y) <= 1

    x = (gamma, theta) in a box of centre c and half-widths h; e bounds what the linear model at c misses, from
    interval slopes. theta is kept where no value within could be better than `high`; theta (P, 2) are its own bounds.
    y is the best one that few steps of coordinate descent (rms) or a linear program (peak, mean) find: any y gives a
    bound, so the answer holds whenever the search ends, also by Ctrl-C or after `most` boxes. Boxes where a row
    cannot be kept are dropped.
    """
    if norm not in ("rms", "peak", "mean"):
        raise InputError(f"there is no bound for the norm {norm!r}", where="bracket")
    whole = bounds.astype(float)
    queue: list[tuple[float, int, Array]] = [(0.0, 0, whole)]
    count, stopped, floor = 1, False, high
    boxes: list[tuple[float, int, Array]] = []
    target = high * (1 - share)
    try:
        while queue and queue[0][0] < target and count < most:
            boxes = [heapq.heappop(queue) for _ in range(min(BATCH, len(queue)))]
            halves = _halved(np.stack([box for _, _, box in boxes]), enclose)
            parents = np.repeat([value for value, _, _ in boxes], 2)
            low = np.maximum(_bounds(enclose, halves, high, norm, weight, theta), parents)
            for value, box in zip(low, halves, strict=True):
                if value < target:
                    count += 1
                    heapq.heappush(queue, (float(value), count, box))
                else:
                    floor = min(floor, float(value))
            if progress:
                progress(count, min(floor, queue[0][0]) if queue else floor, high)
    except KeyboardInterrupt:
        stopped = True
        # Boxes in work when it came are no longer queued: their parents' bounds are the least that is known.
        floor = min([floor, *(value for value, _, _ in boxes)])
    found = min(floor, queue[0][0]) if queue else floor
    return Bracket(max(0.0, min(found, high) * (1 - ROUNDING)), high, count, stopped)


def _halved(boxes: Array, enclose: Enclose) -> Array:
    """Every box (C, G, 2) cut in two across the parameter along which the residual bends most."""
    found = enclose(boxes[:, :, 0], boxes[:, :, 1])
    width = boxes[:, :, 1] - boxes[:, :, 0]
    moved = np.zeros(width.shape)
    for jet in (found.b, *found.A):
        # What the linear model misses grows with how far the slopes stray.
        stray = jet.high[1:] - jet.low[1:]
        size = np.abs(jet.high[0] + jet.low[0]).mean() + 1e-300
        part = np.where(np.isfinite(stray), stray, 1e6 * size).mean(axis=-1).T * width
        moved = np.maximum(moved, part / size)
    axis = moved.argmax(axis=1)
    rows, middle = np.arange(len(boxes)), boxes.mean(axis=2)
    left, right = boxes.copy(), boxes.copy()
    left[rows, axis, 1] = right[rows, axis, 0] = middle[rows, axis]
    return np.stack([left, right], axis=1).reshape(-1, *boxes.shape[1:])


def _bounds(enclose: Enclose, boxes: Array, high: float, norm: Norm, weight: Array, theta: Array) -> Array:
    """Lower bounds (C,) of the norm over boxes (C, G, 2); infinite where a row cannot be kept."""
    centre, half = boxes.mean(axis=2), 0.5 * (boxes[:, :, 1] - boxes[:, :, 0])
    wide, point = enclose(boxes[:, :, 0], boxes[:, :, 1]), enclose(centre, centre)
    size = (len(boxes), len(weight))
    b, slopes, spread = _model(point.b, wide.b, size)
    linear = [_model(p, w, size) for p, w in zip(point.A, wide.A, strict=True)]
    range_ = _theta_range((b, slopes, spread), half, linear, high, norm, weight, theta)
    middle, reach = range_.mean(axis=2), 0.5 * (range_[:, :, 1] - range_[:, :, 0])
    with np.errstate(invalid="ignore", over="ignore"):
        r, J, e = b, slopes, np.einsum("gcn,cg->cn", spread, half)
        columns = []
        for p, (A, slope, wobble) in enumerate(linear):
            t, u = middle[:, p, None], reach[:, p, None]
            r, J = r + A * t, J + slope * t[None]
            e = e + np.abs(t) * np.einsum("gcn,cg->cn", wobble, half)
            e = e + u * np.einsum("gcn,cg->cn", np.abs(slope) + wobble, half)
            columns.append(A)
        J = np.concatenate([J, np.stack(columns)]) if columns else J
        h = np.concatenate([half, reach], axis=1)
        sound = np.isfinite(e).all(axis=1) & np.isfinite(h).all(axis=1)
        low = np.zeros(len(boxes))
        if sound.any():
            y = _multipliers(r[sound], J[:, sound], h[sound], norm, weight)
            pulled = np.abs(np.einsum("gcn,cn->cg", J[:, sound], y))
            low[sound] = (y * r[sound]).sum(axis=1) - (h[sound] * pulled).sum(axis=1) - (np.abs(y) * e[sound]).sum(1)
    dropped = np.zeros(len(boxes), dtype=bool)
    for row in wide.rows:
        dropped |= (row.low[0] > 0).any(axis=-1)
    return np.where(dropped | ~(range_[:, :, 0] <= range_[:, :, 1]).all(axis=1), np.inf, np.maximum(low, 0.0))


def _model(point: Jet, wide: Jet, size: tuple[int, int]) -> tuple[Array, Array, Array]:
    """Value (C, N) and slopes (G, C, N) at the centre, and how far the slopes stray over the box (G, C, N)."""
    G = len(point.low) - 1
    value = np.broadcast_to(point.low[0], size)
    slope = np.broadcast_to(point.low[1:], (G, *size))
    spread = np.maximum(wide.high[1:] - point.low[1:], point.low[1:] - wide.low[1:])
    return value, slope, np.broadcast_to(np.nan_to_num(spread, nan=np.inf), (G, *size))


def _theta_range(
    model: tuple[Array, Array, Array],
    half: Array,
    linear: list[tuple[Array, Array, Array]],
    high: float,
    norm: Norm,
    weight: Array,
    own: Array,
) -> Array:
    """Bounds (C, P, 2) of theta outside of which the norm exceeds `high` everywhere in a box.

    With B the left inverse of A at the centre, B r = B b + theta + D theta, |B r| <= high |B|*: theta lies about
    -B b, as far as D, what A strays over the box, leaves it.
    """
    b, slopes, spread = model
    count, P = len(b), len(linear)
    found = np.tile(own[None], (count, 1, 1)).astype(float)
    if not P:
        return found
    A = np.stack([part[0] for part in linear], axis=-1)
    root = np.sqrt(weight)[None, :, None]
    inverse: Array = np.asarray(np.linalg.pinv(A * root) * np.swapaxes(root, 1, 2), dtype=np.float64)
    # |B r| row by row, by the dual norm.
    scale = np.sqrt((inverse**2 / weight).sum(axis=-1)) if norm == "rms" else _dual(inverse, weight, norm)
    with np.errstate(invalid="ignore", over="ignore"):
        D = np.stack([_drift(inverse, half, slope, stray) for _, slope, stray in linear], axis=-1)
        centre = -(inverse @ b[:, :, None])[:, :, 0]
        known = _drift(inverse, half, slopes, spread) + high * scale
        unit = np.maximum(np.abs(centre), 1e-12 + known)
        D = D * unit[:, None, :] / unit[:, :, None]
        share = (np.abs(centre) / unit)[:, None, :]
        grown = (known / unit + (D * share).sum(axis=2)).max(axis=1)
        left = 1 - D.sum(axis=2).max(axis=1)
        width = np.where(left > 0, grown / np.where(left > 0, left, 1.0), np.inf)[:, None] * unit
    width = np.where(np.isfinite(width), width, np.inf)
    found[:, :, 0] = np.maximum(found[:, :, 0], centre - width)
    found[:, :, 1] = np.minimum(found[:, :, 1], centre + width)
    return found


def _drift(inverse: Array, half: Array, slopes: Array, spread: Array) -> Array:
    """How far B x strays over the box (C, P): its slopes at the centre, and what these stray."""
    steady = np.abs(np.einsum("cpn,gcn->cpg", inverse, slopes))
    stray = np.einsum("gcn,cg->cn", spread, half)
    found = (steady * half[:, None, :]).sum(axis=2) + (np.abs(inverse) @ stray[..., None])[..., 0]
    return np.where(np.isfinite(found), found, np.inf)


def _dual(inverse: Array, weight: Array, norm: Norm) -> Array:
    """The largest of y . r over N(r) <= 1, for every row y (C, P, N)."""
    return np.abs(inverse).sum(axis=-1) if norm == "peak" else (np.abs(inverse) / weight).max(axis=-1)


def _multipliers(r: Array, J: Array, h: Array, norm: Norm, weight: Array) -> Array:
    """Multipliers y (C, N) with N*(y) <= 1 for min over |x| <= h of N(r + J x)."""
    if norm == "rms":
        left = r + np.einsum("gcn,cg->cn", J, _least_squares(r, J, h, weight))
        size = np.sqrt((weight * left**2).sum(axis=1, keepdims=True))
        return weight * left / np.where(size > 0, size, 1.0)
    return np.stack([_linear(r[i], J[:, i], h[i], norm, weight) for i in range(len(r))])


def _least_squares(r: Array, J: Array, h: Array, weight: Array) -> Array:
    """x (C, M) of min |r + J x| within |x| <= h, nearly: coordinate descent on the normal equations."""
    gram = np.einsum("gcn,n,kcn->cgk", J, weight, J)
    side = np.einsum("gcn,n,cn->cg", J, weight, r)
    x = np.zeros_like(h)
    diagonal = np.maximum(np.einsum("cgg->cg", gram), 1e-300)
    for _ in range(SWEEPS):
        for g in range(h.shape[1]):
            slope = side[:, g] + (gram[:, g] * x).sum(axis=1)
            x[:, g] = np.clip(x[:, g] - slope / diagonal[:, g], -h[:, g], h[:, g])
    return x


def _linear(r: Array, J: Array, h: Array, norm: Norm, weight: Array) -> Array:
    """Multipliers of one box's linear program; any answer is scaled into the dual ball."""
    from scipy.optimize import linprog

    M, N = J.shape
    slack = 1 if norm == "peak" else N
    cost = np.concatenate([np.zeros(M), np.ones(1) if norm == "peak" else weight])
    bar = -np.ones((N, 1)) if norm == "peak" else -np.eye(N)
    rows = np.vstack([np.hstack([J.T, bar]), np.hstack([-J.T, bar])])
    limits = [(-w, w) for w in h] + [(0, None)] * slack
    done = linprog(cost, A_ub=rows, b_ub=np.concatenate([-r, r]), bounds=limits, method="highs")
    if done.status != 0:
        return np.zeros(N)
    y = -(done.ineqlin.marginals[:N] - done.ineqlin.marginals[N:])
    size = np.abs(y).sum() if norm == "peak" else (np.abs(y) / weight).max()
    return y / max(float(size), 1.0)
