"""The branch a mechanism's loops are on: which joints they tie together, and the reference posture closed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.errors import InputError, LoopError
from equipoise.loops.constraints import Couple, Equality, equalities
from equipoise.loops.posture import Evaluator
from equipoise.loops.walk import CLOSED, Closed, Loop

if TYPE_CHECKING:
    from equipoise.mechanism import Mechanism

_NUDGE = 0.05  # rad or characteristic lengths: far enough from a singular reference to see the generic rank
_RANK = 1e-4  # postures closed to rounding next to a singular one show false ranks of 1e-6


@dataclass(frozen=True, eq=False)
class Branch:
    """A mechanism's loops with the branch: home is the closed reference posture (one row).

    places (k,) says which driven joint steers each of loop.driven; curved (k,) which of them must be walked
    (a linear coupling of joints is solved from anywhere at once).
    """

    loop: Loop
    home: Closed
    places: NDArray[np.int_]
    curved: NDArray[np.bool_]


def reference_branch(mechanism: Mechanism) -> Branch | None:
    """Partition the joints, check that the driven ones determine the loops, close the reference posture.

    Returns None without active equalities. Raises InputError for driven joints that contradict each other or
    are too few, LoopError for a reference that does not close or is singular.
    """
    parted = part_joints(mechanism)
    if parted is None:
        return None
    loop, places = parted
    driven = mechanism.model.jnt_dofadr[mechanism.driven_ids]
    curved = np.isin(loop.driven, _curved_dofs(loop.equalities, driven))
    return Branch(loop, _close_reference(mechanism, loop, Evaluator(mechanism.model)), places, curved)


def part_joints(mechanism: Mechanism) -> tuple[Loop, NDArray[np.int_]] | None:
    """The loops with their dependent and driven dofs, and which driven joint steers each of the latter.

    Needs no regular reference. Returns None without active equalities; raises as `reference_branch` does.
    """
    model = mechanism.model
    found = equalities(model)
    if not found:
        return None
    evaluate = Evaluator(model)
    driven = model.jnt_dofadr[mechanism.driven_ids]
    reach = _reach(model, found, evaluate, mechanism.reference)
    rows = np.concatenate([item.factor / np.where(item.lengths, reach, 1.0) for item in found])
    columns = np.where(_translates(model), reach, 1.0)
    none = np.zeros(0, dtype=int)
    ties = np.isin(np.arange(model.nv), list(set().union(*(item.dofs for item in found))))
    bare = Loop(model, found, rows, columns, none, none, reach, 0.0)
    samples, gap = _samples(bare, evaluate, mechanism.reference, ties)
    if gap >= CLOSED:
        raise _open_reference(mechanism, gap * reach)
    # a possible column that vanishes at every closed posture belongs to a dof that no loop sees
    active = ties & (np.abs(samples).max(axis=(0, 1)) > 1e-8)
    if not active.any():
        return None
    places = np.flatnonzero(active[driven])
    tied = np.flatnonzero(active)
    dependent = np.setdiff1d(tied, driven)
    _check_mobility(mechanism, samples[:, :, active], tied, driven[places])
    return Loop(model, found, rows, columns, dependent, driven[places], reach, mechanism.singularity), places


def dof_names(model: mujoco.MjModel, dofs: NDArray[np.int_]) -> str:
    """Names of the joints of some dofs, each once."""
    return ", ".join(dict.fromkeys(model.joint(int(joint)).name for joint in model.dof_jntid[dofs]))


def _translates(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """Which dofs (nv,) move in metres."""
    translates = np.zeros(model.nv, dtype=bool)
    for joint in range(model.njnt):
        dof = model.jnt_dofadr[joint]
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE:
            translates[dof] = True
        elif model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE:
            translates[dof : dof + 3] = True
    return translates


def _reach(model: mujoco.MjModel, found: list[Equality], evaluate: Evaluator, reference: Array) -> float:
    """The largest distance between joints and joined points of the loops at the reference, m (1 without any)."""
    data = mujoco.MjData(model)
    data.qpos[:] = reference
    mujoco.mj_kinematics(model, data)
    dofs = np.array(sorted(set().union(*(item.dofs for item in found))), dtype=int)
    pose = evaluate(reference[None])
    points = [data.xanchor[np.unique(model.dof_jntid[dofs])]] + [p for item in found for p in item.points(pose)]
    cloud = np.concatenate(points)
    spread = np.linalg.norm(cloud[:, None] - cloud[None], axis=2).max(initial=0.0)
    return float(spread) if spread > 1e-9 else 1.0


def _samples(loop: Loop, evaluate: Evaluator, reference: Array, ties: NDArray[np.bool_]) -> tuple[Array, float]:
    """Jacobians (S, m, nv) at closed postures near the reference, and the least residual found.

    Around a singular reference they still show the generic rank.
    """
    nudges = np.random.default_rng(0).uniform(-_NUDGE, _NUDGE, (8, loop.model.nv)) * ties
    nudges[0] = 0.0
    every = np.arange(loop.model.nv)
    q = loop.move(np.tile(reference, (8, 1)), nudges, every)
    for _ in range(50):
        error, jacobian = loop.scaled(evaluate, q)
        if np.abs(error).max() < 1e-14:
            break
        q = loop.move(q, _damped(error, jacobian * ties), every)
    error, jacobian = loop.scaled(evaluate, q)
    worst = np.abs(error).max(axis=1)
    return jacobian[worst < CLOSED], float(worst.min())


def _damped(error: Array, jacobian: Array) -> Array:
    """A Levenberg-Marquardt step; damping by the squared residual bears rows that are redundant once closed."""
    left, values, right = np.linalg.svd(jacobian, full_matrices=False)
    damping = (error**2).sum(axis=1, keepdims=True)
    gain = values / np.maximum(values**2 + damping, 1e-18)
    step = -np.einsum("nij,ni->nj", right, gain * np.einsum("nki,nk->ni", left, error))
    longest = np.abs(step).max(axis=1, keepdims=True, initial=1e-300)
    return step * np.minimum(1.0, 0.5 / longest)


def _rank(matrices: Array) -> int:
    if 0 in matrices.shape[1:]:
        return 0
    values = np.linalg.svd(matrices, compute_uv=False)
    return int((values > _RANK * values[:, :1]).sum(axis=1).max())


def _check_mobility(mechanism: Mechanism, samples: Array, tied: NDArray[np.int_], driven: NDArray[np.int_]) -> None:
    """nv - rank J of the loops must be the number of driven joints in them, and these must determine the rest."""
    model = mechanism.model
    steers = np.isin(tied, driven)
    freedom = len(tied) - _rank(samples)
    loose = len(tied) - len(driven) - _rank(samples[:, :, ~steers])
    bound = len(driven) - freedom + loose
    if not loose and not bound:
        return
    given = dof_names(model, driven) or "none"
    count = f"the loops leave {freedom} free motion{'s' * (freedom != 1)}; driven joints in them: {given}"
    if loose and not bound:
        others = dof_names(model, _moving(samples[:, :, ~steers], tied[~steers]))
        raise InputError(
            f"the driven joints do not determine the loops: {count}",
            where=mechanism.name,
            hint=f"drive {loose} more of {others}, or fix what may spin freely",
        )
    null = _null_space(samples[int(np.argmax([_rank(s[None]) for s in samples]))])
    clash = _moving(null[steers].T[None], driven)
    if not loose:
        raise InputError(
            f"the driven joints contradict each other: {count}",
            where=mechanism.name,
            hint=f"drive {bound} fewer of {dof_names(model, clash)}",
        )
    others = dof_names(model, _moving(samples[:, :, ~steers], tied[~steers]))
    raise InputError(
        f"the driven joints are the wrong ones: {count}",
        where=mechanism.name,
        hint=f"drive {loose} of {others} instead of {bound} of {dof_names(model, clash)}",
    )


def _null_space(matrix: Array) -> Array:
    if not matrix.size:
        return np.eye(matrix.shape[1])
    _, values, right = np.linalg.svd(matrix)
    return right[int((values > _RANK * values[0]).sum()) :].T


def _moving(matrices: Array, dofs: NDArray[np.int_]) -> NDArray[np.int_]:
    """The dofs whose column some null vector of the least singular sample moves; all where there is none."""
    ranks = [_rank(matrix[None]) for matrix in matrices]
    null = _null_space(matrices[int(np.argmax(ranks))])
    moving = dofs[np.abs(null).max(axis=1, initial=0.0) > 1e-4]
    return moving if moving.size else dofs


def _curved_dofs(found: list[Equality], driven: NDArray[np.int_]) -> list[int]:
    """Dofs in groups of loops that one Newton step from anywhere does not solve."""
    groups: list[tuple[set[int], bool]] = []
    for item in found:
        dofs = set(item.dofs)
        curved = not (isinstance(item, Couple) and (item.linear or (not item.tendon and item.head not in driven)))
        apart = []
        for group, bent in groups:
            if group & dofs:
                dofs, curved = dofs | group, curved or bent
            else:
                apart.append((group, bent))
        groups = [*apart, (dofs, curved)]
    return [dof for dofs, curved in groups if curved for dof in dofs]


def _close_reference(mechanism: Mechanism, loop: Loop, evaluate: Evaluator) -> Closed:
    """The reference with its loops closed, driven joints held."""
    home = loop.newton(evaluate, mechanism.reference[None], goal=1e-13, turns=100)
    if home.worst[0] > CLOSED:
        raise _open_reference(mechanism, home.worst[0] * loop.reach)
    if home.sigma[0] <= mechanism.singularity:
        raise LoopError(
            f"the reference posture is singular: the smallest singular value of the loop Jacobian is "
            f"{home.sigma[0]:.3g}, the margin is {mechanism.singularity:g}",
            where=mechanism.name,
            hint="name a keyframe away from the singularity as `branch`, or drive another joint",
        )
    return home


def _open_reference(mechanism: Mechanism, gap: float) -> LoopError:
    return LoopError(
        f"the loops do not close at the reference posture: the gap is {gap * 1e3:.4g} mm",
        where=mechanism.name,
        hint="name a keyframe near a closed posture as `branch`, or correct the lengths",
    )
