"""From refined springs that are still to be wound to springs of round sizes, the geometry shaped around them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

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


def wound(refiner: Refiner, refined: Refined, make: Makeable) -> Parts:
    """Parts whose springs are wound of wire sizes kept in stock to round diameters, coils and initial tensions.

    First wire, diameter and number in parallel are rounded and everything else is refined again with the springs' own
    masses; then coils and initial tension. What may still move are hooks, leaders and the lengths of cables. Raises
    InfeasibleError where a spring cannot be wound.
    """
    sized = refiner.refine(_each(refiner, refined, lambda *spring: _sized(make, *spring)))
    return _each(refiner, sized, lambda *spring: _ordered(make, *spring))


def _each(refiner: Refiner, refined: Refined, turn) -> Parts:  # type: ignore[no-untyped-def]
    """The parts with every spring that is still to be wound turned into something more definite."""
    balancers, limits = [], list(refined.parts.limits)
    free = dict(refined.parts.free)
    for balancer in refined.parts.balancers:
        if not (isinstance(balancer, Spring) and isinstance(balancer.law, WindableSpring)):
            balancers.append(balancer)
            continue
        free = {name: bounds for name, bounds in free.items() if not name.startswith(f"{balancer.name}.law.")}
        length = balancer.path.deform(refiner.states)[0]
        turned, freed, own = turn(balancer, refined.of(balancer), length)
        limits = [limit for limit in limits if not _replaced(limit, turned)] + list(own)
        free |= freed
        balancers.append(turned)
    return Parts(tuple(balancers), tuple(limits), free)


Turned = tuple[Spring, dict[str, tuple[float, float]], tuple[Limit, ...]]


def _sized(make: Makeable, spring: Spring, values: Mapping[str, float], length: Array) -> Turned:
    """Wire, diameter and number rounded; its own mass by the coils that it has now."""
    law: WindableSpring = spring.law  # type: ignore[assignment]
    k, product = values["k"], values["k_free_length"]
    chosen = make.chosen(law, k, product, length)
    sample = replace(chosen.sample, coils=max(chosen.coils_of(k), chosen.sample.coils))
    return replace(spring, law=chosen, mass=float(sample.own_mass)), {}, ()


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
        return turned, {f"{spring.name}.path.offset": (offset - play, offset + play)}, (Length(spring.name, max=law.room),)
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
