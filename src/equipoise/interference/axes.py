"""Lines that pass a joint's axis: where the spring would have to jump over the shaft."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.balancers.paths import Line
from equipoise.interference.segments import closest
from equipoise.loops import ancestors
from equipoise.mechanism import Mechanism, Point
from equipoise.states import States

STRAIGHT = 0.5 * np.pi


def passed(states: States, ends: tuple[str, str], a: Array, b: Array) -> dict[str, NDArray[np.bool_]]:
    """Hinges between two bodies whose axis a line from a to b (C, 3) passes on the way between poses: {joint: (C,)}.

    Seen along the axis, the two ends stand at an angle of nearly +180 deg at one pose and nearly -180 deg at another:
    the line has gone over the axis between its ends.
    """
    points = [Point.many(body, p) for body, p in zip(ends, (a, b), strict=True)]
    found = {}
    for joint, axis, u, v in _seen(states, Line(*points)):
        angle = np.arctan2((np.cross(u, v) * axis).sum(-1), (u * v).sum(-1))
        found[joint] = (angle > STRAIGHT).any(axis=-1) & (angle < -STRAIGHT).any(axis=-1)
    return found


def ways(states: States, line: Line) -> dict[str, Array]:
    """Least distance (..., N), m, of a line, seen along the axes of the hinges between its ends, from each axis."""
    nothing = np.zeros(3)
    return {joint: closest(u, v, nothing, nothing) for joint, _, u, v in _seen(states, line)}


def _seen(states: States, line: Line) -> Iterator[tuple[str, Array, Array, Array]]:
    """Per hinge between the ends of a line: its axis (N, 3), and both ends (..., N, 3) from it, square to it."""
    mechanism = states.mechanism
    ends = [states.point(point)[0] for point in (line.a, line.b)]
    for joint in between(mechanism, line.a.body, line.b.body):
        body = int(mechanism.model.jnt_bodyid[joint])
        turn = states.kin.xmat[:, body]
        anchor = states.kin.xpos[:, body] + turn @ mechanism.model.jnt_pos[joint]
        axis = turn @ mechanism.model.jnt_axis[joint]
        u, v = ((end - anchor) - ((end - anchor) * axis).sum(-1)[..., None] * axis for end in ends)
        yield mechanism.model.joint(joint).name, axis, u, v


def between(mechanism: Mechanism, a: str, b: str) -> tuple[int, ...]:
    """Numbers of the hinges that two bodies do not share."""
    model = mechanism.model
    ways = [{int(model.dof_jntid[d]) for d in ancestors(model, mechanism.body_id(body))} for body in (a, b)]
    return tuple(joint for joint in sorted(ways[0] ^ ways[1]) if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE)
