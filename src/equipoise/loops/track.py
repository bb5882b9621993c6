"""A motion closed along its own way: knots in order of time, every other instant from the knot before it."""

from __future__ import annotations

import weakref
from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.errors import LoopError
from equipoise.loops.branch import Branch
from equipoise.loops.choices import choice_hint
from equipoise.loops.close import (
    SHUT,
    branch_of,
    checked,
    close_loops,
    evaluator_of,
    refined,
    selection_of,
    sound,
    transmission_of,
)
from equipoise.loops.constraints import Couple
from equipoise.loops.messages import blocked_way
from equipoise.loops.posture import Evaluator, qpos_width
from equipoise.loops.roadmap import Blocked
from equipoise.loops.walk import CLOSED, TURN, Closed, turn, walk

if TYPE_CHECKING:
    from equipoise.mechanism import Mechanism
    from equipoise.motion.motion import Motion

STRIDE = 0.15  # rad or characteristic lengths of driven motion between two knots
FINE = 4001  # instants that the way is measured on
RELAY = 8  # of so many instants the first is closed before the others
MANY = 400  # instants from which on relays pay
NEAR = 8  # relays that one polynomial goes through
_CHUNK = 16384
_known: weakref.WeakKeyDictionary[Motion, tuple[weakref.ref[Mechanism], Knots]] = weakref.WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class Knots:
    """Closed postures at times (K,) in order, with the driven positions and velocities (K, nd) there."""

    time: Array
    driven: Array
    speed: Array
    closed: Closed


def close_motion(mechanism: Mechanism, motion: Motion, time: Array, driven: Array) -> tuple[Array, Array]:
    """Postures (N, nq) with closed loops at instants (N,) of a motion, and D (N or 1, nv, nd) = dq/dq_driven.

    driven (N, nd) are the driven positions at these instants.
    The first posture is reached from the reference, which names the branch; from there the motion is followed in
    order of time, and no walk crosses a singularity. Raises LoopError with the time and the driven positions at
    which the loops do not close or become singular.
    """
    driven = checked(mechanism, driven)
    try:
        branch = branch_of(mechanism)
    except LoopError as error:
        raise _no_start(mechanism, motion, error) from None
    if branch is None:
        return close_loops(mechanism, driven)
    model, joints = mechanism.model, mechanism.driven_ids
    evaluate = evaluator_of(mechanism)
    knots = _knots(mechanism, branch, evaluate, motion)
    q = np.tile(branch.home.q[0], (len(time), 1))
    q[:, model.jnt_qposadr[joints]] = driven
    transmission = np.zeros((len(time), model.nv, len(joints)))
    transmission[:, model.jnt_dofadr[joints], np.arange(len(joints))] = 1.0
    for first in range(0, len(time), _CHUNK):
        part = slice(first, first + _CHUNK)
        instants, back = np.unique(time[part], return_inverse=True)
        wanted = driven[part][np.unique(back, return_index=True)[1]]
        closed = _closed(mechanism, branch, evaluate, knots, (wanted, instants))
        q[part] = closed.q[back]
        transmission[part] += transmission_of(branch, closed, (1, *transmission.shape[1:]))[back]
    return q, transmission


def close_beside(mechanism: Mechanism, motion: Motion, driven: Array) -> tuple[Array, Array]:
    """As `close_loops`, for poses (N, nd) beside a motion: each is walked to from the nearest knot of its way.

    A motion may pass where no straight walk from the reference leads. Raises LoopError for a pose that cannot be
    reached so.
    """
    from scipy.spatial import KDTree

    driven = checked(mechanism, driven)
    branch = branch_of(mechanism)
    if branch is None or not len(driven):
        return close_loops(mechanism, driven)
    model, joints = mechanism.model, mechanism.driven_ids
    evaluate, loop = evaluator_of(mechanism), branch.loop
    knots = _knots(mechanism, branch, evaluate, motion)
    scale = loop.columns[loop.driven]
    tree = KDTree(knots.driven[:, branch.places] / scale)
    q, transmission = (
        np.tile(branch.home.q[0], (len(driven), 1)),
        np.repeat(selection_of(mechanism), len(driven), axis=0),
    )
    q[:, model.jnt_qposadr[joints]] = driven
    for first in range(0, len(driven), _CHUNK):
        part = slice(first, first + _CHUNK)
        parent = np.asarray(tree.query(driven[part][:, branch.places] / scale)[1])
        at = (knots.closed.rows(parent), knots.driven[parent], None)
        postures = _reached(mechanism, branch, evaluate, at, (driven[part], None)).q
        postures[:, model.jnt_qposadr[joints]] = driven[part]
        closed = refined(mechanism, branch, evaluate, postures, driven[part])
        q[part] = closed.q
        transmission[part] += transmission_of(branch, closed, (1, *transmission.shape[1:]))
    return q, transmission


def _closed(
    mechanism: Mechanism, branch: Branch, evaluate: Evaluator, knots: Knots, goal: tuple[Array, Array]
) -> Closed:
    """Postures closed to rounding at driven positions (M, nd) of instants (M,).

    Guessed between the knots and closed at once; of many instants the relays first, the others from polynomials
    through these, so good that one linearisation is enough. A posture that does not obey what a step of a walk must
    obey is walked to from the knot before it.
    """
    wanted, instants = goal
    loop, places = branch.loop, mechanism.model.jnt_qposadr[mechanism.driven_ids]
    parent = np.clip(np.searchsorted(knots.time, instants, side="right") - 1, 0, len(knots.time) - 1)
    if len(instants) >= MANY:
        some = np.unique(np.r_[0 : len(instants) : RELAY, len(instants) - 1])
        relays = _closed(mechanism, branch, evaluate, knots, (wanted[some], instants[some]))
        guess = _relayed(branch, instants[some], relays.q, instants)
    else:
        guess = _guessed(branch, knots, parent, instants)
    if guess is None:
        late, closed = np.arange(len(instants)), knots.closed.rows(parent)
    else:
        guess[:, places] = wanted
        closed = loop.newton(evaluate, guess, goal=SHUT, turns=4)
        start = knots.closed.rows(parent)
        late = np.flatnonzero(~((closed.worst <= CLOSED) & (closed.sigma > loop.margin) & (turn(start, closed) < TURN)))
    if late.size:
        start = knots.closed.rows(parent[late])
        at = (start, knots.driven[parent[late]], knots.time[parent[late]])
        postures = _reached(mechanism, branch, evaluate, at, (wanted[late], instants[late])).q
        postures[:, places] = wanted[late]
        closed.put(late, refined(mechanism, branch, evaluate, postures, wanted[late]))
    return sound(mechanism, branch, closed, wanted)


def _guessed(branch: Branch, knots: Knots, parent: NDArray[np.int_], time: Array) -> Array | None:
    """Postures (M, nq) by cubics through the knots' positions and velocities; None where joints have quaternions."""
    loop, model = branch.loop, branch.loop.model
    joints = model.dof_jntid[loop.dependent]
    plain = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)
    if len(knots.time) < 2 or not np.isin(model.jnt_type[joints], [int(kind) for kind in plain]).all():
        return None
    places = model.jnt_qposadr[joints]
    steer = knots.speed[:, branch.places] / loop.columns[loop.driven]
    speed = (knots.closed.rate @ steer[..., None])[..., 0] * loop.columns[loop.dependent]
    first = np.minimum(parent, len(knots.time) - 2)
    span = np.diff(knots.time)[first]
    s = ((time - knots.time[first]) / span)[:, None]
    a, b = (knots.closed.q[index][:, places] for index in (first, first + 1))
    va, vb = (speed[index] * span[:, None] for index in (first, first + 1))
    guess = knots.closed.q[first]
    guess[:, places] = (
        (1 + 2 * s) * (1 - s) ** 2 * a + s * (1 - s) ** 2 * va + s**2 * (3 - 2 * s) * b - s**2 * (1 - s) * vb
    )
    return guess


def _relayed(branch: Branch, since: Array, closed: Array, time: Array) -> Array:
    """Postures (M, nq) by polynomials in time through the NEAR closest of closed ones (K, nq), in barycentric form."""
    model = branch.loop.model
    first = np.clip(np.searchsorted(since, time) - NEAR // 2, 0, len(since) - NEAR)
    sets = np.arange(len(since) - NEAR + 1)[:, None] + np.arange(NEAR)
    nodes = since[sets]
    gaps = (nodes[:, :, None] - nodes[:, None]) / np.ptp(nodes, axis=1)[:, None, None] + np.eye(NEAR)
    away = time[:, None] - nodes[first]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = 1.0 / gaps.prod(axis=2)[first] / away
        share /= share.sum(axis=1, keepdims=True)
    share = np.where((away == 0.0).any(axis=1, keepdims=True), away == 0.0, share)
    guess = np.einsum("mk,mkq->mq", share, closed[sets][first])
    for joint in np.unique(model.dof_jntid[branch.loop.dependent]):
        width, place = qpos_width(model, joint), model.jnt_qposadr[joint]
        if width > 1:
            quaternion = guess[:, place + width - 4 : place + width]
            quaternion /= np.linalg.norm(quaternion, axis=1, keepdims=True)
    return guess


def _knots(mechanism: Mechanism, branch: Branch, evaluate: Evaluator, motion: Motion) -> Knots:
    known = _known.get(motion)
    if known is not None and known[0]() is mechanism:
        return known[1]
    loop = branch.loop
    fine = np.linspace(motion.start, motion.end, FINE)
    way = checked(mechanism, motion.at(fine)[0])
    scaled = way[:, branch.places] / loop.columns[loop.driven]
    length = np.r_[0.0, np.cumsum(np.abs(np.diff(scaled, axis=0)).max(axis=1, initial=0.0))]
    marks = np.unique(np.searchsorted(length, np.arange(0.0, length[-1] + STRIDE, STRIDE)).clip(0, FINE - 1))
    time, driven = fine[marks], way[marks]
    try:
        start, _ = close_loops(mechanism, driven[:1], start=_wound(mechanism, branch, driven[0]))
    except LoopError as error:
        raise _no_start(mechanism, motion, error) from None
    closed = loop.linearise(evaluate, start)
    found = closed
    for k in range(1, len(marks)):
        here = (closed, driven[k - 1 : k], time[k - 1 : k])
        closed = _reached(mechanism, branch, evaluate, here, (driven[k : k + 1], time[k : k + 1]))
        found = found.join(closed)
    knots = Knots(time, driven, motion.at(time)[1], found)
    _known[motion] = (weakref.ref(mechanism), knots)
    return knots


def _wound(mechanism: Mechanism, branch: Branch, driven: Array) -> Array:
    """The closed reference (nq,) with hinges turned by whole turns towards driven (nd,): the same posture.

    Hinges with limits, and those that a coupling counts the turns of, stay.
    """
    model, joints = mechanism.model, mechanism.driven_ids
    home = branch.home.q[0].copy()
    counted = set().union(*(item.dofs for item in branch.loop.equalities if isinstance(item, Couple)))
    for joint, value in zip(joints, driven, strict=True):
        free = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE and not model.jnt_limited[joint]
        if free and int(model.jnt_dofadr[joint]) not in counted:
            place = model.jnt_qposadr[joint]
            home[place] += 2 * np.pi * np.round((value - home[place]) / (2 * np.pi))
    return home


def _reached(
    mechanism: Mechanism,
    branch: Branch,
    evaluate: Evaluator,
    start: tuple[Closed, Array, Array | None],
    goal: tuple[Array, Array | None],
) -> Closed:
    """Walk from closed postures with their driven positions and times (if any) to driven positions at later times."""
    loop, scale = branch.loop, branch.loop.columns[branch.loop.driven]
    closed, begin, since = start
    wanted, until = goal
    span = (wanted - begin)[:, branch.places] / scale
    done = walk(loop, evaluate, closed, span)
    if not done.arrived.all():
        row = int(np.flatnonzero(~done.arrived)[0])
        stop = begin[row, branch.places] / scale + done.wall[row] * span[row]
        ahead = (1.0 - done.share[row]) * span[row]
        last = done.closed.rows(np.array([row]))
        blocked = Blocked(0, last, ahead, stop, float(done.lowest[row]), 0)
        error = blocked_way(mechanism, branch, evaluate, blocked, wanted[row])
        if since is None or until is None:
            raise error
        raise _at(error, since[row] + done.wall[row] * (until[row] - since[row]), "the motion stops")
    return done.closed


def _no_start(mechanism: Mechanism, motion: Motion, error: LoopError) -> LoopError:
    """The error of a motion whose first posture is singular or not on the reference's branch, with the choices."""
    choices = choice_hint(mechanism, motion)
    found = _at(error, motion.start, "the motion cannot start")
    if choices:
        found.hint = f"name the assembly it starts in: {choices}; or begin elsewhere, or change its drivers"
    return found


def _at(error: LoopError, time: float, what: str) -> LoopError:
    """The same error with the time at which a motion meets it."""
    return LoopError(
        f"{what} at t = {time:.6g} s: {error.message}",
        where=error.where,
        hint=f"{error.hint}; or begin the motion elsewhere, or change its drivers",
    )
