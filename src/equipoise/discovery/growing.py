"""One number of parts after the other: contenders refined, wound where that is asked for, shaped over the sweep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from equipoise.design import Design
from equipoise.discovery.collect import Collection
from equipoise.discovery.contest import REACH, Entrant, contested
from equipoise.discovery.front import BETTER, Alternative
from equipoise.discovery.making import unweighed, wound
from equipoise.discovery.reach import with_extremes
from equipoise.discovery.refine import Parts, Refined, Refiner, addition, built, judge
from equipoise.discovery.subsets import Ranked, Subset
from equipoise.errors import EquipoiseError
from equipoise.objective import Aim
from equipoise.parts.makeable import Makeable
from equipoise.scattering import Scatter, tolerance
from equipoise.solve.program import Norm
from equipoise.sweep import Sweep
from equipoise.units import text
from equipoise.verification.saved import installed

EXCESS = 1e-5
"""Relative excess of a limit over the refinement's poses above which a choice is no design."""
NOTHING = 1e-6
"""Share of the bare value below which nothing is left."""
BRIEFLY = 10_000
"""Specimens by which contenders are judged."""
WOUND = 2
"""Refined choices per number of springs that are wound, where that is asked for."""
ALIKE = 0.01
"""Share by which values may differ and still be called alike; the stored energy then decides."""


@dataclass(eq=False)
class Found:
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


def grow(
    found: Found, collection: Collection, refiner: Refiner, ranked: Ranked, count: int, sweep: Sweep, aim: Aim
) -> None:
    """Find the design with so many parts, shaped over the whole sweep, or tell why there is none."""
    _one(found, collection, refiner, ranked, count, aim)
    if found.refined is not None and found.made is not None:
        _finish(found, refiner, sweep, aim, found.refined, found.made)


def _one(found: Found, collection: Collection, refiner: Refiner, ranked: Ranked, count: int, aim: Aim) -> None:
    """Refine the contenders of one number of springs and keep the best."""
    make = collection.request.make
    entrants = [
        Entrant(
            collection.dictionary.places(subset),
            Parts.of(
                [collection.propose(i, k, share) for k, (i, share) in enumerate(zip(subset, shares, strict=True), 1)]
            ),
        )
        for subset, shares in _contenders(collection, ranked, aim.norm)
    ]
    entrants += _extended(collection, refiner, found.refined, count)
    tried = contested(refiner, entrants, make)
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
            worse = f"refined as far as it promised, where the winner reached {reached:.3g}"
        elif one.energy > best.energy * (1 + ALIKE):
            worse = f"as good, but it stores {one.energy:.3g} J against {best.energy:.3g} J"
        else:
            worse = "as good: the search came to the same at another place"
        found.alternatives.append(Alternative(count, places, one.value, worse))
    found.refined = found.made = best
    if make is not None:
        near = [one for _, one in sound[:WOUND] if one.value <= (1 + REACH) * best.value]
        found.refined, found.made = _made(found, refiner, near, make)


def _by_band(
    found: Found, refiner: Refiner, count: int, sound: list[tuple[tuple[str, ...], Refined]]
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
    found: Found, refiner: Refiner, sound: Sequence[Refined], make: Makeable
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


def _extended(collection: Collection, refiner: Refiner, before: Refined | None, count: int) -> list[Entrant]:
    """The refined parts with one less, with the candidate that best joins them; none where nothing does."""
    if before is None or len(before.parts.balancers) != count - 1:
        return []
    there = unweighed(before)
    joined = addition(collection, refiner.refine(replace(there, free={})))
    if joined is None:
        return []
    index, share = joined
    places = (f"the best with {count - 1}", *collection.dictionary.places((index,)))
    return [Entrant(places, there.with_one(collection.propose(index, count, share)))]


def _contenders(collection: Collection, ranked: Ranked, norm: Norm) -> list[tuple[Subset, tuple[float, ...]]]:
    """The subsets that the objective's own norm ranks best, those at different places first, with their shares."""
    judged = sorted((*judge(collection, subset, norm), subset) for _, subset in ranked)
    first: dict[tuple[str, ...], tuple[Subset, tuple[float, ...]]] = {}
    for _, shares, subset in judged:
        first.setdefault(collection.dictionary.places(subset), (subset, shares))
    rest = [(subset, shares) for _, shares, subset in judged if (subset, shares) not in first.values()]
    return [*first.values(), *rest][: collection.request.contenders]


def _finish(found: Found, refiner: Refiner, sweep: Sweep, aim: Aim, ideal: Refined, best: Refined) -> None:
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
        # What no model file can hold cannot be verified.
        installed(design)
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
