"""What is adjusted from case to case: settings, travel, the work to turn an adjuster, and what is left in each."""

from __future__ import annotations

from typing import TYPE_CHECKING

from equipoise.cases import Adjuster, Settings
from equipoise.design import Design
from equipoise.reporting.markup import Raw, element, section, table
from equipoise.reporting.numbers import quantity, sig

if TYPE_CHECKING:
    from equipoise.verbs.adjusted import Adjusted

NOTE = (
    "Everything else is shared. Work is the change of the stored energy from the first setting, with the mechanism "
    "held: where the pose decides, least and greatest; turn it in the pose that takes least. Friction comes on top."
)


def summary(adjusted: Adjusted) -> str:
    """The hardest case's design, then a line per case with its settings."""
    design = adjusted.designs[adjusted.hardest]
    settings = design.settings
    assert settings is not None
    cells = _cells(settings)
    widths = [max(len(row[i]) for row in cells) for i in range(len(cells[0]))]
    lines = [
        "  " + "  ".join(cell.ljust(width) if i == 0 else cell.rjust(width) for i, (cell, width) in enumerate(pairs))
        for pairs in ([*zip(row, widths, strict=True)] for row in cells)
    ]
    travel = [
        f"travel      {a.name}: {quantity(a.travel, a.unit)}{_whole_work(a)}" for a in settings.adjusters if a.travel
    ]
    return "\n".join([f"{len(settings.labels)} cases, shown in {settings.label}:", str(design), "", *lines, *travel])


def _whole_work(adjuster: Adjuster) -> str:
    if adjuster.work is None:
        return ""
    low = min(min(pair) for pair in adjuster.work)
    high = max(max(pair) for pair in adjuster.work)
    return f", work to turn it {_span(low, high)}"


def _span(low: float, high: float) -> str:
    return (
        f"{sig(low, 3)} J"
        if abs(high - low) <= 1e-9 * max(abs(low), abs(high))
        else f"{sig(low, 3)} to {sig(high, 3)} J"
    )


def _cells(settings: Settings) -> list[list[str]]:
    """Head and rows: case, settings with their work, what is left."""
    head = ["case"]
    for adjuster in settings.adjusters:
        head += [adjuster.name, *(["work from the first"] if adjuster.work else [])]
    rows = [[*head, "peak left"]]
    for i, label in enumerate(settings.labels):
        row = [label]
        for adjuster in settings.adjusters:
            row.append(quantity(adjuster.values[i], adjuster.unit, 6))
            row += [_span(*adjuster.work[i])] if adjuster.work else []
        rows.append([*row, sig(settings.peaks[i], 3)])
    return rows


def settings_table(design: Design) -> Raw | str:
    """The page's table of settings; nothing where a design serves one case."""
    if design.settings is None:
        return ""
    head, *rows = _cells(design.settings)
    lead = f"This page shows the design in the case {design.settings.label}."
    return section(
        "Settings from case to case", table(head, rows, numbers=1), element("p", NOTE, class_="note"), lead=lead
    )
