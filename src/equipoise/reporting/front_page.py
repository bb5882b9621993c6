"""The report of a discovery: the front, its designs with attachment coordinates, what was considered and lost."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from equipoise import __version__
from equipoise.design import Design
from equipoise.discovery.front import Discovery
from equipoise.discovery.words import CAUSES
from equipoise.reporting import style, tables
from equipoise.reporting.drawing import drawing
from equipoise.reporting.html import document
from equipoise.reporting.markup import Raw, element, image, join, listing, prose, section, table
from equipoise.reporting.numbers import sig
from equipoise.reporting.sample import Sample
from equipoise.units import text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 8.0, 3.4
NOTHING = 1e-4
"""Share of the value before below which the drawing does not look."""
WIDE = 30.0
"""Ratio of values above which the front is drawn on a logarithmic scale."""


def page(front: Discovery) -> str:
    """The report as HTML text."""
    first = front.designs[0]
    body = join(
        [
            _header(front),
            _chart(front),
            _table(front),
            *[_design(front, index) for index in range(len(front.designs))],
            _lost(front),
            _floors(front),
            section("What the springs run into", listing(front.notes)) if front.notes else "",
            _dictionary(front),
            element(
                "footer", f"Made by equipoise {__version__}. Torques are what the motors must supply to hold still."
            ),
        ],
        "\n",
    )
    return document(f"Springs for {first.mechanism.name}", body)


def _header(front: Discovery) -> Raw:
    best = front.designs[front.recommended]
    count = len(best.balancers)
    name = best.mechanism.name
    value = front.values[front.recommended]
    result = (
        f"{count} part{'s' * (count > 1)} lower the {front.aim.norm} from {text(front.before, front.unit)} to "
        f"{text(value, front.unit)}."
    )
    return element(
        "header",
        element("p", "Discovery of springs", class_="kicker"),
        element("h1", f"Which springs for {name}"),
        element("p", result, class_="result"),
        element("p", best.sweep.describe(), class_="sub-line"),
    )


def _chart(front: Discovery) -> Raw:
    with style.styled():
        address = style.picture(chart(front))
    words = f"{front.aim.norm} over the number of parts: " + ", ".join(
        f"{count} {text(value, front.unit)}" for count, value in _points(front)
    )
    caption = "The best design found with each number of parts; grey: choices that lost. Dashed: floors that no part \
can lower."
    return section("The front", image(address, words, caption))


def chart(front: Discovery) -> Figure:
    """Value over the number of parts, with floors and what lost."""
    figure = style.figure(WIDTH, HEIGHT)
    ax = figure.subplots()
    counts, values = (np.array(part, dtype=float) for part in zip(*_points(front), strict=True))
    values = np.maximum(values, NOTHING * front.before)
    lost = [(one.springs, one.value) for one in front.alternatives if np.isfinite(one.value)]
    if lost:
        ax.plot(*zip(*lost, strict=True), "o", color=style.LINK, markersize=5, zorder=1)
    ax.plot(counts, values, "-o", color=style.AFTER, markersize=6, zorder=3)
    ax.plot(counts[:1], values[:1], "o", color=style.BEFORE, markersize=7, zorder=4)
    for count, value, true in zip(counts, values, [one for _, one in _points(front)], strict=True):
        ax.annotate(
            sig(true if true > 1e-9 * front.before else 0.0, 3),
            (count, value),
            xytext=(7, 6),
            textcoords="offset points",
            color=style.INK,
            fontsize=9,
        )
    floor = max((bound.value for bound in front.bounds), default=0.0)
    if floor > 0:
        ax.axhline(floor, color=style.LIMIT, lw=1.0, ls="--", zorder=2)
    if values.max() > WIDE * max(float(values.min()), 1e-300) and values.min() > 0:
        ax.set_yscale("log")
        ax.yaxis.set_major_formatter(lambda value, _: sig(value, 1))
        ax.yaxis.set_minor_formatter(lambda *_: "")
    else:
        ax.set_ylim(bottom=0.0)
    ax.set_xticks(np.arange(int(counts.max()) + 1))
    ax.set_xlabel("number of parts")
    ax.set_ylabel(f"{front.aim.norm}, {front.unit}")
    return figure


def _points(front: Discovery) -> list[tuple[int, float]]:
    found = [(len(design.balancers), value) for design, value in zip(front.designs, front.values, strict=True)]
    return [(0, front.before), *found]


def _table(front: Discovery) -> Raw:
    rows = [["0", text(front.before, front.unit), "", "", "", ""]]
    for design, value in zip(front.designs, front.values, strict=True):
        made = design.parts()
        springs = [part for part in made if "force" in part]
        force = max((max(abs(f) for f in part["force"]) for part in springs), default=0.0)
        energy = sum(part["energy"][1] for part in springs)
        checked = design.verification
        rows.append(
            [
                str(len(made)),
                text(value, front.unit),
                text(design.added_mass, "kg", 3) if design.added_mass > 0 else "",
                f"{sig(force, 3)}" if springs else "",
                text(energy, "J", 3) if springs else "",
                "not verified" if checked is None else f"{sig(checked.max_abs_error, 2)} {checked.unit}",
            ]
        )
    head = ["parts", f"{front.aim.norm}", "mass", "largest force, N or N m", "most stored", "MuJoCo differs by"]
    target = [f"Asked for: {text(front.aim.target, front.unit)}."] if front.aim.target is not None else []
    return section("Parts against what is left", table(head, rows), *[element("p", one) for one in target])


def _design(front: Discovery, index: int) -> Raw:
    design: Design = front.designs[index]
    count = len(design.balancers)
    with style.styled():
        drawn = drawing(Sample(design))
        picture = (
            image(style.picture(drawn), f"{design.mechanism.name} with {count} parts in two poses") if drawn else ""
        )
    inner = tables.parts(design)
    title = f"With {count} part{'s' * (count > 1)}: {text(front.values[index], front.unit)}"
    folder = element(
        "p", prose(f"File: `{front.folder(design)}/design.json`, which `verify`, `report` and `shape` accept.")
    )
    return join([section(title, picture, folder), inner])


def _lost(front: Discovery) -> Raw:
    if not front.alternatives:
        return Raw("")
    rows = [
        [str(one.springs), ", ".join(one.places), text(one.value, front.unit), one.reason] for one in front.alternatives
    ]
    head = ["parts", "where", "reached", "why it lost"]
    lead = "Values of refined contenders are those over the few poses of the refinement."
    return section("Alternatives considered", table(head, rows, numbers=4), lead=lead)


def _floors(front: Discovery) -> Raw:
    if not front.bounds:
        return Raw("")
    rows = [[bound.row, text(bound.value, bound.unit), CAUSES[bound.cause]] for bound in front.bounds]
    return section("Floors", table(["joint", "floor", "because"], rows, numbers=3))


def _dictionary(front: Discovery) -> Raw:
    rows = [
        ["candidates", f"{front.candidates} over {front.poses} states"],
        ["rank", f"{front.rank}; the largest share of a column outside is {sig(front.lost, 2)}"],
        ["points", f"{text(front.spacing, 'm', 3)} apart, within {text(front.margin, 'm', 3)} of the links"],
        ["pairs and places", "; ".join(front.pairs)],
        *[[f"left out: {reason}", str(count)] for reason, count in front.refused.items() if count],
    ]
    return section("How they were looked for", table(["", ""], rows, numbers=2))
