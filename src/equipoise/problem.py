"""The problem file: mechanism, motion, balancers, limits and objective, one-to-one with the constructors."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from equipoise.balancers.spring import Spring
from equipoise.cases import Case, by_payload
from equipoise.errors import EquipoiseError, InputError, ProblemError, nearest
from equipoise.forms import Form, Later, Reading, adapter, whole
from equipoise.mechanism import Mechanism
from equipoise.objective import Aim, as_objective
from equipoise.places import REMEDY, problem_error, where
from equipoise.problemfile import ProblemFile, Search
from equipoise.sweep import Sweep
from equipoise.units import Measured, to_si
from equipoise.yamlfile import Document, read_yaml


@dataclass(frozen=True, eq=False)
class Problem:
    """A validated problem; mechanism and sweep are built when first asked for, and every error names its place."""

    document: Document
    folder: Path
    content: ProblemFile
    reading: Reading

    @property
    def raw(self) -> Mapping[str, Any]:
        """The file as plain data, as design.json keeps it."""
        return self.document.data

    @functools.cached_property
    def mechanism(self) -> Mechanism:
        """What moves, on the branch that was named."""
        try:
            made = self.content.mechanism()
        except InputError as error:
            raise self.placed(error, self._part(error)) from None
        branch, later = self.content.branch, self.content.sweep
        if branch is None:
            return made
        with self.at("sweep"):
            first = None if later is None else self._swept(later, made).poses[0]
        with self.at("branch"):
            return made.on_branch(branch, first)

    @functools.cached_property
    def sweep(self) -> Sweep:
        """The poses and payloads that matter."""
        later = self.content.sweep
        with self.at("sweep"):
            if later is None:
                return Sweep.sobol(self.mechanism)
            self._joint_units(later)
            return self._swept(later, self.mechanism)

    def _swept(self, later: Later, mechanism: Mechanism) -> Sweep:
        """A sweep of the mechanism, with what is added where the sweep depends on it."""
        return later(mechanism, **({"balancers": self.content.balancers} if later.asks("balancers") else {}))

    @functools.cached_property
    def trajectory(self) -> Sweep | None:
        """What the motors of a cable platform follow."""
        later = self.content.trajectory
        if later is None:
            return None
        with self.at("trajectory"):
            if self.mechanism.platform is None or not self.mechanism.platform.cables:
                raise InputError(f"{self.mechanism.name} has no cables, a trajectory says nothing of it")
            self._joint_units(later)
            return later(self.mechanism)

    @functools.cached_property
    def balancers(self) -> tuple[Any, ...]:
        """What is added, at the geometry of the file or of its `start`."""
        found = {balancer.name: balancer for balancer in self.content.balancers}
        for name, start in (self.content.start or {}).items():
            with self.at("start", name):
                if not isinstance(found.get(name), Spring):
                    springs = [other.name for other in found.values() if isinstance(other, Spring)]
                    raise InputError(f"there is no spring {name!r} to start", hint=nearest(name, springs))
                found[name] = start.apply(self.mechanism, found[name], self.sweep)
        return tuple(found.values())

    @property
    def limits(self) -> tuple[Any, ...]:
        """What must hold."""
        return self.content.limits

    @property
    def search(self) -> Search:
        """Starts and seed of the shape search."""
        return self.content.search

    @functools.cached_property
    def objective(self) -> tuple[Aim, ...]:
        """What shall be small."""
        with self.at("objective"):
            return as_objective(None, self.content.objective)

    @functools.cached_property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """Bounds {parameter: (low, high)} of the free geometry, SI; empty without a `shape` block."""
        from equipoise.parameters import unit_of

        found = {}
        for name, pair in (self.content.shape or {}).items():
            with self.at("shape", name):
                unit = unit_of(self.balancers, name)
                low, high = (to_si(value, unit) for value in pair)
                found[name] = (low, high)
        return found

    @functools.cached_property
    def adjusters(self) -> dict[str, tuple[float, float] | None]:
        """Bounds of what is set anew for every case {parameter: (low, high) or None}, SI."""
        from equipoise.parameters import unit_of

        units = {unknown.name: unknown.unit for balancer in self.balancers for unknown in balancer.unknowns}
        found: dict[str, tuple[float, float] | None] = {}
        for name, pair in (self.content.adjust or {}).items():
            with self.at("adjust", name):
                unit = units.get(name) if name in units else unit_of(self.balancers, name)
                assert unit is not None
                found[name] = None if pair is None else (to_si(pair[0], unit), to_si(pair[1], unit))
        return found

    @functools.cached_property
    def cases(self) -> tuple[Case, ...]:
        """What one design must serve, where the file asks for adjusters, `cases` or `tilt`; else nothing."""
        if not (self.content.adjust or self.content.cases or self.content.tilt):
            return ()
        plain = [("", self.mechanism, self.sweep)]
        bases = [self._variant(index) for index in range(len(self.content.cases))] or plain
        found: list[Case] = []
        with self.at("tilt" if self.content.tilt else "sweep"):
            for label, mechanism, sweep in bases:
                leans = self.content.tilt.apply(mechanism) if self.content.tilt else {"": mechanism}
                for lean, leaning in leans.items():
                    name = ", ".join(part for part in (label, lean) if part)
                    apart = self.content.adjust and len(sweep.scenarios) > 1
                    found += by_payload(leaning, sweep, name) if apart else [Case(name or "as is", leaning, sweep)]
        return tuple(found)

    def _variant(self, index: int) -> tuple[str, Mechanism, Sweep]:
        """Label, mechanism and sweep of one of the `cases`."""
        changes = dict(self.raw["cases"][index])
        label = str(changes.pop("case", "")) or ", ".join(f"{name} {value}" for name, value in changes.items())
        block: Any = self.raw["mechanism"]
        if isinstance(block, Mapping) and "model" in block:
            whole: dict[str, Any] = {**block, **changes}
        else:
            builder, own = next(iter(block.items())) if isinstance(block, Mapping) else (block, None)
            whole = {builder: {**(own or {}), **changes}}
        kept = {name: value for name, value in self.raw.items() if name not in ("cases", "adjust", "tilt")}
        with self.at("cases", index):
            other = problem_of(Document("", kept | {"mechanism": whole}), self.folder)
            return label, other.mechanism, other.sweep

    def check(self) -> None:
        """Raise InputError, naming file, line and field, for whatever does not fit the mechanism."""
        from equipoise.checks import check

        check(self)

    @contextmanager
    def at(self, *keys: Any) -> Iterator[None]:
        """Put the place in this file before the place of any InputError raised within."""
        try:
            yield
        except InputError as error:
            raise self.placed(error, keys) from None

    @contextmanager
    def at_names(self) -> Iterator[None]:
        """Put file and line before errors of later steps, which name a block or a balancer and not its place."""
        try:
            yield
        except EquipoiseError as error:
            raise self.placed(error, self._keys(error.where)) from None

    def _keys(self, own: str) -> tuple[Any, ...]:
        """Where in the file a later step's own place is: `limits`, `shape.s1...`, `spring s1`."""
        for index, balancer in enumerate(self.balancers):
            if own.endswith(f" {balancer.name}"):
                return ("balancers", index)
        first, _, rest = own.partition(".")
        if first == "shape" and rest in self.bounds:
            return ("shape", rest)
        return (first,) if first in self.raw else ("limits",) if first.startswith("limit") and self.limits else ()

    def _part(self, error: EquipoiseError) -> tuple[Any, ...]:
        """The field of a builder that its error speaks of: `chain.arm` is a link, the message begins with the field."""
        block = self.raw["mechanism"]
        if not isinstance(block, Mapping) or self.content.mechanism.constructor is Mechanism.load:
            return ("mechanism",)
        keys: list[Any] = ["mechanism", *block]
        block = block[keys[-1]]
        links = block.get("links") if isinstance(block, Mapping) else None
        for index, link in enumerate(links if isinstance(links, list) else ()):
            if isinstance(link, Mapping) and error.where.endswith(f".{link.get('name')}"):
                block, keys = link, [*keys, "links", index]
        word = error.message.partition(" ")[0].partition("[")[0]
        return (*keys, word) if isinstance(block, Mapping) and word in block else tuple(keys)

    def placed(self, error: EquipoiseError, keys: Sequence[Any]) -> EquipoiseError:
        """The same error with the place in this file put before its own."""
        if not self.document.name:
            return error
        place = where(self.document, self.reading, keys)
        if place and not error.where.startswith(self.document.name):
            # The error's own place is often the same field, said without file and line.
            own = error.where and error.where not in place
            error.where = f"{place}: {error.where}" if own else place
        error.hint = error.hint or REMEDY
        return error

    def _joint_units(self, later: Later) -> None:
        for name in ("ranges", "axes"):
            self.joint_units(later.arguments.get(name) or {}, name)
        poses = later.arguments.get("poses")
        for pose in poses if isinstance(poses, tuple) else ():
            self.joint_units(pose, "poses")

    def joint_units(self, values: Mapping[str, Any], field: str) -> None:
        """Raise InputError for a length at a hinge or an angle at a slide."""
        mechanism = self.mechanism
        for joint, value in values.items():
            if joint not in mechanism.driven:
                continue
            hinge = mechanism.driven_units[mechanism.driven.index(joint)] == "N m"
            for number in value if isinstance(value, tuple) else (value,):
                unit = number.unit if isinstance(number, Measured) else ""
                if unit == ("m" if hinge else "rad"):
                    kind = "a hinge: give an angle" if hinge else "a slide: give a length"
                    raise InputError(f"joint {joint} is {kind}, in {'rad or deg' if hinge else 'm or mm'}", where=field)


def load_problem(path: str | Path) -> Problem:
    """Read and validate a problem file (YAML 1.2).

    Raises ProblemError naming file, line and field, what is wrong, what is expected and the nearest names.
    """
    path = Path(path)
    return problem_of(read_yaml(path, str(path)), path.parent)


def model_problem(model: str) -> Problem:
    """The problem that a bare robot file stands for: its mechanism over its joint limits."""
    return problem_of(Document("", {"mechanism": {"model": model}}), Path())


def problem_of(document: Document, folder: Path) -> Problem:
    """Validate plain data; relative paths in it count from `folder`."""
    from pydantic import ValidationError

    if document.data is None:
        raise ProblemError("the file is empty", where=document.name, hint="begin with `mechanism: {model: robot.urdf}`")
    if not isinstance(document.data, Mapping):
        raise ProblemError("the file is not a list of fields", where=document.name, hint="write `name: value` lines")
    reading = Reading(folder=str(folder))
    try:
        content = adapter(Form(ProblemFile)).validate_python(document.data, context=reading)
    except ValidationError as error:
        raise problem_error(error.errors(include_url=False), document, reading) from None
    return Problem(document, folder, content, reading)


def schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of the whole problem file."""
    from equipoise.schema import json_schema

    return json_schema(whole(Form(ProblemFile)))
