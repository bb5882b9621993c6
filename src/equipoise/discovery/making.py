"""From springs that are still to be wound to springs of round sizes, the geometry shaped around them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import Cable
from equipoise.balancers.spring import Spring
from equipoise.discovery.refine import ELASTIC, Parts, Refined, Refiner
from equipoise.errors import InfeasibleError
from equipoise.limits import Elongation, Length, Limit
from equipoise.parts import ExtensionSpring, WindableSpring
from equipoise.parts.makeable import Makeable

DIGITS = 2
"""Digits of an initial tension that is ordered."""
FAINT = 0.01
"""Share of the largest initial tension below which none is ordered."""
PLAY = 0.25
"""Share of a spring's closed length by which its cable may still be cut longer or shorter."""
SPAN = 5.0
"""Factor by which a rate may move up or down."""
ROUNDS = 4
"""How often springs of round sizes are refined over the poses at which they are then shortest and longest."""

Turned = tuple[Spring, dict[str, tuple[float, float]], tuple[Limit, ...]]
"""A spring made more definite, what of its law and cable may still move, and its further limits."""
Turn = Callable[[Spring, float, float, Array], Turned]
"""spring, rate k, N/m, product k L0, N, and lengths (N,), m -> what it becomes."""


def weighed(refiner: Refiner, refined: Refined, make: Makeable, patience: float) -> Refined:
    """Refined parts shaped again with their springs' own masses, which follow rate, wire and index."""
    return refiner.refine(_each(refiner, refined, partial(_weighed, make)), patience)


def wound(refiner: Refiner, refined: Refined, make: Makeable) -> Refined:
    """Refined parts shaped again with springs of stocked wire, round diameters, coils and initial tensions.

    First wire, diameter and number in parallel are rounded, to the lightest and to the nearest that serve, and
    everything else is refined again around each; then coils and initial tension of the better one. What may still move
    then are hooks, leaders and the lengths of cables. Raises InfeasibleError where a spring cannot be wound.
    """
    refiner = refiner.with_extremes(refined.parts)
    choices = [_each(refiner, refined, partial(_sized, make, which)) for which in (0, -1)]
    if choices[0].balancers == choices[1].balancers:
        choices = choices[:1]
    sized = [refiner.refine(choice) for choice in choices]
    best = min(sized, key=lambda one: one.value + ELASTIC * refiner.bare * one.excess)
    short: InfeasibleError | None = None
    for _ in range(ROUNDS):
        # Elsewhere than before springs are longest at other poses, and round ones have nothing to spare.
        refiner = refiner.with_extremes(best.parts)
        best = refiner.refine(best.parts)
        try:
            return refiner.refine(_each(refiner, best, partial(_ordered, make)))
        except InfeasibleError as error:
            short = error
    assert short is not None
    raise short


def unweighed(refined: Refined) -> Parts:
    """Parts whose rates are found again, their springs as heavy as they were: to see what may join them."""
    balancers = tuple(
        replace(one, law=replace(one.law, k=None), mass=float(one.own_mass))
        if isinstance(one, Spring) and isinstance(one.law, WindableSpring)
        else one
        for one in refined.parts.balancers
    )
    free = {name: bounds for name, bounds in refined.parts.free.items() if not name.endswith(".law.k")}
    return replace(refined.parts, balancers=balancers, free=free)


def _each(refiner: Refiner, refined: Refined, turn: Turn) -> Parts:
    """The parts with every spring that is still to be wound turned into something more definite."""
    parts = refined.parts
    balancers, limits, free = [], list(parts.limits), dict(parts.free)
    for spring in parts.balancers:
        if not (isinstance(spring, Spring) and isinstance(spring.law, WindableSpring)):
            balancers.append(spring)
            continue
        found = refined.of(spring)
        k = found["k"] if spring.law.k is None else spring.law.k
        turned, moves, own = turn(spring, k, found["k_free_length"], spring.path.deform(refiner.states)[0])
        free = {name: bounds for name, bounds in free.items() if not name.startswith(f"{spring.name}.law.")} | moves
        limits = [limit for limit in limits if not _said_better(limit, turned)] + list(own)
        balancers.append(turned)
    return Parts(tuple(balancers), tuple(limits), free)


def _weighed(make: Makeable, spring: Spring, k: float, product: float, length: Array) -> Turned:  # noqa: ARG001
    turned = replace(spring, law=replace(spring.law, k=k), mass=0.0)
    return turned, {**make.freed(spring.name), **_rates(spring, k)}, ()


def _sized(make: Makeable, which: int, spring: Spring, k: float, product: float, length: Array) -> Turned:
    """Wire, diameter and number rounded."""
    law: WindableSpring = spring.law  # type: ignore[assignment]
    chosen = replace(make.round(law, k, product, length)[which], k=k)
    return replace(spring, law=chosen), _rates(spring, k), ()


def _rates(spring: Spring, k: float) -> dict[str, tuple[float, float]]:
    return {f"{spring.name}.law.k": (k / SPAN, k * SPAN)}


def _ordered(make: Makeable, spring: Spring, k: float, product: float, length: Array) -> Turned:
    """Coils and initial tension rounded: an extension spring as it is ordered, its leader or cable cut to length."""
    law: WindableSpring = spring.law  # type: ignore[assignment]
    made = law.wound(k, product, length)
    coils = float(np.round(made.coils / make.turn) * make.turn)
    tension = _rounded(made.initial_tension) if made.initial_tension > FAINT * made.largest_tension else 0.0
    part = replace(made, coils=coils, initial_tension=tension, leader=0.0)
    left = float((product + part.tension) / k - part.own_length)
    if isinstance(spring.path, Cable) and law.room is not None:
        offset, play = float(spring.path.offset) - left, PLAY * float(part.own_length)
        turned = replace(spring, law=part, path=replace(spring.path, offset=offset))
        moves = {f"{spring.name}.path.offset": (offset - play, offset + play)}
        return turned, moves, (Length(spring.name, max=law.room),)
    turned = replace(spring, law=replace(part, leader=max(left, 0.0)))
    return turned, {f"{spring.name}.law.leader": (0.0, float(length.max()))}, ()


def _said_better(limit: Limit, spring: Spring) -> bool:
    """Whether a limit stands for what the spring's own working range says better."""
    return isinstance(spring.law, ExtensionSpring) and isinstance(limit, Elongation) and limit.spring == spring.name


def _rounded(tension: float) -> float:
    """Rounded down to the digits that are ordered."""
    ten = 10.0 ** (np.floor(np.log10(tension)) - DIGITS + 1)
    return float(np.floor(tension / ten + 1e-9) * ten)
