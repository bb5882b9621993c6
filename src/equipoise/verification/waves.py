"""Functions of joint positions that are affine in (cos q, sin q) of every hinge and quadratic in every slide."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array

PHASE = 0.3
WIDE = np.pi / 3


@dataclass(frozen=True, eq=False)
class Axes:
    """The joints of such functions: which are hinges (n,), and the box (n, 2) that slides are scaled to."""

    hinge: NDArray[np.bool_]
    box: Array

    def __len__(self) -> int:
        return len(self.hinge)

    def nodes(self) -> Array:
        """Positions (3^n, n), three per joint, whose values determine a function."""
        turns = PHASE + 2 * np.pi * np.arange(3) / 3
        ticks = [
            turns if hinge else low + np.arange(3) / 2 * (high - low)
            for hinge, (low, high) in zip(self.hinge, self.box, strict=True)
        ]
        return np.array(list(itertools.product(*ticks))).reshape(3 ** len(self), len(self))

    def basis(self, q: Array) -> Array:
        """(1, cos q, sin q) of hinges, (1, t, t^2) of slides with t their place in the box, (N, n, 3)."""
        t = self._place(q)
        x, y = np.where(self.hinge, np.cos(q), t), np.where(self.hinge, np.sin(q), t * t)
        return np.stack([np.ones_like(q), x, y], axis=-1)

    def triangles(self, centre: Array, half: Array) -> Array:
        """Corners (C, n, 3, 3) of triangles around the curves basis(q), |q - centre| <= half.

        Of a hinge: both ends of the arc and the point where their tangents meet, or a triangle around the
        whole circle; of a slide: the control points of the parabola (Bernstein).
        """
        low, high = centre - half, centre + half
        wide = self.hinge & (half > WIDE)
        first, last = np.where(wide, centre - 2 * np.pi / 3, low), np.where(wide, centre + 2 * np.pi / 3, high)
        far = np.where(wide, 2.0, 1.0)
        middle = np.where(wide, 2.0, 1.0 / np.cos(np.where(self.hinge & ~wide, half, 0.0)))
        a, m, b = self._place(low), self._place(centre), self._place(high)
        corners = [
            np.where(self.hinge, far * np.cos(first), a), np.where(self.hinge, far * np.sin(first), a * a),
            np.where(self.hinge, middle * np.cos(centre), m), np.where(self.hinge, middle * np.sin(centre), a * b),
            np.where(self.hinge, far * np.cos(last), b), np.where(self.hinge, far * np.sin(last), b * b),
        ]  # fmt: skip
        plane = np.stack(corners, axis=-1).reshape(*centre.shape, 3, 2)
        return np.concatenate([np.ones((*centre.shape, 3, 1)), plane], axis=-1)

    def virtual(self, half: Array) -> NDArray[np.bool_]:
        """Which corners (C, n, 3) are no points of the curve."""
        wide = self.hinge & (half > WIDE)
        return np.stack([wide, half > 0, wide], axis=-1)

    def fit(self, values: Array) -> Array:
        """Coefficients (F, 3^n) of functions whose values (F, 3^n) at the nodes are given."""
        if not len(self):
            return values
        nodes = self.nodes()
        table = self.basis(nodes)
        turned = values[:, None, :]
        for joint in range(len(self)):
            # Three different positions of this joint, whatever the others do.
            stride = 3 ** (len(self) - 1 - joint)
            inverse = np.asarray(np.linalg.inv(table[[0, stride, 2 * stride], joint]), dtype=np.float64)
            turned = _turn(turned, inverse[None, None])
        return turned[:, 0]

    def _place(self, q: Array) -> Array:
        span = np.ptp(self.box, axis=1)
        return (q - self.box.mean(axis=1)) / np.where(span > 0, span, 1.0)


def corner_values(coefficients: Array, corners: Array) -> Array:
    """Values (C, F, 3^n) of functions with coefficients (F, 3^n) at all combinations of corners (C, n, 3, 3).

    A function affine in each joint's (x, y) has its extrema over a product of triangles at their corners.
    """
    values = np.broadcast_to(coefficients, (len(corners), *coefficients.shape))
    for joint in range(corners.shape[1]):
        values = _turn(values, corners[:, joint, None])
    return values


def point_values(coefficients: Array, basis: Array) -> Array:
    """Values (C, F) of functions with coefficients (F, 3^n) at points with basis (C, n, 3)."""
    values = np.broadcast_to(coefficients, (len(basis), *coefficients.shape))
    for joint in range(basis.shape[1]):
        split = values.reshape(*values.shape[:-1], 3, -1)
        values = np.einsum("cb,cfbr->cfr", basis[:, joint], split)
    return values[..., 0]


def _turn(values: Array, matrix: Array) -> Array:
    """Apply (.., 3, 3) to the first joint's axis of (..., 3^n) and put that axis last: n turns restore the order."""
    split = np.swapaxes(values.reshape(*values.shape[:-1], 3, -1), -1, -2)
    return (split @ np.swapaxes(matrix, -1, -2)).reshape(values.shape)
