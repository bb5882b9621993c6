"""The report of a discovery: the front, its designs with attachment coordinates, what was considered and lost."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from equipoise import __version__
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.discovery import words
from equipoise.discovery.front import Discovery
from equipoise.interference.findings import clash_words, room_words
from equipoise.reporting import phrases, style, tables
from equipoise.reporting.alternatives import alternatives
from equipoise.reporting.drawing import drawing
from equipoise.reporting.friction import friction_words
from equipoise.reporting.html import document
from equipoise.reporting.markup import Raw, element, image, join, prose, section, table
from equipoise.reporting.numbers import headed, quantity, shown, sig
from equipoise.reporting.ordering import broken, mounting
from equipoise.reporting.sample import Sample
from equipoise.reporting.tolerance import tolerance_words
from equipoise.units import along_path

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
            alternatives(front.designs),
            _floors(front),
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
    left = words.value_words(front, front.values[front.recommended])
    result = (
        f"{words.counted(count)} lower{'s' * (count == 1)} the {front.aim.norm} from "
        f"{words.value_words(front, front.before)} to {left}"
    )
    if front.highs:
        result += f"; 95 of 100 specimens stay below {words.value_words(front, front.highs[front.recommended])}"
    told = [
        element("p", f"Target {said}.", class_="sub-line") for label, said in words.told(front) if label == "target"
    ]
    return element(
        "header",
        element("p", "Discovery of springs", class_="kicker"),
        element("h1", f"Which springs for {best.mechanism.name}"),
        element("p", f"{result}.", class_="result"),
        *told,
        element("p", best.sweep.describe(), class_="sub-line"),
    )


def _chart(front: Discovery) -> Raw:
    with style.styled():
        address = style.picture(chart(front))
    said = f"{front.aim.norm} over the number of parts: " + ", ".join(
        f"{count} {words.value_words(front, value)}" for count, value in _points(front)
    )
    caption = "The best design found with each number of parts; grey: choices that lost. "
    caption += "Bars: 5 to 95 % of specimens whose parts are as they come. " if front.highs else ""
    caption += "Dashed: the highest floor, which no fixed part can lower." if front.bounds else ""
    return section("The front", image(address, said, caption))


def chart(front: Discovery) -> Figure:
    """Value over the number of parts, with floors and what lost."""
    figure = style.figure(WIDTH, HEIGHT)
    ax = figure.subplots()
    factor, unit = shown(1.0, front.unit)
    counts, values = (np.array(part, dtype=float) for part in zip(*_points(front), strict=True))
    values = factor * np.maximum(values, NOTHING * front.before)
    lost = [
        (one.springs, factor * max(one.value, NOTHING * front.before))
        for one in front.alternatives
        if np.isfinite(one.value)
    ]
    if lost:
        ax.plot(*zip(*lost, strict=True), "o", color=style.LINK, markersize=5, zorder=1)
    ax.plot(counts, values, "-o", color=style.AFTER, markersize=6, zorder=3)
    ax.plot(counts[:1], values[:1], "o", color=style.BEFORE, markersize=7, zorder=4)
    for count, (design, value) in enumerate(zip(front.designs, values[1:], strict=True), 1):
        if design.tolerance is not None:
            band = design.tolerance.band
            low, high = np.maximum(np.array([band.low, band.high]) * factor, NOTHING * values[0])
            ax.plot([counts[count]] * 2, [low, max(high, value)], color=style.AFTER, lw=5, alpha=0.25, zorder=2)
    for count, value, (_, true) in zip(counts, values, _points(front), strict=True):
        ax.annotate(
            words.number(front, true),
            (count, value),
            xytext=(9, 5),
            textcoords="offset points",
            color=style.INK,
            fontsize=9,
            path_effects=style.halo(),
        )
    floor = factor * max((bound.value for bound in front.bounds), default=0.0)
    if floor > 0:
        ax.axhline(floor, color=style.LIMIT, lw=1.0, ls="--", zorder=2)
    if values.max() > WIDE * max(float(values.min()), 1e-300) and values.min() > 0:
        ax.set_yscale("log")
        ax.yaxis.set_major_formatter(lambda value, _: sig(value, 1))
        ax.yaxis.set_minor_formatter(lambda *_: "")
    else:
        ax.set_ylim(bottom=0.0)
    ax.set_xticks(np.arange(int(counts.max()) + 1))
    ax.set_xlim(-0.15, counts.max() + 0.45)
    ax.set_xlabel("number of parts")
    ax.set_ylabel(f"{front.aim.norm} [{unit}]")
    return figure


def _points(front: Discovery) -> list[tuple[int, float]]:
    found = [(len(design.balancers), value) for design, value in zip(front.designs, front.values, strict=True)]
    return [(0, front.before), *found]


def _table(front: Discovery) -> Raw:
    unit = headed(front.unit)
    rows = [["0", words.number(front, front.before), "100 %", "", "", "", "", ""]]
    for index, (design, value) in enumerate(zip(front.designs, front.values, strict=True)):
        made = design.parts()
        largest: dict[str, float] = {}
        for part in [part for part in made if "force" in part]:
            along = along_path("N or N m", part["unit"])
            largest[along] = max(largest.get(along, 0.0), *map(abs, part["force"]))
        energy = sum(part["energy"][1] for part in made if "energy" in part)
        checked = design.verification
        rows.append(
            [
                str(len(made)),
                words.number(front, value),
                words.share(front, value),
                words.number(front, front.highs[index]) if front.highs else "",
                quantity(design.added_mass, "kg", 3) if design.added_mass > 0 else "",
                ", ".join(quantity(force, along, 3) for along, force in largest.items()),
                quantity(energy, "J", 3) if largest else "",
                "not verified" if checked is None else f"{sig(checked.max_abs_error, 2)} {checked.unit}",
            ]
        )
    norms = [f"{front.aim.norm} [{unit}]", "of before", f"95 % [{unit}]"]
    head = ["parts", *norms, "mass", "largest force", "most stored", "MuJoCo differs by"]
    return section("Parts against what is left", table(head, rows))


def _design(front: Discovery, index: int) -> Raw:
    design: Design = front.designs[index]
    count = words.counted(len(design.balancers))
    with style.styled():
        drawn = drawing(Sample(design))
        picture = image(style.picture(drawn), f"{design.mechanism.name} with {count} in two poses") if drawn else ""
    title = f"With {count}: {words.value_words(front, front.values[index])}"
    folder = f"File: `{front.folder(design)}/design.json`, which `verify`, `report`, `pick` and `shape` accept."
    told = _facts(front, index)
    labels = [label for label, _ in told]
    blanked = [label if label not in labels[:place] else "" for place, label in enumerate(labels)]
    facts = table(["", ""], [[label, said] for label, (_, said) in zip(blanked, told, strict=True)], numbers=2)
    return join([section(title, picture, facts, broken(design), element("p", prose(folder))), tables.parts(design)])


def _facts(front: Discovery, index: int) -> list[tuple[str, str]]:
    """What there is to say of a design in a sentence each."""
    design = front.designs[index]
    springs = [balancer for balancer in design.balancers if isinstance(balancer, Spring)]
    facts = [("limited by", one) for one in words.limits(front, index)]
    facts.append(("certificate", phrases.certificate_words(design)))
    facts.append(("verified", phrases.verified_words(design)))
    facts += [(label or "adjusted", said) for label, said in tolerance_words(design)]
    facts += [("friction", said)] if (said := friction_words(design)) else []
    facts += [("to mount", f"{spring.name}: {' at '.join(mounting(design, spring))}") for spring in springs]
    facts += [("room", one) for one in room_words(design)]
    facts += [("clashes", one) for one in (clash_words(front.clashes[index]) if front.clashes else ())]
    return facts


def _floors(front: Discovery) -> Raw:
    matter, faint = words.floors(front)
    if not matter:
        return Raw("")
    rows = [[bound.row, quantity(bound.value, bound.unit, 3), words.CAUSES[bound.cause]] for bound in matter]
    rest = element("p", f"Next to nothing at {', '.join(faint)}.", class_="note") if faint else ""
    return section("Floors", table(["joint", "floor", "because"], rows, numbers=3), rest)


def _dictionary(front: Discovery) -> Raw:
    rows = [
        ["candidates", f"{front.candidates} over {front.poses} states"],
        ["rank", f"{front.rank}; the largest share of a column outside is {sig(front.lost, 2)}"],
        ["points", f"{quantity(front.spacing, 'm', 3)} apart, within {quantity(front.margin, 'm', 3)} of the links"],
        ["pairs and places", "; ".join(front.pairs)],
        *[["note", note] for note in front.notes],
        *[[f"left out: {reason}", str(count)] for reason, count in front.refused.items() if count],
    ]
    return section("How they were looked for", table(["", ""], rows, numbers=2))
