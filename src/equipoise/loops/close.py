"""Closed loops: the dependent joints and the transmission of all poses at once, on the branch of the reference."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.errors import InputError, LoopError
from equipoise.loops.branch import Branch, reference_branch
from equipoise.loops.messages import advice, blocked_way, gap, pose_text
from equipoise.loops.posture import Evaluator, qpos_width
from equipoise.loops.roadmap import Blocked, follow
from equipoise.loops.walk import Closed, least_singular, walk

if TYPE_CHECKING:
    from equipoise.mechanism import Mechanism

_CHUNK = 16384
SHUT = 1e-15  # dimensionless residual that Newton's steps aim at
_ROUNDING = 1e-11  # dimensionless residual beyond which a posture does not count as closed
_evaluators: weakref.WeakKeyDictionary[Mechanism, Evaluator] = weakref.WeakKeyDictionary()
_known: weakref.WeakKeyDictionary[Mechanism, Branch | None] = weakref.WeakKeyDictionary()


def close_loops(mechanism: Mechanism, driven: Array, *, start: Array | None = None) -> tuple[Array, Array]:
    """Postures whose loops are closed, and how every joint follows the driven ones.

        phi(q) = 0,   D = dq/dq_driven = -J_dependent^+ J_driven   in the rows of dependent joints

    mechanism   phi are its model's active connect, weld, joint and tendon equalities
    driven      (N, nd) positions of mechanism.driven, rad or m
    start       (nq,) a closed posture to walk from instead of mechanism.reference; it names the branch
    returns q   (N, nq), residual at rounding level, and
            D   (N, nv, nd) in velocity coordinates; (1, nv, nd) without loops

    Undriven joints that no loop determines keep mechanism.reference. Every pose is reached from the
    reference in small steps that meet no singular posture, straight where possible, else by way of other
    poses of the same call: this is what "the branch of the reference" means.

    The singular value judged against mechanism.singularity is the n-th of the loop Jacobian with respect to
    the n dependent dofs. It is dimensionless: lengths are divided by the largest distance between the joints
    and joined points of the loops in the reference posture, angles are in rad.

    Raises LoopError for a pose that does not close or lies beyond or within the margin of a singularity,
    InputError for positions that are not finite or driven joints that contradict each other or are too few.
    """
    driven = checked(mechanism, driven)
    model, joints = mechanism.model, mechanism.driven_ids
    branch = branch_of(mechanism)
    home = mechanism.reference if branch is None else branch.home.q[0]
    q = np.tile(home, (len(driven), 1))
    q[:, model.jnt_qposadr[joints]] = driven
    if branch is None or not len(driven):
        return q, selection_of(mechanism)
    evaluate = evaluator_of(mechanism)
    origin = branch.home if start is None else _origin(mechanism, branch, evaluate, start)
    postures = _followed(mechanism, branch, evaluate, origin, driven)
    postures[:, model.jnt_qposadr[joints]] = driven
    return _settled(mechanism, branch, evaluate, postures)


def tighten_loops(mechanism: Mechanism, near: Array, turns: int | None = None) -> tuple[Array, Array]:
    """As `close_loops`, for postures near (N, nq) that are closed but for rounding or small steps.

    The driven joints stay where near has them; Newton's steps (`turns`: two suffice for rounding) move the others, and
    near names the branch of each pose by itself. Raises LoopError for a pose that does not close, or closes within
    the margin of a singularity.
    """
    branch = branch_of(mechanism)
    if branch is None:
        return near, selection_of(mechanism)
    return _settled(mechanism, branch, evaluator_of(mechanism), near, turns)


def selection_of(mechanism: Mechanism) -> Array:
    """dq/dq_driven (1, nv, nd) without loops."""
    joints = mechanism.driven_ids
    selection = np.zeros((1, mechanism.model.nv, len(joints)))
    selection[0, mechanism.model.jnt_dofadr[joints], np.arange(len(joints))] = 1.0
    return selection


def _settled(
    mechanism: Mechanism, branch: Branch, evaluate: Evaluator, near: Array, turns: int | None = None
) -> tuple[Array, Array]:
    """Postures refined to rounding, and their transmission."""
    driven = near[:, mechanism.model.jnt_qposadr[mechanism.driven_ids]]
    selection = selection_of(mechanism)
    q, transmission = near.copy(), np.repeat(selection, len(near), axis=0)
    for first in range(0, len(near), _CHUNK):
        part = slice(first, first + _CHUNK)
        closed = refined(mechanism, branch, evaluate, near[part], driven[part], turns)
        q[part] = closed.q
        transmission[part] += transmission_of(branch, closed, selection.shape)
    return q, transmission


def reachable(mechanism: Mechanism, driven: Array) -> NDArray[np.bool_]:
    """Which poses (N, nd) the loops reach straight from the reference, without meeting a singular posture."""
    driven = checked(mechanism, driven)
    branch = branch_of(mechanism)
    if branch is None:
        return np.ones(len(driven), dtype=bool)
    loop, model = branch.loop, mechanism.model
    here = branch.home.q[0, model.jnt_qposadr[model.dof_jntid[loop.driven]]]
    span = (driven[:, branch.places] - here) / loop.columns[loop.driven]
    start = branch.home.rows(np.zeros(len(driven), dtype=int))
    return walk(loop, evaluator_of(mechanism), start, span).arrived


def loop_report(mechanism: Mechanism, q: Array) -> tuple[Array, Array]:
    """How well postures q (N, nq) close: the gap (N,) in m and the singular value (N,) of `close_loops`.

    The gap is the largest over the loops, angles counted at the characteristic length; without loops it is
    zero and the singular value infinite.
    """
    branch = branch_of(mechanism)
    q = np.atleast_2d(np.asarray(q, dtype=float))
    if branch is None:
        return np.zeros(len(q)), np.full(len(q), np.inf)
    closed = branch.loop.linearise(evaluator_of(mechanism), q)
    return gap(branch.loop, closed), least_singular(closed.slope)


def branch_of(mechanism: Mechanism) -> Branch | None:
    """The loops of a mechanism on the branch of its reference; None without loops."""
    if mechanism not in _known:
        _known[mechanism] = reference_branch(mechanism)
    return _known[mechanism]


def evaluator_of(mechanism: Mechanism) -> Evaluator:
    """The mechanism's kinematics for loops, kept since its batch costs a millisecond to build."""
    if mechanism not in _evaluators:
        _evaluators[mechanism] = Evaluator(mechanism.model)
    return _evaluators[mechanism]


def checked(mechanism: Mechanism, driven: Array) -> Array:
    """Driven positions (N, nd) as floats; raises InputError where they are not finite or not as many."""
    driven = np.asarray(driven, dtype=float)
    if driven.ndim != 2 or driven.shape[1] != len(mechanism.driven):
        raise InputError(
            f"positions of {len(mechanism.driven)} driven joints are needed, got an array of shape {driven.shape}",
            where=mechanism.name,
            hint=f"columns are {', '.join(mechanism.driven) or 'none'}",
        )
    for name, joint in zip(mechanism.driven, mechanism.driven_ids, strict=True):
        if qpos_width(mechanism.model, joint) > 1:
            raise InputError(f"joint {name} cannot be driven: only hinges and slides can", where=mechanism.name)
    bad = np.argwhere(~np.isfinite(driven))
    if len(bad):
        row, column = bad[0]
        raise InputError(
            f"position of {mechanism.driven[column]} in pose {row + 1} is {driven[row, column]}",
            where=mechanism.name,
            hint="give finite positions in rad or m",
        )
    return driven


def _origin(mechanism: Mechanism, branch: Branch, evaluate: Evaluator, start: Array) -> Closed:
    # joints outside the loops stay at the reference during the walk, as they do for every pose
    origin = branch.home.q.copy()
    loop, model = branch.loop, mechanism.model
    tied = np.concatenate([loop.dependent, loop.driven])
    for joint in np.unique(model.dof_jntid[tied]):
        place = slice(model.jnt_qposadr[joint], model.jnt_qposadr[joint] + qpos_width(model, joint))
        origin[0, place] = start[place]
    closed = loop.newton(evaluate, origin, goal=1e-13, turns=20)
    if closed.worst[0] > _ROUNDING or closed.sigma[0] <= mechanism.singularity:
        raise LoopError(
            f"the start posture has a gap of {closed.worst[0] * loop.reach * 1e3:.4g} mm and singular value "
            f"{closed.sigma[0]:.3g}",
            where=mechanism.name,
            hint="start from a posture that close_loops returned",
        )
    return closed


def _followed(mechanism: Mechanism, branch: Branch, evaluate: Evaluator, origin: Closed, driven: Array) -> Array:
    """Postures (N, nq) on the branch; only joints that the loops bend are walked, each combination once."""
    loop, model = branch.loop, mechanism.model
    bent = np.flatnonzero(branch.curved)
    if not bent.size:
        return np.tile(origin.q, (len(driven), 1))
    scale = loop.columns[loop.driven]
    here = origin.q[0, model.jnt_qposadr[model.dof_jntid[loop.driven]]] / scale
    wanted = driven[:, branch.places] / scale
    wanted[:, ~branch.curved] = here[~branch.curved]
    targets, back = np.unique(wanted, axis=0, return_inverse=True)
    result = follow(loop, evaluate, origin, here, targets)
    if isinstance(result, Blocked):
        pose = driven[int(np.argmax(back.ravel() == result.index))]
        raise blocked_way(mechanism, branch, evaluate, result, pose)
    return result[back.ravel()]


def refined(
    mechanism: Mechanism,
    branch: Branch,
    evaluate: Evaluator,
    postures: Array,
    driven: Array,
    turns: int | None = None,
) -> Closed:
    """Postures closed to rounding; raises LoopError for one that stays open, or closes too near a singularity."""
    # joints coupled by a law start anywhere: a chain of couplings takes one full step for each
    turns = turns or (2 if branch.curved.all() else 8)
    closed = branch.loop.newton(evaluate, postures, goal=SHUT, turns=turns, stride=np.inf)
    return sound(mechanism, branch, closed, driven)


def sound(mechanism: Mechanism, branch: Branch, closed: Closed, driven: Array) -> Closed:
    """The postures; raises LoopError for one that is open, or within the margin of a singularity."""
    worst = int(np.argmax(closed.worst))
    if closed.worst[worst] > _ROUNDING:
        raise LoopError(
            f"the loops do not close at {pose_text(mechanism, driven[worst])}: the gap is "
            f"{gap(branch.loop, closed)[worst] * 1e3:.4g} mm",
            where=mechanism.name,
        )
    least = int(np.argmin(closed.sigma))
    if closed.sigma[least] <= mechanism.singularity:
        raise LoopError(
            f"the pose {pose_text(mechanism, driven[least])} is within the margin of a singularity: "
            f"gap {gap(branch.loop, closed)[least] * 1e3:.2g} mm, singular value {closed.sigma[least]:.3g} "
            f"(margin {mechanism.singularity:g})",
            where=mechanism.name,
            hint=advice(mechanism, branch),
        )
    return closed


def transmission_of(branch: Branch, closed: Closed, shape: tuple[int, ...]) -> Array:
    """dq/dq_driven (N, nv, nd) in the rows of dependent joints."""
    loop = branch.loop
    follow_up = closed.rate * loop.columns[loop.dependent][:, None] / loop.columns[loop.driven]
    part = np.zeros((len(closed.q), *shape[1:]))
    part[:, loop.dependent[:, None], branch.places] = follow_up
    return part
