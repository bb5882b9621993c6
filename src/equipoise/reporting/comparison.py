"""A comparison of families as text for the terminal and as a Markdown table for the docs."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from equipoise.reporting.numbers import plain, quantity, sig

if TYPE_CHECKING:
    from equipoise.verbs.compare import Comparison, Entry

HEAD = (
    "rank",
    "family",
    "class",
    "peak",
    "rms",
    "mean",
    "95 %",
    "friction",
    "rate",
    "energy J",
    "mass kg",
    "inertia",
    "motor rms",
    "room mm",
    "parts",
    "pin N",
    "real",
)
NONE = "-"


def text(found: Comparison) -> str:
    """The table with its head, and why each stands where it does."""
    rows = [HEAD, *(cells(entry) for entry in found.entries)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(HEAD))]
    left = {1, 2}
    lines = [
        "  ".join(c.ljust(w) if i in left else c.rjust(w) for i, (c, w) in enumerate(zip(row, widths, strict=True)))
        for row in rows
    ]
    reasons = [f"  {entry.rank:>2}  {entry.family.name}: {entry.reason}{_cited(entry)}" for entry in found.entries]
    return "\n".join([headline(found), "", *(line.rstrip() for line in lines), "", *reasons])


def file_name(entry: Entry) -> str:
    """The problem file of a family's member: `02_spring_cable_and_eye.yaml`."""
    return f"{entry.rank:02d}_{re.sub('[^a-z0-9]+', '_', entry.family.name.lower()).strip('_')}.yaml"


def _cited(entry: Entry) -> str:
    return f" [{', '.join(entry.family.sources)}]" if entry.family.sources else ""


def headline(found: Comparison) -> str:
    """Joint, load and motion in a sentence or two."""
    before = found.before
    return (
        f"{found.site.mechanism.name}, {found.site.joint}: {sig(before.peak)} peak, {sig(before.rms)} rms, "
        f"{sig(before.mean)} mean {before.unit} to hold; ranked by {measure(found)}, then parts, then "
        f"room (reach {quantity(found.site.room, 'm')}). Motor rms over {found.motion}: {sig(found.torque)} "
        f"{before.unit} without a balancer."
    )


def measure(found: Comparison) -> str:
    """What the rows are ranked by."""
    return f"the 95 % value of the {found.norm}" if found.judged == "band" else f"what is left of the {found.norm}"


def markdown(found: Comparison) -> str:
    """The same table in Markdown."""
    rows = [cells(entry) for entry in found.entries]
    marks = ["---" if i in (1, 2) else "---:" for i in range(len(HEAD))]
    return "\n".join("| " + " | ".join(row) + " |" for row in [HEAD, marks, *rows])


def cells(entry: Entry) -> list[str]:
    """A row of the table, in the order of its head."""
    family, facts = entry.family, entry.facts
    start = [str(entry.rank), family.name, family.code or NONE]
    parts = str(entry.json()["parts"])
    if facts is None:
        return [*start, *[NONE] * 11, parts, NONE, "no"]
    left = ["0" if value < 1e-9 else sig(value, 3) for value in (facts.peak, facts.rms, facts.mean)]
    return [
        *start,
        *left,
        "0" if facts.high < 1e-9 else sig(facts.high, 3),
        NONE if facts.friction is None else plain(facts.friction if facts.friction > 1e-9 else 0.0, 2),
        NONE if facts.rate is None else plain(facts.rate, 3),
        plain(facts.energy, 3),
        NONE if facts.mass is None else plain(facts.mass, 3),
        plain(facts.inertia, 2),
        sig(facts.torque, 3),
        " x ".join(plain(round(1e3 * side), 3) for side in facts.room),
        parts,
        NONE if facts.pin is None else plain(facts.pin, 3),
        "yes" if entry.realisable else "no",
    ]
