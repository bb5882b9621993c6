"""How springs on cranks are set for each payload of the sweep: angle, force or rate, body by body."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from equipoise.balancers.paths import Absolute, InvertedSliderCrank, ScotchYoke
from equipoise.balancers.payload import Adjustment, payload_rule
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.errors import EquipoiseError
from equipoise.payload import Payload
from equipoise.reporting.markup import Raw, element, section, table
from equipoise.reporting.numbers import plain, sig
from equipoise.sweep import Sweep

Crank = ScotchYoke | InvertedSliderCrank
RULE = (
    "For a payload that stays, turning the crank ahead of its body by the lead and setting force or rate as listed "
    "balances the body exactly (a gas spring: where its yoke is at mid-stroke). All bodies are to be set, also those "
    "that do not carry the payload themselves. The weight of the springs' own parts is left out."
)


def adjustments(design: Design) -> Raw | str:
    """A table with a row per payload and adjustable spring; nothing where no payload or no such spring is there."""
    cranks = list(_cranks(design))
    if not cranks or not design.sweep.payloads:
        return ""
    rows = []
    for masses in design.sweep.scenarios:
        loads = [
            Payload(point.body, float(mass), point.at)
            for point, mass in zip(design.sweep.payloads, masses, strict=True)
        ]
        try:
            over = Sweep(design.sweep.poses, design.sweep.weight, "the sweep's poses")
            rules = {rule.body: rule for rule in payload_rule(design.mechanism, loads, sweep=over)}
        except EquipoiseError:
            return ""
        words = ", ".join(f"{plain(load.masses[0])} kg at {load.body}" for load in loads)
        rows += [[words, spring.name, *_setting(spring, rules[body])] for spring, body in cranks if body in rules]
    if not rows:
        return ""
    head = ["payload", "spring", "lead of the crank", "torque", "setting"]
    return section("Adjusting to a payload", table(head, rows, numbers=2), element("p", RULE, class_="note"))


def _cranks(design: Design) -> Iterator[tuple[Spring, str]]:
    """Springs on cranks that turn as a driven joint's body does, with that body."""
    model = design.mechanism.model
    for spring in design.balancers:
        if not isinstance(spring, Spring) or not isinstance(spring.path, Crank):
            continue
        turn: Any = spring.path.input
        given = dict(turn.terms(model)[0])
        for joint in design.mechanism.driven_ids:
            body = model.body(model.jnt_bodyid[joint]).name
            try:
                same = given == dict(Absolute(body).terms(model)[0])
            except EquipoiseError:
                continue
            if same:
                yield spring, body
                break


def _setting(spring: Spring, rule: Adjustment) -> tuple[str, str, str]:
    lead = f"{sig(math.degrees(rule.lead), 3)} deg" if abs(rule.lead) > 1e-9 else "0 deg"
    path = spring.path
    if isinstance(path, ScotchYoke):
        radius = abs(float(path.radius))
        setting = f"force {sig(rule.force(radius))} N on {plain(1e3 * radius)} mm"
    else:
        assert isinstance(path, InvertedSliderCrank)
        crank, distance = float(path.crank), float(path.distance)
        setting = f"rate {sig(rule.rate(crank, distance))} N/m at zero free length"
    return lead, f"{sig(rule.torque)} N m", setting
