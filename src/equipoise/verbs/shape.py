"""shape: geometry and unknowns together, from screened and seeded starts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from equipoise.assemble import Balancer
from equipoise.design import Design
from equipoise.errors import EquipoiseError, InputError
from equipoise.limits import Limit
from equipoise.mechanism import Mechanism
from equipoise.objective import Aim
from equipoise.parameters import read, write
from equipoise.solve.program import NEGLIGIBLE, Norm
from equipoise.solve.shape import Judge, Optima, by_least_squares, by_limits, descend, sown
from equipoise.solve.sharpen import sharpen, vanish
from equipoise.states import States
from equipoise.sweep import Sweep
from equipoise.tasks import attempt, settle, task_of
from equipoise.tasks.lean import relaxed, spare
from equipoise.tasks.optimum import finish_optimum
from equipoise.tasks.refine import BRIEF, refine
from equipoise.tasks.search import COARSE, Search, freedom_of, load_of, once, thinned
from equipoise.tasks.starts import Progress, descend_all

SOUNDED = 16


def shape(
    mechanism: Mechanism,
    balancers: Sequence[Balancer],
    sweep: Sweep,
    free: Mapping[str, tuple[float, float]],
    *,
    norm: Norm | None = None,
    objective: Aim | Sequence[Aim] | None = None,
    limits: Sequence[Limit] = (),
    starts: int = 24,
    seed: int = 0,
    progress: Progress | None = None,
) -> Design:
    """Find geometry parameters within bounds together with all unknowns.

    free maps parameter names such as `s1.path.line.0.z` to (low, high), SI; `s*.path.line.0.z` is one parameter that
    all balancers whose names match share. Geometries are screened with the
    exact least-squares inner solution, the best and farthest apart become starts, each descends by sequential
    convex programming on few states until it is unlikely that an optimum is still unseen, the best finish on all.
    The same seed gives the same design; progress is called with (starts done, starts, best value). Ctrl-C ends
    the search with the best design so far.
    """
    if not free:
        raise InputError("no geometry is free", where="shape", hint="name parameters with bounds, or use balance")
    if starts < 1:
        raise InputError(f"{starts} starts", where="shape", hint="use at least one")
    freedoms = tuple(freedom_of(balancers, name, bounds) for name, bounds in free.items())
    once(balancers, free)
    open_ones = {f.name: (f.lower + f.upper) / 2 for f in freedoms if read(balancers, f.name) is None}
    task = task_of(mechanism, write(balancers, open_ones), sweep, norm, objective, limits)
    search = Search(task, freedoms)
    states = mechanism.states(sweep)
    load, judge = load_of(task, states), by_least_squares
    called_up = _called_up(search, states, seed)
    if load <= NEGLIGIBLE * called_up:
        load, judge = called_up, by_limits
    elif not load > 0:
        raise InputError(
            "nothing loads what counts, and no limit asks the springs for anything",
            where="objective",
            hint="check gravity and joints, or ask for a least tension",
        )
    optima = _descend_all(search, states, load, judge, starts, seed, progress)
    if optima.best.excess > 1e-6:
        settle(search.at(optima.best.gamma))
        raise EquipoiseError("the limits cannot be kept within the bounds", where="shape", hint="widen the bounds")
    best = sharpen(search.builder(states), freedoms, optima.best)
    search, best, balanced = refine(search, best, load)
    best, balanced = spare(search, best, balanced, load)
    if (exact := vanish(search.builder(balanced.states), freedoms, best)) is not best:
        whole = attempt(search.at(exact.gamma))
        best, balanced = (exact, whole) if whole.broken is None else (best, balanced)
    balanced = replace(balanced, refined=len(balanced.task.sweep.poses) - len(sweep.poses))
    return finish_optimum(search, replace(optima, found=(best, *optima.found[1:])), balanced)


def descended(
    mechanism: Mechanism,
    balancers: Sequence[Balancer],
    sweep: Sweep,
    free: Mapping[str, tuple[float, float]],
    *,
    objective: Sequence[Aim],
    limits: Sequence[Limit],
    precision: float,
    detour: float,
) -> Design:
    """The local optimum next to a geometry that is nearly one: a single descent over the whole sweep.

    precision is what a further step may still gain, a share of the load; detour by what share of the load the
    objective may rise on the way to an equally good geometry with less stored energy. Raises EquipoiseError where the
    limits cannot be kept.
    """
    freedoms = tuple(freedom_of(balancers, name, bounds) for name, bounds in free.items())
    search = Search(task_of(mechanism, balancers, sweep, None, tuple(objective), limits), freedoms)
    states = mechanism.states(sweep)
    load = load_of(search.task, states)
    here = np.array([read(balancers, freedom.name) for freedom in freedoms], dtype=float)
    options: dict[str, Any] = {"precision": precision, "iterations": BRIEF}
    best = descend(search.builder(states), freedoms, here, load, radius=0.05, **options)
    if best.excess > 1e-6:
        raise EquipoiseError("the limits cannot be kept within the bounds", where="shape", hint="widen the bounds")
    search, best, balanced = refine(search, best, load, **options)
    search, best, balanced = relaxed(search, best, balanced, load, detour)
    balanced = replace(balanced, refined=len(balanced.task.sweep.poses) - len(sweep.poses))
    return finish_optimum(search, Optima((best,), 0), balanced)


def _called_up(search: Search, states: States, seed: int) -> float:
    """What the limits call up by themselves: the median over geometries in the bounds; zero where they do not."""
    build = search.builder(states.take(slice(None, None, 1 + len(states) // COARSE)))
    gammas = sown(search.freedoms, SOUNDED, seed)
    sounded = build(gammas)
    found = [sounded.take(index).called_up for index in range(len(gammas))]
    return float(np.median([value for value in found if value > 0] or [0.0]))


def _descend_all(
    search: Search,
    states: States,
    load: float,
    judge: Judge,
    starts: int,
    seed: int,
    progress: Progress | None,
) -> Optima:
    """All starts on few states, the best few distinct ones again on all."""
    task = search.task
    few = task.mechanism.states(thinned(task.sweep, states)) if len(task.sweep.poses) > COARSE else states
    fine = None if few is states else search.builder(states)
    begin = search.present
    return descend_all(
        search.builder(few),
        fine,
        search.freedoms,
        begin,
        load,
        rows=len(few),
        judge=judge,
        starts=starts,
        seed=seed,
        progress=progress,
    )
