"""Units at the edges: text to SI and SI to text, through one lazily built pint registry."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
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
Torque = Annotated[float, Quantity("N m")]
Stiffness = Annotated[float, Quantity("N/m")]
Acceleration = Annotated[float, Quantity("m/s^2")]
Pressure = Annotated[float, Quantity("Pa")]
Density = Annotated[float, Quantity("kg/m^3")]
Number = Annotated[float, Quantity("")]


@functools.cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


def to_si(value: Any, unit: str, where: str = "") -> float:
    """Turn a bare number (already SI) or text such as `12 kg` into a float in `unit`.

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
    import pint

    if len(text) > 64 or "**" in text:
        raise InputError(f"cannot read {text[:32]!r}... as a quantity", where=where)
    try:
        quantity = _registry().Quantity(text)
        return float(quantity.to(unit or "dimensionless").magnitude)
    except pint.DimensionalityError as error:
        raise InputError(
            f"{text!r} is {error.dim1 or 'dimensionless'}, expected a quantity in {unit or 'no unit'}",
            where=where,
            hint=f"give it in {unit}, or as a bare number in {unit}" if unit else "give a bare number",
        ) from None
    except Exception:  # noqa: BLE001 - pint raises many kinds for malformed text
        raise InputError(
            f"cannot read {text!r} as a quantity in {unit or 'no unit'}",
            where=where,
            hint=f"write for example '1.5 {unit}'" if unit else "give a bare number",
        ) from None


def text(value: float, unit: str, digits: int = 4) -> str:
    """Format an SI value with `digits` significant digits and its unit."""
    number = f"{value:.{digits}g}"
    if "e" in number and 1e-4 <= abs(value) < 1e7:
        number = f"{value:.0f}"
    return f"{number} {unit}".rstrip()
