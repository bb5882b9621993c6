"""Forces of loops: the multipliers of the loop equations at closed postures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from equipoise.affine import Array
from equipoise.loops.close import branch_of
from equipoise.loops.constraints import Equality, residual
from equipoise.loops.posture import Pose
from equipoise.loops.walk import Loop

if TYPE_CHECKING:
    from equipoise.mechanism import Mechanism

_CUT = 1e-9


@dataclass(frozen=True, eq=False)
class LoopJacobian:
    """Jacobian (N, m, nv) of a mechanism's loop equations, dimensionless rows and columns as in its `loop`."""

    loop: Loop
    jacobian: Array

    @property
    def equalities(self) -> list[Equality]:
        """The equations in the order of the rows."""
        return self.loop.equalities

    def multipliers(self, force: Array) -> tuple[Array, Array]:
        """What the loops exert (N, m), N or N m, and what is left for the joints (N, nv), for demands (N, nv).

            J_dep' lambda = f_dep,   tau = f - J' lambda

        The least lambda where redundant constraints leave it open.
        """
        loop = self.loop
        slope = self.jacobian[:, :, loop.dependent]
        scaled = force * loop.columns
        gram = np.swapaxes(slope, 1, 2) @ slope
        tension = np.zeros(self.jacobian.shape[:2])
        for _ in range(2):  # once more against rounding: the normal equations square the condition number
            left = scaled[:, loop.dependent] - (tension[:, None] @ slope)[:, 0]
            tension = tension + (slope @ np.linalg.solve(gram, left[..., None]))[..., 0]
        rest = (scaled - (tension[:, None] @ self.jacobian)[:, 0]) / loop.columns
        return tension * loop.rows, rest

    def open_rows(self) -> Array:
        """Multipliers (N, m, k), each of length one, that do no work at any joint: k is the degree of redundancy."""
        slope = self.jacobian[:, :, self.loop.dependent]
        left, sizes, _ = np.linalg.svd(slope)
        rank = int((sizes > _CUT * sizes[:, :1]).sum(axis=1).min(initial=slope.shape[1]))
        return left[:, :, rank:] * self.loop.rows[:, None]


def constraint_jacobian(mechanism: Mechanism, postures: Pose) -> LoopJacobian | None:
    """The loop equations' Jacobian at closed postures; None without loops."""
    branch = branch_of(mechanism)
    if branch is None:
        return None
    loop = branch.loop
    _, jacobian = residual(loop.equalities, postures)
    return LoopJacobian(loop, jacobian * (loop.rows[:, None] * loop.columns))
