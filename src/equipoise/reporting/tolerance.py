"""How a design scatters, in words and as a part of the page."""

from __future__ import annotations

from equipoise.design import Design
from equipoise.reporting.markup import Raw, element, prose, section, table
from equipoise.reporting.numbers import percent, plain, quantity, sig
from equipoise.scattering import Band, Tolerance

SHOWN = 8
NOTE = (
    "Errors are independent and normal, the tolerance is two standard deviations, temperature acts on all springs "
    "alike; a source alone is what the design becomes in 95 of 100 specimens when nothing else is off. An adjuster is "
    "set anew for every specimen. Set your own with `tolerances` in the problem file; the defaults are unsourced."
)


def tolerance_words(design: Design) -> list[tuple[str, str]]:
    """Label and words: the band, who is to blame, what takes it back."""
    found = design.tolerance
    if found is None:
        return []
    worst, best = found.worst, found.adjuster
    words = f"{_range(found.band, found)} in 90 of 100 specimens"
    if worst is not None:
        words += f", most by {worst.name} (± {_size(worst.tolerance, worst.unit)})"
    lines = [("tolerance", words)]
    if best is not None and best.band.high < found.band.high:
        travel = _size(best.travel / 2, best.unit)
        lines.append(("", f"adjusting {best.name} by ± {travel} takes that to {_range(best.band, found)}"))
    return lines


def tolerance_section(design: Design) -> Raw | str:
    """The page's part on errors; nothing where they were not followed."""
    found = design.tolerance
    if found is None:
        return ""
    rows = [["as designed", "", "", _value(found.band.nominal, found), ""]]
    rows.append(["everything off at once", "", *_cells(found.band, found)])
    if found.adjuster is not None:
        best = found.adjuster
        rows.append([f"and {best.name} adjusted", f"± {_size(best.travel / 2, best.unit)}", *_cells(best.band, found)])
    head = [f"{found.norm} [{found.unit}]", "travel", "5 %", "50 %", "95 %"]
    alone = [[one.name, f"± {_size(one.tolerance, one.unit)}", _value(one.high, found)] for one in found.alone[:SHOWN]]
    samples = f"{found.samples:,}".replace(",", "\u202f")
    return section(
        "When parts are as they come",
        table(head, rows, numbers=1),
        table(["by itself", "tolerance", "95 %"], alone, numbers=1) if alone else "",
        element("p", prose(NOTE), class_="note"),
        lead=f"{samples} specimens drawn with seed {found.seed}, each judged at {found.poses} rows of poses.",
    )


def _cells(band: Band, found: Tolerance) -> list[str]:
    return [_value(value, found) for value in (band.low, band.median, band.high)]


def _range(band: Band, found: Tolerance) -> str:
    return f"{_value(band.low, found)} to {_value(band.high, found)} {found.unit}"


def _value(value: float, found: Tolerance) -> str:
    return percent(value) if found.unit.startswith("of ") else sig(value, 3)


def _size(value: float, unit: str) -> str:
    if unit == "K":
        return f"{plain(value, 3)} K"
    return quantity(value, unit, 3) if unit else percent(value)
