"""Cases that one design serves: payloads, patients, tilts; and the one program that they make together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from equipoise.affine import Array, Unknown, merge_unknowns
from equipoise.mechanism import Mechanism
from equipoise.solve.program import Definite, Program, Rows, Term
from equipoise.sweep import Sweep
from equipoise.units import text


@dataclass(frozen=True, eq=False)
class Case:
    """One mechanism over its sweep, with the label that tables call it by."""

    label: str
    mechanism: Mechanism
    sweep: Sweep


@dataclass(frozen=True)
class Adjuster:
    """A parameter that is set anew for every case: its values (S,) in `unit`.

    work, where turning it takes any, is the change of the stored energy (least, greatest) over the poses, J, from the
    first case's setting to each, everything else held.
    """

    name: str
    unit: str
    values: tuple[float, ...]
    work: tuple[tuple[float, float], ...] | None = None

    @property
    def travel(self) -> float:
        """Distance between the extreme settings."""
        return max(self.values) - min(self.values)

    def json(self) -> dict[str, Any]:
        """The adjuster as design.json holds it."""
        work = None if self.work is None else [list(pair) for pair in self.work]
        return {"name": self.name, "unit": self.unit, "values": self.values, "travel": self.travel, "work": work}


@dataclass(frozen=True)
class Settings:
    """The cases that a design serves, which of them it is shown in, and what is adjusted between them."""

    case: int
    labels: tuple[str, ...]
    adjusters: tuple[Adjuster, ...]
    peaks: tuple[float, ...]

    @property
    def label(self) -> str:
        """The case that the design is shown in."""
        return self.labels[self.case]

    def json(self) -> dict[str, Any]:
        """The settings as design.json holds them."""
        adjusters = [adjuster.json() for adjuster in self.adjusters]
        return {"case": self.label, "cases": self.labels, "adjusters": adjusters, "peaks": self.peaks}


def by_payload(mechanism: Mechanism, sweep: Sweep, label: str = "") -> tuple[Case, ...]:
    """One case for every payload scenario of a sweep."""
    found = []
    for masses in sweep.scenarios:
        words = [text(float(mass), "kg") for mass in masses]
        name = ", ".join([label, *words] if label else words) or "no payload"
        found.append(Case(name, mechanism, replace(sweep, scenarios=masses[None])))
    return tuple(found)


def called(name: str, label: str) -> str:
    """What a parameter that every case sets for itself is called in the common program."""
    return f"{name} @ {label}"


def joined(
    programs: Sequence[Program], labels: Sequence[str], own: Mapping[str, tuple[float, float] | None]
) -> Program:
    """One program of several: unknowns are shared but for those in `own`, of which every case has its own.

    own maps names to bounds, None for those that nature sets. The cases weigh equally; every term is over all.
    Terms, rows and unknowns of the programs must stand in the same order.
    """
    mine = [tuple(_own(u, label, own) for u in p.unknowns) for p, label in zip(programs, labels, strict=True)]
    unknowns = merge_unknowns(mine)
    terms = tuple(
        _term([program.terms[i] for program in programs], mine, unknowns) for i in range(len(programs[0].terms))
    )
    rows: list[Rows] = []
    definite: list[Definite] = []
    for program, label, names in zip(programs, labels, mine, strict=True):
        rows += [replace(r, limit=f"{r.limit} ({label})", unknowns=names).expand(unknowns) for r in program.rows]
        definite += [replace(d, unknowns=names).expand(unknowns) for d in program.definite]
    return Program(unknowns, terms, tuple(rows), tuple(definite))


def share_of(program: Program, theta: Array, case: Program, label: str, own: Mapping[str, object]) -> Array:
    """The values (P,) that one case's program sees of the common solution."""
    value = dict(zip([unknown.name for unknown in program.unknowns], theta, strict=True))
    return np.array([value[called(u.name, label) if u.name in own else u.name] for u in case.unknowns])


def _own(unknown: Unknown, label: str, own: Mapping[str, tuple[float, float] | None]) -> Unknown:
    if unknown.name not in own:
        return unknown
    low, high = own[unknown.name] or (unknown.lower, unknown.upper)
    return replace(
        unknown,
        name=called(unknown.name, label),
        lower=max(low, unknown.lower),
        upper=min(high, unknown.upper),
    )


def _term(terms: Sequence[Term], mine: Sequence[tuple[Unknown, ...]], unknowns: tuple[Unknown, ...]) -> Term:
    place = {unknown.name: index for index, unknown in enumerate(unknowns)}
    lead = np.broadcast_shapes(*[t.b.shape[:-2] for t in terms], *[t.A.shape[:-3] for t in terms])
    b, A = [], []
    for term, names in zip(terms, mine, strict=True):
        b.append(np.broadcast_to(term.b, (*lead, *term.b.shape[-2:])))
        wide = np.zeros((*lead, *term.A.shape[-3:-1], len(unknowns)), dtype=term.A.dtype)
        wide[..., [place[unknown.name] for unknown in names]] = term.A
        A.append(wide)
    weight = np.concatenate([term.weight for term in terms]) / len(terms)
    return replace(terms[0], b=np.concatenate(b, axis=-2), A=np.concatenate(A, axis=-3), weight=weight)
