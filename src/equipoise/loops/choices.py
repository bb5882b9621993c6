"""The assemblies that loops allow at given positions of the driven joints, with names to choose one by."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.errors import InputError, LoopError
from equipoise.loops.branch import part_joints
from equipoise.loops.posture import Evaluator
from equipoise.loops.walk import Loop

if TYPE_CHECKING:
    from equipoise.mechanism import Mechanism
    from equipoise.motion.motion import Motion

STARTS = 200
SCALES = (1e-3, 1e-2, 0.1, 1.0, 3.0)
"""How far, in rad or characteristic lengths, starts lie from the reference."""
ROUNDS = 30
TIGHT = 1e-12
SAME = 1e-5
LATER = (3e-3, 1e-2, 3e-2)
"""Shares of a motion at which a singular start is looked at again."""


def assemblies(mechanism: Mechanism, driven: Array) -> dict[str, Array]:
    """Closed regular postures (nq,) at positions (nd,) of the driven joints, by name.

    Found by Newton's method from many starts around the reference, whole turns counted once. They are named by the
    dependent joint that tells them apart best: `platform_x-` and `platform_x+` where there are two, `platform_x 1`
    (its lowest value), `platform_x 2`, ... where there are more. Empty where nothing regular closes.
    """
    parted = part_joints(mechanism)
    if parted is None:
        return {}
    loop, _ = parted
    model = mechanism.model
    random = np.random.default_rng(0)
    q = np.tile(mechanism.reference, (STARTS, 1))
    q[:, model.jnt_qposadr[mechanism.driven_ids]] = driven
    scale = np.resize(SCALES, STARTS)[:, None]
    q = loop.move(q, scale * random.standard_normal((STARTS, len(loop.dependent))), loop.dependent)
    with np.errstate(all="ignore"):
        closed = loop.newton(Evaluator(model), q, goal=TIGHT, turns=ROUNDS)
    good = (closed.worst <= TIGHT * 10) & (closed.sigma > loop.margin)
    found: list[Array] = []
    for wound in closed.q[good]:
        posture = _unwound(loop, wound, mechanism.reference)
        if all(np.abs(posture - other).max() > SAME for other in found):
            found.append(posture)
    return _named(loop, found)


def on_branch(mechanism: Mechanism, driven: Array, branch: str) -> Mechanism:
    """The mechanism with one of its assemblies, by name, at positions (nd,) of the driven joints as its reference.

    Raises LoopError, naming the choices, for a name that is none of them or positions at which nothing regular closes.
    """
    found = assemblies(mechanism, driven)
    if branch not in found:
        where = mechanism.name
        if not found:
            raise LoopError("no regular posture closes the loops there", where=where, hint="begin elsewhere")
        raise LoopError(f"there is no branch {branch!r}", where=where, hint=f"choose {' or '.join(found)}")
    return replace(mechanism, reference=found[branch])


def choice_hint(mechanism: Mechanism, motion: Motion) -> str:
    """What to write where a motion cannot start: its branches, or those a little later where it starts singular."""
    for share in (0.0, *LATER):
        time = motion.start + share * (motion.end - motion.start)
        try:
            found = assemblies(mechanism, motion.at(np.array([time]))[0][0])
        except InputError:
            return ""
        if found:
            choices = " or ".join(f"`branch: {name}`" for name in found)
            return choices if not share else f"begin with `start: {time:.6g} s` in the sweep and write {choices}"
    return ""


def _unwound(loop: Loop, posture: Array, reference: Array) -> Array:
    """Dependent hinges brought within half a turn of the reference."""
    model, result = loop.model, posture.copy()
    for dof in loop.dependent:
        joint = int(model.dof_jntid[dof])
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE and not model.jnt_limited[joint]:
            at = model.jnt_qposadr[joint]
            result[at] -= 2 * np.pi * np.round((result[at] - reference[at]) / (2 * np.pi))
    return result


def _named(loop: Loop, found: list[Array]) -> dict[str, Array]:
    if not found:
        return {}
    model = loop.model
    joints: NDArray[np.int_] = np.unique(model.dof_jntid[loop.dependent])
    kinds = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
    plain = [int(joint) for joint in joints if model.jnt_type[joint] in kinds]
    table = np.stack(found)[:, model.jnt_qposadr[plain]]
    units = loop.columns[model.jnt_dofadr[plain]]
    gaps = np.diff(np.sort(table / units, axis=0), axis=0)
    # a joint on the platform is easier to picture than one in a leg: among near equals the last one names
    apart = gaps.min(axis=0) if len(found) > 1 else np.ones(len(plain))
    column = int(np.flatnonzero(apart >= 0.5 * apart.max())[-1])
    name = model.joint(plain[column]).name
    order = np.argsort(table[:, column], kind="stable")
    marks = ["-", "+"] if len(found) == 2 else [f" {rank + 1}" for rank in range(len(found))]
    return {f"{name}{mark}": found[int(row)] for mark, row in zip(marks, order, strict=True)}
