"""Distances between straight pieces, many at once."""

from __future__ import annotations

import numpy as np

from equipoise.affine import Array

TINY = 1e-24


def closest(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Distance (...) between the segments a-b and c-d, each (..., 3), m.

    Where numbers are complex the places of least distance follow from their real parts; the distance between these
    places has the right derivative, since it is stationary in them.
    """
    along, other, gap = b - a, d - c, a - c
    s, t = _places(np.real(along), np.real(other), np.real(gap))
    off = gap + s[..., None] * along - t[..., None] * other
    square = (off * off).sum(-1)
    return np.sqrt(np.where(np.real(square) > TINY, square, TINY))


def _places(along: Array, other: Array, gap: Array) -> tuple[Array, Array]:
    """Shares (s, t) of the way along both segments at which they are closest."""
    aa, bb = (along * along).sum(-1), (other * other).sum(-1)
    ab, ag, bg = (along * other).sum(-1), (along * gap).sum(-1), (other * gap).sum(-1)
    aa, bb = np.maximum(aa, TINY), np.maximum(bb, TINY)
    det = aa * bb - ab * ab
    s = np.where(det > 1e-12 * aa * bb, (ab * bg - ag * bb) / np.where(det > 0, det, 1.0), 0.0)
    s = np.clip(s, 0.0, 1.0)
    t = np.clip((ab * s + bg) / bb, 0.0, 1.0)
    return np.clip((ab * t - ag) / aa, 0.0, 1.0), t
