"""Many small quadratic programs at once: a primal-dual interior point over arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array

ITERATIONS = 20
PRECISION = 1e-7
BACK = 0.995
AHEAD = 0.03
"""Room that the worst row has at the start."""
NARROW = 1e-9
"""Least room of a bound."""
FEWER = 0.7
"""Share of problems left at which those that are solved are put aside."""


def elastic(H: Array, q: Array, A: Array, e: Array, low: Array, high: Array, price: Array) -> tuple[Array, Array]:
    """z (K, n) of min z'Hz/2 + q'z + price max(0, A z + e) inside low <= z <= high, and the rows' multipliers (K, m).

    H (K, n, n) positive definite, q (K, n), A (K, m, n), e (K, m), scaled so that entries are of order one; low and
    high (K, n), price (K,). One more variable t >= 0 stands for the worst row, so that a point inside is known: from
    there, on the central path, Mehrotra's predictor and corrector (unsourced) stays inside. Problems lie along the last
    axis.
    """
    count, m, n = A.shape
    data = [np.ascontiguousarray(np.moveaxis(part, 0, -1)) for part in (H, q, A, price)]
    z = (low + high).T / 2
    gap = np.einsum("mnk,nk->mk", data[2], z) + e.T
    t = np.maximum(gap.max(axis=0, initial=0.0), 0.0) + AHEAD
    slack = np.concatenate([t - gap, t[None], np.maximum(z - low.T, NARROW), np.maximum(high.T - z, NARROW)])
    dual = price / (1 / slack[: m + 1]).sum(axis=0) / slack
    point, active = [z, slack, dual], np.arange(count)
    answer, multipliers = np.empty((n, count)), np.empty((m, count))
    for _ in range(ITERATIONS):
        # A matrix that is singular to rounding has no step: the point before it is the answer.
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            moved, left = _step(*data, *point)
            sound = np.isfinite(sum(part.sum(axis=0) for part in moved))
        point = moved if sound.all() else [np.where(sound, new, old) for new, old in zip(moved, point, strict=True)]
        answer[:, active], multipliers[:, active] = point[0], point[2][:m]
        going = sound & (left > PRECISION)
        if not going.any():
            break
        if going.mean() < FEWER:
            active = active[going]
            data, point = ([part[..., going] for part in parts] for parts in (data, point))
    return np.clip(answer.T, low, high), multipliers.T


def _step(H: Array, q: Array, A: Array, price: Array, z: Array, slack: Array, dual: Array) -> tuple[list[Array], Array]:
    """One step from (z, slack, dual), and how far the point before it was from a solution (K,).

    Slacks and multipliers are those of the rows, of t, and of the lower and upper bounds, in this order.
    """
    m, n = A.shape[:2]
    rows, below, above = slice(m), slice(m + 1, m + 1 + n), slice(m + 1 + n, None)
    stationary = np.einsum("ijk,jk->ik", H, z) + q + np.einsum("mnk,mk->nk", A, dual[rows]) - dual[below] + dual[above]
    level = price - dual[: m + 1].sum(axis=0)
    both = slack * dual
    mean = both.mean(axis=0)
    weight = dual / slack
    weighted = A * weight[rows, None]
    pull, stiff = weighted.sum(axis=0), weight[: m + 1].sum(axis=0)
    matrix = H + np.einsum("mik,mjk->ijk", weighted, A) - pull[:, None] * (pull / stiff)
    matrix[np.arange(n), np.arange(n)] += weight[below] + weight[above]
    factor = _factor(matrix)

    def direction(wanted: Array) -> tuple[Array, Array, Array]:
        """Newton's step that changes slack * dual by `wanted`."""
        pushed = wanted / slack
        side = pushed[below] - pushed[above] - stationary - np.einsum("mnk,mk->nk", A, pushed[rows])
        lift = (pushed[: m + 1].sum(axis=0) - level) / stiff
        dz = _solved(factor, side + pull * lift)
        dt = lift + (pull * dz).sum(axis=0) / stiff
        ds = np.concatenate([dt - np.einsum("mnk,nk->mk", A, dz), dt[None], dz, -dz])
        return dz, ds, pushed - weight * ds

    _, ds, dd = direction(-both)
    reach = _reach(slack, ds, dual, dd)
    ahead = ((slack + reach * ds) * (dual + reach * dd)).mean(axis=0)
    centring = np.maximum((np.maximum(ahead, 0.0) / np.maximum(mean, 1e-300)) ** 3 * mean, 1e-14)
    dz, ds, dd = direction(centring - both - ds * dd)
    reach = _reach(slack, ds, dual, dd)
    left = np.maximum(np.maximum(np.abs(stationary).max(axis=0), np.abs(level)), mean)
    return [z + reach * dz, slack + reach * ds, dual + reach * dd], left


def _factor(matrix: Array) -> Array:
    """Cholesky's factors of positive matrices (n, n, K), with the inverse of their diagonal in its place."""
    factor = matrix.copy()
    for j in range(len(factor)):
        factor[j, j] = 1 / np.sqrt(np.maximum(factor[j, j], 1e-30))
        below = factor[j + 1 :, j]
        below *= factor[j, j]
        factor[j + 1 :, j + 1 :] -= below[:, None] * below
    return factor


def _solved(factor: Array, side: Array) -> Array:
    """x (n, K) of matrix x = side."""
    x = side.copy()
    for j in range(len(x)):
        x[j] *= factor[j, j]
        x[j + 1 :] -= factor[j + 1 :, j] * x[j]
    for j in reversed(range(len(x))):
        x[j] *= factor[j, j]
        x[:j] -= factor[j, :j] * x[j]
    return x


def _reach(slack: Array, ds: Array, dual: Array, dd: Array) -> Array:
    """The longest step (K,), at most one, that keeps slack and dual positive."""
    steepest = np.maximum((-ds / slack).max(axis=0), (-dd / dual).max(axis=0))
    return BACK / np.maximum(steepest, BACK)


def boxed(H: Array, q: Array, low: Array, high: Array) -> tuple[Array, NDArray[np.bool_]]:
    """z (K, n) of min z'Hz/2 + q'z inside low <= z <= high (K, n), which hold zero: what would leave stops at its end.

    H (K, n, n) positive definite, q (K, n). With it which of them (K,) are the least indeed: not all that stopped need
    have.
    """
    fixed = ((low >= 0) & (q > 0)) | ((high <= 0) & (q < 0))
    held = np.zeros_like(q)
    index = np.arange(q.shape[1])
    z = held
    for _ in range(1 + q.shape[1]):
        matrix = np.where(fixed[:, :, None] | fixed[:, None, :], 0.0, H)
        matrix[:, index, index] = np.where(fixed, 1.0, H[:, index, index])
        pushed = -q - np.einsum("kij,kj->ki", H, held)
        z = np.linalg.solve(matrix, np.where(fixed, held, pushed)[..., None])[..., 0]
        beyond = ~fixed & ((z > high) | (z < low))
        if not beyond.any():
            break
        held = np.where(beyond, np.clip(z, low, high), held)
        fixed |= beyond
    z = np.clip(z, low, high)
    slope = (H @ z[..., None])[..., 0] + q
    size = 1e-9 * (np.abs(q).max(axis=1, keepdims=True) + 1e-300)
    right = np.where(z >= high, slope <= size, np.where(z <= low, slope >= -size, np.abs(slope) <= 1e3 * size))
    return z, right.all(axis=1)
