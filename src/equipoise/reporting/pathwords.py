"""What a path is made of, in words: cranks, rods, pulleys and what drives them, as a workshop needs them."""

from __future__ import annotations

from dataclasses import MISSING, fields, is_dataclass
from typing import Any

from equipoise.balancers.paths import Cable, Mount, Profile, Pulley
from equipoise.mechanism import Point
from equipoise.parameters import tag
from equipoise.reporting.numbers import place, quantity
from equipoise.units import along_path, unit_marks

SPEAKING = ("joint", "body", "through", "input", "mount", "at")
"""Fields whose values say what they are."""


def path_words(path: Any) -> str:
    """`slider crank: input angle link2_joint, crank 150 mm, rod 400 mm`; what has its default value is left out."""
    return f"{_kind(path)}: {', '.join(_fields(path))}"


def _kind(item: Any) -> str:
    return tag(type(item)).replace("_", " ")


def _fields(item: Any) -> list[str]:
    marks = unit_marks(type(item))
    words = []
    for field in fields(item):
        value = getattr(item, field.name)
        if field.default is not MISSING and value == field.default:
            continue
        if isinstance(item, Cable) and field.name == "ratio" and _falls(value) > 1:
            words.append(f"tackle of {_falls(value)} falls")
            continue
        name = field.name.replace("_", " ")
        unit = along_path(marks.get(field.name, ""), getattr(item, "unit", "m"))
        text = place(value) if field.name == "at" and isinstance(value, tuple) else _value(value, unit)
        words.append(text if field.name in SPEAKING else f"{name} {text}")
    return words


def _falls(ratio: float) -> int:
    """How many falls a tackle of this ratio has, 0 where it is none."""
    falls = round(1 / ratio) if 0 < ratio <= 1 else 0
    return falls if falls and abs(falls * ratio - 1) < 1e-9 else 0


def _part(value: Any) -> str:
    """A piece of a path; a pulley of no size and mass is an eye."""
    if isinstance(value, Pulley) and not value.radius and not value.mass:
        return f"eye ({value.body} {place(value.at)})"
    inner = ", ".join(_fields(value))
    return f"mounted at {inner}" if isinstance(value, Mount) else f"{_kind(value)} ({inner})"


def _value(value: Any, unit: str) -> str:
    if isinstance(value, Point):
        return f"{value.body} {place(value.at)}"
    if isinstance(value, Profile):
        return f"of {len(value.angles)} points"
    if is_dataclass(value):
        return _part(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        if isinstance(value, tuple):
            numbers = value and all(isinstance(entry, int | float) for entry in value)
            inner = [f"{entry:g}" if numbers and not unit else _value(entry, unit) for entry in value]
            return f"({', '.join(inner)})" if numbers else " - ".join(inner)
        return str(value)
    return quantity(float(value), unit)
