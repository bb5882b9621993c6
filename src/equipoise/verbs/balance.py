"""balance: the best values of all unknowns at a given geometry, with a certificate."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from equipoise.affine import Array, Block, Indices, Unknown, magnitudes
from equipoise.assemble import Balancer, account, build, check, effort, thrift
from equipoise.balancers.counterweight import Counterweight
from equipoise.balancers.spring import Spring
from equipoise.design import Active, Certificate, Design
from equipoise.errors import EquipoiseError, InfeasibleError, InputError
from equipoise.floors import floors
from equipoise.limits import Balanced as InAllMotions
from equipoise.limits import Limit, OverInterval
from equipoise.limits.balanced import WORDS
from equipoise.loops import reachable
from equipoise.mechanism import Mechanism
from equipoise.motion.moves import Free
from equipoise.objective import Aim, as_objective, goal_blocks
from equipoise.peaks import STARTS, polish
from equipoise.solve.exchange import Solution, solve
from equipoise.solve.program import Norm, Program, Rows
from equipoise.states import States
from equipoise.steepness import steepness
from equipoise.sweep import Sweep
from equipoise.verbs.analyze import before_and_after

EXACT = 1e-9
ROUNDS = 24
FEW = 6
BETWEEN = 1e-7
NEAR = 0.5
CUTS = 60
SAVED = 20_000
"""States over which stored energy is judged."""
EASED = 1e-6
"""Relative excess of a limit on geometry alone that is let be."""
BETWEEN_LENGTHS = 1e-10
"""Relative excess of a limit over an interval at its worst length."""


@dataclass(frozen=True, eq=False)
class Task:
    """One balancing question: what moves, what is added, where, and what shall be small or kept."""

    mechanism: Mechanism
    balancers: tuple[Balancer, ...]
    sweep: Sweep
    objective: tuple[Aim, ...]
    limits: tuple[Limit, ...]

    def program(self, states: States, balancers: Sequence[Balancer] | None = None) -> Program:
        """The program over given states, at this or another geometry."""
        return build(self.mechanism, balancers or self.balancers, self.sweep, states, self.objective, self.limits)


class StrayedError(InfeasibleError):
    """Limits that hold at the samples do not hold at poses found between them: sweep has these, too."""

    def __init__(self, error: InfeasibleError, sweep: Sweep) -> None:
        super().__init__(error.message, where=error.where, hint=error.hint)
        self.sweep = sweep


@dataclass(frozen=True, eq=False)
class Balanced:
    """A solved task: its states (those found between the samples included), program and solution."""

    task: Task
    states: States
    program: Program
    solution: Solution
    refined: int

    @property
    def values(self) -> dict[str, float]:
        """The solution by name."""
        return {u.name: float(v) for u, v in zip(self.program.unknowns, self.solution.theta, strict=True)}

    def account(self, states: States) -> tuple[tuple[Block, ...], Array]:
        """Blocks and residual (N, R) that the design reports, with the solution's values, at any states."""
        task = self.task
        return account(task.mechanism, task.balancers, states, task.objective, self.values)


def balance(
    mechanism: Mechanism,
    balancers: Sequence[Balancer],
    sweep: Sweep,
    *,
    norm: Norm | None = None,
    objective: Aim | Sequence[Aim] | None = None,
    limits: Sequence[Limit] = (),
) -> Design:
    """Find all unknowns of the balancers at their given geometry: one convex program with a certificate.

    min_theta N(b + A theta) subject to the limits; norm rms, peak or mean (default rms), or `objective` for
    weights, caps, joints and divisors. With a Sobol sweep and the peak norm, poses between the samples that
    exceed the peak are added until none does. Raises InfeasibleError naming the limits that conflict.
    """
    task = task_of(mechanism, balancers, sweep, norm, objective, limits)
    try:
        balanced = settle(task)
    except InfeasibleError as error:
        raise _reasoned(task, error) from None
    return finish(balanced, certify(balanced))


def _reasoned(task: Task, error: InfeasibleError) -> InfeasibleError:
    """Why balance for all motions is out of reach, where added mass alone shall bring it."""
    asked = next((limit for limit in task.limits if isinstance(limit, InAllMotions)), None)
    if asked is None or not all(isinstance(balancer, Counterweight) for balancer in task.balancers):
        return error
    from equipoise.reporting.balance import completion_text
    from equipoise.verbs.conditions import conditions

    on = list(dict.fromkeys(b.at.body for b in task.balancers if isinstance(b, Counterweight)))
    found = conditions(task.mechanism, asked.balanced, on=on).completion
    if found.possible:
        return error
    more = (
        "put counterweights on other bodies too" if asked.balanced == "force" else "add a counter-rotor or a flywheel"
    )
    return InfeasibleError(
        f"{error.message}\n{completion_text(found, WORDS[asked.balanced])}",
        where=error.where,
        hint=f"{more}; `equipoise conditions` lists what masses must keep",
    )


def task_of(
    mechanism: Mechanism,
    balancers: Sequence[Balancer],
    sweep: Sweep,
    norm: Norm | None,
    objective: Aim | Sequence[Aim] | None,
    limits: Sequence[Limit],
) -> Task:
    """Check the pieces of a question and put them together."""
    if not balancers:
        raise InputError("there is no balancer", where="balancers", hint="add a spring or a counterweight")
    check(mechanism, balancers)
    return Task(mechanism, tuple(balancers), sweep, as_objective(norm, objective), tuple(limits))


def settle(task: Task) -> Balanced:
    """Solve at the task's geometry; refine between the samples; settle what is free by least stored energy."""
    started, rounds, starts = len(task.sweep.poses), 0, STARTS
    while True:
        states = task.mechanism.states(task.sweep)
        program = _eased(task.program(states))
        try:
            program, solution = tightened(task, program)
        except InfeasibleError as error:
            if rounds:
                raise StrayedError(error, task.sweep) from None
            raise
        solution = saved(task, states, program, solution)
        # Rounding may leave a value outside its bounds by 1e-10 of its size.
        solution = replace(solution, theta=np.clip(solution.theta, program.lower, program.upper))
        found = between(task, states, program, solution, starts)
        if not len(found) and starts == FEW:
            found = between(task, states, program, solution, STARTS)
        rounds += 1
        if not len(found) or rounds == ROUNDS:
            return Balanced(task, states, program, solution, len(task.sweep.poses) - started)
        task = replace(task, sweep=task.sweep.extended(found))
        # The hills found now are among the samples of the next round: a few starts follow them.
        starts = FEW


def _eased(program: Program) -> Program:
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


def saved(task: Task, states: States, program: Program, solution: Solution) -> Solution:
    """Of all equally good values the ones with the least stored energy; unchanged where nothing is free.

    Directions that change no residual are followed exactly; what else a peak or mean leaves open is settled
    under a cap on the objective.
    """
    if not program.unknowns or len([term for term in program.terms if term.cap is None]) > 1:
        return solution
    if program.terms[0].norm == "rms" and not len(solution.flat):
        return solution
    states = states.take(slice(None, None, 1 + len(states) // SAVED))
    value = max(solution.objective, 1e-13 * sum(program.loads))
    lean = thrift(program, task.balancers, states, value * (1 + 1e-8))
    theta = solution.theta
    if len(solution.flat):
        theta = _spared(lean, theta, lambda: _along(lean, theta, solution.flat))
    if program.terms[0].norm != "rms" and solution.objective > EXACT * sum(program.loads):
        theta = _spared(lean, theta, lambda: solve(lean).theta)
    sound = program.objective(theta) <= value * (1 + 1e-6) and program.violation(theta) <= 1e-7
    return replace(solution, theta=theta) if sound else solution


def _spared(lean: Program, theta: Array, better: Callable[[], Array]) -> Array:
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
    for unknown, bound, sign in [(u, u.lower, -1.0) for u in lean.unknowns] + [
        (u, u.upper, 1.0) for u in lean.unknowns
    ]:
        if np.isfinite(bound):
            index = lean.unknowns.index(unknown)
            limit = sign * (bound - theta[index])
            rows.append(
                Rows(
                    unknown.name,
                    unknown.unit,
                    sign * directions[:, index][None],
                    np.array([limit]),
                    moves,
                    scale=max(abs(theta[index]), abs(bound), 1e-9),
                )
            )
    definite = tuple(
        replace(one, S=np.tensordot(directions, one.S, axes=1), S0=one.matrix(theta), unknowns=moves)
        for one in lean.definite
    )
    return theta + solve(Program(moves, (term,), tuple(rows), definite)).theta @ directions


def between(
    task: Task, states: States, program: Program, solution: Solution, starts: int, level: float | None = None
) -> Array:
    """Poses between the samples whose peak exceeds a level, the solved one by default; none for grids and lists."""
    aims = [aim for aim in task.objective if aim.cap is None]
    if not task.sweep.sampled or len(aims) > 1 or aims[0].norm != "peak" or aims[0].goal == "mass":
        return task.sweep.coordinates[:0]
    aim = aims[0]
    bare = effort(task.mechanism, (), states, aim.goal, aim.pole)
    blocks = goal_blocks(task.mechanism, aim.goal)
    counted = np.array([blocks.index(block) for block in aim.blocks(task.mechanism)])
    factor = aim.scales(task.mechanism) / aim.before(task.mechanism, np.ones(len(states)), bare)

    def whole(other: States) -> tuple[Sequence[Block], Array]:
        found = effort(task.mechanism, task.balancers, other, aim.goal, aim.pole).expand(program.unknowns)
        return blocks, found.at(solution.theta)

    size = magnitudes(whole(states)[1], [block.size for block in blocks])[:, counted] * factor
    sampled = size.reshape(len(task.sweep.scenarios), len(task.sweep.poses), -1).max(axis=0)
    if level is None:
        level = max(term.value(solution.theta) for term in program.terms if term.cap is None)
    # A row far below the level at every sample does not reach it between them.
    near = np.flatnonzero(sampled.max(axis=0) >= NEAR * level)
    probe = steepness(task.mechanism, task.sweep, blocks, whole)

    def scaled(places: Array, rows: Indices) -> tuple[Array, Array]:
        value, slope = probe(places, counted[near[rows]])
        return value * factor[near[rows]], slope * factor[near[rows], None]

    peaks = polish(scaled, task.sweep.coordinates, sampled[:, near], task.sweep.domain, starts)
    load = max(float(np.abs(term.b).max()) for term in program.terms)
    if not (peaks.value > level * (1 + BETWEEN) + 1e-12 * load).any():
        return peaks.hills[:0]
    # Lower hills come along: they rise as soon as the highest are pressed down.
    return _apart(peaks.hills[peaks.height >= NEAR * level], task.sweep.domain)


def _apart(places: Array, domain: Array | None) -> Array:
    """Coordinates that differ from each other by more than 1e-4 of the domain somewhere."""
    if domain is None or not len(places):
        return places
    span = np.where(domain[:, 1] > domain[:, 0], domain[:, 1] - domain[:, 0], 1.0)
    _, first = np.unique(np.round((places - domain[:, 0]) / span, 4), axis=0, return_index=True)
    return places[np.sort(first)]


def finish(
    balanced: Balanced,
    certificate: Certificate,
    geometry: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    units: Mapping[str, str] | None = None,
    seed: int = 0,
) -> Design:
    """Put a solved task into words and tables."""
    task, states, unknowns = balanced.task, balanced.states, balanced.program.unknowns

    def bare(other: States) -> tuple[tuple[Block, ...], Array]:
        return account(task.mechanism, (), other, task.objective, {})

    before, after = before_and_after(task.mechanism, task.sweep, states, bare, balanced.account)
    return Design(
        mechanism=task.mechanism,
        balancers=task.balancers,
        sweep=task.sweep,
        states=states,
        objective=task.objective,
        limits=task.limits,
        values={u.name: float(value) for u, value in zip(unknowns, balanced.solution.theta, strict=True)},
        units={u.name: u.unit for u in unknowns} | dict(units or {}),
        before=before,
        after=after,
        certificate=certificate,
        geometry=dict(geometry or {}),
        bounds=dict(bounds or {}),
        seed=seed,
        refined=balanced.refined,
    )


def certify(balanced: Balanced) -> Certificate:
    """The certificate of a fixed geometry: `exact` where nothing is left, also off the grid, else `convex`."""
    task, program, solution = balanced.task, balanced.program, balanced.solution
    unit = unit_of(task)
    first = next(aim for aim in task.objective if aim.cap is None)
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


def unit_of(task: Task) -> str:
    """Unit of the objective; a sum over goals of different units says so."""
    units = list(dict.fromkeys(aim.unit(task.mechanism) for aim in task.objective if aim.cap is None))
    return units[0] if len(units) == 1 else f"weighted sum of {', '.join(units)}"


def quadrature_error(balanced: Balanced) -> float | None:
    """|N_finer / N - 1| of the objective at the same values, where the sweep knows a finer rule and averages count."""
    task, solution = balanced.task, balanced.solution
    counted = [aim for aim in task.objective if aim.cap is None and aim.norm != "peak"]
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
    for aim in task.objective:
        if aim.cap is None:  # what given parts have balanced already is measured by the bare mechanism
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
    return " and ".join(names) + (" trade freely" if len(names) > 1 else " changes nothing")
