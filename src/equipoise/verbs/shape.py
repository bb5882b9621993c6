"""shape: geometry and unknowns together, from screened and seeded starts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from equipoise.affine import Array, Geometry
from equipoise.assemble import Balancer, effort, thrift
from equipoise.design import Active, Design
from equipoise.errors import EquipoiseError, InputError
from equipoise.floors import floors
from equipoise.limits import Limit
from equipoise.mechanism import Mechanism
from equipoise.objective import Aim
from equipoise.parameters import candidates, reaches, read, unit_of, write
from equipoise.solve.exchange import solve
from equipoise.solve.program import NEGLIGIBLE, Norm, Program
from equipoise.solve.shape import (
    Build,
    Freedom,
    Judge,
    Local,
    Optima,
    by_least_squares,
    by_limits,
    descend,
    distinct,
    linearise,
    screen,
    sown,
    spread_out,
)
from equipoise.solve.sharpen import sharpen, vanish
from equipoise.states import States
from equipoise.sweep import Sweep
from equipoise.units import text
from equipoise.verbs.balance import Balanced, Task, certify, finish, settle, task_of

COARSE = 400
PER_START = 24
REFINED = 4
BRIEF = 25
"""Steps of a descent from a geometry that is nearly optimal."""
SOUNDED = 16
NOTHING = 1e-8
"""Share of the load below which a start has found an exact balance, which no other can better."""
ALIKE = 1e-3
"""Share by which values may differ and the stored energy still decide."""
SLACK = 2e-7
"""Share of the objective that may be given for less stored energy."""

Progress = Callable[[int, int, float], None]


@dataclass(frozen=True, eq=False)
class _Search:
    """A task with its freedoms: builders over few and over all states."""

    task: Task
    freedoms: tuple[Freedom, ...]

    def builder(self, states: States) -> Build:
        """gamma (C, G) -> the program of all candidates at once."""
        names = [freedom.name for freedom in self.freedoms]
        return lambda gamma: self.task.program(states, candidates(self.task.balancers, names, gamma))

    def over(self, sweep: Sweep) -> _Search:
        """The same search over another sweep."""
        return replace(self, task=replace(self.task, sweep=sweep))

    def at(self, gamma: Array) -> Task:
        """The task at one geometry."""
        values = {freedom.name: float(value) for freedom, value in zip(self.freedoms, gamma, strict=True)}
        return replace(self.task, balancers=write(self.task.balancers, values))


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
    search = _Search(task, freedoms)
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
    search, best, balanced = _refine(search, best, load)
    best, balanced = _spare(search, best, balanced, load)
    if (exact := vanish(search.builder(balanced.states), freedoms, best)) is not best:
        best, balanced = exact, settle(search.at(exact.gamma))
    balanced = replace(balanced, refined=len(balanced.task.sweep.poses) - len(sweep.poses))
    return _finish(search, replace(optima, found=(best, *optima.found[1:])), balanced)


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
    search = _Search(task_of(mechanism, balancers, sweep, None, tuple(objective), limits), freedoms)
    states = mechanism.states(sweep)
    load = load_of(search.task, states)
    here = np.array([read(balancers, freedom.name) for freedom in freedoms], dtype=float)
    options: dict[str, Any] = {"precision": precision, "iterations": BRIEF}
    best = descend(search.builder(states), freedoms, here, load, radius=0.05, **options)
    if best.excess > 1e-6:
        raise EquipoiseError("the limits cannot be kept within the bounds", where="shape", hint="widen the bounds")
    search, best, balanced = _refine(search, best, load, **options)
    search, best, balanced = _relaxed(search, best, balanced, load, detour)
    balanced = replace(balanced, refined=len(balanced.task.sweep.poses) - len(sweep.poses))
    return _finish(search, Optima((best,), 0), balanced)


def freedom_of(balancers: Sequence[Balancer], name: str, bounds: tuple[float, float]) -> Freedom:
    """One parameter with its bounds; raises InputError where they are none."""
    low, high = (float(bound) for bound in bounds)
    if not (np.isfinite(low) and np.isfinite(high)):
        raise InputError(f"the bounds of {name} are not finite", where=f"shape.{name}")
    if low >= high:
        raise InputError(
            f"the bounds of {name} are reversed or equal: [{low:g}, {high:g}]",
            where=f"shape.{name}",
            hint="write the lower bound first, or give the value in the balancer instead",
        )
    return Freedom(name, unit_of(balancers, name), low, high)


def once(balancers: Sequence[Balancer], free: Mapping[str, tuple[float, float]]) -> None:
    """Raise InputError where two names free the same parameter."""
    owner: dict[str, str] = {}
    for name in free:
        for parameter in reaches(balancers, name):
            if parameter in owner:
                raise InputError(
                    f"{owner[parameter]} and {name} free the same parameter", where=f"shape.{name}", hint="keep one"
                )
            owner[parameter] = name


def load_of(task: Task, states: States) -> float:
    """The objective of the bare mechanism, which makes tolerances and penalties relative; zero without any load."""
    load = 0.0
    for aim in task.objective:
        bare = effort(task.mechanism, (), states, aim.goal, aim.pole)
        if aim.cap is None and np.any(bare.b):
            load += aim.weight * aim.term(task.mechanism, bare, states.weight, bare).value(np.zeros(0))
    return load


def _called_up(search: _Search, states: States, seed: int) -> float:
    """What the limits call up by themselves: the median over geometries in the bounds; zero where they do not."""
    build = search.builder(states.take(slice(None, None, 1 + len(states) // COARSE)))
    gammas = sown(search.freedoms, SOUNDED, seed)
    sounded = build(gammas)
    found = [sounded.take(index).called_up for index in range(len(gammas))]
    return float(np.median([value for value in found if value > 0] or [0.0]))


def _descend_all(
    search: _Search,
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
    begin = _present(search)
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


def descend_all(
    coarse: Build,
    fine: Build | None,
    freedoms: Sequence[Freedom],
    present: Array | None,
    load: float,
    *,
    rows: int,
    judge: Judge,
    starts: int,
    seed: int,
    progress: Progress | None,
) -> Optima:
    """All starts over few states, `rows` of them, the present geometry first; the best distinct ones again over all."""
    if present is not None and starts == 1:
        begin = present
    else:
        ranked, _ = screen(coarse, rows, freedoms, PER_START * starts, seed, 10 * load, judge)
        begin = spread_out(ranked, freedoms, starts)
        begin = begin if present is None else np.vstack([present, begin[: starts - 1]])
    found: list[Local] = []
    try:
        for done, gamma in enumerate(begin, 1):
            found.append(descend(coarse, freedoms, gamma, load, precision=1e-9 if fine is None else 1e-7))
            if progress:
                progress(done, len(begin), min(local.merit for local in found))
            if _settled(found, load):
                break
    except KeyboardInterrupt:
        if not found:
            raise
    found.sort(key=lambda local: local.merit)
    if fine is not None:
        finalists = _distinct(found, freedoms, 3)
        polished = [descend(fine, freedoms, local.gamma, load, radius=0.05) for local in finalists]
        rest = [local for local in found if local not in finalists]
        found = sorted(polished, key=lambda local: local.merit) + rest
    return Optima(tuple(found), seed)


def _settled(found: list[Local], load: float) -> bool:
    """Whether one start leaves nothing of the load, or all so far make it unlikely that an optimum is still unseen.

    n starts that ended in w optima let expect w (n - 1) / (n - w - 2) of them in all (Boender and Rinnooy Kan,
    unsourced); the search ends when that is less than half an optimum more than were seen.
    """
    if min(local.merit for local in found) <= NOTHING * load:
        return True
    n, w = len(found), distinct(found)
    return n > w + 2 and w * (n - 1) / (n - w - 2) < w + 0.5


def _distinct(found: list[Local], freedoms: Sequence[Freedom], count: int) -> list[Local]:
    """The best local optima that differ in value or place."""
    chosen: list[Local] = []
    for local in found:
        near = any(
            all(
                abs(a - b) <= 1e-2 * (f.upper - f.lower) for a, b, f in zip(local.gamma, o.gamma, freedoms, strict=True)
            )
            for o in chosen
        )
        if not near:
            chosen.append(local)
        if len(chosen) == count:
            break
    return chosen


def thinned(sweep: Sweep, states: States, count: int = COARSE) -> Sweep:
    """About `count` of the sweep's poses: an even choice and the most loaded ones."""
    even = np.linspace(0, len(sweep.poses) - 1, count * 3 // 4).astype(int)
    loads = np.abs(states.holding).reshape(len(sweep.scenarios), len(sweep.poses), -1).max(axis=0)
    heavy = np.argsort(-loads, axis=0)[: max(1, count // 4 // loads.shape[1])].ravel()
    keep = np.union1d(even, heavy)
    return sweep.thinned(keep)


def _present(search: _Search) -> Array | None:
    """The given geometry as a start, where it lies inside the bounds."""
    gamma = [read(search.task.balancers, freedom.name) for freedom in search.freedoms]
    inside = [v is not None and f.lower <= v <= f.upper for f, v in zip(search.freedoms, gamma, strict=True)]
    return np.array([gamma], dtype=float) if all(inside) else None


def _refine(search: _Search, best: Local, load: float, **options: Any) -> tuple[_Search, Local, Balanced]:
    """Add the poses between the samples that exceed the peak, and descend again, until none does."""
    balanced = settle(search.at(best.gamma))
    for _ in range(REFINED):
        if not balanced.refined:
            break
        search = search.over(balanced.task.sweep)
        best = descend(search.builder(balanced.states), search.freedoms, best.gamma, load, radius=0.02, **options)
        balanced = settle(search.at(best.gamma))
    return search.over(balanced.task.sweep), best, balanced


def _spare(search: _Search, best: Local, balanced: Balanced, load: float) -> tuple[Local, Balanced]:
    """Among equally good geometries the one with the least stored energy, equally good between the samples too."""
    value = max(balanced.solution.objective, 1e-9 * load)
    if len([aim for aim in search.task.objective if aim.cap is None]) > 1:
        return best, balanced
    for _ in range(REFINED):
        # Half of the slack is left to what the search between the samples finds.
        thrifty = _thrifty(search, best, value * (1 + SLACK / 2))
        if thrifty is None:
            break
        found = settle(search.at(thrifty.gamma))
        if found.solution.objective <= value * (1 + SLACK):
            return thrifty, found
        if not found.refined:
            break
        search = search.over(found.task.sweep)
    return best, balanced


def _relaxed(
    search: _Search, best: Local, balanced: Balanced, load: float, detour: float
) -> tuple[_Search, Local, Balanced]:
    """As `_spare`, by way of geometries that are worse by a share of the load: curved valleys have no other way."""
    states = search.task.mechanism.states(search.task.sweep)
    few = thinned(search.task.sweep, states) if len(search.task.sweep.poses) > COARSE else search.task.sweep
    value = max(balanced.solution.objective, NOTHING * load)
    thrifty = _thrifty(search.over(few), best, value + detour * load)
    if thrifty is None:
        return search, best, balanced
    options: dict[str, Any] = {"precision": 0.1 * ALIKE * value / load, "iterations": BRIEF}
    back = descend(search.builder(states), search.freedoms, thrifty.gamma, load, radius=0.02, **options)
    wider, back, found = _refine(search, back, load, **options)
    as_good = back.excess <= 1e-6 and found.solution.objective <= value * (1 + ALIKE)
    spared = _stored(search, back, found) < _stored(search, best, balanced)
    return (wider, back, found) if as_good and spared else (search, best, balanced)


def _stored(search: _Search, at: Local, balanced: Balanced) -> float:
    """The largest stored energy of a solution, J."""
    energy = thrift(balanced.program, search.at(at.gamma).balancers, balanced.states, 1.0).terms[0]
    return float(energy.value(balanced.solution.theta))


def _thrifty(search: _Search, best: Local, value: float) -> Local | None:
    """The geometry that keeps the objective below a value with the least stored energy, if that is worth a move."""
    states = search.task.mechanism.states(search.task.sweep)
    names = [freedom.name for freedom in search.freedoms]
    plain = search.builder(states)

    def lean(gamma: Geometry) -> Program:
        return thrift(plain(gamma), candidates(search.task.balancers, names, gamma), states, value)

    start = lean(best.gamma[None]).take(0)
    present = solve(plain(best.gamma[None]).take(0))
    stored = start.terms[0].value(present.theta)
    if not stored > 0:
        return None
    thrifty = descend(lean, search.freedoms, best.gamma, stored, radius=0.1, iterations=30, precision=1e-5)
    worth = thrifty.solution.objective <= 0.99 * stored or present.objective > value
    return replace(best, gamma=thrifty.gamma) if thrifty.excess <= 1e-6 and worth else None


def _finish(search: _Search, optima: Optima, balanced: Balanced) -> Design:
    task, best = balanced.task, optima.best
    aim = next(aim for aim in task.objective if aim.cap is None)
    unit = aim.unit(task.mechanism)
    inner = certify(balanced)
    theta = balanced.solution.theta
    wide = linearise(search.builder(balanced.states), search.freedoms, best.gamma, theta)
    sizes = np.concatenate([np.abs(theta), [f.upper - f.lower for f in search.freedoms]])
    bound = [
        Active(
            f"{f.name} {'<=' if price > 0 else '>='} {text(f.upper if price > 0 else f.lower, f.unit)}",
            float(abs(price)),
            f"{unit} per {f.unit}" if f.unit else unit,
        )
        for f, price in zip(search.freedoms, best.prices, strict=True)
        if abs(price) * (f.upper - f.lower) > 1e-6 * max(balanced.solution.objective, 1e-300)
    ]
    merits = [local.merit for local in optima.found]
    certificate = replace(
        inner,
        kind="exact" if inner.kind == "exact" else "local",
        starts=len(optima.found),
        optima=optima.distinct,
        spread=float(max(merits) - min(merits)),
        stationarity=best.stationarity,
        active=tuple(bound) + inner.active,
        floors=floors(
            wide,
            np.append(theta, np.zeros(len(search.freedoms))),
            sizes,
            aim.counted(task.mechanism),
            len(task.sweep.scenarios),
        ),
        flat=inner.flat + _flat(search, wide, balanced, best),
    )
    geometry = {f.name: float(value) for f, value in zip(search.freedoms, best.gamma, strict=True)}
    bounds = {f.name: (f.lower, f.upper) for f in search.freedoms}
    return finish(balanced, certificate, geometry, bounds, {f.name: f.unit for f in search.freedoms}, optima.seed)


def _flat(search: _Search, program: Program, balanced: Balanced, best: Local) -> tuple[str, ...]:
    """Directions of geometry and unknowns along which the optimum does not change to first order."""
    term = next(term for term in program.terms if term.cap is None)
    low = np.array([f.lower for f in search.freedoms])
    high = np.array([f.upper for f in search.freedoms])
    inside = (best.gamma - low > 1e-6 * (high - low)) & (high - best.gamma > 1e-6 * (high - low))
    theta = balanced.solution.theta
    free = np.concatenate([np.ones(len(theta), dtype=bool), inside])
    scale = np.concatenate([np.maximum(np.abs(theta), 1e-12), high - low])
    magnitude = term.magnitudes(term.residual(np.concatenate([theta, np.zeros(len(low))])))
    if term.norm == "peak":
        state, block = np.nonzero(magnitude >= magnitude.max() * (1 - 1e-5))
        slopes = term.A[state, block]
    else:
        slopes = term.triangle[:, :-1]
    slopes = (slopes * scale)[:, free]
    names = np.array([u.name for u in program.unknowns])[free]
    _, singular, vectors = np.linalg.svd(slopes)
    rank = int((singular > 1e-6 * max(program.loads)).sum())
    if rank >= len(names):
        return ()
    loose = np.sqrt((vectors[rank:] ** 2).sum(axis=0))
    words = [str(name) for name, size in zip(names, loose, strict=True) if size > 0.1]
    return (" and ".join(words) + (" trade freely; settled by least stored energy" if len(words) > 1 else " is free"),)
