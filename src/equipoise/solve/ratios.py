"""Positive numbers moved by ratios: what follows powers of them is straight in their logarithms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from equipoise.affine import Array, Geometry, Mask
from equipoise.solve.shape import Build, Freedom, Local, descend


@dataclass(frozen=True, eq=False)
class Ratios:
    """Coordinates u = log gamma of the freedoms `which` (G,), u = gamma of the others."""

    which: Mask

    def inward(self, gamma: Array) -> Array:
        """u of gamma (..., G)."""
        return np.where(self.which, np.log(np.where(self.which, gamma, 1.0)), gamma)

    def outward(self, u: Geometry) -> Geometry:
        """gamma of u (..., G), which may be complex."""
        return np.where(self.which, np.exp(np.where(self.which, u, 0.0)), u)


def descend_by_ratios(
    build: Build, freedoms: Sequence[Freedom], gamma: Array, load: float, which: Mask, **options: float
) -> Local:
    """As `descend`, the freedoms `which` (G,), whose bounds are positive, moved by ratios.

    Wire, index and rate of a coil limit each other by products of powers. In their logarithms these limits are
    straight, so that steps along them are long.
    """
    ratios = Ratios(which)
    low, high = (ratios.inward(np.array(ends)) for ends in zip(*((f.lower, f.upper) for f in freedoms), strict=True))
    inside = [replace(f, lower=float(lo), upper=float(hi)) for f, lo, hi in zip(freedoms, low, high, strict=True)]
    found = descend(lambda u: build(ratios.outward(u)), inside, ratios.inward(gamma), load, **options)  # type: ignore[arg-type]
    return replace(found, gamma=ratios.outward(found.gamma))
