"""Newton's last digits of a geometry whose rms is smooth: no limit and no bound in the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from equipoise.affine import Array
from equipoise.errors import EquipoiseError
from equipoise.solve.exchange import Solution, solve
from equipoise.solve.shape import Build, Freedom, Local, linearise

DIFFERENCE = 1e-5
STEPS = 4
CLEAR = 1e-5
FLAT = 1e-9
DONE = 1e-14
NEAR = 1e-6


def sharpen(build: Build, freedoms: Sequence[Freedom], best: Local) -> Local:
    """Newton steps on the rms over the parameters that no bound holds, theta solved anew at each.

        f(gamma) = min_theta |b + A theta|,   df/dgamma = r . (db/dgamma + dA/dgamma theta) / f

    Sequential convex programming leaves out the curvature of the residual, so it nears the least rms linearly, to
    the accuracy of its cone solver; this takes the rest. The gradient is exact, the Hessian its central difference.
    Other norms, several terms, active limits and a vanishing rms are left as they are.
    """
    low, high = np.array([f.lower for f in freedoms]), np.array([f.upper for f in freedoms])
    span = high - low
    free = (best.gamma - low > CLEAR * span) & (high - best.gamma > CLEAR * span)
    if not free.any() or not _smooth(best.solution):
        return best

    def at(gamma: Array) -> tuple[Solution, Array]:
        """The inner solution, and the gradient over the free parameters in shares of their spans."""
        found = solve(build(gamma[None]).take(0))
        term, count = linearise(build, freedoms, gamma, found.theta).terms[0], len(found.theta)
        residual = term.b + term.A[..., :count] @ found.theta
        size = max(term.value(np.concatenate([found.theta, 0 * gamma])), 1e-300)
        slope = term.factor * np.einsum("n,nr,nrg->g", term.weight, residual, term.A[..., count:]) / size
        return found, (slope * span)[free]

    here, (solution, gradient), left = best.gamma, at(best.gamma), best.stationarity
    try:
        for _ in range(STEPS):
            hessian = np.empty((len(gradient), len(gradient)))
            for column, index in enumerate(np.flatnonzero(free)):
                aside = DIFFERENCE * span * (np.arange(len(span)) == index)
                hessian[:, column] = (at(here + aside)[1] - at(here - aside)[1]) / (2 * DIFFERENCE)
            step = _newton(hessian, gradient)
            there = here.copy()
            there[free] += step * span[free]
            left = 0.5 * abs(float(gradient @ step))
            if left <= DONE * solution.objective or (there < low).any() or (there > high).any():
                break
            found, slope = at(there)
            if found.objective >= solution.objective or not _smooth(found):
                break
            here, solution, gradient = there, found, slope
    except EquipoiseError:
        # A neighbour that a limit forbids: what was found so far stands.
        pass
    if solution.objective >= best.solution.objective:
        return best
    return replace(best, gamma=here, merit=solution.objective, stationarity=left, solution=solution)


def vanish(build: Build, freedoms: Sequence[Freedom], best: Local) -> Local:
    """Gauss-Newton steps towards a residual that vanishes, where almost nothing of the load is left.

        [dr/dtheta, dr/dgamma] step = -r,   the smallest step in shares of the values and of the bounds' widths

    Near an exact balance they converge quadratically to rounding, which a cone solver's accuracy keeps from.
    """
    low, high = np.array([f.lower for f in freedoms]), np.array([f.upper for f in freedoms])
    here, solution = best.gamma, solve(build(best.gamma[None]).take(0))
    for _ in range(STEPS):
        program, theta = solution.program, solution.theta
        if solution.objective > NEAR * sum(program.loads) or program.definite:
            break
        terms = [term for term in linearise(build, freedoms, here, theta).terms if term.cap is None]
        scale = np.concatenate([np.abs(theta), high - low])
        slopes = np.vstack([term.A.reshape(-1, len(scale)) for term in terms]) * scale
        left = np.concatenate([term.residual(np.append(theta, 0 * low)).ravel() for term in terms])
        step = np.linalg.lstsq(slopes, -left, rcond=FLAT)[0] * scale
        there = np.clip(here + step[len(theta) :], low, high)
        try:
            found = solve(build(there[None]).take(0))
        except EquipoiseError:  # a limit forbids it
            break
        if found.objective >= 0.5 * solution.objective:
            break
        here, solution = there, found
    if here is best.gamma:
        return best
    return replace(best, gamma=here, merit=solution.objective, solution=solution)


def _smooth(solution: Solution) -> bool:
    """Whether the objective is a single rms above rounding that no limit touches."""
    program, theta = solution.program, solution.theta
    if len(program.terms) != 1 or program.terms[0].norm != "rms" or program.definite:
        return False
    if solution.objective <= FLAT * sum(program.loads):
        return False
    return all(float((row.h - row.G @ theta).min()) > CLEAR * row.scale for row in program.rows if len(row.h))


def _newton(hessian: Array, gradient: Array) -> Array:
    """-H^-1 g over the directions in which the objective curves upwards; others stay."""
    if not np.isfinite(hessian).all():
        return np.zeros_like(gradient)
    values, vectors = np.linalg.eigh(0.5 * (hessian + hessian.T))
    upward = values > FLAT * np.abs(values).max()
    return -vectors[:, upward] @ ((vectors[:, upward].T @ gradient) / values[upward])
