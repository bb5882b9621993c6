"""Units at the edges: text to SI and SI to text, through one lazily built pint registry."""

from __future__ import annotations

import functools
import math
import re
import typing
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Annotated, Any

from equipoise.errors import InputError


@dataclass(frozen=True)
class Quantity:
    """Marks a field as a physical quantity whose bare number is in the SI unit `unit`."""

    unit: str


Length = Annotated[float, Quantity("m")]
Mass = Annotated[float, Quantity("kg")]
Angle = Annotated[float, Quantity("rad")]
Force = Annotated[float, Quantity("N")]
Energy = Annotated[float, Quantity("J")]
Torque = Annotated[float, Quantity("N m")]
Stiffness = Annotated[float, Quantity("N/m")]
Inertia = Annotated[float, Quantity("kg m^2")]
Acceleration = Annotated[float, Quantity("m/s^2")]
Pressure = Annotated[float, Quantity("Pa")]
Density = Annotated[float, Quantity("kg/m^3")]
Speed = Annotated[float, Quantity("rad/s")]
Power = Annotated[float, Quantity("W")]
Time = Annotated[float, Quantity("s")]
Area = Annotated[float, Quantity("m^2")]
Volume = Annotated[float, Quantity("m^3")]
Temperature = Annotated[float, Quantity("K")]
TorsionRate = Annotated[float, Quantity("N m/rad")]
LinearDensity = Annotated[float, Quantity("kg/m")]
Number = Annotated[float, Quantity("")]
Extent = Annotated[float, Quantity("m or rad")]
Pull = Annotated[float, Quantity("N or N m")]
Rate = Annotated[float, Quantity("N/m or N m/rad")]
Bend = Annotated[float, Quantity("N/m^2 or N m/rad^2")]
Joint = Annotated[float, Quantity("rad or m")]
Effort = Annotated[float, Quantity("N m or N or kg or ratio")]


class Measured(float):
    """A number in SI that remembers which of several admissible units its text was written in."""

    unit: str

    def __new__(cls, value: float, unit: str) -> Measured:
        """The number with its unit."""
        self = super().__new__(cls, value)
        self.unit = unit
        return self


# A number and a product of powers of units: what pint evaluates stays as small as what one reads.
_QUANTITY = re.compile(
    r"[-+]?\s*+(?:\d++\.?\d*+|\.\d++)(?:[eE][-+]?\d++)?"
    r"(?:\s*+[/*]?+\s*+[^\W\d_]++|\s*+[%°]|(?<=[^\W\d_])(?:\^|\*\*)-?\d(?!\d))*+"
)
_SHARE = re.compile(r"[-+]?\d{1,9}\s*/\s*0*[1-9]\d{0,8}")
_NM = re.compile(r"\bNm\b|(?<=\d)Nm\b")


COMMON = {
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254},
    "rad": {"rad": 1.0, "deg": math.pi / 180},
    "kg": {"kg": 1.0, "g": 1e-3, "lb": 0.45359237},
    "N": {"N": 1.0, "kN": 1e3},
    "N m": {"N m": 1.0, "Nm": 1.0},
    "N/m": {"N/m": 1.0, "N/mm": 1e3, "kN/m": 1e3},
    "J": {"J": 1.0},
    "s": {"s": 1.0, "ms": 1e-3},
    "": {"%": 1e-2},
}
"""Factors of what most files say: to read these takes no registry, whose start takes longer than most commands."""
_PLAIN = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\d\s].*)")


@functools.cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


def to_si(value: Any, unit: str, where: str = "") -> float:
    """Turn a bare number (already SI) or text such as `12 kg` into a float in `unit`; without a unit also `1/3`.

    unit may name several, `rad or m`: text then answers a `Measured` in the one that fits.
    Raises InputError for text pint cannot read, a unit of another dimension, NaN or infinity.
    """
    if isinstance(value, bool):
        raise InputError(f"expected a quantity in {unit or 'no unit'}, got {value}", where=where)
    if isinstance(value, int | float):
        number = float(value)
    elif isinstance(value, str):
        number = _parse(value, unit, where)
    else:
        raise InputError(f"expected a quantity in {unit or 'no unit'}, got {type(value).__name__}", where=where)
    if not math.isfinite(number):
        raise InputError(f"the value {value} is not a finite number", where=where, hint="give a finite number")
    return number


def _parse(text: str, unit: str, where: str) -> float:
    options = unit.split(" or ")
    example = f"write for example '1.5 {options[0]}'" if unit else "give a bare number"
    unreadable = InputError(
        f"cannot read {text[:64]!r} as a quantity in {unit or 'no unit'}", where=where, hint=example
    )
    if not unit and _SHARE.fullmatch(text.strip()):
        above, below = text.split("/")
        return float(above) / float(below)
    if len(text) > 64 or not _QUANTITY.fullmatch(text.strip()):
        raise unreadable
    plain = _PLAIN.fullmatch(text.strip())
    written, name = plain.groups() if plain else ("", "")
    for option in options:
        if name in COMMON.get(option, {}):
            number = float(written) * COMMON[option][name]
            return number if len(options) == 1 else Measured(number, option)
    try:
        # Pint takes Nm for a count of yarn.
        quantity = _registry().Quantity(_NM.sub("N m", text))
        for option in options:
            name = option if option not in ("", "ratio") else "dimensionless"
            # To pint an angle is a ratio; a percentage of one is not what anybody means.
            if quantity.is_compatible_with(name) and not (option == "rad" and "%" in text):
                number = float(quantity.to(name).magnitude)
                return number if len(options) == 1 else Measured(number, "" if quantity.unitless else option)
    except Exception:  # pint raises many kinds for malformed text
        raise unreadable from None
    raise InputError(
        f"{text!r} is {quantity.dimensionality}, expected a quantity in {unit or 'no unit'}",
        where=where,
        hint=f"give it in {unit}, or as a bare number in SI" if unit else "give a bare number",
    )


def unit_marks(cls: type) -> dict[str, str]:
    """The units of a dataclass's quantities {field: unit}, from the types of its fields."""
    hints = typing.get_type_hints(cls, include_extras=True)
    marks = {field.name: _mark(hints[field.name]) for field in fields(cls)}
    return {name: unit for name, unit in marks.items() if unit is not None}


def _mark(hint: Any) -> str | None:
    for part in (*getattr(hint, "__metadata__", ()), *getattr(hint, "__args__", ())):
        unit = part.unit if isinstance(part, Quantity) else _mark(part)
        if unit is not None:
            return unit
    return None


def along_path(unit: str, along: str) -> str:
    """Of a unit such as `N/m or N m/rad` the part that counts on a path in m (the first) or in rad (the last).

    Where the path's own unit is among them, as in `rad or m`, it is that.
    """
    options = unit.split(" or ")
    if along in options:
        return along
    return options[0] if along == "m" else options[-1]


def text(value: float, unit: str, digits: int = 4) -> str:
    """Format an SI value with `digits` significant digits and its unit."""
    number = f"{value:.{digits}g}"
    if "e" in number and 1e-4 <= abs(value) < 1e7:
        number = f"{value:.0f}"
    return f"{number} {unit}".rstrip()


def enumerated(words: Sequence[str]) -> str:
    """`a, b and c`."""
    return " and ".join(filter(None, [", ".join(words[:-1]), *words[-1:]]))
