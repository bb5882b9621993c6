"""Balancers and limits as the plain data that a problem file holds: the constructors read back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, fields, is_dataclass
from typing import Any

from equipoise import tags
from equipoise.assemble import Balancer
from equipoise.errors import InputError
from equipoise.limits import Limit
from equipoise.mechanism import Point

TABLES = (
    tags.BALANCERS,
    tags.PATHS,
    tags.LAWS,
    tags.PULLEYS,
    tags.MASSES,
    tags.SHAPES,
    tags.EXPONENTS,
    tags.PROFILES,
)


def plain_problem(
    content: Mapping[str, Any],
    balancers: Sequence[Balancer],
    limits: Sequence[Limit],
    bounds: Mapping[str, tuple[float, float]],
) -> dict[str, Any]:
    """A problem file's content with its search replaced by what was found."""
    kept = {key: value for key, value in content.items() if key not in ("discover", "balancers", "shape", "limits")}
    kept["balancers"] = [plain(balancer) for balancer in balancers]
    kept["limits"] = [plain_limit(limit) for limit in limits]
    if bounds:
        kept["shape"] = {name: [float(low), float(high)] for name, (low, high) in bounds.items()}
    return kept


def plain(value: Any) -> Any:
    """A value as YAML would hold it; raises InputError for what no problem file can say."""
    if isinstance(value, Point):
        return [value.body, *(float(v) for v in value.at)]
    if is_dataclass(value):
        return {_tag(type(value)): _fields(value)}
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [plain(item) for item in value]
    if isinstance(value, bool) or value is None or isinstance(value, str | int):
        return value
    number: Any = value
    return float(number)


def plain_limit(limit: Limit) -> dict[str, Any]:
    """A limit: its tag holds its first field, the others stand beside it."""
    tag = next((tag for tag, kind in tags.LIMITS.items() if kind is type(limit)), None)
    if tag is None:
        raise InputError(f"no problem file can say the limit {type(limit).__name__}", where="limits")
    first, *_ = fields(limit)  # type: ignore[arg-type]
    said = _fields(limit)
    return {tag: said.pop(first.name), **said}


def _fields(value: Any) -> dict[str, Any]:
    """Fields that differ from their defaults; an unknown without a default is left out, which is how it is said."""
    found = {}
    for field in fields(value):
        item = getattr(value, field.name)
        if item == field.default or (item is None and field.default is MISSING):
            continue
        found[field.name] = plain(item)
    return found


def _tag(kind: type) -> str:
    for table in TABLES:
        for tag, member in table.items():
            if member is kind:
                return tag
    raise InputError(f"no problem file can say {kind.__name__}", where="problem")
