"""What to order and how to live with it: parts by their order lines, where they mount, what a broken one leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.reporting.markup import Raw, join, section, small, table
from equipoise.reporting.numbers import percent, quantity, sig, sort_out
from equipoise.units import along_path

LEAD = (
    "The order line is what a maker or dealer needs. Used is the clause that is used most. A spring is hooked in at "
    "the pose where it pulls, or pushes, least."
)


def ordering(design: Design) -> Raw | str:
    """Order lines, use, stored energy and mounting of every real part; nothing where no spring is one."""
    parts = [part for part in design.parts() if "order" in part]
    springs = {balancer.name: balancer for balancer in design.balancers if isinstance(balancer, Spring)}
    rows = []
    for part in parts:
        used = max(part["clauses"].items(), key=lambda entry: entry[1]["used"], default=None)
        length, force = springs[part["name"]].force(design.states, design.values)
        easiest = int(np.abs(force).argmin())
        pull = quantity(float(abs(force[easiest])), along_path("N or N m", part["unit"]), 3)
        where = f"{quantity(float(length[easiest]), part['unit'], 3)}, {_pose(design, easiest)}"
        doubt = f"unsourced, ask the maker: {', '.join(part['unsourced'])}" if part["unsourced"] else ""
        rows.append([
            part["name"],
            join([part["order"], small(doubt)]) if doubt else part["order"],
            f"{used[0]} {percent(used[1]['used'])}" if used else "",
            quantity(max(part["energy"]), "J", 3),
            quantity(part["mass"], "kg", 3),
            join([pull, small(where)]),
        ])  # fmt: skip
    if not rows:
        return ""
    head = ["spring", "order", "used", "stored", "mass", "to mount"]
    return section("What to order", table(head, rows, numbers=2), broken(design), lead=LEAD)


def broken(design: Design) -> Raw:
    """Each loaded motor's peak if one spring breaks, over the sweep's poses."""
    springs = [balancer for balancer in design.balancers if isinstance(balancer, Spring)]
    matter = [joint for joint in sort_out(design.before, design.after)[0] if joint in design.mechanism.driven]
    rows = []
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


def _pose(design: Design, row: int) -> str:
    """The pose of a state in words: the joints that vary."""
    driven = design.states.driven
    units = {"N m": "rad", "N": "m"}
    said = [
        f"{joint} {quantity(float(driven[row, i]), units[design.mechanism.driven_units[i]], 3)}"
        for i, joint in enumerate(design.mechanism.driven)
        if np.ptp(driven[:, i]) > 0
    ]
    return ", ".join(said[:3])
