"""Forward kinematics of many postures: what MuJoCo says of them at rest and in motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import mujoco
import numpy as np

from equipoise.affine import Array, Indices
from equipoise.loops import accelerations
from equipoise.loops.posture import Pose, dense_tendons
from equipoise.mechanism import Mechanism

_PLACES = ("xpos", "xmat", "subtree_com", "cdof")
_CLOSING = ("xquat", "ten_length", "ten_J")


@dataclass(frozen=True, eq=False)
class Kinematics(Pose):
    """What MuJoCo says of postures q (N, nq): every array has N rows.

    Beside the places, bias and spring (N, nv) forces at rest, energy (N,). What only loop equations ask for, xquat and
    the tendons, is empty where no equality is active.
    """

    bias: Array
    spring: Array
    energy: Array

    def take(self, rows: slice | Indices) -> Kinematics:
        """Some of the rows."""
        return Kinematics(**{field.name: getattr(self, field.name)[rows] for field in fields(Kinematics)})


@dataclass(frozen=True, eq=False)
class Rates:
    """How the postures move: velocity and acceleration of the driven joints (N, nd) and of all dofs (N, nv).

    cdof_dot (N, nv, 6) are the rates of the motion axes, damper (N, nv) the file's own damping forces.
    """

    driven_velocity: Array
    driven_acceleration: Array
    velocity: Array
    acceleration: Array
    cdof_dot: Array
    damper: Array

    def take(self, rows: slice | Indices) -> Rates:
        """Some of the rows."""
        return Rates(*(getattr(self, field.name)[rows] for field in fields(Rates)))


def kinematics(mechanism: Mechanism, q: Array) -> Kinematics:
    """Forward kinematics, gravity and file springs of all postures on all cores."""
    return _forward(mechanism, q, None, ())[0]


def in_motion(
    mechanism: Mechanism, q: Array, transmission: Array, driven: tuple[Array, Array]
) -> tuple[Kinematics, Rates]:
    """Kinematics, exact velocities D v and accelerations D a + Ddot v of all dofs, for driven (v, a) (N, nd) each."""
    v, a = driven
    velocity, start = ((transmission @ x[..., None])[..., 0] for x in (v, a))
    kin, (cdof_dot, damper) = _forward(mechanism, q, velocity, ("cdof_dot", "qfrc_damper"))
    cdof_dot = cdof_dot.reshape(kin.cdof.shape)
    acceleration = accelerations(mechanism, kin, velocity, cdof_dot, start)
    return kin, Rates(v, a, velocity, acceleration, cdof_dot, damper)


def _forward(
    mechanism: Mechanism, q: Array, velocity: Array | None, more: Sequence[str]
) -> tuple[Kinematics, list[Array]]:
    """Kinematics of postures, and more of MuJoCo's fields, at given velocities (None: at rest)."""
    model, count = mechanism.model, len(q)
    closing = _CLOSING if model.neq else ()
    names = [name for name in closing if model.ntendon or not name.startswith("ten")]
    names += ["qfrc_bias"] if velocity is None else []
    asked = (*_PLACES, "qfrc_spring", "energy", *names, *more)
    found = dict(zip(asked, mechanism.forward(q, velocity, asked), strict=True))
    cdof, com = found["cdof"].reshape(count, -1, 6), found["subtree_com"]
    kin = Kinematics(
        q=q,
        xpos=found["xpos"],
        xmat=found["xmat"].reshape(count, -1, 3, 3),
        xquat=found.get("xquat", np.zeros((count, 0, 4))),
        com=com[:, model.body_rootid],
        cdof=cdof,
        ten_length=found.get("ten_length", np.zeros((count, 0))),
        ten_J=dense_tendons(model, found["ten_J"]) if "ten_J" in found else np.zeros((count, 0, model.nv)),
        bias=found["qfrc_bias"] if velocity is None else _weights(model, com, cdof),
        spring=found["qfrc_spring"],
        energy=found["energy"][:, 0],
    )
    return kin, [found[name] for name in more]


def _weights(model: mujoco.MjModel, com: Array, cdof: Array) -> Array:
    """The bias at rest (N, nv): what carries the weight of all that lies beyond each dof, -m g at its centre."""
    off = model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    body = model.dof_bodyid
    lift = -model.body_subtreemass[body, None] * (0.0 if off else model.opt.gravity)
    arm = com[:, body] - com[:, model.body_rootid[body]]
    moment = np.einsum("nji,jik->njk", arm, _across(lift))
    return np.einsum("nji,ji->nj", cdof[..., 3:], lift) + (cdof[..., :3] * moment).sum(axis=2)


def _across(force: Array) -> Array:
    """Matrices (..., 3, 3) with r @ matrix = r x force."""
    return np.cross(np.eye(3), force[..., None, :])
