"""A task solved: on its sweep, between the samples, over intervals, and with the least stored energy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.spring import Spring
from equipoise.errors import EquipoiseError, InfeasibleError
from equipoise.limits import OverInterval
from equipoise.peaks import STARTS
from equipoise.solve.exchange import Solution, solve
from equipoise.solve.program import Program, Rows
from equipoise.tasks.between import between
from equipoise.tasks.sparing import spared
from equipoise.tasks.task import Balanced, Task

ROUNDS = 24
"""How often poses between the samples are looked for."""
FEW = 6
"""Starts of that search once the hills are known."""
CUTS = 60
EASED = 1e-6
"""Relative excess of a limit on geometry alone that is let be."""
BETWEEN_LENGTHS = 1e-10
"""Relative excess of a limit over an interval at its worst length."""


def settle(task: Task) -> Balanced:
    """Solve at the task's geometry; refine between the samples; settle what is free by least stored energy.

    Raises InfeasibleError where the limits conflict, at the samples or at the poses found between them.
    """
    found = attempt(task)
    if found.broken is not None:
        raise found.broken
    return found


def attempt(task: Task) -> Balanced:
    """As `settle`; but limits that conflict only at poses found between the samples come back as `broken`.

    The task that comes back then has those poses, and the solution is the last one without them: another geometry
    may keep the limits there. Raises InfeasibleError where limits conflict at the samples themselves.
    """
    started, starts, found = len(task.sweep.poses), STARTS, None
    for _ in range(ROUNDS):
        try:
            found = _solved(task, started)
        except InfeasibleError as error:
            if found is None:
                raise
            added = len(task.sweep.poses) - started
            why = InfeasibleError(f"{error.message}, at poses between the samples", where=error.where, hint=error.hint)
            states = task.mechanism.states(task.sweep)
            return replace(found, task=task, states=states, refined=added, broken=why)
        higher = _between(found, starts)
        if not len(higher):
            return found
        task = replace(task, sweep=task.sweep.extended(higher))
        # The hills found now are among the samples of the next round: a few starts follow them.
        starts = FEW
    assert found is not None
    return found


def _solved(task: Task, started: int) -> Balanced:
    states = task.mechanism.states(task.sweep)
    whole = task.program(states)
    program, solution = tightened(task, eased(whole))
    solution = spared(task, states, program, solution)
    # Rounding may leave a value outside its bounds by 1e-10 of its size.
    solution = replace(solution, theta=np.clip(solution.theta, program.lower, program.upper))
    # What was let be is part of the answer's violation.
    program = replace(program, rows=(*whole.rows, *program.rows[len(whole.rows) :]))
    return Balanced(task, states, program, solution, len(task.sweep.poses) - started)


def _between(found: Balanced, starts: int) -> Array:
    """Poses between the samples that exceed the peak; where few starts find none, many look again."""
    higher = between(found.task, found.states, found.program, found.solution, starts)
    if len(higher) or starts == STARTS:
        return higher
    return between(found.task, found.states, found.program, found.solution, STARTS)


def eased(program: Program) -> Program:
    """The program with rows of geometry alone kept that are exceeded by next to nothing.

    No unknown can mend them, and a geometry shaped to its limits exceeds them by rounding.
    """
    return replace(program, rows=tuple(row if row.G.any() or row.equality else _let_be(row) for row in program.rows))


def _let_be(row: Rows) -> Rows:
    return replace(row, h=np.where(row.h > -EASED * row.scale, row.h.clip(0.0), row.h))


def tightened(task: Task, program: Program) -> tuple[Program, Solution]:
    """Solve, and add the worst lengths of limits over intervals, until every length keeps them."""
    springs = {balancer.name: balancer for balancer in task.balancers if isinstance(balancer, Spring)}
    curves = [
        limit for limit in task.limits if isinstance(limit, OverInterval) and limit.over and limit.samples is None
    ]
    for _ in range(CUTS):
        solution = solve(program)
        values = {u.name: float(v) for u, v in zip(program.unknowns, solution.theta, strict=True)}
        added: list[Rows] = []
        for limit in curves:
            spring = springs[limit.spring]
            lengths = limit.outside(spring, values, BETWEEN_LENGTHS)
            if len(lengths):
                added += [rows.expand(program.unknowns) for rows in limit.rows_at(spring, lengths)]
        if not added:
            return program, solution
        program = replace(program, rows=(*program.rows, *added))
    raise EquipoiseError(
        f"the limits over intervals did not settle in {CUTS} rounds", where="limits", hint="use a lower degree"
    )
