"""Many small problems side by side: sequential quadratic programming, one step for all candidates that still move."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.solve.program import Program
from equipoise.solve.small import boxed, elastic

STEPS = 40
PRICE, RISE, DEAREST = 30.0, 10.0, 3000.0
"""Of one unit of relative excess, in units of the squared residual of what nothing balances; how it rises, and ends."""
PASSED = 1e-7
RADIUS = 0.2
STILL = 3e-5
"""Share of the squared residual below which a predicted gain is none."""
SMALL = 1e-8
NUDGE = 1e-7
"""Step of the differences, in shares of the bounds."""
NEAR = 10
"""How many limits a step looks at."""
OPEN = 100.0
"""Range of a variable without bounds, in units that move the residual by what nothing balances."""
FAR = 5.0
"""Relative room of a limit that no step uses up."""

Which = NDArray[np.intp]
Many = Callable[[Which, Array], Program]
"""(which candidates (K,), their geometries (K, G)) -> their program."""


@dataclass(frozen=True, eq=False)
class Fitted:
    """Where candidates came to rest: gamma (C, G), theta (C, P), the objective (C,) and the excess of limits (C,)."""

    gamma: Array
    theta: Array
    value: Array
    excess: Array

    def take(self, rows: Which) -> Fitted:
        """Some of the candidates."""
        return Fitted(self.gamma[rows], self.theta[rows], self.value[rows], self.excess[rows])

    def updated(self, rows: Which, other: Fitted) -> Fitted:
        """The same with some of the candidates fitted anew."""
        found = self.take(np.arange(len(self.gamma)))
        found.gamma[rows], found.theta[rows] = other.gamma, other.theta
        found.value[rows], found.excess[rows] = other.value, other.excess
        return found


@dataclass(frozen=True, eq=False)
class _Here:
    """Residual (K, R) and excess (K, M) with their slopes over all variables (K, ., G + P)."""

    residual: Array
    slope: Array
    excess: Array
    steepness: Array

    @property
    def parts(self) -> tuple[Array, Array, Array, Array]:
        """All arrays."""
        return self.residual, self.slope, self.excess, self.steepness

    def take(self, rows: Which | NDArray[np.bool_]) -> _Here:
        """Some of the candidates."""
        return _Here(*(part[rows] for part in self.parts))

    def put(self, rows: Which, other: _Here) -> None:
        """Replace some of the candidates."""
        for whole, part in zip(self.parts, other.parts, strict=True):
            whole[rows] = part

    @property
    def beyond(self) -> Array:
        """The worst relative excess (K,), zero where all limits are kept."""
        return np.maximum(self.excess.max(axis=-1, initial=0.0), 0.0)

    def merit(self, price: Array) -> Array:
        """Squared residual and the price (K,) of the worst excess (K,)."""
        return (self.residual**2).sum(-1) + price * self.beyond


Measure = Callable[[Which, Array], _Here]


def fit(many: Many, lower: Array, upper: Array, gamma: Array, theta: Array, load: float, steps: int = STEPS) -> Fitted:
    """Least squares of every candidate's residual over its geometry and unknowns, limits kept, all at once.

        min sum_i r_i(gamma, theta)^2   subject to   g(gamma, theta) <= 0,   lower <= (gamma, theta) <= upper

    lower, upper (G + P,); gamma (C, G) and theta (C, P) are where each begins; load makes residuals relative. Every
    step solves a small elastic quadratic program in a trust region. Its slopes are differences, three times as fast as
    exact ones, for every step is judged by its true residual; its curvature is Gauss-Newton's plus what the slopes of
    residuals, and of limits times their multipliers, were seen to change by (the structured secant update of Dennis,
    Gay and Welsch, unsourced). Where curvature spoils a step, the model is bent by what it missed and solved again.
    Limits have a price, which rises where one is still passed when nothing moves any more. Candidates are independent:
    the answer of one does not depend on the others. A few steps tell good beginnings from bad ones.
    """
    count, free = gamma.shape
    x = np.clip(np.hstack([gamma, theta]), lower, upper)
    measure = partial(_measure, many, free, load, upper - lower)
    here = measure(np.arange(count), x)
    if x.shape[1]:
        _descend(measure, x, here, (lower, upper), steps)
    return Fitted(x[:, :free], x[:, free:], np.sqrt((here.residual**2).sum(-1)) * load, here.beyond)


def _descend(measure: Measure, x: Array, here: _Here, box: tuple[Array, Array], steps: int) -> None:
    """Steps of all candidates, in place, until each stands still."""
    (count, V), span = x.shape, box[1] - box[0]
    turn, radius, price = np.zeros((count, V, V)), np.full(count, RADIUS), np.full(count, PRICE)
    missed = _Here(*(np.zeros_like(part) for part in here.parts))
    bent = np.zeros(count, dtype=bool)
    active = np.arange(count)
    for _ in range(steps):
        now = here.take(active)
        unit = _unit(now, span)
        room = radius[active, None] * np.minimum(span / unit, OPEN)
        reach = np.maximum((box[0] - x[active]) / unit, -room), np.minimum((box[1] - x[active]) / unit, room)
        move, predicted, dual = _step(now, missed.take(active), turn[active], unit, reach, price[active])
        standing = (predicted <= STILL * now.merit(price[active]) + STILL**2) & ~bent[active]
        # Limits that are passed where nothing moves any more have too low a price.
        cheap = standing & (now.beyond > PASSED) & (price[active] < DEAREST)
        price[active[cheap]] *= RISE
        radius[active[cheap]] = RADIUS
        keep = ~standing
        raised = active[cheap]
        active, move, predicted, now, unit = active[keep], move[keep], predicted[keep], now.take(keep), unit[keep]
        dual = dual[keep]
        if not len(active):
            if not len(raised):
                return
            active = raised
            continue
        there = np.clip(x[active] + move, *box)
        trial = measure(active, there)
        gain = now.merit(price[active]) - trial.merit(price[active])
        ratio = gain / np.maximum(predicted, 1e-300)
        better = (gain > 0) & (ratio > 0.02)
        done = active[better]
        turn[done] = _turned(turn[done], move[better], now.take(better), trial.take(better), dual[better])
        x[done] = there[better]
        here.put(done, trial.take(better))
        # A first failure bends the model by what it missed there; a second shrinks its region.
        again = ~better & ~bent[active]
        spoilt = active[again]
        missed.put(spoilt, _missed(now.take(again), trial.take(again), move[again]))
        length = (np.abs(move) / np.minimum(span, OPEN * unit)).max(axis=1)
        radius[active] = np.where(
            better,
            np.where(
                ratio > 0.7,
                np.maximum(radius[active], 2.5 * length),
                np.where(ratio > 0.25, radius[active], length / 2),
            ),
            np.where(bent[active], np.minimum(radius[active], length) / 4, radius[active]),
        )
        bent[active] = again
        straight = active[~again]
        for part in (missed.residual, missed.excess):
            part[straight] = 0.0
        active = np.sort(np.append(active[radius[active] > SMALL], raised))


def _unit(here: _Here, span: Array) -> Array:
    """Units (K, V) in which every variable moves the residual about equally, but by no more than its span."""
    slope = np.sqrt((here.slope**2).sum(axis=1))
    return np.minimum(1.0 / np.maximum(slope, 1e-12), span)


def _step(
    here: _Here, missed: _Here, turn: Array, unit: Array, reach: tuple[Array, Array], price: Array
) -> tuple[Array, Array, Array]:
    """The move (K, V) of the elastic quadratic program, the merit it predicts to gain (K,), the multipliers (K, M)."""
    J = here.slope * unit[:, None, :]
    dual = np.zeros_like(here.excess)
    A, excess, near = _near(here.steepness * unit[:, None, :], here.excess + missed.excess, reach)
    plain = np.swapaxes(J, 1, 2) @ J
    curved = plain + turn * unit[:, :, None] * unit[:, None, :]
    values, vectors = np.linalg.eigh(curved)
    positive = np.einsum("kij,kj,klj->kil", vectors, np.maximum(np.abs(values), 1e-9), vectors)
    gradient = np.einsum("krv,kr->kv", J, here.residual + missed.residual)
    move, least = boxed(positive, gradient, *reach)
    passing = np.flatnonzero(~least | (np.einsum("kiv,kv->ki", A, move) + excess > 0).any(axis=1))
    if len(passing):
        low, high = (end[passing] for end in reach)
        limits = A[passing], np.maximum(excess[passing], -FAR)
        move[passing], pushed = elastic(positive[passing], gradient[passing], *limits, low, high, price[passing] / 2)
        dual[passing[:, None], near[passing]] = pushed
    after = np.einsum("kiv,kv->ki", A, move) + excess
    model = np.einsum("kv,kvw,kw->k", move, positive, move) + 2 * (gradient * move).sum(-1)
    predicted = -model + price * (here.beyond - np.maximum(after.max(axis=-1, initial=0.0), 0.0))
    return move * unit, predicted, dual


def _near(A: Array, excess: Array, reach: tuple[Array, Array]) -> tuple[Array, Array, Which]:
    """The limits (K, NEAR) that a step could come closest to passing, or pass farthest, and which they are."""
    if excess.shape[1] <= NEAR:
        return A, excess, np.broadcast_to(np.arange(excess.shape[1]), excess.shape)
    most = excess + (np.maximum(A * reach[1][:, None, :], A * reach[0][:, None, :])).sum(-1)
    rows = np.argpartition(-most, NEAR, axis=1)[:, :NEAR]
    return np.take_along_axis(A, rows[..., None], axis=1), np.take_along_axis(excess, rows, axis=1), rows


def _missed(here: _Here, there: _Here, move: Array) -> _Here:
    """What the linear model at `here` missed at `there`, a move (K, V) away."""
    residual = there.residual - here.residual - np.einsum("krv,kv->kr", here.slope, move)
    excess = there.excess - here.excess - np.einsum("kmv,kv->km", here.steepness, move)
    return _Here(residual, np.zeros_like(here.slope), excess, np.zeros_like(here.steepness))


def _turned(S: Array, step: Array, old: _Here, new: _Here, dual: Array) -> Array:
    """The second-order part S (K, V, V) of residual and limits, times their multipliers (K, M), after a step (K, V)."""
    bent = np.einsum("kmv,km->kv", new.steepness - old.steepness, dual)
    before = np.einsum("krv,kr->kv", old.slope, old.residual)
    after = np.einsum("krv,kr->kv", new.slope, new.residual)
    turned = np.einsum("krv,kr->kv", new.slope - old.slope, new.residual) + bent
    changed = after - before + bent
    along = (changed * step).sum(-1)
    Ss = np.einsum("kij,kj->ki", S, step)
    with np.errstate(divide="ignore", invalid="ignore"):
        size = np.minimum(1.0, np.abs((step * turned).sum(-1)) / np.abs((step * Ss).sum(-1)))
        size = np.where(np.isfinite(size), size, 1.0)
        miss = turned - size[:, None] * Ss
        outer = miss[:, :, None] * changed[:, None, :]
        grown = (outer + np.swapaxes(outer, 1, 2)) / along[:, None, None]
        grown -= ((miss * step).sum(-1) / along**2)[:, None, None] * changed[:, :, None] * changed[:, None, :]
    sizes = np.linalg.norm(changed, axis=-1) * np.linalg.norm(step, axis=-1)
    sound = (along > 1e-8 * sizes) & np.isfinite(grown).all(axis=(1, 2))
    return np.where(sound[:, None, None], size[:, None, None] * S + grown, S)


def _measure(many: Many, free: int, load: float, span: Array, which: Which, x: Array) -> _Here:
    """Residuals and limits of candidates at x (K, G + P), with their slopes."""
    count, P, copies = len(which), x.shape[1] - free, free + 1
    shifts = np.vstack([np.zeros(free), np.diag(NUDGE * span[:free])])
    gamma = (x[:, None, :free] + shifts).reshape(count * copies, free)
    program = many(np.repeat(which, copies), gamma)
    tiled = np.repeat(x[:, free:], copies, axis=0)[:, None, :, None]

    def full(array: Array, rank: int) -> Array:
        return np.broadcast_to(array, (count * copies, *array.shape[array.ndim - rank :]))

    def sloped(value: Array, by_theta: Array) -> tuple[Array, Array]:
        """A quantity (K, R) and its slopes (K, R, G + P)."""
        value = value.reshape(count, copies, -1)
        turned = (value[:, 1:] - value[:, :1]) / (NUDGE * span[:free, None])
        return value[:, 0].copy(), np.concatenate([np.swapaxes(turned, 1, 2), by_theta[::copies]], axis=-1)

    residuals, limits = [], []
    for term in program.terms:
        if term.cap is None:
            root = term.factor * np.sqrt(term.weight)[:, None] / load
            b, A = full(term.b, 2), full(term.A, 3)
            r = b + (A @ tiled)[..., 0] if P else b
            residuals.append(sloped(r * root, (A * root[..., None]).reshape(*b.shape[:1], r[0].size, P)))
    for rows in program.rows:
        G, h = full(rows.G, 2), full(rows.h, 1)
        g = ((G @ tiled[:, 0])[..., 0] if P else 0.0) - h
        signs = (1.0, -1.0) if rows.equality else (1.0,)
        limits += [sloped(sign * g / rows.scale, sign * G / rows.scale) for sign in signs]
    none = np.zeros((count, 0)), np.zeros((count, 0, x.shape[1]))
    residual, slope = (np.concatenate(parts, axis=1) for parts in zip(*residuals, strict=True))
    excess, steepness = (np.concatenate(parts, axis=1) for parts in zip(*(limits or [none]), strict=True))
    return _Here(residual, slope, excess, steepness)
