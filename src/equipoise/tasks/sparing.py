"""Of equally good values the ones that store least energy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from equipoise.affine import Array, Unknown
from equipoise.assemble import thrift
from equipoise.errors import InfeasibleError
from equipoise.solve.exchange import Solution, solve
from equipoise.solve.program import Program, Rows
from equipoise.states import States
from equipoise.tasks.certificate import EXACT
from equipoise.tasks.task import Task

MOST_STATES = 20_000
"""States over which stored energy is judged."""


def spared(task: Task, states: States, program: Program, solution: Solution) -> Solution:
    """Of all equally good values the ones with the least stored energy; unchanged where nothing is free.

    Directions that change no residual are followed exactly; what else a peak or mean leaves open is settled
    under a cap on the objective.
    """
    if not program.unknowns or len([term for term in program.terms if term.cap is None]) > 1:
        return solution
    if program.terms[0].norm == "rms" and not len(solution.flat):
        return solution
    states = states.take(slice(None, None, 1 + len(states) // MOST_STATES))
    value = max(solution.objective, 1e-13 * sum(program.loads))
    lean = thrift(program, task.balancers, states, value * (1 + 1e-8))
    theta = solution.theta
    if len(solution.flat):
        theta = _better(lean, theta, lambda: _along(lean, theta, solution.flat))
    if program.terms[0].norm != "rms" and solution.objective > EXACT * sum(program.loads):
        theta = _better(lean, theta, lambda: solve(lean).theta)
    sound = program.objective(theta) <= value * (1 + 1e-6) and program.violation(theta) <= 1e-7
    return replace(solution, theta=theta) if sound else solution


def _better(lean: Program, theta: Array, better: Callable[[], Array]) -> Array:
    """The better values where they save energy worth speaking of."""
    stored = lean.terms[0].value(theta)
    if stored <= 0:
        return theta
    try:
        candidate = better()
    except InfeasibleError:
        return theta
    return candidate if lean.terms[0].value(candidate) < (1 - 1e-4) * stored else theta


def _along(lean: Program, theta: Array, directions: Array) -> Array:
    """Least stored energy over theta + directions' z, within limits and bounds; the residual stays as it is."""
    moves = tuple(Unknown(f"move {i}", "") for i in range(len(directions)))
    saving = lean.terms[0]
    term = replace(saving, b=saving.residual(theta), A=saving.A @ directions.T)
    rows = [
        replace(r, G=r.G @ directions.T, h=r.h - r.G @ theta, unknowns=moves)
        for r in lean.rows
        if not (r.equality or r.fixed)
    ]
    for index, unknown in enumerate(lean.unknowns):
        for bound, sign in ((unknown.lower, -1.0), (unknown.upper, 1.0)):
            if np.isfinite(bound):
                room = np.array([sign * (bound - theta[index])])
                scale = max(abs(theta[index]), abs(bound), 1e-9)
                slope = sign * directions[:, index][None]
                rows.append(Rows(unknown.name, unknown.unit, slope, room, moves, scale=scale))
    definite = tuple(
        replace(one, S=np.tensordot(directions, one.S, axes=1), S0=one.matrix(theta), unknowns=moves)
        for one in lean.definite
    )
    return theta + solve(Program(moves, (term,), tuple(rows), definite)).theta @ directions
