"""adjust: one design for several cases, in which chosen parameters are set anew for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from equipoise.affine import Geometry
from equipoise.assemble import Balancer, thrift
from equipoise.cases import Case, joined
from equipoise.errors import EquipoiseError, InputError, nearest
from equipoise.limits import Limit
from equipoise.objective import Aim
from equipoise.parameters import read, unit_of, write
from equipoise.peaks import STARTS
from equipoise.solve.exchange import solve
from equipoise.solve.program import Norm, Program
from equipoise.solve.shape import Local, Optima, by_least_squares, descend
from equipoise.solve.sharpen import vanish
from equipoise.states import States
from equipoise.tasks.between import between
from equipoise.tasks.family import Family
from equipoise.tasks.refine import REFINED
from equipoise.tasks.search import COARSE, freedom_of, load_of, once, thinned
from equipoise.tasks.starts import Progress, descend_all
from equipoise.tasks.task import task_of
from equipoise.verbs.adjusted import Adjusted, finished

NO_EFFECT = 1e-12
"""Share of the load below which an adjuster changes nothing."""

SPARED = 200
"""States of a case over which stored energy is judged."""

Ranges = Mapping[str, tuple[float, float] | None]


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
    return finished(family, replace(optima, found=(best, *optima.found[1:])))


def _family(
    cases: Sequence[Case],
    balancers: Sequence[Balancer],
    adjusters: Ranges,
    free: Mapping[str, tuple[float, float]],
    norm: Norm | None,
    objective: Aim | Sequence[Aim] | None,
    limits: Sequence[Limit],
) -> Family:
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
    return Family(labels, tasks, shared, adjusted, own)


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


def _insist_on_effect(family: Family, states: Sequence[States], load: float) -> None:
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
    family: Family, states: Sequence[States], load: float, starts: int, seed: int, progress: Progress | None
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


def _resolved(family: Family, best: Local, load: float) -> Local:
    if not family.freedoms:
        solution = solve(family.builder(family.states)(np.zeros((1, 0))))
        return replace(best, merit=solution.objective, solution=solution)
    return descend(family.builder(family.states), family.freedoms, best.gamma, load, radius=0.02)


def _refined(family: Family, best: Local, load: float) -> tuple[Family, Local]:
    """Add the poses between the samples that exceed a case's share of the peak, and solve again, until none does."""
    for _ in range(REFINED):
        found = family.parted(best)
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


def _spared(family: Family, best: Local, load: float) -> Local:
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
