"""Postures: their kinematics on all cores, steps in velocity coordinates, and which dofs move a body."""

from __future__ import annotations

import copy
from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco.batch import Batch

from equipoise.affine import Array

_FIELDS = ("xpos", "xmat", "xquat", "subtree_com", "cdof")
_FREE, _BALL = int(mujoco.mjtJoint.mjJNT_FREE), int(mujoco.mjtJoint.mjJNT_BALL)


@dataclass(frozen=True, eq=False)
class Pose:
    """Kinematics of postures q (N, nq), as MuJoCo names them; com (N, nbody, 3) is the centre cdof refers to."""

    q: Array
    xpos: Array
    xmat: Array
    xquat: Array
    com: Array
    cdof: Array
    ten_length: Array
    ten_J: Array

    def point(self, body: int, local: Array) -> Array:
        """World place (N, 3) of a body's point."""
        place = self.xpos[:, body]
        for axis in np.flatnonzero(local):
            place = place + local[axis] * self.xmat[:, body, :, axis]
        return place


class Evaluator:
    """Evaluates poses on all cores; keeps one batch that grows with the largest request."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model = copy.copy(model)
        flags = mujoco.mjtDisableBit
        self.model.opt.disableflags |= int(flags.mjDSBL_CONSTRAINT) | int(flags.mjDSBL_CONTACT)
        self._size = 0

    def __call__(self, q: Array) -> Pose:
        """The kinematics of postures q (N, nq)."""
        count = len(q)
        if count > self._size:
            self._grow(max(count, 64))
        self._qpos[:count] = q
        self._batch.forward(ids=np.arange(count, dtype=np.int32), stage=int(mujoco.mjtStage.mjSTAGE_POS))
        xpos, xmat, xquat, com, cdof = (field[:count] for field in self._fields)
        model = self.model
        return Pose(
            q=q,
            xpos=xpos,
            xmat=xmat.reshape(count, -1, 3, 3),
            xquat=xquat,
            com=com[:, model.body_rootid],
            cdof=cdof.reshape(count, -1, 6),
            ten_length=self._ten_length[:count] if model.ntendon else np.zeros((count, 0)),
            ten_J=dense_tendons(model, self._ten_J[:count]) if model.ntendon else np.zeros((count, 0, model.nv)),
        )

    def _grow(self, size: int) -> None:
        self._size = size
        self._batch = Batch(self.model, size)
        self._qpos = self._batch.bind("qpos")
        self._fields = [self._batch.bind(name) for name in _FIELDS]
        if self.model.ntendon:
            self._ten_length, self._ten_J = self._batch.bind("ten_length"), self._batch.bind("ten_J")


def dense_tendons(model: mujoco.MjModel, sparse: Array) -> Array:
    """Tendon Jacobians (N, ntendon, nv) from MuJoCo's sparse rows (N, nnz)."""
    dense = np.zeros((len(sparse), model.ntendon, model.nv))
    for tendon in range(model.ntendon):
        start, number = model.ten_J_rowadr[tendon], model.ten_J_rownnz[tendon]
        dense[:, tendon, model.ten_J_colind[start : start + number]] = sparse[:, start : start + number]
    return dense


def ancestors(model: mujoco.MjModel, body: int) -> list[int]:
    """Degrees of freedom that move a body, root first."""
    while body and model.body_dofnum[body] == 0:
        body = int(model.body_parentid[body])
    if not body:
        return []
    dof = int(model.body_dofadr[body] + model.body_dofnum[body] - 1)
    chain = []
    while dof >= 0:
        chain.append(dof)
        dof = int(model.dof_parentid[dof])
    return chain[::-1]


def qpos_width(model: mujoco.MjModel, joint: int) -> int:
    """How many positions a joint has: 7 free, 4 ball, 1 hinge or slide."""
    return {_FREE: 7, _BALL: 4}.get(int(model.jnt_type[joint]), 1)


def integrate(model: mujoco.MjModel, q: Array, step: Array) -> Array:
    """The postures q (N, nq) moved by velocity-coordinate steps (N, nv); quaternions turn in the body's frame."""
    moved = q.copy()
    plain = np.flatnonzero((model.jnt_type != _FREE) & (model.jnt_type != _BALL))
    moved[:, model.jnt_qposadr[plain]] += step[:, model.jnt_dofadr[plain]]
    for joint in np.flatnonzero((model.jnt_type == _FREE) | (model.jnt_type == _BALL)):
        at, dof = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        if model.jnt_type[joint] == _FREE:
            moved[:, at : at + 3] += step[:, dof : dof + 3]
            at, dof = at + 3, dof + 3
        moved[:, at : at + 4] = _turned(moved[:, at : at + 4], step[:, dof : dof + 3])
    return moved


def _turned(quat: Array, turn: Array) -> Array:
    half = 0.5 * np.linalg.norm(turn, axis=1, keepdims=True)
    small = np.concatenate([np.cos(half), 0.5 * np.sinc(half / np.pi) * turn], axis=1)
    result = quat_product(quat, small)
    return result / np.linalg.norm(result, axis=1, keepdims=True)


def cross(a: Array, b: Array) -> Array:
    """The cross product over the last axis; numpy's own is several times slower on short arrays."""
    (ax, ay, az), (bx, by, bz) = (tuple(v[..., i] for i in range(3)) for v in (a, b))
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1)


def quat_product(a: Array, b: Array) -> Array:
    """Hamilton product of quaternions (..., 4), scalar part first."""
    aw, av, bw, bv = a[..., :1], a[..., 1:], b[..., :1], b[..., 1:]
    scalar = aw * bw - np.sum(av * bv, axis=-1, keepdims=True)
    return np.concatenate([scalar, aw * bv + bw * av + cross(av, bv)], axis=-1)
