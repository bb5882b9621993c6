"""Every joint its own coordinate, and every bearing come apart: the coordinates that bearing forces work along."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property

import mujoco
import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array, Block
from equipoise.loops import ancestors
from equipoise.loops.posture import cross
from equipoise.mechanism import Mechanism
from equipoise.momentum import beyond_sums, body_wrenches, joint_loads
from equipoise.states import States

_TRANSLATIONS = {int(mujoco.mjtJoint.mjJNT_SLIDE): 1, int(mujoco.mjtJoint.mjJNT_FREE): 3}


@dataclass(frozen=True, eq=False)
class Loosened(Mechanism):
    """A mechanism in the coordinates of all its joints and of every bearing's separation along the world's axes."""

    @cached_property
    def driven_blocks(self) -> tuple[Block, ...]:
        """All coordinates: joints first."""
        return (Block("every coordinate", "", self.model.nv + 3 * len(carried_bodies(self.model))),)


def own_loads(states: States) -> Array:
    """What the mechanism's own motion, weight, springs and dampers ask for in all coordinates (N, nv + 3 K).

    In a joint the generalised force where no loop closes, in a separation the force, N, that holds on to all that
    lies beyond the bearing: the wrenches of the bodies, summed from the tips to the base.
    """
    mechanism, model, kin = states.mechanism, states.mechanism.model, states.kin
    lift = -model.body_mass[:, None] * mechanism.gravity
    centre = kin.xpos + np.einsum("nbij,bj->nbi", kin.xmat, model.body_ipos)
    wrenches = body_wrenches(states) + np.concatenate([np.broadcast_to(lift, centre.shape), cross(centre, lift)], -1)
    for point, mass in zip(states.payload_points, states.payload_mass.T, strict=True):
        lift = -mass[:, None] * mechanism.gravity
        moment = np.cross(states.point(point)[0], lift)
        wrenches[:, mechanism.body_id(point.body)] += np.concatenate([lift, moment], axis=1)
    held = beyond_sums(model, wrenches)
    joints = joint_loads(states, held)
    joints += states.moving.acceleration * model.dof_armature - kin.spring - states.moving.damper
    return np.concatenate([joints, held[:, carried_bodies(model), :3].reshape(len(states), -1)], axis=1)


def carried_bodies(model: mujoco.MjModel) -> NDArray[np.int_]:
    """The bodies (K,) that have joints of their own: each hangs on a bearing."""
    return np.flatnonzero(model.body_dofnum > 0)


def beyond(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """Which bodies (K, nbody) lie beyond each bearing."""
    carried = carried_bodies(model)
    found = np.zeros((len(carried), model.nbody), dtype=bool)
    for body in range(1, model.nbody):  # parents come first
        found[:, body] = found[:, model.body_parentid[body]] | (carried == body)
    return found


def loosen(states: States) -> States:
    """The same states in the coordinates of all joints and separations; `effort` then answers what acts along them."""
    mechanism, model, count = states.mechanism, states.mechanism.model, len(states)
    loose = Loosened(**{field.name: getattr(mechanism, field.name) for field in fields(Mechanism)})
    after = beyond(model)
    width = model.nv + 3 * len(after)
    bodies = {}
    for body in range(model.nbody):
        linear, angular = np.zeros((2, count, 3, width))
        dofs = ancestors(model, body)
        motion = np.swapaxes(states.kin.cdof[:, dofs], 1, 2)
        linear[..., dofs], angular[..., dofs] = motion[:, 3:], motion[:, :3]
        for bearing in np.flatnonzero(after[:, body]):
            linear[..., model.nv + 3 * bearing : model.nv + 3 * bearing + 3] = np.eye(3)
        bodies[body] = (linear, angular)
    joints = np.eye(model.nv, width)[None]
    driven = np.zeros((count, width))
    return replace(states, mechanism=loose, driven=driven, D=joints, _bodies=bodies, _points={})


def is_bearing(model: mujoco.MjModel, body: int) -> bool:
    """Whether a body's joints hold it: one that slides or floats in a plane is placed by coordinates only."""
    first = model.body_jntadr[body]
    kinds = model.jnt_type[first : first + model.body_jntnum[body]]
    return sum(_TRANSLATIONS.get(int(kind), 0) for kind in kinds) < 2
