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
from equipoise.states import Placement, States

FORCE, MOMENT = Block("force", "N", 3), Block("moment", "N m", 3)
MASS = Block("mass", "kg")
_wrenches: weakref.WeakKeyDictionary[States, Array] = weakref.WeakKeyDictionary()
_LEVI = np.zeros((3, 3, 3))
_LEVI[[0, 1, 2], [1, 2, 0], [2, 0, 1]] = 1.0
_LEVI[[0, 2, 1], [2, 1, 0], [1, 0, 2]] = -1.0


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
    carried = np.einsum("...pab,nib->...npai", J, rate)  # J Xddot'
    linear = np.swapaxes(carried[..., 3, :], -1, -2)
    product = np.einsum("nja,...npak->...npjk", frame, carried)
    return np.concatenate([linear, np.einsum("ijk,...npjk->...nip", _LEVI, product)], axis=-2)


def inertial_effort(place: Placement, J: Array) -> Array:
    """Effort (N, nd, P) of the driven joints that gives bodies of J (P, 4, 4) their motion, weight left out."""
    carried = np.einsum("...pab,nib->...npai", J, place.bend)
    return np.einsum("njia,...npai->...njp", place.slope, carried)


def bare_wrench(states: States) -> Array:
    """Rate of linear and angular momentum (N, 6) of the mechanism and its payload about the world origin."""
    if states not in _wrenches:  # force and moment are asked for one after the other
        _wrenches[states] = _bare_wrench(states)
    return _wrenches[states]


def _bare_wrench(states: States) -> Array:
    model = states.mechanism.model
    total = np.zeros((len(states), 6))
    for body in range(1, model.nbody):
        if states.carried(body):
            place = states.placement(model.body(body).name)
            total += wrench(place, body_inertia(model, body)[None])[..., 0]
    for point, mass in zip(states.payload_points, states.payload_mass.T, strict=True):
        total += states.point_wrench(point, mass)
    return total


def bare_drive(states: States) -> tuple[Array, Array]:
    """Inertial and static part (N, nd) of the driven joints' effort over a motion.

    Static: weights, springs and dampers of the file, payloads; inertial: all that acceleration and speed ask for,
    rotor inertias (armature) of the file included.
    """
    model, moving = states.mechanism.model, states.moving
    rotors = moving.acceleration * model.dof_armature
    inertial = (rotors[:, None, :] @ states.D)[:, 0]
    for body in range(1, model.nbody):
        if states.carried(body):
            place = states.placement(model.body(body).name)
            inertial = inertial + inertial_effort(place, body_inertia(model, body)[None])[..., 0]
    for point, mass in zip(states.payload_points, states.payload_mass.T, strict=True):
        inertial = inertial + states.point_inertia(point, mass)
    return inertial, states.holding - (moving.damper[:, None, :] @ states.D)[:, 0]
