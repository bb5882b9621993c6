"""Geometry parameters by name: `s1.path.line.0.z` reads and replaces a number inside frozen balancers."""

from __future__ import annotations

import fnmatch
import functools
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from typing import Any, TypeVar, cast

import numpy as np

from equipoise.errors import InputError, nearest
from equipoise.mechanism import Point
from equipoise.units import along_path, unit_marks

AXES = {"x": 0, "y": 1, "z": 2}
Item = TypeVar("Item", bound=Any)
Changes = dict[tuple[str, ...], tuple[Any, str]]
"""What changes within an item: {words that lead there: (value, the parameter's whole name)}."""


@functools.cache
def tag(cls: type) -> str:
    """The word that names a class in a problem file: ZeroFreeLength -> zero_free_length."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", cls.__name__).lower()


def read(balancers: Sequence[Item], name: str) -> float | None:
    """The present value of a parameter, None where it is left open; raises InputError for a name that leads nowhere.

    Of a name with a `*`, which stands for a parameter that several balancers share, the first one's value.
    """
    (balancer, *_), keys = _start(balancers, name)
    value = _walk(balancer, keys, name)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{name} is not a number", where="shape", hint=nearest(keys[-1], _choices(value)))
    return float(value)


def write(balancers: Sequence[Item], values: Mapping[str, Any]) -> tuple[Item, ...]:
    """The same balancers with parameters replaced; values may be arrays that lead the states' axis."""
    changes: dict[str, Changes] = {}
    for name, value in values.items():
        sharing, keys = _start(balancers, name)
        for balancer in sharing:
            changes.setdefault(balancer.name, {})[tuple(keys)] = value, name
    return tuple(_replaced(one, changes[one.name]) if one.name in changes else one for one in balancers)


def candidates(balancers: Sequence[Item], names: Sequence[str], gamma: Any) -> tuple[Item, ...]:
    """Balancers that carry all candidates gamma (C, G) at once, on an axis before the states'."""
    return write(balancers, {name: np.asarray(gamma)[:, [index]] for index, name in enumerate(names)})


def unit_of(balancers: Sequence[Any], name: str) -> str:
    """SI unit of a parameter, from the type of the field that holds it."""
    (balancer, *_), keys = _start(balancers, name)
    parent = _walk(balancer, keys[:-1], name)
    if not is_dataclass(parent) or isinstance(parent, Point):
        return "m"
    along = _along(parent, _along(getattr(balancer, "path", None), "m"))
    return along_path(unit_marks(type(parent)).get(keys[-1], ""), along)


def _along(item: Any, above: str) -> str:
    """The unit of a path's own length, `m` or `rad`; of what is no path the unit of the path it belongs to."""
    return getattr(item, "unit", above)


def geometry(balancer: Any) -> tuple[tuple[str, str], ...]:
    """Names of all numbers that say where a balancer acts, with their SI units: of its path, or its place."""
    if hasattr(balancer, "path"):
        return tuple(_numbers(balancer.path, f"{balancer.name}.path", balancer.path.unit))
    if getattr(balancer, "at", None) is not None:
        return tuple((f"{balancer.name}.at.{axis}", "m") for axis in AXES)
    return ()


def _numbers(item: Any, name: str, along: str) -> Iterator[tuple[str, str]]:
    if isinstance(item, Point):
        yield from ((f"{name}.{axis}", "m") for axis in AXES)
    elif isinstance(item, tuple):
        for index, entry in enumerate(item):
            yield from _numbers(entry, f"{name}.{index}", along)
    elif is_dataclass(item) and not isinstance(item, type):
        marks, along = unit_marks(type(item)), _along(item, along)
        for field in fields(item):
            value, inner = getattr(item, field.name), f"{name}.{_written(item, field.name)}"
            if is_dataclass(value) or (isinstance(value, tuple) and any(is_dataclass(entry) for entry in value)):
                yield from _numbers(value, inner, along)
            elif marks.get(field.name) and isinstance(value, int | float) and not isinstance(value, bool):
                yield inner, along_path(marks[field.name], along)


def _written(item: Any, field: str) -> str:
    """How a problem file writes a field: by name, but the ends of a line, which is a list, by number."""
    ends = [one.name for one in fields(item)]
    return f"{tag(type(item))}.{ends.index(field)}" if all(isinstance(getattr(item, e), Point) for e in ends) else field


def reaches(balancers: Sequence[Item], name: str) -> tuple[str, ...]:
    """The parameters that a name with a `*` stands for, one per balancer; of any other name itself."""
    sharing, keys = _start(balancers, name)
    return tuple(".".join([balancer.name, *keys]) for balancer in sharing)


def _start(balancers: Sequence[Item], name: str) -> tuple[list[Item], list[str]]:
    """The balancers whose names match the first word, `*` for any letters, and the words behind it."""
    head, *keys = name.split(".")
    found = [balancer for balancer in balancers if fnmatch.fnmatchcase(balancer.name, head)]
    if not found:
        raise InputError(
            f"there is no balancer {head!r}", where=f"shape.{name}", hint=nearest(head, [b.name for b in balancers])
        )
    if not keys:
        raise InputError(f"{name!r} names no parameter", where="shape", hint=f"for example {head}.law.k")
    return found, keys


def _walk(item: Any, keys: Sequence[str], name: str) -> Any:
    for key in keys:
        item = _child(item, key, name)
    return item


def _child(item: Any, key: str, name: str) -> Any:
    if isinstance(item, Point) and key in AXES:
        return item.at[AXES[key]]
    if is_dataclass(item) and key == tag(type(item)):
        return item
    if is_dataclass(item):
        names = [field.name for field in fields(item)]
        if key.isdigit() and int(key) < len(names):
            return getattr(item, names[int(key)])
        if key in names:
            return getattr(item, key)
    elif isinstance(item, tuple) and (key in AXES or key.isdigit()):
        index = AXES.get(key, int(key) if key.isdigit() else 0)
        if index < len(item):
            return item[index]
    raise InputError(f"{key!r} leads nowhere", where=f"shape.{name}", hint=nearest(key, _choices(item)))


def _choices(item: Any) -> list[str]:
    if isinstance(item, Point):
        return list(AXES)
    if is_dataclass(item):
        return [field.name for field in fields(item)]
    return list(AXES) if isinstance(item, tuple) else []


def _replaced(item: Any, changes: Changes) -> Any:
    """The item with everything that changes within it replaced at once."""
    inside: dict[str, Changes] = {}
    for (key, *rest), change in changes.items():
        if rest and is_dataclass(item) and key == tag(type(item)):
            key, *rest = rest  # noqa: PLW2901
        inside.setdefault(key, {})[tuple(rest)] = change
    new = {key: _changed(item, key, within) for key, within in inside.items()}
    if isinstance(item, tuple):
        return tuple(_entries(item, new))
    if isinstance(item, Point) and new.keys() <= AXES.keys():
        return replace(item, at=tuple(_entries(item.at, new)))
    names = [field.name for field in fields(item)]
    return replace(cast(Any, item), **{names[int(key)] if key.isdigit() else key: new[key] for key in new})


def _changed(item: Any, key: str, within: Changes) -> Any:
    """What stands under a key, with the changes within it."""
    child = _child(item, key, next(iter(within.values()))[1])
    return within[()][0] if () in within else _replaced(child, within)


def _entries(entries: tuple[Any, ...], new: Mapping[str, Any]) -> list[Any]:
    """The entries with some of them, by number or axis, replaced."""
    placed = {AXES.get(key, int(key) if key.isdigit() else 0): value for key, value in new.items()}
    return [placed.get(index, entry) for index, entry in enumerate(entries)]
