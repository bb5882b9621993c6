"""What the cables of a platform can do, pose by pose, before anything is added to it."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from equipoise.affine import Array
from equipoise.cables.clearance import Clearance, clearance
from equipoise.cables.distribution import distribute
from equipoise.cables.reach import Reach, closure, feasible
from equipoise.cables.stiffness import held_stiffness, principal
from equipoise.states import States
from equipoise.sweep import Sweep

MOST = 400
"""Poses of a sweep that are looked at."""
TAUT = 1e-4
"""N, above which cables count as taut: slack ones stiffen nothing."""


@dataclass(frozen=True, eq=False)
class Survey:
    """Wrench closure, feasibility, clearance and stiffness at the states of poses.

    stiffness (N, nd), N/m, holds the principal stiffnesses while motors keep the tensions of least norm, least first;
    an angle counts as the arc at the platform's length; nan where the tensions cannot hold the platform, or none are.
    """

    closure: Reach
    feasible: Reach
    clearance: Clearance
    stiffness: Array

    @property
    def states(self) -> States:
        """Where."""
        return self.closure.states

    def table(self) -> tuple[list[str], Array]:
        """A row per pose: head and numbers, SI."""
        mechanism = self.states.mechanism
        units = ["m" if unit == "N" else "rad" for unit in mechanism.driven_units]
        head = [f"{joint} [{unit}]" for joint, unit in zip(mechanism.driven, units, strict=True)]
        columns = [self.states.driven, self.closure.margin, self.feasible.margin, self.stiffness[:, 0]]
        head += ["closure [1]", "feasible [N]", "least stiffness [N/m]"]
        for pair, distance in self.clearance.pairs.items():
            head.append(f"{pair[0]} to {pair[1]} [m]")
            columns.append(distance)
        for cable, distance in self.clearance.platform.items():
            head.append(f"{cable} to platform [m]")
            columns.append(distance)
        return head, np.column_stack(columns)

    def write(self, path: Path) -> Path:
        """The table as CSV."""
        head, rows = self.table()
        with path.open("w", newline="", encoding="utf-8") as stream:
            csv.writer(stream).writerow(head)
            np.savetxt(stream, rows, fmt="%.12g", delimiter=",")
        return path

    def json(self) -> dict[str, Any]:
        """What `analyze --json` says of the cables, SI."""
        pairs = [(distance, list(pair)) for pair, distance in self.clearance.pairs.items()]
        platform = [(distance, cable) for cable, distance in self.clearance.platform.items()]
        return {
            "poses": len(self.states),
            "closure": {"share": self.closure.share, "margin": self.closure.margin, "outside": self.closure.outside},
            "feasible": {
                "share": self.feasible.share,
                "margin": self.feasible.margin,
                "outside": self.feasible.outside,
                "t_min": self.states.mechanism.platform.t_min,  # type: ignore[union-attr]
                "t_max": self.states.mechanism.platform.t_max,  # type: ignore[union-attr]
            },
            "clearance": {
                "cables": [
                    {"between": pair, "least": float(d.min()), "at": self.pose(d.argmin())} for d, pair in pairs
                ],
                "platform": [
                    {"cable": one, "least": float(d.min()), "at": self.pose(d.argmin())} for d, one in platform
                ],
            },
            "stiffness": self.stiffness,
        }

    def pose(self, row: Any) -> dict[str, float]:
        """The pose {joint: value} of a row."""
        return dict(zip(self.states.mechanism.driven, self.states.driven[int(row)].tolist(), strict=True))


def survey(
    states: States, t_min: float | Sequence[float] | None = None, t_max: float | Sequence[float] | None = None
) -> Survey:
    """Look at every state: closure, feasibility between t_min and t_max (N, default the platform's), distances, K.

    Raises InputError for a mechanism without cables and for limits that are reversed.
    """
    held = feasible(states, t_min, t_max)
    K = np.full((len(states), states.driven.shape[1]), np.nan)
    good = np.flatnonzero(held.margin > 0)
    if len(good):
        part = states.take(good)
        tensions = distribute(part, t_min, t_max)
        taut = tensions.total.max(axis=1) > TAUT
        K[good] = np.where(taut[:, None], principal(states.mechanism, held_stiffness(part, tensions)), np.nan)
    return Survey(closure(states), held, clearance(states), K)


def looked_at(sweep: Sweep, most: int = MOST) -> Array:
    """Poses (N, nd) that stand for a sweep: those that weigh something, evenly thinned."""
    poses = sweep.poses[sweep.weight > 0]
    return poses[np.linspace(0, len(poses) - 1, min(most, len(poses))).astype(int)]
