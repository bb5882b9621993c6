"""Walking on the branch: closed postures are followed from pose to pose and never jump over a singularity."""

from __future__ import annotations

from dataclasses import dataclass, fields

import mujoco
import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.loops.constraints import Equality, residual
from equipoise.loops.posture import Evaluator, integrate

Flags = NDArray[np.bool_]
STEP = 0.2  # largest motion of any joint in one step, rad or characteristic lengths
SMALLEST = 1e-6  # a step that must be shorter than this runs into a wall
CLOSED = 1e-9  # residual that a step leaves; the final posture is refined to rounding
SHORT = 1e-13  # a step that leaves Jacobians as they are, within their rounding
CLEAR = 10.0  # margins above which a bound of the singular value is enough
TURN = 0.9  # below 1 the chord between two Jacobians meets no singular one


@dataclass(frozen=True, eq=False)
class Closed:
    """Postures with their linearised loops: all dimensionless, N rows.

    q (N, nq), error (N, m) residual, slope (N, m, n) Jacobian of the dependent dofs and steer (N, m, k) of
    the driven ones, inverse (N, n, m) pseudo-inverse of slope, sigma (N,) its n-th singular value, or
    a lower bound where that is well above the margin.
    """

    q: Array
    error: Array
    slope: Array
    steer: Array
    inverse: Array
    sigma: Array

    def rows(self, index: NDArray[np.int_]) -> Closed:
        """A selection of postures."""
        return Closed(*(getattr(self, field.name)[index] for field in fields(self)))

    def put(self, index: NDArray[np.int_], other: Closed) -> None:
        """Write other's rows at index."""
        for field in fields(self):
            getattr(self, field.name)[index] = getattr(other, field.name)

    def join(self, other: Closed) -> Closed:
        """Both, one after the other."""
        return Closed(*(np.concatenate([getattr(x, f.name) for x in (self, other)]) for f in fields(self)))

    @property
    def worst(self) -> Array:
        """Largest residual (N,)."""
        return np.abs(self.error).max(axis=1, initial=0.0)

    @property
    def rate(self) -> Array:
        """Dependent steps per driven step (N, n, k) = -slope^+ steer, refined once against rounding."""
        first = -self.inverse @ self.steer
        return first - self.inverse @ (self.slope @ first + self.steer)


@dataclass(frozen=True, eq=False)
class Loop:
    """The loop equations of a model in dimensionless form.

    rows (m,) and columns (nv,) turn the Jacobian J into rows J columns; dependent (n,) and driven (k,) are
    the dofs that the loops tie together; reach is the characteristic length, m,
    margin the least admissible singular value.
    """

    model: mujoco.MjModel
    equalities: list[Equality]
    rows: Array
    columns: Array
    dependent: NDArray[np.int_]
    driven: NDArray[np.int_]
    reach: float
    margin: float

    def scaled(self, evaluate: Evaluator, q: Array) -> tuple[Array, Array]:
        """Residual (N, m) and Jacobian (N, m, nv), dimensionless."""
        error, jacobian = residual(self.equalities, evaluate(q))
        return error * self.rows, jacobian * (self.rows[:, None] * self.columns)

    def linearise(self, evaluate: Evaluator, q: Array) -> Closed:
        """The loops at postures q, which need not be closed."""
        error, jacobian = self.scaled(evaluate, q)
        slope, steer = jacobian[:, :, self.dependent], jacobian[:, :, self.driven]
        inverse, sigma = inverted(slope, CLEAR * self.margin)
        return Closed(q, error, slope, steer, inverse, sigma)

    def move(self, q: Array, step: Array, dofs: NDArray[np.int_]) -> Array:
        """Postures after a dimensionless step (N, len(dofs)) of some dofs."""
        motion = np.zeros((len(q), self.model.nv))
        motion[:, dofs] = step * self.columns[dofs]
        return integrate(self.model, q, motion)

    def newton(self, evaluate: Evaluator, q: Array, *, goal: float, turns: int, stride: float = 0.5) -> Closed:
        """Newton's steps of the dependent dofs until every residual is below goal, or turns are used up.

        No step is longer than stride. After one that is shorter than SHORT the residual is what the Jacobian foretells.
        """
        closed = self.linearise(evaluate, q)
        for _ in range(turns):
            late = np.flatnonzero(closed.worst > goal)
            if not late.size:
                break
            now = closed.rows(late)
            step = -(now.inverse @ now.error[:, :, None])[..., 0]
            longest = np.abs(step).max(axis=1, keepdims=True)
            step *= np.minimum(1.0, stride / np.maximum(longest, 1e-300))
            moved = self.move(now.q, step, self.dependent)
            short = longest[:, 0] < SHORT
            closed.q[late], closed.error[late] = moved, now.error + (now.slope @ step[:, :, None])[..., 0]
            if short.all():
                break
            closed.put(late[~short], self.linearise(evaluate, moved[~short]))
        return closed


def inverted(slope: Array, clear: float) -> tuple[Array, Array]:
    """Pseudo-inverses (N, n, m) of matrices (N, m, n), and the n-th singular value (N,) or a lower bound of it.

    The normal equations give G = slope' slope, slope^+ = G^-1 slope', |G^-1|_F^(-1/2) <= sigma. Only where that bound
    falls below `clear`, or the normal equations lose half the digits, does the singular value decomposition tell the
    value itself.
    """
    count = slope.shape[2]
    if not count or slope.shape[1] < count:
        return _decomposed(slope)
    normal = np.swapaxes(slope, 1, 2)
    gram = normal @ slope
    size = np.trace(gram, axis1=1, axis2=2)
    gram[:, range(count), range(count)] += 1e-15 * size[:, None] + 1e-300
    back = np.linalg.inv(gram)
    inverse = back @ normal
    with np.errstate(all="ignore"):
        sigma = np.einsum("nij,nij->n", back, back) ** -0.25
        late = np.flatnonzero(~(sigma > np.maximum(clear, 1e-4 * np.sqrt(size))))
    if late.size:
        inverse[late], sigma[late] = _decomposed(slope[late])
    return inverse, sigma


def _decomposed(slope: Array) -> tuple[Array, Array]:
    left, values, right = np.linalg.svd(slope, full_matrices=False)
    weights = np.divide(1.0, values, out=np.zeros_like(values), where=values > 1e-10 * values[:, :1])
    inverse = np.swapaxes(right, 1, 2) @ (weights[:, :, None] * np.swapaxes(left, 1, 2))
    count = slope.shape[2]
    sigma = values[:, count - 1] if values.shape[1] >= count else np.zeros(len(slope))
    return inverse, sigma


def least_singular(slope: Array) -> Array:
    """The n-th singular value (N,) of matrices (N, m, n)."""
    return _decomposed(slope)[1]


@dataclass(frozen=True, eq=False)
class Walk:
    """Where walks ended: the last closed postures, whether they are at their targets, and what stopped them.

    share (N,) is the part of the way that was walked, wall (N,) the part at which the walk was stopped (the
    singular posture ahead, if one was seen), lowest (N,) the smallest singular value met.
    """

    closed: Closed
    arrived: Flags
    share: Array
    wall: Array
    lowest: Array


def walk(loop: Loop, evaluate: Evaluator, start: Closed, span: Array) -> Walk:
    """Move the driven dofs of closed postures by span (N, k), dimensionless, straight and in small steps.

    A step is taken when Newton closes it, the singular value stays above the margin, and the Jacobians J0, J1 at
    its ends obey min(|J0^+ (J1 - J0)|, |J1^+ (J1 - J0)|) < 1, so that no Jacobian between them is singular:
    the walk cannot slip to another branch. Otherwise the step is halved until it is too small to go on.
    """
    now = start.rows(np.arange(len(span)))
    share, wall, lowest = np.zeros(len(span)), np.zeros(len(span)), now.sigma.copy()
    size = np.ones(len(span))
    arrived = np.zeros(len(span), dtype=bool)
    active = np.arange(len(span))
    while active.size:
        here, way = now.rows(active), span[active]
        follow = (here.rate @ way[:, :, None])[..., 0]
        speed = np.maximum(np.abs(way).max(axis=1, initial=0.0), np.abs(follow).max(axis=1, initial=0.0))
        part = np.minimum(size[active], STEP / np.maximum(speed, STEP))
        part = np.minimum(part, 1.0 - share[active])
        ahead = loop.move(here.q, part[:, None] * way, loop.driven)
        ahead = loop.move(ahead, part[:, None] * follow, loop.dependent)
        there = loop.newton(evaluate, ahead, goal=CLOSED, turns=6)
        sound = (there.worst <= CLOSED) & (turn(here, there) < TURN)
        taken = sound & (there.sigma > loop.margin)
        lowest[active[sound]] = np.minimum(lowest[active[sound]], there.sigma[sound])
        now.put(active[taken], there.rows(np.flatnonzero(taken)))
        share[active[taken]] += part[taken]
        size[active] = np.where(taken, np.minimum(2.0 * part, 0.75 * _room(here, there, part)), 0.5 * part)
        arrived[active] = share[active] >= 1.0 - 1e-12
        barred = sound & ~taken
        wall[active] = share[active] + np.where(barred, part, 0.0)
        stuck = barred | (~sound & (part * speed < SMALLEST))
        active = active[~arrived[active] & ~stuck]
    return Walk(now, arrived, share, wall, lowest)


def _room(here: Closed, there: Closed, part: Array) -> Array:
    """How far ahead (N,) the singular value vanishes if its square falls on linearly, as at the end of a branch."""
    drop = here.sigma**2 - there.sigma**2
    return np.where(drop > 0.0, part * there.sigma**2 / np.where(drop > 0.0, drop, 1.0), np.inf)


def turn(here: Closed, there: Closed) -> Array:
    """min(|J0^+ (J1 - J0)|, |J1^+ (J1 - J0)|) (N,): below 1 no Jacobian between the two is singular."""
    change = there.slope - here.slope
    forward, backward = here.inverse @ change, there.inverse @ change
    return np.sqrt(np.minimum((forward**2).sum(axis=(1, 2)), (backward**2).sum(axis=(1, 2))))
