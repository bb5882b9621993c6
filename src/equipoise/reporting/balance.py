"""Conditions of balance and what goes with them, as text for a terminal."""

from __future__ import annotations

from equipoise.completion import Completion, Share
from equipoise.reporting.numbers import plain, quantity, sig
from equipoise.verbs.conditions import Conditions
from equipoise.verbs.front import Front
from equipoise.verbs.side_by_side import SideBySide

GOALS = {"force": "force", "moment": "moment", "both": "force and moment"}


def conditions_text(found: Conditions) -> str:
    """One line per condition, what the mechanism lacks, and whether added mass alone will do."""
    goal, count = GOALS[found.goal], len(found.names)
    lines = [
        f"{found.mechanism.name}: {goal} vanish{'' if found.goal == 'both' else 'es'} in all motions under "
        f"{found.rank} conditions on {count} mass parameters"
    ]
    width = max((len(found.names[index]) for index in found.solved), default=0)
    for row, index, missing in zip(found.rows, found.solved, found.missing, strict=True):
        unit = found.units[index]
        lack = "kept" if abs(missing) <= 1e-12 * (1 + abs(found.own[index])) else f"lacks {sig(missing)} {unit}"
        lines.append(f"  {found.names[index]:<{width}} = {_terms(found, row, index)}   [{lack}]")
    lines.append(completion_text(found.completion, goal))
    return "\n".join(lines)


def _terms(found: Conditions, row: object, solved: int) -> str:
    words = ""
    for name, value in zip(found.names, row, strict=True):  # type: ignore[call-overload]
        if value and name != found.names[solved]:
            sign = "-" if value > 0 else "+"
            words += f" {sign} {'' if abs(abs(value) - 1) < 1e-9 else plain(abs(value)) + ' '}{name}"
    words = words.strip()
    return words.removeprefix("+ ") if words else "0"


def completion_text(found: Completion, goal: str) -> str:
    """Whether added mass alone meets the conditions: the least mass and where, or the form that forbids it."""
    if found.possible:
        if not found.added:
            return f"{goal}: balanced as it is"
        parts = [f"{name} {sig(value)}" for name, value in found.added.items() if abs(value) > 1e-9]
        return f"{goal} by added mass alone: possible, the least is {sig(found.mass or 0.0)} kg ({', '.join(parts)})"
    more = "other bodies must carry it" if goal == "force" else "a counter-rotor or a flywheel must turn against it"
    if not found.form:
        return f"{goal} by added mass alone: impossible; {more}"
    why = "\n    + ".join(_share(share) for share in found.form)
    return (
        f"{goal} by added mass alone: impossible. The conditions together ask that this vanishes:\n      {why}\n"
        f"    which every body makes positive: {more}"
    )


def _share(share: Share) -> str:
    words = []
    if share.second and len(share.centre) == 3:
        words.append(f"second moments of {share.body}, {plain(share.second)} at most for one direction")
    elif share.second:
        off = any(share.centre)
        where = f"its point ({', '.join(quantity(value, 'm') for value in share.centre)})" if off else "its joint"
        words.append(f"{plain(share.second)} x the moment of inertia of {share.body} about {where}")
    if share.first:
        words.append(f"{plain(share.first)} m^2 x the mass of {share.body}")
    return "\n    + ".join(words)


def columns_text(found: SideBySide) -> str:
    """A table with a line per quantity; what is rounding beside the bare mechanism reads 0."""
    width = max(len(f"{one.what} [{one.unit}]") for one in found.lines) + 2
    columns = [max(12, len(name) + 2) for name in found.columns]
    lines = [" " * width + "".join(f"{name:>{w}}" for name, w in zip(found.columns, columns, strict=True))]
    for one in found.lines:
        floor = 1e-9 * abs(one.values[0] or 0.0)
        cells = ["-" if v is None else plain(v if abs(v) > floor else 0.0) for v in one.values]
        label = f"{one.what} [{one.unit}]" if one.unit else one.what
        lines.append(f"{label:<{width}}" + "".join(f"{c:>{w}}" for c, w in zip(cells, columns, strict=True)))
    return "\n".join(lines)


def front_text(found: Front) -> str:
    """A line per step: cap, best value, what one more unit would take off."""
    head = f"{found.against} [{found.against_unit}]"
    price = f"less per {found.against_unit}"
    lines = [
        f"{found.objective} [{found.unit}] against {found.against}; the limits ask for {sig(found.least)} "
        f"{found.against_unit} at least",
        f"{head:>16}{'at best':>14}{price:>18}{'proven to':>14}",
    ]
    for step in found.steps:
        gap = f"{(step.value - step.dual) / step.value:.0e}" if step.value > 0 else "-"
        lines.append(f"{sig(step.cap, 5):>16}{sig(step.value, 5):>14}{sig(step.price):>18}{gap:>14}")
    return "\n".join(lines)
