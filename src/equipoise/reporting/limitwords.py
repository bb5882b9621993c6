"""Limits in words: what each costs, and what holds a design where it is."""

from __future__ import annotations

import re

from equipoise.certificate import Active
from equipoise.design import Design
from equipoise.objective import minimised
from equipoise.reporting.numbers import (
    quantity,
    shown,
    sig,
)

STEPS = {
    "m": 0.01,
    "m^2": 1e-4,
    "m^3": 1e-3,
    "N": 10.0,
    "N/m": 100.0,
    "N m/rad": 1.0,
    "Pa": 1e5,
    "kg": 0.1,
    "kg m": 0.01,
    "rad": 0.0174532925,
    "N m": 1.0,
}
"""How far a limit is relaxed when its price is put into words, SI."""

BOUND = re.compile(r"([<>]=) *(-?[\d.]+(?:e[+-]?\d+)?)")
"""The side and value at the end of a limit's name."""


def goal_word(design: Design) -> str:
    """What a price lowers: `the peak`, or the weighted objective of several aims."""
    aims = minimised(design.objective)
    return f"the {aims[0].norm}" if len(aims) == 1 else "the objective"


def price_words(active: Active, design: Design) -> str:
    """`stroke of s1 <= 380 mm: 10 mm more would lower the peak by 0.4 N m`."""
    gained, _, per = active.unit.rpartition(" per ")
    limit = limit_words(active.limit)
    bound = BOUND.search(active.limit)
    if is_natural(active):
        return f"{limit}, the bound that nature sets"
    if not gained:
        return f"{limit} (price {sig(active.price, 3)} {active.unit})"
    if bound and f" {per}" not in active.limit:
        # A price per newton says nothing about a limit in millimetres.
        return limit
    step = STEPS.get(per, 1.0)
    # A price is a slope: it is quoted over a step that changes the objective by less than a third.
    while step * active.price > 0.3 * design.certificate.primal > 0:
        step /= 10
    amount = quantity(step, per, 2)
    move = {"<=": f"{amount} more", ">=": f"{amount} less"}.get(bound[1] if bound else "", f"relaxing it by {amount}")
    gain = sig(shown(step * active.price, gained)[0], 2)
    return f"{limit}: {move} would lower {goal_word(design)} by {gain} {shown(0.0, gained)[1]}"


def is_natural(active: Active) -> bool:
    """Whether nature sets the bound: a rate or a mass cannot be negative."""
    bound = BOUND.search(active.limit)
    user = active.limit.startswith(("slack", "force", "length", "stiffness"))
    return bool(bound and bound[1] == ">=" and float(bound[2]) == 0 and not user)


def limit_words(limit: str) -> str:
    """A limit's name with its value in mm, degrees, litres or bar where it is a length, an angle, a volume ..."""

    def convert(match: re.Match[str]) -> str:
        return quantity(float(match[1]), match[2])

    return re.sub(r"(-?\d[\d.]*(?:e[+-]?\d+)?) (m\^[23]|m|rad|Pa|K)(?=$|[\s);,])", convert, limit)


def floor_words(design: Design) -> list[str]:
    """What holds the objective up although no part can lower it."""
    words = []
    for floor in design.certificate.floors:
        row = design.after[floor.row]
        kind = "torque" if row.unit == "N m" else "force"
        size = f"{sig(row.peak)} {row.unit}"
        if floor.cause == "own":
            words.append(f"{floor.row}'s own {kind} ({size}), which no added part reaches")
        else:
            words.append(
                f"the payload: half of what it changes at {floor.row} ({size}), which no fixed design can beat"
            )
    return words


def limited_by(design: Design) -> list[str]:
    """Everything that holds the optimum where it is, the dearest first."""
    held = floor_words(design) + [price_words(active, design) for active in design.certificate.active]
    if not held and design.certificate.kind != "exact":
        return ["no limit or bound: only the places and kinds of the parts"]
    return held


def is_the_purpose(active: Active) -> bool:
    """Whether the limit is what the design is made for: balance in all motions, exact poses."""
    return "balanced in all motions" in active.limit or active.limit.startswith("exact")
