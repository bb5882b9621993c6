"""Balance for all motions, as equations between mass parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from equipoise.affine import Affine, Array
from equipoise.errors import InputError, nearest
from equipoise.limits.limit import Setting
from equipoise.solve.program import Rows

GOALS: dict[str, tuple[str, ...]] = {"force": ("force",), "moment": ("moment",), "both": ("force", "moment")}
WORDS = {"force": "force", "moment": "moment", "both": "force and moment"}


@dataclass(frozen=True)
class Balanced:
    """Shaking force, moment, or both vanish in all motions, whatever the sweep: p and L stay zero.

        p(q, qdot) = 0,  L(q, qdot) = 0   over random admissible states, in as few combinations as there are unknowns

    balanced is `force`, `moment` (about the world origin; without the axes that flywheels take) or `both`. What is
    then left free serves the objective: the least mass, the moment over one motion, drive torque.
    """

    balanced: Literal["force", "moment", "both"]
    sources: ClassVar[tuple[str, ...]] = ("arakelian_smith_2008",)

    def __post_init__(self) -> None:
        if self.balanced not in GOALS:
            raise InputError(
                f"{self.balanced!r} cannot be balanced for all motions",
                where="limits",
                hint=nearest(self.balanced, tuple(GOALS)),
            )

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """One more equality row than unknowns for each of force and moment, each in shares of the bare momentum."""
        assert setting.momentum is not None
        return tuple(self._rows(goal, setting.momentum(goal)) for goal in GOALS[self.balanced])

    def _rows(self, goal: str, momentum: Affine) -> Rows:
        b = momentum.b.reshape(*momentum.b.shape[:-2], -1)
        A = momentum.A.reshape(*momentum.A.shape[:-3], -1, momentum.A.shape[-1])
        # Fixed combinations keep derivatives to the geometry exact, which a factorisation would not.
        mixed = _mixture(len(momentum.unknowns) + 1, b.shape[-1])
        G, h = mixed @ A, -(b @ mixed.T)
        load = max(float(np.abs(np.real(h)).max()), float(np.abs(np.real(G)).max(initial=0.0)) * 1e-9, 1e-300)
        unit = {"force": "kg m/s", "moment": "kg m^2/s"}[goal]
        return Rows(f"{goal} balanced in all motions", unit, G, h, momentum.unknowns, equality=True, scale=load)


def _mixture(count: int, rows: int) -> Array:
    return np.random.default_rng(0).standard_normal((min(count, rows), rows)) / np.sqrt(rows)
