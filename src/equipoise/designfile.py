"""design.json as a design again: the problem rebuilt, the found values put in, nothing solved anew."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from equipoise.affine import merge_unknowns
from equipoise.assemble import Balancer, account
from equipoise.certificate import Active, Certificate
from equipoise.design import Design
from equipoise.discovery.alternative import Alternative
from equipoise.errors import ProblemError
from equipoise.floors import Floor
from equipoise.mechanism import Mechanism
from equipoise.parameters import unit_of, write
from equipoise.parts.choice import Choice
from equipoise.problem import Problem, problem_of
from equipoise.steepness import Account
from equipoise.sweep import Sweep
from equipoise.verbs.analyze import before_and_after
from equipoise.verbs.place import Placed, put
from equipoise.yamlfile import Document

MAX_BYTES = 64 * 1024 * 1024
CHANGED = 1e-6

T = TypeVar("T")


def with_problem(design: Design, problem: Problem, out: Path | None) -> Design:
    """The design with what it takes to rebuild it: the file's content, and its folder as seen from `out`."""
    folder = os.path.relpath(problem.folder.absolute(), (out or Path()).absolute())
    file = Path(problem.document.name).name if design.problem is None else design.problem.get("file", "")
    record = {"file": file, "folder": Path(folder).as_posix(), "content": problem.raw}
    if design.settings is not None:
        record["case"] = design.settings.case
    return replace(design, problem=record, friction=problem.content.friction)


def load_design(path: Path) -> tuple[Problem, Design, tuple[str, ...]]:
    """Read design.json: its problem, the design, and remarks where its tables are not what its values give.

    Raises ProblemError for a file that is no design, or whose values do not fit its problem.
    """
    name = str(path)
    data = _read(path, name)
    record = data["problem"]
    folder = path.parent / str(record.get("folder", "."))
    problem = problem_of(Document(f"{name}, problem", record["content"]), folder)
    problem.check()
    geometry, values = (_values(data, key, name) for key in ("geometry", "unknowns"))
    ranges = problem.bounds | {name: pair for name, pair in problem.adjusters.items() if pair}
    for parameter in geometry:
        if parameter not in ranges:
            raise ProblemError(f"geometry {parameter!r} is not in the problem's `shape`", where=name)
    balancers = write(problem.balancers, geometry)
    mechanism, sweep = _case(problem, record, name)
    states = mechanism.states(sweep)
    places = _places(data, name)
    balancers = put(balancers, states, places)
    unknowns = merge_unknowns([balancer.unknowns for balancer in balancers])
    missing = [unknown.name for unknown in unknowns if unknown.name not in values]
    if missing:
        raise ProblemError(f"there is no value for {', '.join(missing)}", where=f"{name}, unknowns")
    ordered = {unknown.name: values[unknown.name] for unknown in unknowns}

    def told(parts: tuple[Balancer, ...]) -> Account:
        return lambda other: account(mechanism, parts, other, problem.objective, ordered)

    before, after = before_and_after(mechanism, sweep, states, told(()), told(balancers))
    design = Design(
        mechanism=mechanism,
        balancers=balancers,
        sweep=sweep,
        states=states,
        objective=problem.objective,
        limits=problem.limits,
        values=ordered,
        units={u.name: u.unit for u in unknowns} | {g: unit_of(balancers, g) for g in geometry},
        before=before,
        after=after,
        certificate=_certificate(data.get("certificate"), name),
        geometry=geometry,
        bounds={parameter: ranges[parameter] for parameter in geometry},
        seed=int(data.get("seed") or 0),
        refined=int(data.get("refined") or 0),
        problem=record,
        places=places,
        choices=_kept(data, "choices", Choice.read, name),
        alternatives=_kept(data, "alternatives", Alternative.read, name),
        friction=problem.content.friction,
    )
    return problem, design, tuple(_changes(design, data))


def _places(data: Mapping[str, Any], name: str) -> dict[str, Placed]:
    """Where springs were put among equals."""
    try:
        return {spring: Placed(**entry) for spring, entry in (data.get("places") or {}).items()}
    except (AttributeError, TypeError):
        raise ProblemError("the places of springs are incomplete", where=f"{name}, places") from None


def _kept(data: Mapping[str, Any], key: str, read: Callable[[Mapping[str, Any]], T], name: str) -> tuple[T, ...]:
    """What the file tells of how the design came about, which its problem does not."""
    try:
        return tuple(read(entry) for entry in data.get(key) or ())
    except (AttributeError, KeyError, TypeError):
        raise ProblemError("an entry is incomplete", where=f"{name}, {key}") from None


def _case(problem: Problem, record: Mapping[str, Any], name: str) -> tuple[Mechanism, Sweep]:
    """What the design moves: of several cases the one that the file names."""
    index = record.get("case")
    if index is None:
        return problem.mechanism, problem.sweep
    if not isinstance(index, int) or not 0 <= index < len(problem.cases):
        raise ProblemError(f"there is no case number {index}", where=f"{name}, problem.case")
    case = problem.cases[index]
    return case.mechanism, case.sweep


def _read(path: Path, name: str) -> dict[str, Any]:
    hint = "design.json is what `equipoise design FILE --out DIR` writes"
    try:
        with path.open("rb") as stream:
            content = stream.read(MAX_BYTES + 1)
        data = json.loads(content) if len(content) <= MAX_BYTES else None
    except OSError as error:
        raise ProblemError(f"the file cannot be read: {error.strerror or error}", where=name) from None
    except (ValueError, RecursionError) as error:
        line = getattr(error, "lineno", None)
        place = f"{name}, line {line}" if line else name
        raise ProblemError(f"not valid JSON: {getattr(error, 'msg', 'unreadable')}", where=place, hint=hint) from None
    if not isinstance(data, dict) or not isinstance(data.get("unknowns"), dict):
        raise ProblemError("this is not a design", where=name, hint=hint)
    record = data.get("problem")
    if not isinstance(record, Mapping) or not isinstance(record.get("content"), Mapping):
        raise ProblemError("the design does not hold its problem, so it cannot be rebuilt", where=name, hint=hint)
    return data


def _values(data: Mapping[str, Any], key: str, name: str) -> dict[str, float]:
    found = {}
    for parameter, entry in (data.get(key) or {}).items():
        value = entry.get("value") if isinstance(entry, Mapping) else None
        if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
            raise ProblemError("the value is not a number", where=f"{name}, {key}.{parameter}")
        found[parameter] = float(value)
    return found


def _certificate(found: Any, name: str) -> Certificate:
    """The certificate as the solver gave it: it belongs to the solution, so it is read and not made anew."""
    known = {field.name for field in fields(Certificate)}
    try:
        kept = {key: value for key, value in found.items() if key in known}
        kept["active"] = tuple(Active(**entry) for entry in kept.get("active", ()))
        kept["floors"] = tuple(Floor(**entry) for entry in kept.get("floors", ()))
        kept["flat"] = tuple(kept.get("flat", ()))
        return Certificate(**kept)
    except (AttributeError, TypeError):
        raise ProblemError("the certificate is missing or incomplete", where=f"{name}, certificate") from None


def _changes(design: Design, data: Mapping[str, Any]) -> list[str]:
    remarks = []
    for joint, row in design.after.items():
        said = ((data.get("after") or {}).get(joint) or {}).get("peak")
        scale = max(other.peak for other in (*design.before.values(), row) if other.unit == row.unit)
        if isinstance(said, int | float) and abs(said - row.peak) > CHANGED * scale:
            remarks.append(f"{joint}: the file says a peak of {said:.6g} {row.unit}, its values give {row.peak:.6g}")
    return remarks
