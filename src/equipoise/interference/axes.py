"""Lines that pass a joint's axis: where the spring would have to jump over the shaft."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.loops import ancestors
from equipoise.mechanism import Mechanism, Point
from equipoise.states import States

STRAIGHT = 0.5 * np.pi


def passed(states: States, ends: tuple[str, str], a: Array, b: Array) -> dict[str, NDArray[np.bool_]]:
    """Hinges between two bodies whose axis a line from a to b (C, 3) passes on the way between poses: {joint: (C,)}.

    Seen along the axis, the two ends stand at an angle of nearly +180 deg at one pose and nearly -180 deg at another:
    the line has gone over the axis between its ends.
    """
    mechanism = states.mechanism
    points = [Point(body, tuple(np.moveaxis(p[:, :, None], 1, 0))) for body, p in zip(ends, (a, b), strict=True)]
    p, q = (states.point(point)[0] for point in points)
    found = {}
    for joint in between(mechanism, *ends):
        body = int(mechanism.model.jnt_bodyid[joint])
        turn = states.kin.xmat[:, body]
        anchor = states.kin.xpos[:, body] + turn @ mechanism.model.jnt_pos[joint]
        axis = turn @ mechanism.model.jnt_axis[joint]
        u, v = ((end - anchor) - ((end - anchor) * axis).sum(-1)[..., None] * axis for end in (p, q))
        angle = np.arctan2((np.cross(u, v) * axis).sum(-1), (u * v).sum(-1))
        over = (angle > STRAIGHT).any(axis=-1) & (angle < -STRAIGHT).any(axis=-1)
        found[mechanism.model.joint(joint).name] = over
    return found


def between(mechanism: Mechanism, a: str, b: str) -> tuple[int, ...]:
    """Numbers of the hinges that two bodies do not share."""
    model = mechanism.model
    ways = [{int(model.dof_jntid[d]) for d in ancestors(model, mechanism.body_id(body))} for body in (a, b)]
    return tuple(joint for joint in sorted(ways[0] ^ ways[1]) if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE)
