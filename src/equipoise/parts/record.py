"""A part as plain data: what a problem file would say of it."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, fields
from typing import Any

from equipoise.parameters import tag
from equipoise.parts.part import Part

FIELDS = ("name", "path", "law", "mass", "like", "mass_at")
"""Of a spring, in the order in which a list gives them."""


def plain(part: Part) -> dict[str, dict[str, Any]]:
    """{tag: {field: value}} of a part, SI, fields at their default left out."""
    said = {}
    for field in fields(part):
        value = getattr(part, field.name)
        if field.default is not MISSING and value == field.default:
            continue
        said[field.name] = value if isinstance(value, str) or value is None else float(value)
    return {tag(type(part)): said}


def with_parts(content: Mapping[str, Any], parts: Mapping[str, Part], bounds: Mapping[str, Sequence[float]]) -> dict:
    """A problem's content with parts {spring: part} for laws, and what stays free; no part is asked for again."""
    new = copy.deepcopy(dict(content))
    new.pop("pick", None)
    new.pop("start", None)
    for block in new["balancers"]:
        if not isinstance(block, dict) or "spring" not in block:
            continue
        spring: Any = block["spring"]
        if isinstance(spring, list):
            spring = block["spring"] = dict(zip(FIELDS, spring, strict=False))
        name = str(spring.get("like") or spring["name"])
        if name in parts:
            spring["law"] = plain(parts[name])
            if not isinstance(spring.get("mass", 0.0), int | float | str):
                spring.pop("mass")
    if bounds:
        new["shape"] = {name: [float(low), float(high)] for name, (low, high) in bounds.items()}
    else:
        new.pop("shape", None)
    return new
