"""One number of parts after the other: contenders refined, wound where that is asked for, shaped over the sweep."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from equipoise.design import Design
from equipoise.discovery.apart import Leeway, set_apart
from equipoise.discovery.collect import Collection
from equipoise.discovery.contest import Contender, Contest
from equipoise.discovery.entrants import Entrant, refined
from equipoise.discovery.front import BETTER
from equipoise.discovery.making import unweighed
from equipoise.discovery.reach import with_extremes
from equipoise.discovery.refine import Parts, addition, built, judge
from equipoise.discovery.stage import Stage
from equipoise.discovery.subsets import Ranked, Subset
from equipoise.errors import EquipoiseError
from equipoise.objective import Aim, leading
from equipoise.reporting.numbers import quantity
from equipoise.scattering import tolerance
from equipoise.solve.program import Norm
from equipoise.sweep import Sweep
from equipoise.verification.saved import installed


@dataclass(eq=False)
class Found:
    """What the search has finished so far: designs, and who won the last number of parts."""

    contest: Contest
    designs: list[Design] = field(default_factory=list)
    values: list[float] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    best: Contender | None = None
    floor: float = 0.0
    stopped: bool = False

    def words(self, value: float) -> str:
        """A value of the objective with its unit."""
        refiner = self.contest.refiner
        return quantity(value, leading(refiner.objective).unit(refiner.mechanism), 3)

    def lose(self, contender: Contender, reason: str) -> None:
        """Tell why there is no design with so many parts."""
        self.contest.lose(contender, reason)
        one = self.contest.lost[-1]
        self.notes.append(f"with {one.springs}: no design, {reason} ({self.words(one.value)} was reached)")


def grow(found: Found, collection: Collection, ranked: Ranked, count: int, sweep: Sweep, aim: Aim) -> None:
    """Find the design with so many parts, shaped over the whole sweep, or tell why there is none."""
    entrants = [*_entrants(collection, ranked, aim), *_extended(found, collection, count)]
    tried = refined(found.contest.refiner, entrants, collection.request.make, found.contest.tell)
    found.best = found.contest.winner(tried, collection.request.make)
    if found.best is not None:
        _finish(found, collection, sweep, aim, found.best)


def _entrants(collection: Collection, ranked: Ranked, aim: Aim) -> Iterator[Entrant]:
    """The best subsets of so many candidates."""
    for subset, shares in _promising(collection, ranked, aim.norm):
        chosen = enumerate(zip(subset, shares, strict=True), 1)
        parts = Parts.of([collection.propose(i, k, share) for k, (i, share) in chosen])
        yield Entrant(collection.dictionary.places(subset), parts)


def _extended(found: Found, collection: Collection, count: int) -> Iterator[Entrant]:
    """The best with one part less, with the candidate that best joins it; nothing where nothing does."""
    before = None if found.best is None else found.best.unwound or found.best.refined
    if before is None or len(before.parts.balancers) != count - 1:
        return
    there = unweighed(before)
    joined = addition(collection, found.contest.refiner.refine(replace(there, free={})))
    if joined is not None:
        index, share = joined
        places = (f"the best with {count - 1}", *collection.dictionary.places((index,)))
        yield Entrant(places, there.with_one(collection.propose(index, count, share)))


def _promising(collection: Collection, ranked: Ranked, norm: Norm) -> list[tuple[Subset, tuple[float, ...]]]:
    """The subsets that the objective's own norm ranks best, those at different places first, with their shares."""
    judged = sorted((*judge(collection, subset, norm), subset) for _, subset in ranked)
    first: dict[tuple[str, ...], tuple[Subset, tuple[float, ...]]] = {}
    for _, shares, subset in judged:
        first.setdefault(collection.dictionary.places(subset), (subset, shares))
    rest = [(subset, shares) for _, shares, subset in judged if (subset, shares) not in first.values()]
    return [*first.values(), *rest][: collection.request.contenders]


def _leeway(collection: Collection) -> Leeway:
    """Where guides and hooks may be slid to."""
    request = collection.request
    return Leeway(collection.scene.ground, collection.margin, request.keep_out, request.radius)


def _finish(found: Found, collection: Collection, sweep: Sweep, aim: Aim, best: Contender) -> None:
    """Shape the best over the whole sweep; a design that is hardly better than the one before is told."""
    parts, refiner = best.refined.parts, found.contest.refiner
    sweep = with_extremes(refiner.mechanism, parts.balancers, sweep, (*refiner.limits, *parts.limits))
    count = len(parts.balancers)
    least = found.values[-1] if found.values else refiner.bare
    if aim.judged == "nominal" and best.refined.value > least * (1 - BETTER):
        found.lose(best, "one part more gains next to nothing")
        return
    found.contest.tell(Stage(count, "shaping over all poses"))
    try:
        design = built(parts, refiner.shaped(parts, sweep))
        design = set_apart(design, _leeway(collection))
        # What no model file can hold cannot be verified.
        installed(design)
    except EquipoiseError as error:
        found.lose(best, error.message)
        return
    if aim.judged == "band":
        design = replace(design, tolerance=tolerance(design, found.contest.scatter))
    if found.designs and design.judged > found.designs[-1].judged * (1 - BETTER):
        found.lose(best, "one part more gains next to nothing")
        return
    found.designs.append(design)
    found.values.append(design.reached(aim))
    if best.unwound is not None:
        found.notes.append(f"with {count}: {found.words(best.unwound.value)} before rounding to sizes")
