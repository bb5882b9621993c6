"""Who stands for a number of parts: all refined roughly, those within reach of the best to the end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from equipoise.discovery.contest import REACH, Contender
from equipoise.discovery.making import weighed
from equipoise.discovery.refine import ELASTIC, Parts, Refined, Refiner
from equipoise.discovery.stage import Stage, Tell, untold
from equipoise.errors import InfeasibleError
from equipoise.parts.makeable import Makeable

ROUGH, CLOSER = 0.03, 0.01
"""Share of the value that a few steps must gain for an entrant to go on: still without, and with its own mass."""


@dataclass(frozen=True, eq=False)
class Entrant:
    """Parts that may win, and the places at which they are."""

    places: tuple[str, ...]
    parts: Parts


def refined(
    refiner: Refiner, entrants: Sequence[Entrant], make: Makeable | None, tell: Tell = untold
) -> list[Contender]:
    """All entrants whose limits can be kept, refined as far as they promise, in their order.

    A descent gains most in its first steps; the rest of them, a few per cent, is worth its time only where the
    contender may still win. Springs that are to be wound count with their own masses.
    """
    tried: list[Contender] = []
    for number, entrant in enumerate(entrants, 1):
        tell(Stage(len(entrant.parts.balancers), "refining", number, len(entrants)))
        try:
            tried.append(Contender(entrant.places, _roughly(refiner, entrant.parts, make)))
        except InfeasibleError:
            continue
    cost = [one.refined.value + ELASTIC * refiner.bare * one.refined.excess for one in tried]
    near = (1 + REACH) * min(cost, default=0.0)
    for index, (one, paid) in enumerate(zip(tried, cost, strict=True)):
        parts = one.refined.parts
        if paid <= near and parts.free:
            tell(Stage(len(parts.balancers), "refining to the end", index + 1, len(tried)))
            tried[index] = replace(one, refined=refiner.refine(parts))
    return tried


def _roughly(refiner: Refiner, parts: Parts, make: Makeable | None) -> Refined:
    if make is None:
        return refiner.refine(parts, CLOSER)
    return weighed(refiner, refiner.refine(parts, ROUGH), make, CLOSER)
