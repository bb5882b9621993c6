"""Contenders against each other: all refined roughly, those within reach of the best to the end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from equipoise.discovery.making import PRICE, weighed
from equipoise.discovery.refine import Parts, Refined, Refiner
from equipoise.errors import InfeasibleError
from equipoise.parts.makeable import Makeable

ROUGH, CLOSER = 0.03, 0.01
"""Share of the value that a few steps must gain for a contender to go on: still without, and with its own mass."""
REACH = 0.2
"""Share by which a roughly refined contender may be worse than the best and still be refined to the end."""

Tried = tuple[tuple[str, ...], Refined]
"""Where a contender's parts are, and what became of them."""


@dataclass(frozen=True, eq=False)
class Entrant:
    """Parts that may win, and the places at which they are."""

    places: tuple[str, ...]
    parts: Parts


def contested(refiner: Refiner, entrants: Sequence[Entrant], make: Makeable | None) -> list[Tried]:
    """All entrants that can keep the limits' own geometry, refined as far as they promise, in their order.

    A descent gains most in its first steps; the rest of them, a few per cent, is worth its time only where the
    contender may still win.
    """
    tried: list[Tried] = []
    for entrant in entrants:
        try:
            tried.append((entrant.places, _roughly(refiner, entrant.parts, make)))
        except InfeasibleError:
            continue
    cost = [one.value + PRICE * refiner.bare * one.excess for _, one in tried]
    near = (1 + REACH) * min(cost, default=0.0)
    return [
        (places, refiner.refine(one.parts) if paid <= near and one.parts.free else one)
        for (places, one), paid in zip(tried, cost, strict=True)
    ]


def _roughly(refiner: Refiner, parts: Parts, make: Makeable | None) -> Refined:
    if make is None:
        return refiner.refine(parts, CLOSER)
    return weighed(refiner, refiner.refine(parts, ROUGH), make, CLOSER)
