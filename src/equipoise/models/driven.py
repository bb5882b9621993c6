"""Which joints are driven: the rest of a loop follows them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError, nearest
from equipoise.models.loop_rank import loop_jacobian
from equipoise.models.notices import some

_HINGE, _SLIDE = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
_INDEPENDENT = 1e-4
"""Part of a column that must be new for the column to count: links that line up leave false parts of 1e-6."""
_TOUCHED = 1e-9


@dataclass(frozen=True)
class Choice:
    """The driven joints in model order, those that loops determine, and those held at the reference posture.

    loose are those of the held ones that a loop would leave free to move: they need a lock.
    """

    driven: tuple[str, ...]
    following: tuple[str, ...]
    held: tuple[str, ...]
    loose: tuple[str, ...] = ()

    def remarks(self, model: mujoco.MjModel, reference: Array) -> list[str]:
        """What the audit says of joints that are not driven, and of driven slides without limits."""
        said = []
        if self.following:
            said.append(f"determined by loops or mimic: {some(self.following)}")
        if self.held:
            said.append(f"held at the reference posture: {some(self.held)}")
        outside = [name for name in self.held if _outside(model, name, reference)]
        if outside:
            said.append(f"held outside their limits: {some(outside)}; name a keyframe with `branch`, or drive them")
        endless = [name for name in self.driven if _is_endless(model, model.joint(name).id)]
        if endless:
            said.append(f"slides without limits: {some(endless)}; give their range in the sweep")
        return said


def choose_driven(model: mujoco.MjModel, reference: Array, wanted: Sequence[str] | None, where: str) -> Choice:
    """Split the joints of a model into driven, following and held ones.

    Without `wanted`: every hinge and slide with a range that nothing else determines; of a loop's joints those
    with an actuator in the file first, then those nearest to the base. A joint follows if a column of the
    constraint Jacobian belongs to it; as many follow as the Jacobian has ranks.
    Raises InputError for a wanted joint that cannot be driven.
    """
    asked = None if wanted is None else _asked(model, wanted, where)
    J = loop_jacobian(model, reference, where)
    basis = _following_dofs(J, _order(model, asked))
    touched = np.linalg.norm(J, axis=0) > _TOUCHED if len(J) else np.zeros(model.nv, dtype=bool)
    driven, following, held, loose = [], [], [], []
    for joint in range(model.njnt):
        name = model.joint(joint).name
        first, count = int(model.jnt_dofadr[joint]), _dofs(model, joint)
        if asked is not None and joint in asked and first in basis:
            loop = [model.joint(int(model.dof_jntid[dof])).name for dof in np.flatnonzero(touched)]
            rest = some(n for n in wanted or () if n != name and n in loop)
            raise InputError(
                f"joint {name!r} cannot be driven as well: the loops of {some(loop, 8)} determine it",
                where=where,
                hint=f"leave it out of `driven`, or drive it instead of {rest or 'another'}",
            )
        if basis.intersection(range(first, first + count)):
            following.append(name)
        elif joint in asked if asked is not None else _can_be_driven(model, joint):
            driven.append(name)
        else:
            held.append(name)
            if touched[first] and model.jnt_type[joint] in (_HINGE, _SLIDE):
                loose.append(name)
    return Choice(tuple(driven), tuple(following), tuple(held), tuple(loose))


def _asked(model: mujoco.MjModel, wanted: Sequence[str], where: str) -> set[int]:
    if isinstance(wanted, str):
        raise InputError(f"driven is the text {wanted!r}", where=where, hint=f"give a list: [{wanted}]")
    known = [model.joint(joint).name for joint in range(model.njnt)]
    asked: set[int] = set()
    for name in wanted:
        if name not in known:
            raise InputError(f"there is no joint {name!r} to drive", where=where, hint=nearest(str(name), known))
        joint = known.index(name)
        if model.jnt_type[joint] not in (_HINGE, _SLIDE):
            kind = "free" if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE else "ball"
            raise InputError(f"joint {name!r} is a {kind} joint and cannot be driven", where=where,
                             hint="drive hinges and slides; write a ball joint as three hinges")  # fmt: skip
        if joint in asked:
            raise InputError(f"joint {name!r} is named twice in driven", where=where, hint="name it once")
        asked.add(joint)
    if not asked:
        raise InputError("driven is empty", where=where, hint="name at least one joint, or leave `driven` out")
    return asked


def _order(model: mujoco.MjModel, asked: set[int] | None) -> list[int]:
    """Degrees of freedom in the order in which they are let follow: the last resort is a driven motor."""
    actuated = actuated_joints(model)
    joint_rows = model.eq_type == mujoco.mjtEq.mjEQ_JOINT
    mimics = {int(joint) for joint in model.eq_obj1id[joint_rows & (model.eq_active0 != 0)]}
    depth = np.zeros(model.nv, dtype=int)
    for dof in range(model.nv):
        parent = int(model.dof_parentid[dof])
        depth[dof] = depth[parent] + 1 if parent >= 0 else 0

    def rank(dof: int) -> tuple[int, int, int]:
        joint = int(model.dof_jntid[dof])
        if model.jnt_type[joint] not in (_HINGE, _SLIDE):
            group = 0
        elif asked is not None and joint in asked:
            group = 4
        elif joint in actuated:
            group = 3
        else:
            group = 1 if joint in mimics else 2
        return group, -int(depth[dof]), -dof

    return sorted(range(model.nv), key=rank)


def actuated_joints(model: mujoco.MjModel) -> set[int]:
    """Numbers of joints that an actuator of the file acts on directly."""
    kinds = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
    direct = np.isin(model.actuator_trntype, kinds)
    return {int(joint) for joint in model.actuator_trnid.reshape(-1, 2)[direct, 0]}


def _following_dofs(J: Array, order: list[int]) -> set[int]:
    """The first independent columns of J in this order (Gram-Schmidt, twice for rounding)."""
    basis = np.zeros((J.shape[0], 0))
    chosen: set[int] = set()
    for dof in order:
        column = J[:, dof]
        size = float(np.linalg.norm(column))
        if size <= _TOUCHED or basis.shape[1] == J.shape[0]:
            continue
        rest = column - basis @ (basis.T @ column)
        rest = rest - basis @ (basis.T @ rest)
        left = float(np.linalg.norm(rest))
        if left > _INDEPENDENT * size:
            basis = np.column_stack([basis, rest / left])
            chosen.add(dof)
    return chosen


def _can_be_driven(model: mujoco.MjModel, joint: int) -> bool:
    if model.jnt_type[joint] not in (_HINGE, _SLIDE):
        return False
    low, high = model.jnt_range[joint]
    return not model.jnt_limited[joint] or high > low


def _is_endless(model: mujoco.MjModel, joint: int) -> bool:
    return bool(model.jnt_type[joint] == _SLIDE and not model.jnt_limited[joint])


def _outside(model: mujoco.MjModel, name: str, reference: Array) -> bool:
    joint = model.joint(name).id
    if model.jnt_type[joint] not in (_HINGE, _SLIDE) or not model.jnt_limited[joint]:
        return False
    low, high = model.jnt_range[joint]
    return not low - 1e-6 <= reference[model.jnt_qposadr[joint]] <= high + 1e-6


def _dofs(model: mujoco.MjModel, joint: int) -> int:
    kind = int(model.jnt_type[joint])
    return {int(mujoco.mjtJoint.mjJNT_FREE): 6, int(mujoco.mjtJoint.mjJNT_BALL): 3}.get(kind, 1)
