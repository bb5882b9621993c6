"""Quadrature over workspaces: triangles, polygons and boxes, right at corners where directions are undefined.

At an anchor the direction of its cable jumps, so |f|^2 has no limit there. Rules whose points collapse onto such
corners see a smooth integrand along every ray and converge spectrally (Duffy).
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.errors import InputError

NEAR = 1e-6
"""How near, in shares of the workspace, a pose that counts for peaks lies to a corner."""


def gauss(count: int) -> tuple[Array, Array]:
    """Gauss-Legendre nodes and weights on (0, 1)."""
    x, w = np.polynomial.legendre.leggauss(count)
    return (x + 1) / 2, w / 2


def triangle_rule(corner: Array, second: Array, third: Array, count: int) -> tuple[Array, Array]:
    """count^2 points (N, 2) and weights (N,) of a triangle, collapsed onto its first corner; weights sum to its area.

    p = v0 + u (v1 - v0 + s (v2 - v1)),   dA = 2 A u du ds
    """
    x, w = gauss(count)
    u, s = (grid.ravel() for grid in np.meshgrid(x, x, indexing="ij"))
    points = corner + u[:, None] * (second - corner + s[:, None] * (third - second))
    return points, abs(_cross(second - corner, third - corner)) * u * np.outer(w, w).ravel()


def polygon_rule(vertices: Array, special: Array, count: int) -> tuple[Array, Array]:
    """Points and weights of a simple polygon (V, 2), collapsed onto every vertex and special point (S, 2) in it.

    The polygon is cut into triangles, those into six about their centroid, each with one of the corners: 6 count^2
    points per triangle. Weights sum to the area.
    """
    parts = [
        triangle_rule(triangle[i], (triangle[i] + triangle[(i + step) % 3]) / 2, triangle.mean(0), count)
        for triangle in _split(_ears(vertices), special, float(np.ptp(vertices, axis=0).max()))
        for i in range(3)
        for step in (1, 2)
    ]
    return np.concatenate([points for points, _ in parts]), np.concatenate([weight for _, weight in parts])


def rim(vertices: Array, count: int) -> Array:
    """Poses (M, 2) on the edges of a polygon and close to its vertices, along its edges and bisectors."""
    size = float(np.ptp(vertices, axis=0).max())
    x, _ = gauss(4 * count)
    found = []
    for i, here in enumerate(vertices):
        after, before = vertices[(i + 1) % len(vertices)], vertices[i - 1]
        found.append(here + x[:, None] * (after - here))
        ahead, back = (d / np.linalg.norm(d) for d in (after - here, before - here))
        share = np.linspace(0, 1, 9)[:, None]
        found.append(here + NEAR * size * ((1 - share) * ahead + share * back))
    return np.concatenate(found)


def box_rule(low: Array, high: Array, count: int) -> tuple[Array, Array]:
    """Points and weights of a box in d dimensions, collapsed onto its 2^d corners: d 2^d count^d points.

    Every orthant about the centre is cut into d pyramids with the corner as apex: y_j = u, y_i = u s_i,
    dV = V u^(d-1) du ds.
    """
    d = len(low)
    x, w = gauss(count)
    grid = np.stack([axis.ravel() for axis in np.meshgrid(*[x] * d, indexing="ij")], axis=1)
    weight = np.prod([axis.ravel() for axis in np.meshgrid(*[w] * d, indexing="ij")], axis=0)
    half = (high - low) / 2
    points, weights = [], []
    for signs in itertools.product((0, 1), repeat=d):
        corner = np.where(signs, high, low)
        inward = np.where(signs, -half, half)
        for j in range(d):
            y = grid[:, [j]] * grid
            y[:, j] = grid[:, j]
            points.append(corner + y * inward)
            weights.append(weight * grid[:, j] ** (d - 1) * half.prod())
    return np.concatenate(points), np.concatenate(weights)


def contains(corners: Array, points: Array) -> NDArray[np.bool_]:
    """Which points (M, 2) lie in a simple polygon (V, 2), its edges included."""
    size = float(np.ptp(corners, axis=0).max())
    inside = np.zeros(len(points), dtype=bool)
    near = np.zeros(len(points), dtype=bool)
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        crosses = (a[1] > points[:, 1]) != (b[1] > points[:, 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            at = a[0] + (points[:, 1] - a[1]) * (b[0] - a[0]) / (b[1] - a[1])
        inside ^= crosses & (points[:, 0] < at)
        along = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        near |= np.linalg.norm(points - a - along[:, None] * (b - a), axis=1) <= 1e-9 * size
    return inside | near


def _ears(vertices: Array) -> list[Array]:
    """Triangles of a simple polygon, by cutting ears off."""
    area = _area(vertices)
    size = float(np.ptp(vertices, axis=0).max())
    if len(vertices) < 3 or abs(area) <= 1e-12 * size**2:
        raise InputError("the polygon has no area", where="sweep", hint="give at least three corners not in a line")
    ring = list(vertices if area > 0 else vertices[::-1])
    _simple(np.array(ring))
    found = []
    while len(ring) > 3:
        for i in range(len(ring)):
            a, b, c = ring[i - 1], ring[i], ring[(i + 1) % len(ring)]
            others = [p for p in ring if not any(p is q for q in (a, b, c))]
            if _cross(b - a, c - b) > 1e-14 * size**2 and not any(_within(np.array([a, b, c]), p) for p in others):
                found.append(np.array([a, b, c]))
                del ring[i]
                break
            if abs(_cross(b - a, c - b)) <= 1e-14 * size**2:
                del ring[i]  # a vertex on a straight edge
                break
        else:
            raise InputError("the polygon crosses itself", where="sweep", hint="list its corners in order")
    return [*found, np.array(ring)]


def _simple(ring: Array) -> None:
    n = len(ring)
    for i, j in itertools.combinations(range(n), 2):
        if (i - j) % n in (1, n - 1):
            continue
        a, b, c, d = ring[i], ring[(i + 1) % n], ring[j], ring[(j + 1) % n]
        if _cross(b - a, c - a) * _cross(b - a, d - a) < 0 and _cross(d - c, a - c) * _cross(d - c, b - c) < 0:
            raise InputError("the polygon crosses itself", where="sweep", hint="list its corners in order")


def _split(triangles: list[Array], special: Array, size: float) -> list[Array]:
    """Cut triangles at the special points that lie in them or on their edges."""
    for point in special:
        cut = []
        for triangle in triangles:
            if not _within(triangle, point) or np.linalg.norm(triangle - point, axis=1).min() < 1e-9 * size:
                cut.append(triangle)
                continue
            for i in range(3):
                part = np.array([point, triangle[i], triangle[(i + 1) % 3]])
                if _area(part) > 1e-12 * size**2:
                    cut.append(part)
        triangles = cut
    return triangles


def _within(triangle: Array, point: Array) -> bool:
    slack = -1e-12 * _area(triangle)
    return all(_cross(triangle[(i + 1) % 3] - triangle[i], point - triangle[i]) >= slack for i in range(3))


def _area(ring: Array) -> float:
    x, y = ring.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def _cross(a: Array, b: Array) -> float:
    return float(a[0] * b[1] - a[1] * b[0])
