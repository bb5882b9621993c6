"""From refined springs that are still to be wound to springs of round sizes, the geometry shaped around them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import Cable
from equipoise.balancers.spring import Spring
from equipoise.discovery.refine import Parts, Refined, Refiner
from equipoise.limits import Elongation, Length, Limit
from equipoise.parts import ExtensionSpring, WindableSpring
from equipoise.parts.makeable import Makeable

DIGITS = 2
"""Digits of an initial tension that is ordered."""
PLAY = 0.25
"""Share of a spring's closed length by which its cable may still be cut longer or shorter."""

PRICE = 30.0
"""What a limit that is not kept costs, per unit of relative excess, in units of the bare load."""

Turned = tuple[Spring, dict[str, tuple[float, float]] | None, tuple[Limit, ...]]
"""A spring made more definite, what of it may still move (None: as before), and its further limits."""
Turn = Callable[[Spring, Mapping[str, float], Array], Turned]


def wound(refiner: Refiner, refined: Refined, make: Makeable) -> Refined:
    """The refined parts with springs of stocked wire, round diameters, coils and initial tensions.

    First the springs' own masses join, with wire and index still free; then wire, diameter and number in parallel are
    rounded, to the lightest and to the nearest that serve, and everything else is refined again around each; then
    coils and initial tension of the better one. What may still move then are hooks, leaders and the lengths of
    cables. Raises InfeasibleError where a spring cannot be wound.
    """
    refiner = refiner.with_extremes(refined.parts)
    heavy = refiner.refine(_each(refiner, refined, _weighed))
    choices = [_each(refiner, heavy, partial(_sized, make, which)) for which in (0, -1)]
    sized = min((refiner.refine(choice) for choice in choices), key=_merit(refiner))
    again = refiner.refine(_each(refiner, sized, _weighed))
    return refiner.refine(_each(refiner, again, partial(_ordered, make)))


def _merit(refiner: Refiner) -> Callable[[Refined], float]:
    return lambda refined: refined.value + PRICE * refiner.bare * refined.excess


def _each(refiner: Refiner, refined: Refined, turn: Turn) -> Parts:
    """The parts with every spring that is still to be wound turned into something more definite."""
    balancers, limits = [], list(refined.parts.limits)
    free = dict(refined.parts.free)
    for balancer in refined.parts.balancers:
        if not (isinstance(balancer, Spring) and isinstance(balancer.law, WindableSpring)):
            balancers.append(balancer)
            continue
        length = balancer.path.deform(refiner.states)[0]
        turned, freed, own = turn(balancer, refined.of(balancer), length)
        if freed is not None:
            free = {name: bounds for name, bounds in free.items() if not name.startswith(f"{balancer.name}.law.")}
            free |= freed
        limits = [limit for limit in limits if not _replaced(limit, turned)] + list(own)
        balancers.append(turned)
    return Parts(tuple(balancers), tuple(limits), free)


def _weighed(spring: Spring, values: Mapping[str, float], length: Array) -> Turned:  # noqa: ARG001 - like the others
    """With its own mass, by the coils that it has now."""
    law: WindableSpring = spring.law  # type: ignore[assignment]
    return replace(spring, mass=law.own_mass_at(values["k"])), None, ()


def _sized(make: Makeable, which: int, spring: Spring, values: Mapping[str, float], length: Array) -> Turned:
    """Wire, diameter and number rounded."""
    law: WindableSpring = spring.law  # type: ignore[assignment]
    chosen = make.round(law, values["k"], values["k_free_length"], length)[which]
    return replace(spring, law=chosen, mass=chosen.own_mass_at(values["k"])), {}, ()


def _ordered(make: Makeable, spring: Spring, values: Mapping[str, float], length: Array) -> Turned:
    """Coils and initial tension rounded: an extension spring as it is ordered."""
    law: WindableSpring = spring.law  # type: ignore[assignment]
    k, product = values["k"], values["k_free_length"]
    made = law.wound(k, product, length)
    coils = np.round(made.coils / make.turn) * make.turn
    tension = _rounded(made.initial_tension)
    part = replace(made, coils=float(coils), initial_tension=tension, leader=0.0)
    slack = (product + part.tension) / k - part.own_length
    if isinstance(spring.path, Cable):
        offset = float(spring.path.offset) - slack
        play = PLAY * float(part.own_length)
        turned = replace(spring, law=part, path=replace(spring.path, offset=offset), mass=0.0)
        assert law.room is not None
        return (
            turned,
            {f"{spring.name}.path.offset": (offset - play, offset + play)},
            (Length(spring.name, max=law.room),),
        )
    leader = max(float(slack), 0.0)
    turned = replace(spring, law=replace(part, leader=leader), mass=0.0)
    return turned, {f"{spring.name}.law.leader": (0.0, float(length.max()))}, ()


def _replaced(limit: Limit, spring: Spring) -> bool:
    """Whether a limit stands for what the spring's own working range says better."""
    return isinstance(spring.law, ExtensionSpring) and isinstance(limit, Elongation) and limit.spring == spring.name


def _rounded(tension: float) -> float:
    """Rounded down to the digits that are ordered."""
    if not tension > 0:
        return 0.0
    ten = 10.0 ** (np.floor(np.log10(tension)) - DIGITS + 1)
    return float(np.floor(tension / ten + 1e-9) * ten)
