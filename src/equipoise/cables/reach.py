"""Where cables can hold a platform: wrench closure, and feasibility under weight."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.cables.tensions import allowed, roomiest
from equipoise.cables.wrench import wrench_matrix
from equipoise.states import States

RANK = 1e-9


@dataclass(frozen=True, eq=False)
class Reach:
    """Per pose a margin (N,), positive where the cables hold the platform, and the states it was asked at."""

    margin: Array
    states: States

    @property
    def outside(self) -> list[dict[str, float]]:
        """Poses {joint: value} at which the cables cannot hold the platform."""
        driven = self.states.mechanism.driven
        rows = self.states.driven[self.margin <= 0]
        return [dict(zip(driven, row.tolist(), strict=True)) for row in rows]

    @property
    def share(self) -> float:
        """Share of the poses at which the cables hold."""
        return float((self.margin > 0).mean())


def closure(states: States) -> Reach:
    """Wrench closure: any load can be held with enough tension.

        rank W = n and there is t > 0 with W t = 0   (so m >= n + 1)

    The margin is the least tension of the most even such t, as a share of the largest: 1 is as even as can be,
    0 or less is outside. Gravity does not matter.
    """
    W, _, _ = wrench_matrix(states)
    n, m = W.shape[1:]
    singular = np.linalg.svd(W, compute_uv=False)
    full = singular[:, -1] > RANK * singular[:, 0] if m > n else np.zeros(len(W), dtype=bool)
    margin = np.array([roomiest(matrix, np.zeros(n), np.zeros(m), np.ones(m), above=False) for matrix in W])
    return Reach(np.where(full & (margin > RANK), margin, np.minimum(margin, 0.0)), states)


def feasible(
    states: States, t_min: float | Sequence[float] | None = None, t_max: float | Sequence[float] | None = None
) -> Reach:
    """Whether tensions between t_min and t_max, N, hold weight and payload: W t + w = 0.

    One limit for all cables or one for each; by default the platform's own. The margin, N, is how far from both
    limits all tensions can stay; below 0 the limits cannot be kept, minus infinity where no tensions at all hold the
    platform. Raises InputError for limits that are reversed.
    """
    low, high = allowed(states, t_min, t_max)
    W, w, _ = wrench_matrix(states)
    margin = np.array([roomiest(matrix, load, low, high) for matrix, load in zip(W, w, strict=True)])
    size = max(1.0, float(low.max()), *high[np.isfinite(high)].tolist())
    # On the limit itself the platform is still held.
    return Reach(np.where(np.abs(margin) < RANK * size, RANK, margin), states)
