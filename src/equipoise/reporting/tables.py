"""The tables of the HTML page: joints before and after, parts and their places, verification."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from equipoise.balancers.paths import Line
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.reporting import partwords, phrases
from equipoise.reporting.markup import Raw, clean, element, join, listing, section, small, table
from equipoise.reporting.numbers import percent, plain, quantity, seen, shown, sig, sort_out, span
from equipoise.reporting.pathwords import path_words
from equipoise.reporting.rehearsal import motion_table
from equipoise.row import Row

if TYPE_CHECKING:
    from equipoise.verification.findings import Bound

PERCENT = (
    "Peak: the largest magnitude, found by local ascent from the worst samples; the largest sample stands below it. "
    "Rms and mean are over the weighted sweep. Percentages are of the same joint's peak before: value / peak before "
    "x 100 %. "
)


def before_after(design: Design) -> Raw:
    """The table of all joints that carry a load."""
    matter = sort_out(design.before, design.after)[0]
    counted = {row for aim in design.objective for row in aim.counted(design.mechanism)}
    rows = []
    for joint in matter:
        before, after = design.before[joint], design.after[joint]
        name = join([joint, small(f"{before.unit}{'' if joint in counted else ', not counted'}")])
        limit = plain(before.limit) if before.limit is not None else "none"
        rows.append([name, *_cells(before, before.peak), *_cells(after, before.peak), limit])
    groups = (
        '<tr><th></th><th class="group before" colspan="3">before</th>'
        '<th class="group after" colspan="3">after</th><th></th></tr>'
    )
    head = ["joint", "peak", "rms", "mean", "peak", "rms", "mean", "motor limit"]
    left_out = phrases.unloaded_words(design)
    idle = f"Left out: {left_out}." if left_out else ""
    note = element("p", PERCENT, f"Made small: {phrases.objective_words(design)}. ", idle, class_="note")
    return section("Before and after", table(head, rows, numbers=1, groups=groups), note)


def _cells(row: Row, reference: float) -> list[Raw]:
    cells = []
    for norm in ("peak", "rms", "mean"):
        value = seen(getattr(row, norm))
        share = percent(value / reference) if seen(reference) and value >= 1e-9 * reference else "" if value else "0 %"
        lines = [clean(sig(value)), small(share)]
        if norm == "peak":
            lines.append(small(f"sampled {sig(seen(row.sample_peak))}"))
        cells.append(join(lines))
    return cells


def parts(design: Design) -> Raw:
    """One block per part: what it is, where it goes, what it does; then the numbers that were found."""
    blocks = []
    for part, balancer in zip(design.parts(), design.balancers, strict=True):
        spring = isinstance(balancer, Spring)
        words = partwords.law_words(part, balancer) if spring else partwords.weight_words(part, design)
        ends = [[end["body"], *(_coordinate(value) for value in end["at"])] for end in part["ends"]]
        where = table(["attached to link", "x [mm]", "y [mm]", "z [mm]"], ends, numbers=1) if ends else Raw("")
        led = [element("p", path_words(balancer.path))] if spring and not isinstance(balancer.path, Line) else []
        placed = partwords.placed_words(part, design)
        facts = [*_facts(part), *([["place", placed]] if placed else [])] if spring else []
        does = table(["over the sweep", ""], facts, numbers=1) if spring else Raw("")
        blocks += [element("h3", f"{part['name']}: {words}"), *led, element("div", where, does, class_="pair")]
    lead = "Points are in the link's own frame, as the robot file defines it; the link called world is the base."
    return section("Parts and attachment points", *blocks, _found(design), lead=lead)


def _coordinate(value: float) -> str:
    return plain(round(1e3 * value, 2) + 0.0, 5)


def _facts(part: Mapping[str, Any]) -> list[list[str]]:
    pushes = part["force"][0] < -1e-9 * abs(part["force"][1])
    facts = [[name, value] for name, value in partwords.facts(part)]
    if pushes:
        facts[1][1] = join([facts[1][1], small("negative: it pushes")])
    if room := partwords.room_words(part):
        facts.append(["room", room.removeprefix(", room ")])
    facts += [[name, value] for name, value in partwords.details(part)]
    if part.get("unsourced"):
        facts.append(["unsourced, ask the maker", ", ".join(part["unsourced"])])
    if part.get("mass"):
        facts.append(["own mass", quantity(part["mass"], "kg", 3)])
    if words := partwords.stored_words(part):
        facts.append(["saved model", words])
    return facts


def _found(design: Design) -> Raw:
    rows = [
        [name, value_words(value, design.units[name], 5), "convex program"] for name, value in design.values.items()
    ]
    for name, value in design.geometry.items():
        unit, (low, high) = design.units[name], design.bounds.get(name, (-math.inf, math.inf))
        edge = min(value - low, high - value) <= 1e-6 * (high - low)
        bounds = f"shape, within {span((low, high), unit, 4)}" + (", at the bound" if edge else "")
        # A bound at zero is met to working accuracy only.
        nought = abs(value) < 1e-9 * (high - low) < math.inf
        rows.append([name, value_words(0.0 if nought else value, unit, 5), bounds])
    if not rows:
        return Raw("")
    made = table(["name", "value", "found by"], rows, numbers=1, kind="facts wide")
    return join([element("h3", "Numbers that were found"), made])


def verification(design: Design) -> Raw:
    """What an independent simulation says, and what lies between the samples."""
    found = design.verification
    if found is None:
        return section("Verification", element("p", "Not verified yet.", class_="warning"))
    matter = sort_out(design.before, design.after)[0]
    rows, methods = [], {}
    for joint, error in found.errors.items():
        if joint not in matter:
            continue
        bound = found.bounds.get(joint)
        upper = "none" if bound is None or not math.isfinite(bound.upper) else sig(bound.upper)
        polished = sig(bound.polished) if bound else ""
        name = join([joint, small(error.unit)])
        rows.append([name, sig(error.error, 2), sig(error.relative, 2), polished, upper, _sure(bound)])
        if bound is not None:
            methods.setdefault(bound.method, []).append(joint)
    elements = ", ".join(f"{name} {sig(error, 2)}" for name, error in found.energy.items())
    saved = f"The saved model, {found.model.name}, was" if found.model else "The model with its parts was saved,"
    scenarios = f", {found.scenarios} payloads each" if found.scenarios > 1 else ""
    said = element(
        "p",
        f"{saved} reloaded, compiled by {found.engine} and compared with the design at {found.where}"
        f"{scenarios} (seed {found.seed}), which the design never saw: it ",
        element("b", "agrees" if found.agrees else "DISAGREES"),
        f", the largest difference over all joints is {sig(found.max_abs_error, 2)} {found.unit} "
        f"(tolerance {sig(found.tolerance, 1)} of the load).",
        class_="" if found.agrees else "warning",
    )
    worst = f"Largest difference: {found.worst}." if found.worst is not None and not found.agrees else ""
    between = (
        "Upper bound, where proven: no pose of the swept box, sampled or not, exceeds it. Method: "
        f"{'; '.join(_methods(methods))}."
        if methods
        else ""
    )
    head = ["joint", "difference", "relative", *(["peak after", "upper bound", ""] if methods else [])]
    energy = (
        f"Every effort is the derivative of its energy; relative differences: {elements} "
        f"(tolerance {sig(found.energy_tolerance, 1)})."
    )
    return section(
        "Verification",
        said,
        element("p", worst, class_="warning") if worst else "",
        table(head, [row[: len(head)] for row in rows], numbers=1),
        element("p", between, class_="note") if between else "",
        element("p", energy, class_="note"),
        motion_table(found.motion) if found.motion else "",
        listing(found.notes) if found.notes else "",
    )


def _methods(methods: dict[str, list[str]]) -> list[str]:
    if len(methods) == 1:
        return list(methods)
    return [f"{method} ({', '.join(joints)})" for method, joints in methods.items()]


def _sure(bound: Bound | None) -> str:
    if bound is None or not math.isfinite(bound.upper):
        return ""
    return ("proven" if bound.rigorous else "estimate") + ("" if bound.complete else ", budget used up")


def value_words(value: float, unit: str, digits: int = 4) -> str:
    """A value in workshop units with exactly `digits` significant digits."""
    number, name = shown(value, unit)
    return f"{sig(number, digits)} {name}".rstrip()
