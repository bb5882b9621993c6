"""How a platform behaves with its springs: where it rests, how stiffly, and what its motors still do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from equipoise.affine import Array
from equipoise.cables.distribution import Distribution, distribute, spring_tensions
from equipoise.cables.equilibria import Equilibrium, equilibria
from equipoise.cables.floor import SplineFloor, spline_floor
from equipoise.cables.stiffness import held_stiffness, principal
from equipoise.cables.survey import Survey, looked_at, survey
from equipoise.design import Design
from equipoise.errors import InfeasibleError
from equipoise.platform import platform_of
from equipoise.states import States
from equipoise.sweep import Sweep

LEAST: tuple[Literal["norm", "peak"], ...] = ("norm", "peak")
DENSE = 200


@dataclass(frozen=True, eq=False)
class Motors:
    """What motors do along a trajectory without the springs (`alone`) and with them (`helped`), by what is least."""

    states: States
    label: str
    alone: Mapping[str, Distribution]
    helped: Mapping[str, Distribution]

    def saved(self, least: str) -> dict[str, float]:
        """Energy, J, and peak tension, N, that the springs take off the motors; below 0 they add to it."""
        alone, helped = self.alone[least], self.helped[least]
        return {"energy": alone.work - helped.work, "peak": alone.peak - helped.peak}

    def json(self) -> dict[str, Any]:
        """Peak and rms tension, N, and energy, J, SI."""
        return {"trajectory": self.label} | {
            least: {"alone": _told(self.alone[least]), "helped": _told(self.helped[least]), "saved": self.saved(least)}
            for least in self.alone
        }


@dataclass(frozen=True, eq=False)
class Behaviour:
    """A cable platform with its springs.

    survey is of the cables themselves; peak {cable: N} the largest tension of its spring over the sweep; stiffness
    {name: (nd,)}, N/m, the principal stiffnesses at the middle of the sweep, least first: motors alone at the tensions
    of least norm, and with springs that share the load, None where the tensions cannot hold the platform there;
    motors is None without a trajectory, or where it leaves the platform's tension limits, which `unheld` then says.
    """

    survey: Survey
    equilibria: tuple[Equilibrium, ...]
    peak: Mapping[str, float]
    middle: Mapping[str, float]
    stiffness: Mapping[str, tuple[float, ...]] | None
    motors: Motors | None
    unheld: str
    floor: SplineFloor | None

    def json(self) -> dict[str, Any]:
        """The findings as design.json holds them, SI."""
        return {
            "survey": self.survey.json(),
            "equilibria": [
                {"pose": dict(one.pose), "kind": one.kind, "stiffness": one.stiffness} for one in self.equilibria
            ],
            "peak_tension": dict(self.peak),
            "middle": dict(self.middle),
            "stiffness": None if self.stiffness is None else dict(self.stiffness),
            "motors": self.motors.json() if self.motors is not None else self.unheld or None,
            "floor": None if self.floor is None else vars(self.floor),
        }


def behaviour(design: Design, trajectory: Sweep | None = None) -> Behaviour:
    """All that can be said of a cable platform with a design's springs, over its sweep and along a trajectory.

    The trajectory is a motion (inertia counts) or poses in order, joined by straight lines in the coordinates; of
    several payloads the first counts. Raises InputError for a mechanism without cables.
    """
    mechanism, sweep = design.mechanism, design.sweep
    platform = platform_of(mechanism)
    states = mechanism.states(sweep.at_poses(looked_at(sweep)))
    tension = spring_tensions(design, design.states)
    weighed = sweep.weight > 0
    middle = np.average(sweep.poses[weighed], axis=0, weights=sweep.weight[weighed])
    motors, unheld = None, ""
    if trajectory is not None:
        try:
            motors = _motors(design, trajectory)
        except InfeasibleError as error:
            unheld = error.message
    return Behaviour(
        survey(states),
        equilibria(design),
        {cable: float(tension[:, column].max()) for column, cable in enumerate(platform.cables)},
        dict(zip(mechanism.driven, middle.tolist(), strict=True)),
        _stiffness(design, middle),
        motors,
        unheld,
        spline_floor(design),
    )


def _stiffness(design: Design, middle: Array) -> dict[str, tuple[float, ...]] | None:
    states = design.mechanism.states(design.sweep.at_poses(middle[None])).take(slice(0, 1))
    try:
        alone, helped = distribute(states), distribute(states, design=design)
    except InfeasibleError:
        return None
    found = {"alone": held_stiffness(states, alone), "helped": held_stiffness(states, helped, design)}
    return {name: tuple(principal(design.mechanism, K)[0].tolist()) for name, K in found.items()}


def _motors(design: Design, trajectory: Sweep) -> Motors:
    dense = _dense(trajectory)
    states = design.mechanism.states(dense).take(slice(0, len(dense.poses)))
    alone = {least: distribute(states, least=least) for least in LEAST}
    helped = {least: distribute(states, design=design, least=least) for least in LEAST}
    return Motors(states, trajectory.describe(), alone, helped)


def _dense(trajectory: Sweep) -> Sweep:
    """Poses in order with as many between them as it takes to follow straight lines."""
    poses = trajectory.poses
    if trajectory.moves is not None or not 1 < len(poses) < DENSE:
        return trajectory
    parts = -(-DENSE // (len(poses) - 1))
    share = np.arange(parts) / parts
    between = (poses[:-1, None] + share[:, None] * np.diff(poses, axis=0)[:, None]).reshape(-1, poses.shape[1])
    return trajectory.at_poses(np.vstack([between, poses[-1:]]))


def _told(found: Distribution) -> dict[str, float]:
    return {"peak": found.peak, "rms": found.rms, "energy": found.work}
