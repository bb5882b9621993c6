"""What is proved of a solved task: how good it is, and what holds it back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from equipoise.affine import Array
from equipoise.assemble import effort
from equipoise.certificate import Active, Certificate
from equipoise.floors import floors
from equipoise.loops import reachable
from equipoise.motion.moves import Free
from equipoise.objective import leading, minimised
from equipoise.solve.exchange import Solution
from equipoise.solve.program import Program
from equipoise.tasks.task import Balanced, unit_of
from equipoise.units import enumerated

EXACT = 1e-9
"""Share of its load below which a row counts as vanished."""


def certify(balanced: Balanced) -> Certificate:
    """The certificate of a fixed geometry: `exact` where nothing is left, also off the grid, else `convex`."""
    task, program, solution = balanced.task, balanced.program, balanced.solution
    unit = unit_of(task)
    first = leading(task.objective)
    primal = program.objective(solution.theta)
    return Certificate(
        kind="exact" if is_exact(balanced) else "convex",
        primal=primal,
        dual=min(solution.gap.dual, primal),
        unit=unit,
        violation=max(0.0, program.violation(solution.theta)),
        active=active_limits(program, solution, unit),
        floors=floors(
            program, solution.theta, np.abs(solution.theta), first.counted(task.mechanism), len(task.sweep.scenarios)
        ),
        flat=tuple(_direction(vector, program) for vector in solution.flat),
        quadrature=quadrature_error(balanced),
    )


def quadrature_error(balanced: Balanced) -> float | None:
    """|N_finer / N - 1| of the objective at the same values, where the sweep knows a finer rule and averages count."""
    task, solution = balanced.task, balanced.solution
    counted = [aim for aim in minimised(task.objective) if aim.norm != "peak"]
    if task.sweep.finer is None or not counted:
        return None
    finer = replace(task, sweep=task.sweep.finer(), objective=tuple(counted), limits=())
    value = [
        term.factor * term.value(solution.theta) for term in finer.program(finer.mechanism.states(finer.sweep)).terms
    ]
    here = [t.factor * t.value(solution.theta) for t in balanced.program.terms if t.cap is None and t.norm != "peak"]
    return abs(sum(value) / sum(here) - 1) if sum(here) > 0 else 0.0


def is_exact(balanced: Balanced) -> bool:
    """Whether every counted row vanishes to 1e-9 of its load, on the sweep and at 256 other states of its region."""
    task, program, theta = balanced.task, balanced.program, balanced.solution.theta
    loads = []
    for aim in minimised(task.objective):
        # What given parts have balanced already is measured by the bare mechanism.
        bare = effort(task.mechanism, (), balanced.states, aim.goal, aim.pole)
        term = aim.term(task.mechanism, bare, balanced.states.weight, bare)
        loads.append(float(np.abs(term.b).max()) or 1.0)

    def vanishes(other: Program) -> bool:
        terms = [term for term in other.terms if term.cap is None]
        return all(np.abs(t.residual(theta)).max() <= EXACT * load for t, load in zip(terms, loads, strict=True))

    if not vanishes(program):
        return False
    region = task.sweep.domain
    if region is None:
        return True
    others = region[:, 0] + np.random.default_rng(0).random((256, len(region))) * (region[:, 1] - region[:, 0])
    if isinstance(task.sweep.moves, Free):
        joints = task.mechanism.driven
        others = others[reachable(task.mechanism, others[:, : len(joints)])]
    return vanishes(task.program(task.mechanism.states(task.sweep.at(others))))


def active_limits(program: Program, solution: Solution, unit: str) -> tuple[Active, ...]:
    """Limits and bounds of unknowns that carry a price, the dearest first (in shares of the objective)."""
    found: list[tuple[float, Active]] = []
    scales = {rows.limit: (rows.scale, rows.unit) for rows in program.rows}
    for limit, price in solution.prices.limits.items():
        scale, limit_unit = scales.get(limit, (1.0, "kg"))  # definite matrices are written in kg
        found.append((price * scale, Active(limit, price, f"{unit} per {limit_unit}")))
    for side, prices, values in (
        (">=", solution.prices.lower, program.lower),
        ("<=", solution.prices.upper, program.upper),
    ):
        for unknown, price, value in zip(program.unknowns, prices, values, strict=False):
            if not np.isfinite(value):
                continue
            size = price * max(abs(value), program.scale[program.unknowns.index(unknown)])
            found.append((size, Active(f"{unknown.name} {side} {value:g}", float(price), f"{unit} per {unknown.unit}")))
    worth = 1e-6 * max(solution.objective, 1e-300)
    return tuple(active for size, active in sorted(found, key=lambda pair: -pair[0]) if size > worth)


def _direction(vector: Array, program: Program) -> str:
    relative = np.abs(vector / program.scale)
    names = [u.name for u, size in zip(program.unknowns, relative, strict=True) if size > 1e-3 * relative.max()]
    return enumerated(names) + (" trade freely" if len(names) > 1 else " changes nothing")
