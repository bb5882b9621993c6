"""Prose for the terminal: a design and an analysis in about fifteen lines."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from equipoise.balancers.paths import Line
from equipoise.design import Design
from equipoise.reporting import cablewords, limitwords, machinery, partwords, phrases
from equipoise.reporting.friction import friction_words
from equipoise.reporting.layout import blank_repeats, labelled, table, wrapped
from equipoise.reporting.numbers import percent, plain, seen, sig, sort_out
from equipoise.reporting.pathwords import path_words
from equipoise.reporting.tolerance import tolerance_words
from equipoise.row import Row

if TYPE_CHECKING:
    from equipoise.verbs.analyze import Analysis

NORMS = ("peak", "rms", "mean")


def summary(design: Design) -> str:
    """A design in words: what was added, what it leaves, what limits it, how sure that is, what to try next."""
    lines = wrapped(phrases.headline(design))
    lines += _rows(design)
    left_out = phrases.unloaded_words(design)
    lines += wrapped(left_out, "  ") if left_out else []
    for part, balancer in zip(design.parts(), design.balancers, strict=True):
        lines += part_lines(part, balancer, design)
    if design.machine is not None:
        for label, words in (*machinery.motor_words(design.machine), *machinery.bearing_words(design.machine)):
            lines += labelled(label, words)
    for words in limitwords.limited_by(design):
        lines += labelled("limited by", words)
    if design.missed:
        lines += labelled("missed", design.missed)
    lines += labelled("certificate", phrases.certificate_words(design))
    lines += labelled("verified", phrases.verified_words(design))
    for label, text in tolerance_words(design):
        lines += labelled(label, text)
    rubs = friction_words(design)
    lines += labelled("friction", rubs) if rubs else []
    if design.cables is not None:
        for label, text in cablewords.behaviour_lines(design):
            lines += labelled(label, text)
    for step in phrases.next_steps(design):
        lines += labelled("next", step)
    return "\n".join(blank_repeats(lines))


def analysis(analysis: Analysis) -> str:
    """An analysis in words: mass audit, holding torque per joint, which joints are worth a spring, the next step."""
    mechanism = analysis.mechanism
    count = len(mechanism.driven)
    sweep = analysis.sweep.describe()
    lines = wrapped(f"{mechanism.name}, {count} driven joint{'s' * (count != 1)}, {plain(mechanism.mass)} kg; {sweep}")
    for remark in mechanism.remarks or (phrases.SOUND,):
        lines += labelled("mass audit", remark)
    loaded = [joint for joint, row in analysis.rows.items() if joint not in sort_out(analysis.rows)[2]]
    if loaded:
        head = [*NORMS, "motor limit", "used", ""]
        names = [f"{joint} [{analysis.rows[joint].unit}]" for joint in loaded]
        worth = analysis.worth if analysis.cables is None else ()
        body = [_analysis_cells(analysis.rows[joint], joint in worth) for joint in loaded]
        over = "to hold the weight" if analysis.machine is None else "over the motion"
        lines += table(names, head, body, {0: over}, len(NORMS))
    if analysis.machine is not None:
        found = [analysis.machine]
        for label, words in (*machinery.motor_words(found), *machinery.bearing_words(found)):
            lines += labelled(label, words)
    if analysis.cables is not None:
        for label, words in cablewords.survey_lines(analysis.cables):
            lines += labelled(label, words)
        lines += labelled("next", _advice(analysis))
        return "\n".join(blank_repeats(lines))
    for joint, reason in analysis.reasons.items():
        if reason:
            lines += labelled("no spring", f"{joint}: {reason}")
    lines += labelled("next", _advice(analysis))
    return "\n".join(blank_repeats(lines))


def _analysis_cells(row: Row, worth: bool) -> list[str]:
    used = percent(row.peak / row.limit) if row.limit else ""
    norms = [sig(seen(getattr(row, norm))) for norm in NORMS]
    return [*norms, _motor(row), used, "worth a spring" if worth else ""]


def _advice(analysis: Analysis) -> str:
    if analysis.cables is not None:
        cable = analysis.cables.states.mechanism.platform.cables[0]  # type: ignore[union-attr]
        return f"springs on the reels, path `reel: [{cable}]`: write a problem file, then `equipoise design FILE`"
    if not analysis.worth:
        return "gravity asks little of these motors; a spring would not pay"
    model = analysis.mechanism.model
    joint = max(analysis.worth, key=lambda name: analysis.rows[name].peak)
    child = int(model.jnt_bodyid[analysis.mechanism.joint_id(joint)])
    parent, body = model.body(int(model.body_parentid[child])).name, model.body(child).name
    return (
        f"`equipoise discover FILE` finds which springs, and where; one from {parent} to {body} acts on {joint}, and "
        "`equipoise design FILE` has a problem file to start from"
    )


def _rows(design: Design) -> list[str]:
    matter = sort_out(design.before, design.after)[0]
    counted = {row for aim in design.objective for row in aim.counted(design.mechanism)}
    body = []
    for joint in matter:
        before, after = design.before[joint], design.after[joint]
        numbers = [sig(seen(getattr(row, norm))) for row in (before, after) for norm in NORMS]
        body.append([*numbers, _motor(before), "" if joint in counted else "not counted"])
    names = [f"{joint} [{design.before[joint].unit}]" for joint in matter]
    head = [*NORMS, *NORMS, "motor limit", ""]
    return table(names, head, body, {0: "before", 3: "after"}, len(NORMS)) if matter else []


def _motor(row: Row) -> str:
    return plain(row.limit) if row.limit is not None else "none"


def _led(part: Mapping[str, Any], balancer: Any) -> str:
    """Where a spring on a straight line is hooked on, or what leads to any other."""
    return partwords.where_words(part) if isinstance(balancer.path, Line) else path_words(balancer.path)


def part_lines(part: Mapping[str, Any], balancer: object, design: Design) -> list[str]:
    """What a part is, where it goes and what it does over the sweep."""
    if part["kind"] == "spring":
        name = f"spring {part['name']}"
        return [
            *labelled(name, partwords.law_words(part, balancer)),
            *labelled("", _led(part, balancer)),
            *labelled("", partwords.work_words(part)),
            *(labelled("", words) if (words := partwords.placed_words(part, design)) else []),
            *(labelled("", words) if (words := partwords.used_words(part)) else []),
            *(labelled("", words) if (words := partwords.stored_words(part)) else []),
        ]
    word = {"counterweight": "weight", "counter_rotor": "rotor", "flywheel": "flywheel"}[part["kind"]]
    name = f"{word} {part['name']}"
    return [*labelled(name, partwords.weight_words(part, design)), *labelled("", f"at {partwords.where_words(part)}")]
