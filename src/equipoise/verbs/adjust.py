"""adjust: one design for several cases, in which chosen parameters are set anew for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from equipoise.affine import Array, Geometry
from equipoise.assemble import Balancer, thrift
from equipoise.cases import Adjuster, Case, Settings, called, joined, share_of
from equipoise.certificate import Certificate
from equipoise.design import Design
from equipoise.errors import EquipoiseError, InputError, nearest
from equipoise.limits import Limit
from equipoise.objective import Aim, leading
from equipoise.parameters import candidates, read, unit_of, write
from equipoise.peaks import STARTS
from equipoise.solve.exchange import Solution, solve
from equipoise.solve.program import Norm, Program
from equipoise.solve.shape import Build, Freedom, Local, Optima, by_least_squares, descend
from equipoise.solve.sharpen import vanish
from equipoise.states import States
from equipoise.tasks import Balanced, Task, active_limits, between, finish, is_exact, task_of
from equipoise.verbs.shape import COARSE, REFINED, Progress, descend_all, freedom_of, load_of, once, thinned

NO_EFFECT = 1e-12
SPARED = 200
"""States of a case over which stored energy is judged."""

Ranges = Mapping[str, tuple[float, float] | None]


@dataclass(frozen=True, eq=False)
class Adjusted:
    """One design that serves several cases: what it is in each, and the settings that lead from one to the next."""

    labels: tuple[str, ...]
    designs: tuple[Design, ...]

    @property
    def adjusters(self) -> tuple[Adjuster, ...]:
        """What is set anew for each case."""
        settings = self.designs[0].settings
        return () if settings is None else settings.adjusters

    @property
    def hardest(self) -> int:
        """Number of the case that loads the mechanism most."""
        return int(np.argmax([max(row.peak for row in design.before.values()) for design in self.designs]))

    def json(self) -> dict[str, Any]:
        """The hardest case's design.json, with the settings and every case's design."""
        cases = [{"case": label} | design.json() for label, design in zip(self.labels, self.designs, strict=True)]
        return self.designs[self.hardest].json() | {"cases": cases}

    def __str__(self) -> str:
        from equipoise.reporting.settings import summary

        return summary(self)


@dataclass(frozen=True, eq=False)
class _Family:
    """The tasks of all cases, what they share, and what each sets for itself."""

    labels: tuple[str, ...]
    tasks: tuple[Task, ...]
    shared: tuple[Freedom, ...]
    adjusted: tuple[Freedom, ...]
    unknowns: Mapping[str, tuple[float, float] | None]

    @property
    def freedoms(self) -> tuple[Freedom, ...]:
        """Shared geometry first, then every case's own."""
        own = [replace(f, name=called(f.name, label)) for label in self.labels for f in self.adjusted]
        return (*self.shared, *own)

    def columns(self, case: int) -> list[int]:
        """Which of all freedoms a case sees."""
        first = len(self.shared) + case * len(self.adjusted)
        return [*range(len(self.shared)), *range(first, first + len(self.adjusted))]

    def placed(self, case: int, gamma: Geometry) -> tuple[Balancer, ...]:
        """The balancers of a case at candidates gamma (C, G)."""
        names = [f.name for f in (*self.shared, *self.adjusted)]
        return candidates(self.tasks[case].balancers, names, gamma[:, self.columns(case)])

    def programs(self, states: Sequence[States], gamma: Geometry) -> list[Program]:
        """Every case's own program at candidates gamma."""
        return [
            task.program(states[i], self.placed(i, gamma) if len(self.freedoms) else None)
            for i, task in enumerate(self.tasks)
        ]

    def builder(self, states: Sequence[States]) -> Build:
        """gamma (C, G) -> the common program."""
        return lambda gamma: joined(self.programs(states, gamma), self.labels, self.unknowns)

    def at(self, gamma: Array) -> tuple[Task, ...]:
        """The tasks at one geometry."""
        names = [f.name for f in (*self.shared, *self.adjusted)]
        found = []
        for i, task in enumerate(self.tasks):
            values = {name: float(v) for name, v in zip(names, gamma[self.columns(i)], strict=True)}
            found.append(replace(task, balancers=write(task.balancers, values)))
        return tuple(found)

    @cached_property
    def states(self) -> list[States]:
        """The states of every case's sweep."""
        return [task.mechanism.states(task.sweep) for task in self.tasks]


def adjust(
    cases: Sequence[Case],
    balancers: Sequence[Balancer],
    adjusters: Ranges,
    free: Mapping[str, tuple[float, float]] | None = None,
    *,
    norm: Norm | None = None,
    objective: Aim | Sequence[Aim] | None = None,
    limits: Sequence[Limit] = (),
    starts: int = 24,
    seed: int = 0,
    progress: Progress | None = None,
) -> Adjusted:
    """One design for several cases: adjusters take a value for each, everything else is shared.

        min over shared and own values of N over all cases' residuals r_s = b_s + A_s(gamma, gamma_s) (theta, theta_s)

    cases are payloads (`by_payload`), patients, tilts: a mechanism and a sweep each, all of one weight. adjusters maps
    names of unknowns (`s1.k`) or of geometry (`s1.path.line.0.z`) to bounds (low, high), SI; None leaves an unknown
    its natural ones. free is shared geometry, as in `shape`. Without adjusters one and the same design serves all cases
    and the worst counts. Among equals the least stored energy is taken. Raises InputError for an adjuster that is no
    parameter, that is shared geometry too, or that nothing depends on, and for adjusters with a single case.
    """
    family = _family(cases, balancers, adjusters, free or {}, norm, objective, limits)
    states = family.states
    load = max(load_of(task, own) for task, own in zip(family.tasks, states, strict=True))
    if not load > 0:
        raise InputError("nothing loads what counts", where="objective", hint="check gravity, joints and payloads")
    _insist_on_effect(family, states, load)
    optima = _searched(family, states, load, starts, seed, progress)
    if optima.best.excess > 1e-6:
        raise EquipoiseError("the limits cannot be kept in all cases", where="adjust", hint="widen the bounds")
    family, best = _refined(family, optima.best, load)
    best = _spared(family, best, load)
    best = vanish(family.builder(family.states), family.freedoms, best)
    return _finished(family, replace(optima, found=(best, *optima.found[1:])))


def _family(
    cases: Sequence[Case],
    balancers: Sequence[Balancer],
    adjusters: Ranges,
    free: Mapping[str, tuple[float, float]],
    norm: Norm | None,
    objective: Aim | Sequence[Aim] | None,
    limits: Sequence[Limit],
) -> _Family:
    labels = tuple(case.label for case in cases)
    if len(set(labels)) < len(labels):
        raise InputError(f"two cases are called alike: {', '.join(labels)}", where="cases")
    if adjusters and len(cases) < 2:
        raise InputError(
            "there is one case only, so there is nothing to adjust to",
            where="adjust",
            hint="give the payload several masses, or several `cases`",
        )
    unknowns = {unknown.name for balancer in balancers for unknown in balancer.unknowns}
    own = {name: bounds for name, bounds in adjusters.items() if name in unknowns}
    moved = {name: _bounded(name, bounds, balancers, unknowns) for name, bounds in adjusters.items() if name not in own}
    for name, bounds in own.items():
        if bounds is not None and not bounds[0] < bounds[1]:
            raise InputError(f"the bounds of {name} are reversed or equal", where=f"adjust.{name}")
    once(balancers, {**free, **moved})
    shared, adjusted = (tuple(freedom_of(balancers, *item) for item in part.items()) for part in (free, moved))
    middle = {f.name: (f.lower + f.upper) / 2 for f in (*shared, *adjusted) if read(balancers, f.name) is None}
    opened = write(balancers, middle)
    tasks = tuple(task_of(case.mechanism, opened, case.sweep, norm, objective, limits) for case in cases)
    return _Family(labels, tasks, shared, adjusted, own)


def _bounded(
    name: str, bounds: tuple[float, float] | None, balancers: Sequence[Balancer], unknowns: set[str]
) -> tuple[float, float]:
    """Bounds of adjusted geometry, which must have some; raises InputError for a name that leads nowhere."""
    try:
        unit_of(balancers, name)
        read(balancers, name)
    except InputError as error:
        known = nearest(name, sorted(unknowns))
        error.where, error.hint = f"adjust.{name}", error.hint or known
        raise
    if bounds is None:
        raise InputError(
            f"{name} is geometry, its adjuster needs a range", where=f"adjust.{name}", hint=f"{name}: [low, high]"
        )
    return bounds


def _insist_on_effect(family: _Family, states: Sequence[States], load: float) -> None:
    """Raise InputError for an adjuster that changes no residual of any case, wherever it stands."""
    from equipoise.solve.shape import linearise, sown

    count = 4 if family.freedoms else 1
    places = sown(family.freedoms, count, 1)[:count] if family.freedoms else np.zeros((1, 0))
    few = [own.take(slice(None, None, 1 + len(own) // 50)) for own in states]
    moved = dict.fromkeys((*family.unknowns, *(f.name for f in family.adjusted)), 0.0)
    for gamma in places:
        program = family.builder(few)(gamma[None]).take(0)
        theta = np.where(program.lower > 0, program.lower, program.scale)
        wide = linearise(family.builder(few), family.freedoms, gamma, theta) if family.freedoms else program
        spans = [f.upper - f.lower for f in family.freedoms]
        sizes = np.concatenate([program.scale, spans])
        for unknown, size, column in zip(wide.unknowns, sizes, range(len(sizes)), strict=True):
            name, at, _ = unknown.name.partition(" @ ")
            if at:
                effect = max(float(np.abs(term.A[..., column]).max()) * size for term in wide.terms)
                moved[name] = max(moved[name], effect)
    for name, effect in moved.items():
        if effect <= NO_EFFECT * load:
            raise InputError(
                f"nothing depends on {name}: no effort changes with it at any pose of any case",
                where=f"adjust.{name}",
                hint="adjust a parameter that acts on a joint that counts",
            )


def _searched(
    family: _Family, states: Sequence[States], load: float, starts: int, seed: int, progress: Progress | None
) -> Optima:
    """The best geometries; without free geometry the one solution that there is."""
    if not family.freedoms:
        solution = solve(family.builder(states)(np.zeros((1, 0))))
        return Optima((Local(np.zeros(0), solution.objective, 0.0, 0.0, solution, np.zeros(0)),), seed)
    share = COARSE // len(states) + 20
    few = [
        task.mechanism.states(thinned(task.sweep, own)) if len(task.sweep.poses) > share else own
        for task, own in zip(family.tasks, states, strict=True)
    ]
    same = all(one is other for one, other in zip(few, states, strict=True))
    fine = None if same else family.builder(states)
    present = [read(family.tasks[0].balancers, f.name.partition(" @ ")[0]) for f in family.freedoms]
    inside = all(v is not None and f.lower <= v <= f.upper for v, f in zip(present, family.freedoms, strict=True))
    begin = np.array([present], dtype=float) if inside else None
    return descend_all(
        family.builder(few),
        fine,
        family.freedoms,
        begin,
        load,
        rows=sum(len(own) for own in few),
        judge=by_least_squares,
        starts=starts,
        seed=seed,
        progress=progress,
    )


def _resolved(family: _Family, best: Local, load: float) -> Local:
    if not family.freedoms:
        solution = solve(family.builder(family.states)(np.zeros((1, 0))))
        return replace(best, merit=solution.objective, solution=solution)
    return descend(family.builder(family.states), family.freedoms, best.gamma, load, radius=0.02)


def _refined(family: _Family, best: Local, load: float) -> tuple[_Family, Local]:
    """Add the poses between the samples that exceed a case's share of the peak, and solve again, until none does."""
    for _ in range(REFINED):
        found = _parted(family, best)
        level = best.solution.objective
        more = [between(b.task, b.states, b.program, b.solution, STARTS, level) for b in found]
        if not any(len(places) for places in more):
            break
        tasks = tuple(
            replace(task, sweep=task.sweep.extended(places)) if len(places) else task
            for task, places in zip(family.tasks, more, strict=True)
        )
        family = replace(family, tasks=tasks)
        best = _resolved(family, best, load)
    return family, best


def _spared(family: _Family, best: Local, load: float) -> Local:
    """Among equally good designs the one with the least peak of stored energy."""
    terms = [term for term in best.solution.program.terms if term.cap is None]
    if not family.freedoms or len(terms) > 1:
        return best
    few = [own.take(slice(None, None, 1 + len(own) // SPARED)) for own in family.states]
    value = max(best.solution.objective, 1e-9 * load) * (1 + 1e-7)

    def lean(gamma: Geometry) -> Program:
        programs = [
            thrift(program, family.placed(i, gamma), few[i], value)
            for i, program in enumerate(family.programs(few, gamma))
        ]
        return joined(programs, family.labels, family.unknowns)

    start = lean(best.gamma[None]).take(0)
    stored = start.terms[0].value(solve(family.builder(few)(best.gamma[None]).take(0)).theta)
    if not stored > 0:
        return best
    thrifty = descend(lean, family.freedoms, best.gamma, stored, radius=0.1, iterations=30, precision=1e-5)
    if thrifty.excess > 1e-6 or thrifty.solution.objective > 0.99 * stored:
        return best
    solution = solve(family.builder(family.states)(thrifty.gamma[None]).take(0), elastic=30 * load)
    kept = solution.objective <= best.solution.objective * (1 + 1e-6) + 1e-8 * load and solution.excess <= 1e-6
    return replace(best, gamma=thrifty.gamma, merit=solution.objective, solution=solution) if kept else best


def _parted(family: _Family, best: Local) -> list[Balanced]:
    """Every case's own program with its share of the common solution."""
    states = family.states
    tasks, common = family.at(best.gamma), best.solution
    found = []
    for i, (task, own) in enumerate(zip(tasks, states, strict=True)):
        program = task.program(own)
        theta = share_of(common.program, common.theta, program, family.labels[i], family.unknowns)
        theta = np.clip(theta, program.lower, program.upper)
        solution = Solution(theta, program, common.working, common.answer)
        found.append(Balanced(task, own, program, solution, 0))
    return found


def _finished(family: _Family, optima: Optima) -> Adjusted:
    best = optima.best
    parts = _parted(family, best)
    names = [f.name for f in (*family.shared, *family.adjusted)]
    bounds = {f.name: (f.lower, f.upper) for f in (*family.shared, *family.adjusted)}
    units = {f.name: f.unit for f in (*family.shared, *family.adjusted)}
    certificate = _certificate(family, optima, parts)
    designs = [
        finish(
            balanced,
            certificate,
            {name: float(v) for name, v in zip(names, best.gamma[family.columns(i)], strict=True)},
            bounds,
            units,
            optima.seed,
        )
        for i, balanced in enumerate(parts)
    ]
    every = (*family.unknowns, *(f.name for f in family.adjusted))
    adjusters = tuple(_adjuster(family, designs, name) for name in every)
    counted = {row for aim in family.tasks[0].objective for row in aim.counted(family.tasks[0].mechanism)}
    peaks = tuple(max(design.after[row].peak for row in counted) for design in designs)
    shown = [replace(design, settings=Settings(i, family.labels, adjusters, peaks)) for i, design in enumerate(designs)]
    return Adjusted(family.labels, tuple(shown))


def _certificate(family: _Family, optima: Optima, parts: Sequence[Balanced]) -> Certificate:
    """`exact` where every case is, else `local` over free geometry or `convex`."""
    best, aim = optima.best, leading(family.tasks[0].objective)
    unit = aim.unit(family.tasks[0].mechanism)
    program = best.solution.program
    merits = [local.merit for local in optima.found]
    exact = all(is_exact(part) for part in parts)
    return Certificate(
        kind="exact" if exact else "local" if family.freedoms else "convex",
        primal=program.objective(best.solution.theta),
        dual=min(best.solution.gap.dual, program.objective(best.solution.theta)),
        unit=unit,
        violation=max(0.0, program.violation(best.solution.theta)),
        starts=len(optima.found) if family.freedoms else 0,
        optima=optima.distinct if family.freedoms else 0,
        spread=float(max(merits) - min(merits)),
        stationarity=best.stationarity,
        active=active_limits(program, best.solution, unit),
    )


def _adjuster(family: _Family, designs: Sequence[Design], name: str) -> Adjuster:
    """Values of one adjuster, and the work that turning it takes with everything else held."""
    values = tuple({**d.geometry, **d.values}[name] for d in designs)
    if name in family.unknowns:
        return Adjuster(name, designs[0].units[name], values)
    work = tuple(_work(designs[0], design, name) for design in designs)
    return Adjuster(name, designs[0].units[name], values, work)


def _work(first: Design, then: Design, name: str) -> tuple[float, float]:
    """Least and greatest change of the stored energy over the poses, J, as one parameter goes to another case's."""
    from equipoise.assemble import storage

    moved = write(first.balancers, {name: then.geometry[name]})
    energies = []
    for balancers in (first.balancers, moved):
        stored = storage(balancers, first.states)
        theta = np.array([first.values[unknown.name] for unknown in stored.unknowns])
        energies.append((stored.b + stored.A @ theta).sum(axis=-1))
    change = energies[1] - energies[0]
    return float(change.min()), float(change.max())
