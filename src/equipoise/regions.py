"""Poses of a workspace: a rule over the joints that span it, crossed with Gauss points of the others."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.posefile import held
from equipoise.ranges import crossed, driven_index, tensor, ticks_of
from equipoise.units import Joint


@dataclass(frozen=True, eq=False)
class Workspace:
    """A region over some driven joints: corners (V, j), a rule of points (M, j) with weights (M,), edge points (E, j).

    Weights sum to the region's measure; edge points weigh nothing and count for peaks only.
    """

    joints: tuple[str, ...]
    corners: Array
    rule: tuple[Array, Array]
    edge: Array

    def poses(self, mechanism: Mechanism, axes: Mapping[str, Sequence[Joint]]) -> tuple[Array, Array]:
        """Poses (N, nd) and weights (N,), the weightless edge last; axes {joint: (low, high, points)} are crossed.

        Raises InputError where the region leaves the joints' limits, or a joint stands in both.
        """
        indices = self._within(mechanism)
        if set(self.joints) & set(axes):
            raise InputError("a joint is in the region and in the axes", where="sweep.axes", hint="name it once")
        start = held(mechanism)
        others, weight, ends = start[None], np.ones(1), start[None]
        if axes:
            ticks, box = ticks_of(mechanism, axes, gauss_ticks)
            others, weight = tensor(ticks)
            ends = np.array(list(itertools.product(*box)))
        points, w = self.rule
        inner, rim = crossed(points, others, indices), crossed(self.edge, np.unique(ends, axis=0), indices)
        return np.concatenate([inner, rim]), np.concatenate([np.outer(w, weight).ravel(), np.zeros(len(rim))])

    def _within(self, mechanism: Mechanism) -> list[int]:
        """The joints' places among the driven ones."""
        indices = [driven_index(mechanism, name, "sweep") for name in self.joints]
        limits = mechanism.box[indices]
        for corner in self.corners:
            for name, value, (low, high) in zip(self.joints, corner, limits, strict=True):
                if value < low - 1e-9 or value > high + 1e-9:
                    raise InputError(
                        f"the workspace reaches {name} = {value:g}, the platform only {low:g} to {high:g}",
                        where="sweep",
                        hint="keep it within the anchors, or widen the platform's `limits`",
                    )
        return indices


def gauss_ticks(low: float, high: float, count: int) -> tuple[Array, Array]:
    """Gauss-Legendre points (n,) of an interval and their weights (n,), which sum to its length."""
    x, w = np.polynomial.legendre.leggauss(count)
    return (low + high) / 2 + x * (high - low) / 2, w * (high - low) / 2
