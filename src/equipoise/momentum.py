"""The second ledger: rate of momentum and inertial effort of bodies, linear in their pseudo-inertia.

A mass element at x = (r, 1) in a body's frame is at X x in the world, so that with J = int x x' dm (4, 4)

    p = Xdot J e4,   L_i = eps_ijk (X J Xdot')_jk,   F = Xddot J e4,   M_i = eps_ijk (X J Xddot')_jk,
    tau_j = tr(dX/dq_j J Xddot')

about the world origin: everything that shakes a base or loads a motor is linear in J.
"""

from __future__ import annotations

import weakref
from collections.abc import Sequence

import mujoco
import numpy as np

from equipoise.affine import Array, Block
from equipoise.frames import Placement, columns_crossed, cross_parts, parts_of
from equipoise.loops.posture import cross
from equipoise.states import States

FORCE, MOMENT = Block("force", "N", 3), Block("moment", "N m", 3)
MASS = Block("mass", "kg")
_wrenches: weakref.WeakKeyDictionary[States, Array] = weakref.WeakKeyDictionary()


def pseudo_inertia(mass: float, com: Sequence[float] | Array, inertia: Array) -> Array:
    """J (4, 4) = [[S, m c], [m c', m]], S = tr(I_o) / 2 - I_o, from mass, centre (3,) and inertia (3, 3) about it."""
    c = np.asarray(com, dtype=float)
    about = inertia + mass * (c @ c * np.eye(3) - np.outer(c, c))
    J = np.empty((4, 4))
    J[:3, :3] = 0.5 * np.trace(about) * np.eye(3) - about
    J[:3, 3] = J[3, :3] = mass * c
    J[3, 3] = mass
    return J


def body_inertia(model: mujoco.MjModel, body: int) -> Array:
    """Pseudo-inertia (4, 4) of a body of the model about its own frame."""
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[body])
    turn = turn.reshape(3, 3)
    inertia = turn @ np.diag(model.body_inertia[body]) @ turn.T
    return pseudo_inertia(float(model.body_mass[body]), model.body_ipos[body], inertia)


def wrench(place: Placement, J: Array) -> Array:
    """Force and moment about the world origin (N, 6, P) that give bodies of J (P, 4, 4) their motion: d(p, L)/dt."""
    return _first_moments(place.frame, place.bend, J)


def momentum(place: Placement, J: Array) -> Array:
    """Linear and angular momentum about the world origin (N, 6, P) of bodies of J (P, 4, 4)."""
    return _first_moments(place.frame, place.speed, J)


def _first_moments(frame: Array, rate: Array, J: Array) -> Array:
    carried = rate[:, None] @ J[..., None, :, :, :]  # Xddot J
    angular = columns_crossed(frame[:, None], carried).sum(axis=-1)
    return np.swapaxes(np.concatenate([carried[..., 3], angular], axis=-1), -1, -2)


def inertial_effort(states: States, body: str, J: Array) -> Array:
    """Effort (N, nd, P) of the driven joints that gives bodies of J (P, 4, 4) their motion, weight left out.

    J stands in the frame of `body`, which carries them.
    """
    return states.worked(body, wrench(states.placement(body), J))


def body_wrenches(states: States) -> Array:
    """Rate of linear and angular momentum (N, nbody, 6) of each body, payloads included, about the world origin."""
    if states not in _wrenches:  # force, moment, drive and bearings ask for it one after the other
        mechanism, model, frames = states.mechanism, states.mechanism.model, states.frames
        inertias = np.array([body_inertia(model, body) for body in range(model.nbody)])
        carried = np.einsum("iabn,bak->ikbn", parts_of(frames.bend), inertias)
        angular = cross_parts(parts_of(frames.frame), carried).sum(axis=1)
        found = np.concatenate([carried[:, 3], angular]).T
        for point, mass in zip(states.payload_points, states.payload_mass.T, strict=True):
            found[:, mechanism.body_id(point.body)] += states.point_wrench(point, mass)
        _wrenches[states] = found
    return _wrenches[states]


def bare_wrench(states: States) -> Array:
    """Rate of linear and angular momentum (N, 6) of the mechanism and its payload about the world origin."""
    return body_wrenches(states).sum(axis=1)


def bare_drive(states: States) -> tuple[Array, Array]:
    """Inertial and static part (N, nd) of the driven joints' effort over a motion.

    Static: weights, springs and dampers of the file, payloads; inertial: all that acceleration and speed ask for,
    rotor inertias (armature) of the file included.
    """
    model, moving = states.mechanism.model, states.moving
    joints = joint_loads(states, beyond_sums(model, body_wrenches(states)))
    joints += moving.acceleration * model.dof_armature
    inertial = (joints[:, None, :] @ states.D)[:, 0]
    return inertial, states.holding - (moving.damper[:, None, :] @ states.D)[:, 0]


def beyond_sums(model: mujoco.MjModel, wrenches: Array) -> Array:
    """For each body the sum (N, nbody, 6) of the wrenches (N, nbody, 6) of all that it carries, itself included."""
    total = wrenches.copy()
    for body in range(model.nbody - 1, 0, -1):  # parents come first
        total[:, model.body_parentid[body]] += total[:, body]
    return total


def joint_loads(states: States, beyond: Array) -> Array:
    """The part (N, nv) along each joint's axis of the wrench (N, nbody, 6) that moves all beyond it."""
    kin, bodies = states.kin, states.mechanism.model.dof_bodyid
    force = beyond[:, bodies, :3]
    moment = beyond[:, bodies, 3:] - cross(kin.com[:, bodies], force)
    return (kin.cdof[..., :3] * moment).sum(axis=2) + (kin.cdof[..., 3:] * force).sum(axis=2)
