"""discover: which springs at all, from a dictionary of candidates; the front of number of springs against residual."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from equipoise.design import Design
from equipoise.discovery.collect import Collection, collect
from equipoise.discovery.front import BETTER, Alternative, Discovery, bounds_of
from equipoise.discovery.making import unweighed, weighed, wound
from equipoise.discovery.reach import with_extremes
from equipoise.discovery.refine import Parts, Refined, Refiner, addition, built, judge
from equipoise.discovery.request import Discover
from equipoise.discovery.subsets import Ranked, Search, Subset
from equipoise.errors import EquipoiseError, InfeasibleError, InputError
from equipoise.interference import shell
from equipoise.interference.findings import clashes
from equipoise.limits import Limit
from equipoise.mechanism import Mechanism
from equipoise.objective import Aim, as_objective
from equipoise.parts.makeable import Makeable
from equipoise.scattering import Scatter, tolerance
from equipoise.solve.program import Norm
from equipoise.sweep import Sweep
from equipoise.units import text
from equipoise.verbs.shape import thinned

JUDGED = 40
"""Subsets per number of springs that are judged by the objective's own norm."""
EXCESS = 1e-5
NOTHING = 1e-6
"""Share of the bare value below which nothing is left."""
BRIEFLY = 10_000
"""Specimens by which contenders are judged."""
FEW = 256
"""Poses over which contenders are refined."""
WOUND = 2
"""Refined choices per number of springs that are wound, where that is asked for."""
ALIKE = 0.01
"""Share by which values may differ and still be called alike; the stored energy then decides."""

Progress = Callable[[int, int, float], None]


@dataclass(eq=False)
class _Found:
    """What the search has finished so far."""

    designs: list[Design] = field(default_factory=list)
    values: list[float] = field(default_factory=list)
    alternatives: list[Alternative] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    refined: Refined | None = None
    made: Refined | None = None
    floor: float = 0.0
    scatter: Scatter = field(default_factory=Scatter)
    stopped: bool = False

    def lose(self, one: Alternative) -> None:
        """Tell why there is no design with so many parts."""
        self.alternatives.append(one)
        self.notes.append(f"with {one.springs}: no design, {one.reason} ({one.value:.3g} over the refinement's poses)")


def discover(
    mechanism: Mechanism,
    sweep: Sweep | None = None,
    request: Discover | None = None,
    *,
    norm: Norm | None = None,
    objective: Aim | Sequence[Aim] | None = None,
    limits: Sequence[Limit] = (),
    scatter: Scatter | None = None,
    progress: Progress | None = None,
) -> Discovery:
    """Find which springs to add, where, and how big: the front of their number against what motors still hold.

    A dictionary of candidates is compressed to its rank and searched for the best subsets (pairs exhaustively, more
    by a beam with exchange); those that the objective's own norm ranks best, and the design before with the best
    candidate added, are refined by sequential convex programming; the best of each number is shaped over the whole
    sweep (default: 2048 Sobol poses; default norm: peak). Where the objective is judged by its band under the scatter,
    refined contenders, and numbers of parts, are ranked by that. progress is called with (numbers done, numbers,
    value); Ctrl-C returns what is finished. Raises InputError for an objective that is not the holding effort,
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
    compressed = collection.dictionary.compressed
    search = Search.of(compressed, collection.dictionary.spots)
    ranked = search.best(request.springs, keep=JUDGED)
    bounds = bounds_of(collection, sweep, aim)
    found = _Found(scatter=scatter or Scatter())
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
                if found.refined is not None and found.made is not None:
                    _finish(found, refiner, sweep, aim, found.refined, found.made)
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
            hint="try other `kinds`, widen `margin` or list `points` farther out, or relax the limits",
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
    make = collection.request.make
    tried: list[tuple[tuple[str, ...], Refined]] = []
    for subset, shares in _contenders(collection, ranked, aim.norm):
        parts = Parts.of(
            [collection.propose(i, k, share) for k, (i, share) in enumerate(zip(subset, shares, strict=True), 1)]
        )
        _try(refiner, parts, collection.dictionary.places(subset), tried, make)
    before = found.refined
    if before is not None and len(before.parts.balancers) == count - 1:
        there = unweighed(before)
        joined = addition(collection, refiner.refine(replace(there, free={})))
        if joined is not None:
            index, share = joined
            parts = there.with_one(collection.propose(index, count, share))
            _try(refiner, parts, (f"the best with {count - 1}", *collection.dictionary.places((index,))), tried, make)
    sound = [(places, one) for places, one in tried if one.excess <= EXCESS]
    if aim.judged == "band":
        sound = _by_band(found, refiner, count, sound)
    found.alternatives += [
        Alternative(count, places, one.value, f"it breaks a limit by {100 * one.excess:.2g} %")
        for places, one in tried
        if one.excess > EXCESS
    ]
    if not sound:
        found.refined = found.made = None
        return
    least = min(one.value for _, one in sound)
    alike = max(least * (1 + ALIKE), NOTHING * refiner.bare)
    sound.sort(key=lambda pair: (pair[1].value > alike, pair[1].energy))
    best = sound[0][1]
    for places, one in sound[1:]:
        if one.value > alike:
            reached = best.value if best.value > NOTHING * refiner.bare else 0.0
            worse = f"refined as the winner was, which reached {reached:.3g}"
        elif one.energy > best.energy * (1 + ALIKE):
            worse = f"as good, but it stores {one.energy:.3g} J against {best.energy:.3g} J"
        else:
            worse = "as good: the search came to the same at another place"
        found.alternatives.append(Alternative(count, places, one.value, worse))
    found.refined = found.made = best
    if make is not None:
        found.refined, found.made = _made(found, refiner, [one for _, one in sound[:WOUND]], make)


def _by_band(
    found: _Found, refiner: Refiner, count: int, sound: list[tuple[tuple[str, ...], Refined]]
) -> list[tuple[tuple[str, ...], Refined]]:
    """Refined contenders with the 95 % value of their band as their value."""
    ranked = []
    for places, one in sound:
        try:
            ranked.append((places, refiner.banded(one, found.scatter, BRIEFLY)))
        except EquipoiseError as error:
            found.alternatives.append(Alternative(count, places, one.value, error.message))
    return ranked


def _made(
    found: _Found, refiner: Refiner, sound: Sequence[Refined], make: Makeable
) -> tuple[Refined | None, Refined | None]:
    """Of the best refined parts those that are best once they are wound: as they were, and wound."""
    best: tuple[Refined | None, Refined | None] = (None, None)
    for one in sound:
        names = tuple(balancer.name for balancer in one.parts.balancers)
        try:
            made = wound(refiner, one, make)
        except EquipoiseError as error:
            found.alternatives.append(Alternative(len(names), names, one.value, error.message))
            continue
        if made.excess > EXCESS:
            reason = f"wound to round sizes it breaks a limit by {100 * made.excess:.2g} %"
            found.alternatives.append(Alternative(len(names), names, made.value, reason))
        elif best[1] is None or made.value < best[1].value:
            best = one, made
    return best


def _try(
    refiner: Refiner,
    parts: Parts,
    places: tuple[str, ...],
    tried: list[tuple[tuple[str, ...], Refined]],
    make: Makeable | None,
) -> None:
    try:
        found = refiner.refine(parts)
        tried.append((places, found if make is None else weighed(refiner, found, make)))
    except InfeasibleError:
        return


def _contenders(collection: Collection, ranked: Ranked, norm: Norm) -> list[tuple[Subset, tuple[float, ...]]]:
    """The subsets that the objective's own norm ranks best, those at different places first, with their shares."""
    judged = sorted((*judge(collection, subset, norm), subset) for _, subset in ranked)
    first: dict[tuple[str, ...], tuple[Subset, tuple[float, ...]]] = {}
    for _, shares, subset in judged:
        first.setdefault(collection.dictionary.places(subset), (subset, shares))
    rest = [(subset, shares) for _, shares, subset in judged if (subset, shares) not in first.values()]
    return [*first.values(), *rest][: collection.request.contenders]


def _finish(found: _Found, refiner: Refiner, sweep: Sweep, aim: Aim, ideal: Refined, best: Refined) -> None:
    """Shape the refined parts over the whole sweep; a design that is hardly better than the one before is told."""
    parts = best.parts
    sweep = with_extremes(refiner.mechanism, parts.balancers, sweep)
    count = len(parts.balancers)
    places = tuple(balancer.name for balancer in parts.balancers)
    least = found.values[-1] if found.values else refiner.bare
    if aim.judged == "nominal" and best.value > least * (1 - BETTER):
        found.lose(Alternative(count, places, best.value, "one part more gains next to nothing"))
        return
    try:
        design = built(parts, refiner.shaped(parts, sweep))
    except EquipoiseError as error:
        found.lose(Alternative(count, places, best.value, error.message))
        return
    if aim.judged == "band":
        design = replace(design, tolerance=tolerance(design, found.scatter))
    if found.designs and design.judged > found.designs[-1].judged * (1 - BETTER):
        found.lose(Alternative(count, places, design.judged, "one part more gains next to nothing"))
        return
    found.designs.append(design)
    found.values.append(design.reached(aim))
    if ideal is not best:
        words = f"{text(ideal.value, aim.unit(refiner.mechanism), 3)} before rounding to sizes"
        found.notes.append(f"with {count}: {words}")
