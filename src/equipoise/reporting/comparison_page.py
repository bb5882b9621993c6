"""The report of a comparison: the ranked table, what every family leaves over the joint, and why it stands there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from equipoise import __version__
from equipoise.affine import Array
from equipoise.reporting import style
from equipoise.reporting.comparison import HEAD, cells, file_name, measure
from equipoise.reporting.html import document
from equipoise.reporting.markup import Raw, element, image, join, listing, prose, section, small, table
from equipoise.reporting.numbers import effort_word, quantity, shown, sig
from equipoise.reporting.references import reference
from equipoise.reporting.words import part_lines

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from equipoise.states import States
    from equipoise.verbs.compare import Comparison, Entry

LEFT = ("peak", "rms", "mean", "95 %", "friction", "motor rms")
TAKES = ("parts", "energy J", "mass kg", "inertia", "rate", "pin N", "room mm", "real")
"""Columns of the two tables, by their names in the text."""
COLUMNS, WIDTH, HEIGHT = 4, 10.4, 1.75
"""Panels beside each other; the picture's width and each row's height, inches."""
BINS = 24
"""Parts of the joint's range in which the largest effort is looked for where other joints move too."""
NOTHING = 1e-9
MEANING = (
    "friction: the springs' own at the joint, at its largest",
    "95 %: the norm that 95 of 100 specimens keep when parts and robot are as they come",
    "motor rms: over the motion, inertia included",
    "energy: the most that is stored; mass: the least round steel wire that stores it, or the weight",
    "room: sides of the box along x, y, z that the parts sweep, without their widths",
    "pin: the largest force at a pin, roller or hook",
)


def page(found: Comparison) -> str:
    """The report as HTML text."""
    entries = [entry for entry in found.entries if entry.design is not None]
    sources = dict.fromkeys(key for entry in found.entries for key in entry.family.sources)
    body = join(
        [
            _header(found),
            _left(found),
            _curves(found, entries),
            _takes(found),
            _reasons(found),
            _designs(entries),
            section("Where the families are described", listing(map(reference, sources))) if sources else "",
            element("footer", f"Made by equipoise {__version__}. Every row is a design: certified, and held still."),
        ],
        "\n",
    )
    return document(f"Balancers for {found.site.joint}", body)


def _header(found: Comparison) -> Raw:
    before, best = found.before, found.entries[0]
    value = "" if best.facts is None else f": {best.reason}, the motor's rms falls from {sig(found.torque, 3)} to "
    motor = "" if best.facts is None else f"{sig(best.facts.torque, 3)} {before.unit}"
    return element(
        "header",
        element("p", "Comparison of balancers", class_="kicker"),
        element("h1", f"Which balancer for {found.site.joint} of {found.site.mechanism.name}"),
        element("p", f"First comes the {best.family.name}{value}{motor}.", class_="result"),
        element(
            "p",
            f"Without a balancer the joint holds {sig(before.peak)} {before.unit} at most, {sig(before.rms)} rms, "
            f"{sig(before.mean)} mean. Ranked by {measure(found)}, then parts, then room; cranks, springs and "
            f"weights may reach {quantity(found.site.room, 'm')} from the joint.",
            class_="sub-line",
        ),
        element("p", f"{found.sweep.describe()}. Motor: {found.motion}.", class_="sub-line"),
    )


def _rows(found: Comparison, names: Sequence[str]) -> list[list[str]]:
    """Rank and family, and the named columns of the text's table."""
    columns = [HEAD.index(name) for name in names]
    rows = []
    for entry in found.entries:
        said = cells(entry)
        name = join([entry.family.name, small(f"class {entry.family.code}")]) if entry.family.code else said[1]
        rows.append([said[0], name, *(said[column] for column in columns)])
    return rows


def _left(found: Comparison) -> Raw:
    unit = found.before.unit
    before = [sig(value, 3) for value in (found.before.peak, found.before.rms, found.before.mean)]
    bare = ["", "no balancer", *before, "", "", sig(found.torque, 3)]
    head = ["rank", "family", *LEFT]
    lead = f"All in {unit}; rows that cannot be had as they stand come last."
    return section("What is left", table(head, [bare, *_rows(found, LEFT)], numbers=2), lead=lead)


def _takes(found: Comparison) -> Raw:
    made = table(["rank", "family", *TAKES], _rows(found, TAKES), numbers=2)
    return section("What it takes", made, listing(MEANING))


def _reasons(found: Comparison) -> Raw:
    rows = [[str(entry.rank), entry.family.name, entry.reason] for entry in found.entries]
    return section("Why each stands where it does", table(["rank", "family", "because"], rows, numbers=3))


def _designs(entries: Sequence[Entry]) -> Raw:
    blocks = []
    for entry in entries:
        assert entry.design is not None
        lines = [
            line
            for part, balancer in zip(entry.design.parts(), entry.design.balancers, strict=True)
            for line in part_lines(part, balancer, entry.design)
        ]
        summary = element("summary", f"{entry.rank}  {entry.family.name}")
        file = element("p", "File: ", element("code", file_name(entry)))
        blocks.append(element("details", summary, element("pre", "\n".join(lines)), file))
    lead = "Each is a problem file beside this page, which `design`, `shape`, `pick` and `verify` take on from here."
    return section("The designs", *blocks, lead=prose(lead))


def _curves(found: Comparison, entries: Sequence[Entry]) -> Raw:
    drawn = [entry for entry in entries if _peak(entry) > NOTHING * found.before.peak]
    exact = [entry.family.name for entry in entries if entry not in drawn]
    told = f"Nothing is left by: {', '.join(exact)}." if exact else ""
    if not drawn:
        return section("What is left over the joint", element("p", told))
    with style.styled():
        address = style.picture(chart(found, drawn))
    what = "Each panel has its own scale; grey is zero."
    if not _alone(found):
        what += " Other joints move too: the largest effort in each part of the joint's range is drawn."
    said = "; ".join(f"{entry.family.name}: peak {sig(_peak(entry), 3)} {found.before.unit}" for entry in drawn)
    return section("What is left over the joint", image(address, said, " ".join([what, told]).strip()))


def chart(found: Comparison, entries: Sequence[Entry]) -> Figure:
    """A panel for each family: the effort that it leaves over the joint's range."""
    rows = -(-len(entries) // COLUMNS)
    figure = style.figure(WIDTH, HEIGHT * rows + 0.3)
    axes = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    states = found.site.mechanism.states(found.sweep)
    for ax, entry in zip(axes, entries, strict=False):
        _panel(ax, found, entry, states)
    for ax in axes[len(entries) :]:
        ax.set_axis_off()
    kind = effort_word(found.before.unit)
    figure.supylabel(f"{kind} left to hold [{found.before.unit}]", fontsize=9.5)
    unit = shown(0.0, "m" if found.site.slide else "rad")[1]
    figure.supxlabel(f"{found.site.joint} [{unit}]", fontsize=9.5)
    return figure


def _panel(ax: Axes, found: Comparison, entry: Entry, states: States) -> None:
    x, y = _curve(found, entry, states)
    factor = shown(1.0, "m" if found.site.slide else "rad")[0]
    ax.axhline(0.0, color=style.LINK, lw=1.0)
    ax.plot(factor * x, y, color=style.AFTER if entry.realisable else style.MUTED, lw=1.4)
    ax.set_title(_wrapped(f"{entry.rank}  {entry.family.name}"), fontsize=8, fontweight="normal")
    ax.tick_params(labelsize=7.5)
    ax.locator_params(axis="y", nbins=4)
    if not found.site.slide:
        ax.xaxis.set_major_locator(_fewer(float(factor * x.min()), float(factor * x.max())))


def _curve(found: Comparison, entry: Entry, states: States) -> tuple[Array, Array]:
    """Joint positions and what is left there; the largest in each part of the range where other joints move too."""
    assert entry.design is not None
    column = found.site.mechanism.driven.index(found.site.joint)
    q, left = states.driven[:, column], entry.design.residual(states)[:, column]
    if _alone(found):
        order = np.argsort(q, kind="stable")
        return q[order], left[order]
    part = np.minimum((BINS * (q - q.min()) / max(float(np.ptp(q)), 1e-300)).astype(int), BINS - 1)
    known = np.unique(part)
    return (
        np.array([q[part == one].mean() for one in known]),
        np.array([np.abs(left[part == one]).max() for one in known]),
    )


def _alone(found: Comparison) -> bool:
    """Whether one joint alone moves, with one payload."""
    moves = np.ptp(found.sweep.poses, axis=0) > 0
    return int(moves.sum()) == 1 and len(found.sweep.scenarios) == 1


def _peak(entry: Entry) -> float:
    return 0.0 if entry.facts is None else entry.facts.peak


def _fewer(low: float, high: float) -> Any:
    """Ticks of narrow panels, deg."""
    from matplotlib.ticker import MaxNLocator, MultipleLocator

    steps = [step for step in (15, 30, 45, 60, 90, 180) if (high - low) / step <= 4.01]
    return MultipleLocator(steps[0]) if steps and high - low > 30 else MaxNLocator(4)


def _wrapped(words: str, width: int = 34) -> str:
    import textwrap

    return "\n".join(textwrap.wrap(words, width))
