"""What a discovery considered in the place of its designs, and why it lost."""

from __future__ import annotations

from collections.abc import Sequence

from equipoise.design import Design
from equipoise.discovery.alternative import Alternative
from equipoise.objective import leading
from equipoise.reporting.markup import Raw, section, table
from equipoise.reporting.numbers import quantity

NOTHING = 1e-9
"""Share of the value before below which nothing is left."""


def alternatives(designs: Sequence[Design]) -> Raw | str:
    """A table of the choices that lost to designs; nothing where there are none."""
    rows = [
        [str(one.springs), " and ".join(one.places), reached_words(design, one), one.reason]
        for design in designs
        for one in design.alternatives
    ]
    if not rows:
        return ""
    told = meaning(designs[0])
    head = ["parts", "where", "reached", "why it lost"]
    return section("Alternatives considered", table(head, rows, numbers=4), lead=f"{told[0].upper()}{told[1:]}.")


def reached_words(design: Design, one: Alternative) -> str:
    """The value of a choice that lost, with its unit."""
    aim = leading(design.objective)
    nothing = one.value <= NOTHING * design.bare(aim)
    return quantity(0.0 if nothing else one.value, aim.unit(design.mechanism), 3)


def meaning(design: Design) -> str:
    """What the values of choices that lost are."""
    value = "its 95 % value" if leading(design.objective).judged == "band" else "its value"
    return f"what lost is told with {value} over the whole sweep, its hooks where refinement over few poses left them"
