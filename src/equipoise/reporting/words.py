"""Prose for the terminal: a design and an analysis in about fifteen lines."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from equipoise.balancers.paths import Line
from equipoise.design import Design, Row
from equipoise.reporting import cablewords, machinery, phrases
from equipoise.reporting.friction import friction_words
from equipoise.reporting.numbers import percent, plain, seen, sig, sort_out
from equipoise.reporting.pathwords import path_words
from equipoise.reporting.tolerance import tolerance_words

if TYPE_CHECKING:
    from equipoise.verbs.analyze import Analysis

WIDTH = 110
LABEL = 12
NORMS = ("peak", "rms", "mean")


def summary(design: Design) -> str:
    """A design in words: what was added, what it leaves, what limits it, how sure that is, what to try next."""
    lines = _wrap(phrases.headline(design), "")
    lines += _rows(design)
    left_out = phrases.unloaded_words(design)
    lines += _wrap(left_out, "  ") if left_out else []
    for part, balancer in zip(design.parts(), design.balancers, strict=True):
        lines += _part(part, balancer, design)
    if design.machine is not None:
        for label, words in (*machinery.motor_words(design.machine), *machinery.bearing_words(design.machine)):
            lines += _labelled(label, words)
    for words in phrases.limited_by(design):
        lines += _labelled("limited by", words)
    if design.missed:
        lines += _labelled("missed", design.missed)
    lines += _labelled("certificate", phrases.certificate_words(design))
    lines += _labelled("verified", phrases.verified_words(design))
    for label, text in tolerance_words(design):
        lines += _labelled(label, text)
    rubs = friction_words(design)
    lines += _labelled("friction", rubs) if rubs else []
    if design.cables is not None:
        for label, text in cablewords.behaviour_lines(design):
            lines += _labelled(label, text)
    for step in phrases.next_steps(design):
        lines += _labelled("next", step)
    return "\n".join(_blank_repeats(lines))


def analysis(analysis: Analysis) -> str:
    """An analysis in words: mass audit, holding torque per joint, which joints are worth a spring, the next step."""
    mechanism = analysis.mechanism
    count = len(mechanism.driven)
    sweep = analysis.sweep.describe()
    lines = _wrap(
        f"{mechanism.name}, {count} driven joint{'s' * (count != 1)}, {plain(mechanism.mass)} kg; {sweep}", ""
    )
    for remark in mechanism.remarks or (phrases.SOUND,):
        lines += _labelled("mass audit", remark)
    loaded = [joint for joint, row in analysis.rows.items() if joint not in sort_out(analysis.rows)[2]]
    if loaded:
        head = [*NORMS, "motor limit", "used", ""]
        names = [f"{joint} [{analysis.rows[joint].unit}]" for joint in loaded]
        worth = analysis.worth if analysis.cables is None else ()
        body = [_analysis_cells(analysis.rows[joint], joint in worth) for joint in loaded]
        lines += _table(names, {0: "to hold the weight" if analysis.machine is None else "over the motion"}, head, body)
    if analysis.machine is not None:
        found = [analysis.machine]
        for label, words in (*machinery.motor_words(found), *machinery.bearing_words(found)):
            lines += _labelled(label, words)
    if analysis.cables is not None:
        for label, words in cablewords.survey_lines(analysis.cables):
            lines += _labelled(label, words)
        lines += _labelled("next", _advice(analysis))
        return "\n".join(_blank_repeats(lines))
    for joint, reason in analysis.reasons.items():
        if reason:
            lines += _labelled("no spring", f"{joint}: {reason}")
    lines += _labelled("next", _advice(analysis))
    return "\n".join(_blank_repeats(lines))


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
        f"a spring from {parent} to {body} acts on {joint}: write it into a problem file, then `equipoise design FILE`"
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
    return _table(names, {0: "before", 3: "after"}, [*NORMS, *NORMS, "motor limit", ""], body) if matter else []


def _motor(row: Row) -> str:
    return plain(row.limit) if row.limit is not None else "none"


def _table(
    names: Sequence[str], groups: Mapping[int, str], head: Sequence[str], body: Sequence[Sequence[str]]
) -> list[str]:
    """Right-aligned columns under their heads and groups; the last column is a remark and reads from the left."""
    first = max(len(name) for name in names)
    widths = [max(7, len(head[i]), *(len(row[i]) for row in body)) for i in range(len(head) - 1)]
    gaps = [4 if index in groups or index == max(groups) + len(NORMS) else 2 for index in range(len(widths))]
    lines = []
    top = " " * (2 + first)
    for index, group in groups.items():
        start = 2 + first + sum(gaps[: index + 1]) + sum(widths[:index])
        top = top.ljust(start + widths[index] - len(head[index])) + group
    lines.append(top)
    for name, cells in zip(["", *names], [head, *body], strict=True):
        numbers = "".join(
            " " * gap + cell.rjust(width) for cell, width, gap in zip(cells[:-1], widths, gaps, strict=True)
        )
        lines.append(f"  {name.ljust(first)}{numbers}   {cells[-1]}".rstrip())
    return lines


def _led(part: Mapping[str, Any], balancer: Any) -> str:
    """Where a spring on a straight line is hooked on, or what leads to any other."""
    return phrases.where_words(part) if isinstance(balancer.path, Line) else path_words(balancer.path)


def _part(part: Mapping[str, Any], balancer: object, design: Design) -> list[str]:
    if part["kind"] == "spring":
        name = f"spring {part['name']}"
        return [
            *_labelled(name, phrases.law_words(part, balancer)),
            *_labelled("", _led(part, balancer)),
            *_labelled("", phrases.work_words(part)),
            *(_labelled("", words) if (words := phrases.placed_words(part, design)) else []),
            *(_labelled("", words) if (words := phrases.used_words(part)) else []),
            *(_labelled("", words) if (words := phrases.stored_words(part)) else []),
        ]
    word = {"counterweight": "weight", "counter_rotor": "rotor", "flywheel": "flywheel"}[part["kind"]]
    name = f"{word} {part['name']}"
    return [*_labelled(name, phrases.weight_words(part, design)), *_labelled("", f"at {phrases.where_words(part)}")]


def _labelled(label: str, text: str) -> list[str]:
    lead = label.ljust(LABEL) if len(label) < LABEL else f"{label}  "
    return _wrap(text, lead)


def _wrap(text: str, lead: str) -> list[str]:
    return textwrap.wrap(
        text, WIDTH, initial_indent=lead, subsequent_indent=" " * min(len(lead), LABEL) or "  ", break_long_words=False,
        break_on_hyphens=False,
    )  # fmt: skip


def _blank_repeats(lines: Sequence[str]) -> list[str]:
    """Blank a label that repeats the one above it, so that lists read as lists."""
    shown, last = [], ""
    for line in lines:
        label = line[:LABEL] if line[:1].strip() and len(line) > LABEL and line[LABEL - 1] == " " else ""
        repeated = bool(label) and label == last
        shown.append(" " * LABEL + line[LABEL:] if repeated else line)
        last = label or ("" if line[:1].strip() else last)
    return shown
