"""Many small quadratic programs at once: a primal-dual interior point over arrays."""

from __future__ import annotations

import numpy as np

from equipoise.affine import Array

ITERATIONS = 25
PRECISION = 1e-9
BACK = 0.995


def quadratic(H: Array, q: Array, G: Array, h: Array, start: Array, dual: Array) -> Array:
    """z (K, n) of min z'Hz/2 + q'z subject to G z <= h, one problem per row.

    H (K, n, n) positive definite, q (K, n), G (K, m, n), h (K, m), scaled so that entries are of order one; start
    (K, n) is where it begins, dual (K, m) > 0 what the multipliers are about. The constraints must leave an interior, as
    elastic ones do. Mehrotra's predictor and corrector (unsourced).
    """
    z = start
    slack = np.maximum(h - (G @ z[..., None])[..., 0], 1e-3)
    transposed = np.swapaxes(G, 1, 2)
    for _ in range(ITERATIONS):
        stationary = (H @ z[..., None])[..., 0] + q + (transposed @ dual[..., None])[..., 0]
        primal = (G @ z[..., None])[..., 0] + slack - h
        gap = (slack * dual).mean(axis=1)
        if max(np.abs(primal).max(), np.abs(stationary).max(), gap.max()) < PRECISION:
            break
        weight = dual / slack
        matrix = H + (transposed * weight[:, None, :]) @ G

        def direction(centre: Array) -> tuple[Array, Array, Array]:
            """Newton's step towards slack * dual = centre."""
            pushed = (weight * primal) + (centre - slack * dual) / slack  # noqa: B023
            right = -stationary - (transposed @ pushed[..., None])[..., 0]  # noqa: B023
            dz = np.linalg.solve(matrix, right[..., None])[..., 0]  # noqa: B023
            ds = -primal - (G @ dz[..., None])[..., 0]  # noqa: B023
            return dz, ds, (centre - slack * dual - dual * ds) / slack  # noqa: B023

        _, ds, dd = direction(np.zeros_like(slack))
        reach = np.minimum(_reach(slack, ds), _reach(dual, dd))[:, None]
        ahead = ((slack + reach * ds) * (dual + reach * dd)).mean(axis=1)
        centring = (np.maximum(ahead, 0.0) / np.maximum(gap, 1e-300)) ** 3 * gap
        dz, ds, dd = direction(np.maximum(centring, 1e-14)[:, None] - ds * dd)
        reach = np.minimum(_reach(slack, ds), _reach(dual, dd))[:, None]
        z, slack, dual = z + reach * dz, slack + reach * ds, dual + reach * dd
    return z


def _reach(value: Array, step: Array) -> Array:
    """The longest step (K,), at most one, that keeps value + step positive."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(step < 0, -value / step, np.inf)
    return np.minimum(1.0, BACK * ratio.min(axis=1))
