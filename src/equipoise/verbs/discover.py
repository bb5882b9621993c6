"""discover: which springs at all, from a dictionary of candidates; the front of number of springs against residual."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from equipoise.design import Design
from equipoise.discovery.collect import Collection, collect
from equipoise.discovery.front import BETTER, Alternative, Discovery, bounds_of
from equipoise.discovery.refine import PRECISION, Parts, Refined, Refiner, additions, built, judge
from equipoise.discovery.request import Discover
from equipoise.discovery.subsets import Ranked, Search, Subset
from equipoise.errors import EquipoiseError, InfeasibleError, InputError
from equipoise.interference import shell
from equipoise.interference.findings import clashes
from equipoise.limits import Limit
from equipoise.mechanism import Mechanism
from equipoise.objective import Aim, as_objective
from equipoise.solve.program import Norm
from equipoise.sweep import Sweep
from equipoise.verbs.balance import balance
from equipoise.verbs.shape import descended, thinned

JUDGED = 40
"""Subsets per number of springs that are judged by the objective's own norm."""
EXCESS = 1e-5
NOTHING = 1e-6
"""Share of the bare value below which nothing is left."""
FEW = 256
"""Poses over which contenders are refined."""
ALIKE = 0.01
"""Share by which values may differ and still be called alike; the stored energy then decides."""
DETOUR = 1e-3
"""Share of the bare value by which a design may get worse on its way to less stored energy."""

Progress = Callable[[int, int, float], None]


@dataclass(eq=False)
class _Found:
    """What the search has finished so far."""

    designs: list[Design] = field(default_factory=list)
    values: list[float] = field(default_factory=list)
    alternatives: list[Alternative] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    refined: Refined | None = None
    floor: float = 0.0
    stopped: bool = False


def discover(
    mechanism: Mechanism,
    sweep: Sweep | None = None,
    request: Discover | None = None,
    *,
    norm: Norm | None = None,
    objective: Aim | Sequence[Aim] | None = None,
    limits: Sequence[Limit] = (),
    progress: Progress | None = None,
) -> Discovery:
    """Find which springs to add, where, and how big: the front of their number against what motors still hold.

    A dictionary of candidates is compressed to its rank and searched for the best subsets (pairs exhaustively, more
    by a beam with exchange); those that the objective's own norm ranks best, and the design before with the best
    candidate added, are refined by sequential convex programming; the best of each number is shaped over the whole
    sweep (default: 2048 Sobol poses; default norm: peak). progress is called with (numbers done, numbers, value);
    Ctrl-C returns what is finished. Raises InputError for an objective that is not the holding effort,
    InfeasibleError where filters leave no candidate, naming what removed how many.
    """
    request = request or Discover()
    sweep = sweep or Sweep.sobol(mechanism)
    aims = as_objective(norm or ("peak" if objective is None else None), objective)
    counted = [aim for aim in aims if aim.cap is None]
    if len(counted) > 1 or counted[0].goal != "hold":
        raise InputError(
            "discover makes the holding effort small, and nothing else beside it",
            where="objective",
            hint="give one aim with goal hold; others as caps",
        )
    aim = counted[0]
    collection = collect(mechanism, sweep, request, aim)
    compressed = collection.dictionary.compress()
    search = Search.of(compressed, collection.dictionary.spots)
    ranked = search.best(request.springs, keep=JUDGED)
    bounds = bounds_of(collection, sweep, aim)
    found = _Found()
    few = thinned(sweep, mechanism.states(sweep), FEW) if len(sweep.poses) > FEW else sweep
    refiner = Refiner(mechanism, few, aims, limits)
    found.floor = max([bound.value for bound in bounds] + [NOTHING * refiner.bare])
    try:
        for count in range(1, request.springs + 1):
            if found.values and found.values[-1] <= found.floor * (1 + ALIKE):
                found.notes.append(f"the floor is reached with {len(found.designs[-1].balancers)}: no more were tried")
                break
            if count in ranked:
                _one(found, collection, refiner, ranked[count], count, aim)
                if found.refined is not None:
                    _finish(found, refiner, sweep, aim)
            if progress:
                progress(count, request.springs, found.values[-1] if found.values else float("nan"))
    except KeyboardInterrupt:
        if not found.designs:
            raise
        found.stopped = True
    if not found.designs:
        raise InfeasibleError(
            "no subset of the candidates gains anything within the limits",
            where="discover",
            hint="relax the limits, or widen margin and spacing",
        )
    return Discovery(
        designs=tuple(found.designs),
        aim=aim,
        unit=aim.unit(mechanism),
        before=_before(found.designs[0], aim),
        alternatives=tuple(found.alternatives),
        bounds=bounds,
        candidates=len(collection.dictionary),
        poses=len(collection.states),
        rank=compressed.rank,
        lost=compressed.lost,
        spacing=collection.spacing,
        margin=collection.margin,
        refused=collection.refused,
        pairs=tuple(dict.fromkeys(batch.place for batch in collection.dictionary.batches)),
        notes=(*found.notes, f"clashes are judged by capsules {shell(mechanism, request.radius).words}"),
        clashes=tuple(clashes(design, request.radius) for design in found.designs),
        stopped=found.stopped,
        values=tuple(found.values),
    )


def _before(design: Design, aim: Aim) -> float:
    """The objective's norm without any part."""
    return replace(design, after=design.before).reached(aim)


def _one(found: _Found, collection: Collection, refiner: Refiner, ranked: Ranked, count: int, aim: Aim) -> None:
    """Refine the contenders of one number of springs and keep the best."""
    contenders = _contenders(collection, ranked, aim.norm)
    tried: list[tuple[tuple[str, ...], Refined]] = []
    for subset in contenders:
        parts = Parts.of([collection.propose(i, k) for k, i in enumerate(subset, 1)])
        _try(refiner, parts, collection.dictionary.places(subset), tried)
    before = found.refined
    if before is not None and len(before.parts.balancers) == count - 1:
        for index in additions(collection, before, None, 1):
            parts = before.parts.with_one(collection.propose(index, count))
            _try(refiner, parts, (f"the best with {count - 1}", *collection.dictionary.places((index,))), tried)
    sound = [(places, one) for places, one in tried if one.excess <= EXCESS]
    found.alternatives += [
        Alternative(count, places, one.value, f"it breaks a limit by {100 * one.excess:.2g} %")
        for places, one in tried
        if one.excess > EXCESS
    ]
    if not sound:
        found.refined = None
        return
    least = min(one.value for _, one in sound)
    alike = max(least * (1 + ALIKE), NOTHING * refiner.bare)
    sound.sort(key=lambda pair: (pair[1].value > alike, pair[1].energy))
    best = sound[0][1]
    for places, one in sound[1:]:
        if one.value > alike:
            worse = f"refined as the winner was, which reached {best.value:.3g}"
        elif one.energy > best.energy * (1 + ALIKE):
            worse = f"as good, but it stores {one.energy:.3g} J against {best.energy:.3g} J"
        else:
            worse = "as good: the search came to the same at another place"
        found.alternatives.append(Alternative(count, places, one.value, worse))
    found.refined = best


def _try(refiner: Refiner, parts: Parts, places: tuple[str, ...], tried: list[tuple[tuple[str, ...], Refined]]) -> None:
    try:
        tried.append((places, refiner.refine(parts)))
    except InfeasibleError:
        return


def _contenders(collection: Collection, ranked: Ranked, norm: Norm) -> list[Subset]:
    """The subsets that the objective's own norm ranks best, those at different places first."""
    judged = sorted((judge(collection, subset, norm), subset) for _, subset in ranked)
    chosen: list[Subset] = []
    seen: set[tuple[str, ...]] = set()
    for _, subset in judged:
        places = collection.dictionary.places(subset)
        if places not in seen:
            seen.add(places)
            chosen.append(subset)
    chosen += [subset for _, subset in judged if subset not in chosen]
    return chosen[: collection.request.contenders]


def _finish(found: _Found, refiner: Refiner, sweep: Sweep, aim: Aim) -> None:
    """Shape the refined parts over the whole sweep; a design that is hardly better than the one before is told."""
    best = found.refined
    assert best is not None
    parts = best.parts
    limits = (*refiner.limits, *parts.limits)
    count = len(parts.balancers)
    places = tuple(balancer.name for balancer in parts.balancers)
    least = found.values[-1] if found.values else refiner.bare
    if best.value > least * (1 - BETTER):
        found.alternatives.append(Alternative(count, places, best.value, "one part more gains next to nothing"))
        return
    try:
        if parts.free:
            shaped = descended(
                refiner.mechanism,
                parts.balancers,
                sweep,
                parts.free,
                objective=refiner.objective,
                limits=limits,
                precision=PRECISION,
                detour=DETOUR,
            )
            design = built(parts, shaped)
        else:
            design = balance(refiner.mechanism, parts.balancers, sweep, objective=refiner.objective, limits=limits)
    except EquipoiseError as error:
        found.alternatives.append(Alternative(count, places, best.value, error.message))
        return
    value = design.reached(aim)
    if found.values and value > found.values[-1] * (1 - BETTER):
        found.alternatives.append(Alternative(count, places, value, "one part more gains next to nothing"))
        return
    found.designs.append(design)
    found.values.append(value)
