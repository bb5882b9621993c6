"""The constraint Jacobian of closed loops at a posture that is not singular by accident."""

from __future__ import annotations

import copy

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.errors import ModelError

_CLOSED = 1e-10
_STEPS = 60
_RANK = 1e-4
"""Relative: postures closed to rounding still show false ranks of 1e-6 where links line up."""
_TRIALS = 4


def loop_jacobian(model: mujoco.MjModel, reference: Array, where: str) -> Array:
    """The Jacobian (rows, nv) of all active equalities at a regular posture near the reference.

    A reference posture may be singular (a stretched four-bar); postures near it are closed by Newton steps and
    the one of highest rank is taken. No rows if there are no loops. Raises ModelError for loops beyond numbers.
    """
    bare = copy.copy(model)
    flags = mujoco.mjtDisableBit
    off = (flags.mjDSBL_CONTACT, flags.mjDSBL_LIMIT, flags.mjDSBL_FRICTIONLOSS)
    bare.opt.disableflags |= sum(int(flag) for flag in off)
    bare.opt.disableflags &= ~(int(flags.mjDSBL_CONSTRAINT) | int(flags.mjDSBL_EQUALITY))
    bare.opt.jacobian = int(mujoco.mjtJacobian.mjJAC_DENSE)
    data = mujoco.MjData(bare)
    data.qpos[:] = reference
    J, _ = _rows(bare, data)
    if not len(J):
        return J
    if not _usable(J):
        raise ModelError("an equality has a Jacobian that is not finite", where=where, hint="check its coefficients")
    best, best_rank = J, -1
    random = np.random.default_rng(0)
    for trial in range(_TRIALS):
        data.qpos[:] = reference
        if trial:
            mujoco.mj_integratePos(bare, data.qpos, random.uniform(-0.1, 0.1, model.nv), 1.0)
        J, closed = _close(bare, data)
        rank = int(np.linalg.matrix_rank(J, rtol=_RANK)) if closed else -1
        if rank > best_rank:
            best, best_rank = J, rank
    return best


def _close(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[Array, bool]:
    """Newton with least-norm steps of bounded length; the Jacobian where it ends, and whether loops close."""
    for _ in range(_STEPS):
        J, gap = _rows(model, data)
        if not _usable(J, gap):
            return J, False
        if np.abs(gap).max(initial=0.0) < _CLOSED:
            break
        step = -np.linalg.lstsq(J, gap, rcond=_RANK)[0]
        step *= min(1.0, 0.3 / max(1e-12, float(np.abs(step).max())))
        mujoco.mj_integratePos(model, data.qpos, step, 1.0)
    J, gap = _rows(model, data)
    return J, bool(_usable(J, gap) and np.abs(gap).max(initial=0.0) < _CLOSED)


def _usable(*arrays: Array) -> bool:
    return all(bool(np.all(np.abs(array) < 1e12)) for array in arrays)  # also false for NaN


def _rows(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[Array, Array]:
    mujoco.mj_fwdPosition(model, data)
    equality = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    J = np.array(data.efc_J)[: len(equality) * model.nv].reshape(len(equality), model.nv)
    return J[equality], np.array(data.efc_pos)[equality]
