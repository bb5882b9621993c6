"""What to order and how to live with it: order lines, what else was tried, mounting, what a broken spring leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.objective import leading
from equipoise.reporting import partwords
from equipoise.reporting.markup import Raw, element, join, listing, prose, section, small, table
from equipoise.reporting.numbers import percent, quantity, sig, sort_out
from equipoise.reporting.tables import value_words
from equipoise.units import along_path

LEAD = (
    "The order line is what a maker or dealer needs. Used is the clause that is used most. A spring is hooked in at "
    "the pose where it pulls, or pushes, least."
)
UNMOVED = 1e-9
"""Share of the largest slope of a spring's length below which a joint does not move it."""
TRIED = (
    "Every candidate is optimised with the geometry that is free; the best are shaped with the design's own norm and "
    "limits, and the best of those stays."
)


def ordering(design: Design) -> Raw | str:
    """Order lines, use, stored energy and mounting of the springs, and what a broken one leaves; else nothing."""
    rows = []
    made = {part["name"]: part for part in design.parts()}
    for spring in _springs(design):
        part = made[spring.name]
        used = max(part.get("clauses", {}).items(), key=lambda entry: entry[1]["used"], default=None)
        doubt = f"unsourced, ask the maker: {', '.join(part['unsourced'])}" if part.get("unsourced") else ""
        order = part.get("order", "no part yet: `equipoise pick` finds one")
        pull, where = mounting(design, spring)
        rows.append([
            part["name"],
            join([prose(order), small(doubt)]) if doubt else prose(order),
            f"{used[0]} {percent(used[1]['used'])}" if used else "",
            partwords.energy_words(part).removeprefix("energy "),
            quantity(part["mass"], "kg", 3) if part["mass"] else "",
            join([pull, small(where)]),
        ])  # fmt: skip
    if not rows:
        return ""
    head = ["spring", "order", "used", "stored", "mass", "to mount"]
    title = "What to order" if any("order" in part for part in made.values()) else "Mounting, and what may break"
    return section(title, table(head, rows, numbers=2, kind="order"), broken(design), lead=LEAD)


def mounting(design: Design, spring: Spring) -> tuple[str, str]:
    """The force, or torque, at which a spring is hooked in where it is easiest, and its length and pose there."""
    length, force = spring.force(design.states, design.values)
    easiest = int(np.abs(force).argmin())
    pull = quantity(float(abs(force[easiest])), along_path("N or N m", spring.path.unit), 3)
    moved = np.abs(spring.path.deform(design.states)[1]).max(axis=0)
    turns = moved > UNMOVED * moved.max()
    return pull, f"{quantity(float(length[easiest]), spring.path.unit, 3)}, {_pose(design, easiest, turns)}"


def _springs(design: Design) -> list[Spring]:
    return [balancer for balancer in design.balancers if isinstance(balancer, Spring)]


def tried(design: Design) -> Raw | str:
    """The parts tried for each spring with what they reached, and what took the others out; nothing where none was."""
    aim = leading(design.objective)
    unit = aim.unit(design.mechanism)
    head = ["rank", "part", "in parallel", f"{aim.norm}, shaped around it", "95 % value", ""]
    blocks = []
    for choice in design.choices:
        rows = [
            [
                str(rank),
                one.part,
                str(one.number),
                value_words(one.value, unit),
                "" if one.high is None else value_words(one.high, unit),
                "taken" if one is choice.taken else "",
            ]
            for rank, one in enumerate(choice.tried, 1)
        ]
        blocks += [element("h3", f"{choice.spring}: {choice.order}"), table(head, rows, numbers=2)]
        blocks.append(listing([*choice.counted(), *choice.remarks]))
    return section("Candidates tried", *blocks, lead=TRIED) if blocks else ""


def broken(design: Design) -> Raw | str:
    """Each loaded motor's peak if one spring breaks, over the sweep's poses; nothing without springs or motors."""
    springs = _springs(design)
    matter = [joint for joint in sort_out(design.before, design.after)[0] if joint in design.mechanism.driven]
    rows = []
    if not (springs and matter):
        return ""
    for spring in springs:
        left = tuple(balancer for balancer in design.balancers if balancer is not spring)
        peaks = np.abs(replace(design, balancers=left).residual(design.states)).max(axis=0)
        cells = []
        for joint in matter:
            peak, limit = float(peaks[design.mechanism.driven.index(joint)]), design.before[joint].limit
            over = f"{percent(peak / limit)} of the motor's" if limit else ""
            cells.append(join([sig(peak), small(over)]) if over else sig(peak))
        rows.append([f"{spring.name} breaks", *cells])
    return table(["peak if", *(f"{joint} [{design.before[joint].unit}]" for joint in matter)], rows, numbers=1)


def _pose(design: Design, row: int, turns: NDArray[np.bool_]) -> str:
    """The pose of a state in words: of the joints (nd,) that turn, at most three that vary."""
    driven = design.states.driven
    units = {"N m": "rad", "N": "m"}
    said = [
        f"{joint} {quantity(float(driven[row, i]), units[design.mechanism.driven_units[i]], 3)}"
        for i, joint in enumerate(design.mechanism.driven)
        if turns[i] and np.ptp(driven[:, i]) > 0
    ]
    return ", ".join(said[:3])
