"""Many small quadratic programs at once: a primal-dual interior point over arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array

ITERATIONS = 16
PRECISION = 1e-8
BACK = 0.995
RIDGE = 1e-13


def quadratic(H: Array, q: Array, G: Array, h: Array, start: Array, dual: Array) -> tuple[Array, Array]:
    """z (K, n) of min z'Hz/2 + q'z subject to G z <= h, and its multipliers (K, m), one problem per row.

    H (K, n, n) positive definite, q (K, n), G (K, m, n), h (K, m), scaled so that entries are of order one; start
    (K, n) is where it begins, dual (K, m) > 0 what the multipliers are about. The constraints must leave an interior,
    as elastic ones do. Mehrotra's predictor and corrector (unsourced).
    """
    z, dual = start.copy(), dual.copy()
    slack = np.maximum(h - (G @ z[..., None])[..., 0], 1e-9)
    active = np.arange(len(z))
    for _ in range(ITERATIONS):
        step = _step(H[active], q[active], G[active], h[active], z[active], slack[active], dual[active])
        z[active], slack[active], dual[active], left = step
        active = active[left > PRECISION]
        if not len(active):
            break
    return z, dual


def _step(
    H: Array, q: Array, G: Array, h: Array, z: Array, slack: Array, dual: Array
) -> tuple[Array, Array, Array, Array]:
    """One step from (z, slack, dual), and how far the point before it was from a solution (K,)."""
    transposed = np.swapaxes(G, 1, 2)
    stationary = (H @ z[..., None])[..., 0] + q + (transposed @ dual[..., None])[..., 0]
    primal = (G @ z[..., None])[..., 0] + slack - h
    both = slack * dual
    gap = both.mean(axis=1)
    weight = dual / slack
    inverse = _inverse(H + (transposed * weight[:, None, :]) @ G)

    def direction(centre: Array) -> tuple[Array, Array, Array]:
        """Newton's step towards slack * dual = centre."""
        pushed = weight * primal + (centre - both) / slack
        dz = (inverse @ (-stationary - (transposed @ pushed[..., None])[..., 0])[..., None])[..., 0]
        ds = -primal - (G @ dz[..., None])[..., 0]
        return dz, ds, (centre - both) / slack - weight * ds

    _, ds, dd = direction(np.zeros_like(slack))
    reach = _reach(slack, ds, dual, dd)
    ahead = ((slack + reach * ds) * (dual + reach * dd)).mean(axis=1)
    centring = (np.maximum(ahead, 0.0) / np.maximum(gap, 1e-300)) ** 3 * gap
    dz, ds, dd = direction(np.maximum(centring, 1e-14)[:, None] - ds * dd)
    reach = _reach(slack, ds, dual, dd)
    left = np.maximum(np.maximum(np.abs(primal).max(axis=1), np.abs(stationary).max(axis=1)), gap)
    return z + reach * dz, slack + reach * ds, dual + reach * dd, left


def _inverse(matrix: Array) -> Array:
    """Inverses of positive matrices (K, n, n), scaled first, for some of their entries grow without end."""
    size = np.sqrt(np.maximum(np.einsum("kii->ki", matrix), 1e-300))
    outer = size[:, :, None] * size[:, None, :]
    return np.linalg.inv(matrix / outer + RIDGE * np.eye(matrix.shape[-1])) / outer


def _reach(slack: Array, ds: Array, dual: Array, dd: Array) -> Array:
    """The longest step (K, 1), at most one, that keeps slack and dual positive."""
    steepest = np.maximum((-ds / slack).max(axis=1), (-dd / dual).max(axis=1))
    return np.minimum(1.0, BACK / np.maximum(steepest, BACK))[:, None]


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
