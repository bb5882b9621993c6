"""Many small problems side by side: Levenberg-Marquardt with limits, one step for all candidates that still move."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.solve.program import Program
from equipoise.solve.shape import STEP

ROUNDS = 8
STEPS = 12
STIFFNESS = 10.0
HARDER = 4.0
ENOUGH = 1e-7
"""Relative excess of a limit at which a candidate needs no further round."""
STILL = 1e-8
"""Relative gain below which a candidate stands still."""
STUCK = 1e10

Which = NDArray[np.int_]
Many = Callable[[Which, Array], Program]
"""(which candidates (K,), their geometries (K, G), complex where derivatives are asked) -> their program."""


@dataclass(frozen=True, eq=False)
class Fitted:
    """Where candidates came to rest: gamma (C, G), theta (C, P), the objective (C,) and the excess of limits (C,)."""

    gamma: Array
    theta: Array
    value: Array
    excess: Array


@dataclass(frozen=True, eq=False)
class _Here:
    """Residual (K, R) and excess (K, M) with their slopes over all variables (K, ., G + P)."""

    residual: Array
    slope: Array
    excess: Array
    steepness: Array


def fit(many: Many, lower: Array, upper: Array, gamma: Array, theta: Array, load: float) -> Fitted:
    """Least squares of every candidate's residual over its geometry and unknowns, limits kept, all at once.

        min sum_i |r_i(gamma, theta)|^2   subject to   g(gamma, theta) <= 0,   lower <= (gamma, theta) <= upper

    lower, upper (G + P,); gamma (C, G) and theta (C, P) are where each begins; load makes residuals relative. Limits
    enter by an augmented Lagrangian, so they hold to rounding without a stiff penalty; derivatives are exact (complex
    step in gamma). Candidates are independent: the answer of one does not depend on the others.
    """
    count, free = gamma.shape
    x = np.clip(np.hstack([gamma, theta]), lower, upper)
    probe = _measure(many, np.arange(count), x, free, load)
    shift = np.zeros_like(probe.excess)
    stiff = np.full(count, STIFFNESS)
    open_ones, last = np.arange(count), np.full(count, np.inf)
    for _ in range(ROUNDS):
        _descend(many, open_ones, x, free, load, shift, stiff, (lower, upper))
        here = _measure(many, open_ones, x[open_ones], free, load, sloped=False)
        worst = _most(here.excess)
        shift[open_ones] = np.maximum(0.0, here.excess + shift[open_ones])
        slow = worst > 0.25 * last[open_ones]
        raised = open_ones[slow]
        stiff[raised] *= HARDER
        shift[raised] /= HARDER
        last[open_ones] = worst
        open_ones = open_ones[worst > ENOUGH]
        if not len(open_ones):
            break
    end = _measure(many, np.arange(count), x, free, load, sloped=False)
    value = np.sqrt((end.residual**2).sum(-1)) * load
    return Fitted(x[:, :free], x[:, free:], value, np.maximum(_most(end.excess), 0.0))


def _most(excess: Array) -> Array:
    return excess.max(axis=-1, initial=-np.inf)


def _descend(
    many: Many, which: Which, x: Array, free: int, load: float, shift: Array, stiff: Array, box: tuple[Array, Array]
) -> None:
    """Damped Gauss-Newton steps of the candidates `which`, in place, until each stands still."""
    damping = np.full(len(x), 1e-3)
    for _ in range(STEPS):
        here = _measure(many, which, x[which], free, load)
        merit = _merit(here, shift[which], stiff[which])
        gradient, curvature = _normal(here, shift[which], stiff[which])
        todo = np.arange(len(which))
        moved = np.zeros(len(which))
        for _ in range(6):
            at = x[which[todo]]
            step = _step(gradient[todo], curvature[todo], damping[which[todo]], at, box)
            there = np.clip(at + step, *box)
            trial = _merit(_measure(many, which[todo], there, free, load, sloped=False), shift[which[todo]], stiff[which[todo]])
            better = trial < merit[todo]
            done = todo[better]
            x[which[done]] = there[better]
            moved[done] = merit[done] - trial[better]
            damping[which[done]] = np.maximum(damping[which[done]] / 9, 1e-12)
            todo = todo[~better]
            damping[which[todo]] *= 8
            todo = todo[damping[which[todo]] < STUCK]
            if not len(todo):
                break
        which = which[moved > STILL * np.maximum(merit, 1e-12)]
        if not len(which):
            return


def _step(gradient: Array, curvature: Array, damping: Array, at: Array, box: tuple[Array, Array]) -> Array:
    """Solve (H + lambda diag H) dx = -g; variables at a bound that push outwards stay where they are."""
    low, high = box
    stay = ((at <= low) & (gradient > 0)) | ((at >= high) & (gradient < 0))
    diagonal = np.einsum("kii->ki", curvature)
    size = np.sqrt(np.maximum(diagonal, 1e-300))
    scaled = curvature / (size[:, :, None] * size[:, None, :])
    index = np.arange(scaled.shape[-1])
    scaled[:, index, index] = 1.0 + damping[:, None] + 1e-12
    scaled = np.where(stay[:, :, None] | stay[:, None, :], 0.0, scaled)
    scaled[:, index, index] = np.where(stay, 1.0, scaled[:, index, index])
    right = np.where(stay, 0.0, -gradient / size)
    return np.linalg.solve(scaled, right[..., None])[..., 0] / size


def _merit(here: _Here, shift: Array, stiff: Array) -> Array:
    return (here.residual**2).sum(-1) + stiff * (np.maximum(0.0, here.excess + shift) ** 2).sum(-1)


def _normal(here: _Here, shift: Array, stiff: Array) -> tuple[Array, Array]:
    """Gradient (K, V) and Gauss-Newton curvature (K, V, V), both halved."""
    hinge = np.maximum(0.0, here.excess + shift)
    active = np.where((hinge > 0)[..., None], here.steepness, 0.0)
    gradient = np.einsum("krv,kr->kv", here.slope, here.residual)
    gradient += stiff[:, None] * np.einsum("kmv,km->kv", active, hinge)
    curvature = np.swapaxes(here.slope, -1, -2) @ here.slope
    curvature += stiff[:, None, None] * (np.swapaxes(active, -1, -2) @ active)
    return gradient, curvature


def _measure(many: Many, which: Which, x: Array, free: int, load: float, *, sloped: bool = True) -> _Here:
    """Residuals and limits of candidates at x (K, G + P), with slopes where they are asked."""
    count, P = len(which), x.shape[1] - free
    gamma, theta = x[:, :free], x[:, free:]
    sloped = sloped and free > 0
    if sloped:
        steps = gamma[:, None, :] + 1j * STEP * np.eye(free)
        program = many(np.repeat(which, free), steps.reshape(-1, free))
        copies = free
    else:
        program, copies = many(which, gamma), 1
    tiled = np.repeat(theta, copies, axis=0)[:, None, :, None]

    def full(array: Array, rank: int) -> Array:
        return np.broadcast_to(array, (count * copies, *array.shape[array.ndim - rank :]))

    residuals, excesses, by_theta, by_theta_limits = [], [], [], []
    for term in program.terms:
        if term.cap is None:
            root = term.factor * np.sqrt(term.weight)[:, None] / load
            b, A = full(term.b, 2), full(term.A, 3)
            r = b + (A @ tiled)[..., 0] if P else b
            residuals.append((r * root).reshape(count * copies, -1))
            by_theta.append((A[::copies] * root[..., None]).reshape(count, residuals[-1].shape[1], P))
    for rows in program.rows:
        G, h = full(rows.G, 2), full(rows.h, 1)
        g = ((G @ tiled[:, 0])[..., 0] if P else 0.0) - h
        for sign in (1.0, -1.0) if rows.equality else (1.0,):
            excesses.append(sign * g / rows.scale)
            by_theta_limits.append(sign * G[::copies] / rows.scale)
    empty = np.zeros((count * copies, 0))
    residual = np.concatenate(residuals, axis=-1)
    excess = np.concatenate(excesses, axis=-1) if excesses else empty
    slope = _slopes(residual, by_theta, count, free if sloped else 0, P)
    limits = by_theta_limits if excesses else [np.zeros((count, 0, P))]
    steepness = _slopes(excess, limits, count, free if sloped else 0, P)
    return _Here(np.real(residual[::copies]), slope, np.real(excess[::copies]), steepness)


def _slopes(value: Array, by_theta: list[Array], count: int, free: int, P: int) -> Array:
    """d value / d (gamma, theta) (K, R, G + P): by complex step, and what stands at the unknowns."""
    known = np.real(np.concatenate(by_theta, axis=1)) if P else np.zeros((count, value.shape[-1], 0))
    if not free:
        return known
    turned = np.imag(value).reshape(count, free, -1) / STEP
    return np.concatenate([np.swapaxes(turned, 1, 2), known], axis=-1)
