"""Numbers as engineers read them: three to four significant digits, mm and degrees, never ten digits."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from equipoise.row import Row

SHOWN = {
    "m": (1e3, "mm"),
    "rad": (180 / math.pi, "deg"),
    "m^2": (1e6, "mm^2"),
    "m^3": (1e3, "L"),
    "Pa": (1e-5, "bar"),
}
FREEZING = 273.15
SMALL = 1e-4
LARGE = 1e7
UNLOADED = 1e-6
UNSEEN = 1e-11
MINOR = 1e-2


def sig(value: float, digits: int = 4) -> str:
    """A number with `digits` significant digits; powers of ten only below 1e-4 and above 1e7."""
    if not math.isfinite(value):
        return "none" if math.isnan(value) else ("-inf" if value < 0 else "inf")
    if value == 0:
        return "0"
    rounded = float(f"{value:.{digits - 1}e}")
    if not SMALL <= abs(rounded) < LARGE:
        mantissa, exponent = f"{value:.{min(digits, 2) - 1}e}".split("e")
        return f"{mantissa.removesuffix('.0')}e{int(exponent)}"
    return f"{value:.{max(0, digits - 1 - math.floor(math.log10(abs(rounded))))}f}"


def seen(value: float) -> float:
    """An effort, N or N m, without the trace that a body without mass leaves."""
    return value if abs(value) > UNSEEN else 0.0


def plain(value: float, digits: int = 4) -> str:
    """As `sig`, without trailing zeros: for limits and inputs that were given round."""
    text = sig(value, digits)
    return text.rstrip("0").rstrip(".") if "." in text and "e" not in text else text


def shown(value: float, unit: str) -> tuple[float, str]:
    """The value in a workshop's unit: mm for m, degrees, litres, bar, deg C, percent for shares of the motor limit."""
    if unit == "of the motor limit":
        return 100 * value, "% of the motor limit"
    if unit == "K":
        return value - FREEZING, "deg C"
    factor, name = SHOWN.get(unit, (1.0, unit))
    return factor * value, name


def headed(unit: str) -> str:
    """A unit as it stands over a column: `% of motor` for shares of the motor limit."""
    return shown(0.0, unit)[1].replace("the motor limit", "motor")


def quantity(value: float, unit: str, digits: int = 4) -> str:
    """A value with its unit, lengths in mm and angles in degrees."""
    number, name = shown(value, unit)
    return f"{plain(number, digits)} {name}".rstrip()


def span(ends: Sequence[float], unit: str, digits: int = 3) -> str:
    """`150 to 448 mm`, or one value where both read the same."""
    (a, name), (b, _) = shown(ends[0], unit), shown(ends[1], unit)
    size = max(abs(a), abs(b))
    # A range whose lower end is zero to working accuracy reads 0, not 3e-15.
    first, last = (plain(0.0 if abs(x) < 1e-9 * size else x, digits) for x in (a, b))
    return f"{first} {name}" if first == last else f"{first} to {last} {name}"


def place(point: Mapping[str, Any] | Sequence[float]) -> str:
    """Coordinates of a point in mm: `(0, 220, 150) mm`."""
    at = point["at"] if isinstance(point, Mapping) else point
    coordinates = (1e3 * float(value) for value in at)
    return "(" + ", ".join(plain(round(value, 2) + 0.0, 5) for value in coordinates) + ") mm"


def percent(share: float) -> str:
    """A share as a percentage with two to three digits."""
    return f"{plain(100 * share, 3)} %" if share >= SMALL / 10 or share == 0 else "< 0.001 %"


def effort_word(unit: str) -> str:
    """What a driven joint supplies: a torque or a force."""
    return {"N m": "torque", "N": "force"}.get(unit, "effort")


def loads(before: Mapping[str, Row], after: Mapping[str, Row] | None = None) -> dict[str, float]:
    """Per joint its largest peak as a share of the largest of the same unit, before or after."""
    peak = {name: max(row.peak, after[name].peak if after else 0.0) for name, row in before.items()}
    largest: dict[str, float] = {}
    for name, row in before.items():
        largest[row.unit] = max(largest.get(row.unit, 0.0), peak[name])
    return {name: peak[name] / (largest[row.unit] or 1.0) for name, row in before.items()}


def sort_out(
    before: Mapping[str, Row], after: Mapping[str, Row] | None = None
) -> tuple[list[str], list[str], list[str]]:
    """Joints that matter, joints with hardly any load (under 1 % of the largest), joints with none."""
    share = loads(before, after)
    matter, minor, none = [], [], []
    for name, row in before.items():
        used = row.peak / row.limit if row.limit else 0.0
        if share[name] <= UNLOADED:
            none.append(name)
        elif share[name] < MINOR and used < 10 * MINOR:
            minor.append(name)
        else:
            matter.append(name)
    return matter, minor, none
