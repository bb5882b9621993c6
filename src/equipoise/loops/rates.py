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
        return _couple_drift(item, pose, velocity, cdof_dot)
    assert isinstance(item, Connect)
    ends = [
        _point_drift(item.model, body, place, pose, velocity, cdof_dot)[1]
        for body, place in zip(item.bodies, item.points(pose), strict=True)
    ]
    return ends[0] - ends[1]


def _point_drift(
    model: mujoco.MjModel, body: int, place: Array, pose: Pose, velocity: Array, cdof_dot: Array
) -> tuple[Array, Array]:
    """Velocity (N, 3) of a body's point at place (N, 3), and its acceleration where no joint accelerates."""
    twist, rate = _twist(model, body, pose, velocity, cdof_dot)
    arm = place - pose.com[:, body]
    point = twist[:, 3:] + cross(twist[:, :3], arm)
    return point, rate[:, 3:] + cross(rate[:, :3], arm) + cross(twist[:, :3], point)


def _twist(model: mujoco.MjModel, body: int, pose: Pose, velocity: Array, cdof_dot: Array) -> tuple[Array, Array]:
    """Velocity of a body (N, 6), angular then linear at its tree's centre, and its rate without joint accelerations."""
    dofs = ancestors(model, body)
    speed = velocity[:, dofs, None]
    return (pose.cdof[:, dofs] * speed).sum(axis=1), (cdof_dot[:, dofs] * speed).sum(axis=1)


def _couple_drift(item: Couple, pose: Pose, velocity: Array, cdof_dot: Array) -> Array:
    """y1'' - c'(d) y2'' - c''(d) y2'^2 (N, 1) of a coupling y1 = c(d), d = y2 - y2_0, where no joint accelerates."""
    found = _item_drift(item, 0, pose, velocity, cdof_dot)
    if len(item.items) == 2:
        law = np.polynomial.Polynomial(item.coefficients)
        if item.tendon:
            offset = pose.ten_length[:, item.items[1]] - item.references[1]
            rate = (pose.ten_J[:, item.items[1]] * velocity).sum(axis=1)
        else:
            offset = pose.q[:, item.model.jnt_qposadr[item.items[1]]] - item.references[1]
            rate = velocity[:, item.model.jnt_dofadr[item.items[1]]]
        found = found - law.deriv()(offset) * _item_drift(item, 1, pose, velocity, cdof_dot)
        found = found - law.deriv(2)(offset) * rate**2
    return found[:, None]


def _item_drift(item: Couple, which: int, pose: Pose, velocity: Array, cdof_dot: Array) -> Array:
    """The second derivative (N,) of a joint's position or a tendon's length where no joint accelerates.

    Of a straight run with ends p, q and d = p - q: (d . d'' + d' . d' - (d . d')^2 / d . d) / |d|, over the divisor
    of its pulley; joints, and tendons over joints, have none.
    """
    none = np.zeros(len(pose.q))
    if not item.tendon:
        return none
    model, tendon = item.model, item.items[which]
    kinds, wraps = mujoco.mjtWrap, range(model.tendon_adr[tendon], model.tendon_adr[tendon] + model.tendon_num[tendon])
    total, divisor, last = none, 1.0, None
    for wrap in wraps:
        kind = model.wrap_type[wrap]
        if kind == kinds.mjWRAP_JOINT:
            return none
        if kind == kinds.mjWRAP_PULLEY:
            divisor, last = float(model.wrap_prm[wrap]), None
            continue
        if kind != kinds.mjWRAP_SITE:
            raise InputError(
                f"accelerations over the tendon {model.tendon(tendon).name!r}, which wraps around a body, are not "
                "available",
                hint="close the loop with a connect, weld or joint equality, or a tendon through sites",
            )
        site = int(model.wrap_objid[wrap])
        body = int(model.site_bodyid[site])
        place = pose.point(body, model.site_pos[site])
        here = (place, *_point_drift(model, body, place, pose, velocity, cdof_dot))
        if last is not None:
            run, speed, change = (there - before for there, before in zip(here, last, strict=True))
            square = (run**2).sum(axis=1)
            along = (run * change).sum(axis=1) + (speed**2).sum(axis=1) - (run * speed).sum(axis=1) ** 2 / square
            total = total + along / np.sqrt(square) / divisor
        last = here
    return total
