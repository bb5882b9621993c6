"""How dependent joints accelerate: the second derivative of the loop equations."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.loops.close import branch_of
from equipoise.loops.constraints import Connect, Couple, Equality, Weld
from equipoise.loops.posture import Pose, ancestors, cross, quat_product

if TYPE_CHECKING:
    from equipoise.mechanism import Mechanism

_CHUNK = 1024  # postures whose Jacobians stay in the processor's cache


def accelerations(mechanism: Mechanism, postures: Pose, velocity: Array, cdof_dot: Array, start: Array) -> Array:
    """Accelerations (N, nv) of all joints that keep the loops closed.

        J qacc = -Jdot qvel,   qacc = start + J_dep^+ (-Jdot qvel - J start)

    postures are N closed ones, velocity (N, nv) keeps them closed, cdof_dot (N, nv, 6) are the rates of the
    motion axes; start (N, nv) carries the driven joints' accelerations and is corrected in the dependent joints.
    """
    branch = branch_of(mechanism)
    if branch is None:
        return start
    loop = branch.loop
    found = start.copy()
    for first in range(0, len(start), _CHUNK):
        part = slice(first, first + _CHUNK)
        pose = Pose(*(getattr(postures, field.name)[part] for field in fields(Pose)))
        jacobian = np.concatenate([item.rows(pose)[1] for item in loop.equalities], axis=1)
        drift = np.concatenate([_drift(item, pose, velocity[part], cdof_dot[part]) for item in loop.equalities], axis=1)
        jacobian, drift = jacobian * (loop.rows[:, None] * loop.columns), drift * loop.rows
        scaled = start[part] / loop.columns
        slope = jacobian[:, :, loop.dependent]
        normal = np.swapaxes(slope, 1, 2)
        gram = normal @ slope
        for _ in range(2):  # once more against rounding: the normal equations square the condition number
            left = -drift - (jacobian @ scaled[..., None])[..., 0]
            scaled[:, loop.dependent] += np.linalg.solve(gram, normal @ left[..., None])[..., 0]
        found[part] = scaled * loop.columns
    return found


def _drift(item: Equality, pose: Pose, velocity: Array, cdof_dot: Array) -> Array:
    """Jdot qvel (N, rows) of one equality: its second derivative where no joint accelerates."""
    if isinstance(item, Weld):
        twists = [_twist(item.point.model, body, pose, velocity, cdof_dot) for body in item.point.bodies]
        one = quat_product(pose.xquat[:, item.point.bodies[0]], item.turns[0])
        back = quat_product(pose.xquat[:, item.point.bodies[1]], item.turns[1]) * np.array([1.0, -1.0, -1.0, -1.0])
        # closed welds turn alike, so only the difference of the angular accelerations is left
        spin = np.concatenate([np.zeros((len(one), 1)), twists[0][1][:, :3] - twists[1][1][:, :3]], axis=1)
        turn = 0.5 * item.scale * quat_product(quat_product(back, spin), one)[:, 1:]
        return np.concatenate([_drift(item.point, pose, velocity, cdof_dot), turn], axis=1)
    if isinstance(item, Couple):
        return _couple_drift(item, pose, velocity)
    assert isinstance(item, Connect)
    ends = []
    for body, place in zip(item.bodies, item.points(pose), strict=True):
        twist, rate = _twist(item.model, body, pose, velocity, cdof_dot)
        arm = place - pose.com[:, body]
        point = twist[:, 3:] + cross(twist[:, :3], arm)
        ends.append(rate[:, 3:] + cross(rate[:, :3], arm) + cross(twist[:, :3], point))
    return ends[0] - ends[1]


def _twist(model: mujoco.MjModel, body: int, pose: Pose, velocity: Array, cdof_dot: Array) -> tuple[Array, Array]:
    """Velocity of a body (N, 6), angular then linear at its tree's centre, and its rate without joint accelerations."""
    dofs = ancestors(model, body)
    speed = velocity[:, dofs, None]
    return (pose.cdof[:, dofs] * speed).sum(axis=1), (cdof_dot[:, dofs] * speed).sum(axis=1)


def _couple_drift(item: Couple, pose: Pose, velocity: Array) -> Array:
    if item.tendon:
        for tendon in item.items:
            if item.model.wrap_type[item.model.tendon_adr[tendon]] != mujoco.mjtWrap.mjWRAP_JOINT:
                raise InputError(
                    f"accelerations over the spatial tendon {item.model.tendon(tendon).name!r} are not available",
                    hint="close the loop with a connect, weld or joint equality",
                )
    if len(item.items) < 2 or not item.coefficients[2:].any():
        return np.zeros((len(pose.q), 1))
    if item.tendon:
        offset = pose.ten_length[:, item.items[1]] - item.references[1]
        rate = (pose.ten_J[:, item.items[1]] * velocity).sum(axis=1)
    else:
        offset = pose.q[:, item.model.jnt_qposadr[item.items[1]]] - item.references[1]
        rate = velocity[:, item.model.jnt_dofadr[item.items[1]]]
    return -(np.polynomial.Polynomial(item.coefficients).deriv(2)(offset) * rate**2)[:, None]
