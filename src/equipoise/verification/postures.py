"""Postures of a reloaded model: the mechanism's own joints by name, the loops of added parts closed in that model."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.errors import ModelError, nearest
from equipoise.loops import tighten_loops
from equipoise.states import States

MARGIN = 1e-7
_WIDTHS = {int(mujoco.mjtJoint.mjJNT_FREE): (7, 6), int(mujoco.mjtJoint.mjJNT_BALL): (4, 3)}


def postures(
    model: mujoco.MjModel,
    states: States,
    positions: Mapping[str, Array],
    laws: Mapping[str, Array],
) -> tuple[Array, Array]:
    """Positions q (N, nq) of all joints of a reloaded model, and how they follow the driven ones, D (N or 1, nv, nd).

    The mechanism's joints are found by name and stand as in the states. Joints of added parts start at positions
    {joint: (N,)}, and Newton's steps close the model's own loops from there; D is that of its constraint Jacobian.
    laws {joint equality: (N, 5)} are the coefficients that hold for each state, where one polynomial is not enough.
    """
    mechanism = states.mechanism
    places, dofs = by_name(model, mechanism.model)
    count, nd = states.driven.shape
    q = np.tile(model.qpos0, (count, 1))
    q[:, places] = states.kin.q
    added = [model.joint(index).name for index in range(model.njnt)]
    added = [name for name in added if name in positions]
    if not added:
        transmission = np.zeros((len(states.D), model.nv, nd))
        transmission[:, dofs] = states.D
        return q, transmission
    for name in added:
        q[:, model.joint(name).qposadr[0]] = positions[name]
    transmission = np.zeros((count, model.nv, nd))
    for bound, rows in _bound(model, laws, count):
        middle = q[rows].mean(axis=0)
        home = q[rows][int(np.abs(q[rows] - middle).sum(axis=1).argmin())]
        judge = replace(mechanism, model=bound, reference=home, singularity=MARGIN, _batches={})
        q[rows], transmission[rows] = tighten_loops(judge, q[rows])
    return q, transmission


def _bound(
    model: mujoco.MjModel, laws: Mapping[str, Array], count: int
) -> list[tuple[mujoco.MjModel, NDArray[np.int_]]]:
    """The model with each set of laws that occurs, and the states for which it holds."""
    if not laws:
        return [(model, np.arange(count))]
    ids = [model.equality(name).id for name in laws]
    table = np.concatenate([np.asarray(law) for law in laws.values()], axis=1)
    kinds, which = np.unique(table, axis=0, return_inverse=True)
    found = []
    for number, kind in enumerate(kinds):
        bound = copy.copy(model)
        for index, law in zip(ids, kind.reshape(len(ids), 5), strict=True):
            bound.eq_data[index, :5] = law
        found.append((bound, np.flatnonzero(which.ravel() == number)))
    return found


def by_name(model: mujoco.MjModel, original: mujoco.MjModel) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Where the original's positions (nq,) and degrees of freedom (nv,) sit in the reloaded model."""
    positions, dofs = np.empty(original.nq, dtype=int), np.empty(original.nv, dtype=int)
    names = [model.joint(index).name for index in range(model.njnt)]
    for old in range(original.njnt):
        name = original.joint(old).name
        if name not in names:
            raise ModelError(f"the saved model has no joint {name!r}", hint=nearest(name, names))
        new = names.index(name)
        width = _WIDTHS.get(int(original.jnt_type[old]), (1, 1))
        for table, start, there, size in (
            (positions, original.jnt_qposadr, model.jnt_qposadr, width[0]),
            (dofs, original.jnt_dofadr, model.jnt_dofadr, width[1]),
        ):
            table[start[old] : start[old] + size] = there[new] + np.arange(size)
    return positions, dofs
