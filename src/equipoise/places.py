"""From the places that validation names to the file, line and field that a person looks for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from equipoise.errors import ProblemError
from equipoise.fields import BRANCH
from equipoise.forms import Reading
from equipoise.yamlfile import Document

SHOWN = 5
REMEDY = "correct it; `equipoise schema` describes every field"


def where(document: Document, reading: Reading, keys: Sequence[Any]) -> str:
    """`file, line N, balancers[0].spring.law.k` of a place; empty where there is no file."""
    node, line, path = document.data, None, ""
    inside: tuple[str, str] | None = None
    for key in keys:
        if isinstance(key, str) and key.startswith(BRANCH):
            continue
        fold = reading.folded.get(id(node))
        if fold is not None and inside is None and key == fold[0]:
            # The tag of a leading block: its fields stand beside it, so one stays in the block.
            inside, line = fold, document.line(node, key) or line
            continue
        step = inside[0] if inside is not None and key == inside[1] else key
        inside = None
        if isinstance(node, list) and step in reading.lists.get(id(node), ()):
            step = reading.lists[id(node)].index(step)
        line = document.line(node, step) or line
        path += f"[{step}]" if isinstance(step, int) else f".{step}"
        node = _entry(node, step)
    parts = [document.name, f"line {line}" if line else "", path.lstrip(".")]
    return ", ".join(part for part in parts if part)


def _entry(node: Any, key: Any) -> Any:
    if isinstance(node, Mapping):
        return node.get(key)
    return node[key] if isinstance(node, list) and isinstance(key, int) and key < len(node) else None


def problem_error(errors: Sequence[Mapping[str, Any]], document: Document, reading: Reading) -> ProblemError:
    """What pydantic found, in the order of the file, with places and next steps."""
    found = [_described(error, document, reading) for error in errors]
    found.sort(key=lambda error: _line(error.where))
    first, others = found[0], found[1:SHOWN]
    if others:
        more = "".join(f"\n{error}" for error in others)
        left = len(found) - len(others) - 1
        first.hint = (first.hint or "see below for more") + more + (f"\n... and {left} more" if left else "")
    return first


def _described(error: Mapping[str, Any], document: Document, reading: Reading) -> ProblemError:
    place = list(error["loc"])
    context = error.get("ctx", {})
    if error["type"] == "equipoise":
        if context["key"] is not None:
            place.append(context["key"])
        return ProblemError(context["message"], where=where(document, reading, place), hint=context["hint"] or REMEDY)
    if error["type"] == "missing":
        what = f"the field {place[-1]!r} is missing"
        return ProblemError(what, where=where(document, reading, place[:-1]), hint=f"add `{place[-1]}: ...`")
    return ProblemError(str(error["msg"]), where=where(document, reading, place), hint=REMEDY)


def _line(place: str) -> int:
    for part in place.split(", "):
        if part.startswith("line ") and part[5:].isdigit():
            return int(part[5:])
    return 0
