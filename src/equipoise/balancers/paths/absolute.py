"""The absolute angle of a planar body."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np

from equipoise.balancers.paths.angle import HINGE
from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.rub import Rub, after
from equipoise.balancers.paths.turn import Terms, Turn
from equipoise.errors import InputError
from equipoise.loops import ancestors
from equipoise.mechanism import Mechanism, Point
from equipoise.states import States
from equipoise.units import Angle, Number

PARALLEL = 1e-6
RIGHT = np.array([0.0, -1.0, 0.0])


@dataclass(frozen=True)
class Absolute(Turn):
    """The absolute angle of a planar body, which belts, chains or parallelograms bring to the base.

        l = ratio (phi_0 + sum_j +-q_j) + offset

    phi is the angle of the body's x axis in the x-z plane: from +x counter-clockwise (datum `right`) or from +z
    clockwise (datum `up`); q_j are the hinges between the world and the body, so l is continuous over any number
    of turns, and phi_0 in (-pi, pi] is the angle at the model's zero posture. ratio has no unit, offset is in rad.
    Raises InputError for a body that a hinge off the y axis or a joint that is no hinge or slide turns.
    """

    body: str
    ratio: Number = 1.0
    offset: Angle = 0.0
    datum: Literal["right", "up"] = "right"
    unit = "rad"

    def rubs(self, states: States) -> tuple[Rub, ...]:
        """The belts or parallelograms that bring the angle to the base, where there is more than one joint."""
        rate = self.deform(states)[1]
        return after("mesh", rate) if np.count_nonzero(np.any(rate, axis=0)) > 1 else ()

    def terms(self, model: mujoco.MjModel) -> Terms:
        """Every hinge on the way to the body with its sign."""
        found, start = _chain(model, self.body)
        sense, zero = (1.0, start) if self.datum == "right" else (-1.0, 0.5 * math.pi - start)
        rest = sum(sign * float(model.qpos0[model.jnt_qposadr[joint]]) for joint, sign in found.items())
        constant = _wrapped(zero) - sense * rest
        return (
            {model.joint(joint).name: self.ratio * (sense * sign) for joint, sign in found.items()},
            self.ratio * constant + self.offset,
        )

    def shaft(self, model: mujoco.MjModel) -> Mount:
        """The first hinge on the way to the body, as the base sees it."""
        found, _ = _chain(model, self.body)
        data = mujoco.MjData(model)
        data.qpos[:] = model.qpos0
        mujoco.mj_kinematics(model, data)
        at = Point("world", tuple(data.xanchor[next(iter(found))].tolist()))
        if self.datum == "right":
            return Mount(at, (1.0, 0.0, 0.0), (0.0, -1.0, 0.0))
        return Mount(at, (0.0, 0.0, 1.0), (0.0, 1.0, 0.0))

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for a body that is not there, does not turn or leaves the plane."""
        mechanism.body_id(self.body)
        found, _ = _chain(mechanism.model, self.body)
        if not found:
            raise InputError(
                f"no hinge turns {self.body}, so its absolute angle never changes",
                where=f"spring {name}",
                hint="name a body that a hinge moves",
            )


def _chain(model: mujoco.MjModel, body: str) -> tuple[dict[int, float], float]:
    """Hinges that turn a body with their signs about (0, -1, 0), root first, and its angle at the zero posture."""
    index = model.body(body).id
    data = mujoco.MjData(model)
    data.qpos[:] = model.qpos0
    mujoco.mj_kinematics(model, data)
    found: dict[int, float] = {}
    for dof in ancestors(model, index):
        joint = int(model.dof_jntid[dof])
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE:
            continue
        sign = float(data.xaxis[joint] @ RIGHT)
        if model.jnt_type[joint] != HINGE or abs(abs(sign) - 1.0) > PARALLEL:
            raise InputError(
                f"joint {model.joint(joint).name} turns {body} out of the x-z plane, so it has no absolute angle",
                where=f"absolute {body}",
                hint="an absolute angle needs hinges along y all the way from the base",
            )
        found[joint] = math.copysign(1.0, sign)
    forward = data.xmat[index].reshape(3, 3)[:, 0]
    if abs(forward[1]) > PARALLEL:
        raise InputError(
            f"the x axis of {body} stands out of the x-z plane, so its angle there is not defined",
            where=f"absolute {body}",
        )
    return found, math.atan2(forward[2], forward[0])


def _wrapped(angle: float) -> float:
    """The same angle in (-pi, pi]."""
    return -(((-angle + math.pi) % (2 * math.pi)) - math.pi)
