"""Wire: strength by diameter and moduli, as data rows with their source, and the sizes that dealers keep."""

from __future__ import annotations

import csv
import functools
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, Literal

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError, nearest

MM, MPA, GPA = 1e-3, 1e6, 1e9
UNSOURCED = "unsourced"


@dataclass(frozen=True)
class Piece:
    """Rm = first - second lg d (`log`) or first / d^second (`power`), MPa with d in mm, from least to largest, mm."""

    form: str
    first: float
    second: float
    least: float
    largest: float

    def strength(self, d: Any) -> Any:
        """Rm, MPa, of a wire d, mm."""
        if self.form == "log":
            return self.first - self.second * np.log10(d)
        return self.first * d**-self.second


@dataclass(frozen=True)
class Grade:
    """A grade of spring wire: young E and shear G in Pa, density in kg/m^3, and where its numbers were read.

    sources are keys in references.bib; `unsourced` among them means a number from memory that the wire's maker
    should confirm.
    """

    name: str
    pieces: tuple[Piece, ...]
    young: float
    shear: float
    density: float
    sources: tuple[str, ...]

    @property
    def range(self) -> tuple[float, float]:
        """Least and largest wire diameter, m, for which the strength is known."""
        return self.pieces[0].least * MM, self.pieces[-1].largest * MM

    @property
    def unsourced(self) -> bool:
        """Whether some number of it has no source that was opened."""
        return UNSOURCED in self.sources

    def strength(self, wire: Any) -> Any:
        """Minimum tensile strength Rm, Pa, of wires of diameter d, m; beyond the range the nearest row continues."""
        d = np.asarray(wire) / MM
        found = self.pieces[-1].strength(d)
        for piece in reversed(self.pieces[:-1]):
            found = np.where(np.real(d) <= piece.largest, piece.strength(d), found)
        return found[()] * MPA

    def covers(self, wire: Any) -> Any:
        """Whether the strength of wires of diameter d, m, is known."""
        low, high = self.range
        d = np.real(np.asarray(wire))
        return (d >= low * (1 - 1e-9)) & (d <= high * (1 + 1e-9))


@functools.cache
def grades() -> dict[str, Grade]:
    """All grades by name, in the order of the data."""
    found: dict[str, Grade] = {}
    for row in rows("wires.csv"):
        piece = Piece(row["form"], *(float(row[key]) for key in ("first", "second", "least", "largest")))
        known = found.get(row["grade"])
        found[row["grade"]] = Grade(
            name=row["grade"],
            pieces=(*(known.pieces if known else ()), piece),
            young=float(row["E"]) * GPA,
            shear=float(row["G"]) * GPA,
            density=float(row["density"]),
            sources=tuple(dict.fromkeys((row["strength_source"], row["moduli_source"]))),
        )
    return found


@functools.cache
def grade(name: str) -> Grade:
    """A grade by its name, `EN 10270-1 SH`, or by its last word where that is unique; InputError otherwise."""
    known = grades()
    if name in known:
        return known[name]
    ends = [full for full in known if full.split()[-1].lower() == name.lower().split()[-1:][0]] if name.split() else []
    if len(ends) == 1 and name.lower() in ends[0].lower():
        return known[ends[0]]
    raise InputError(f"there is no wire {name!r}", where="grade", hint=nearest(name, list(known)))


Series = Literal["metric", "inch"]


def preferred_sizes(series: Series = "metric") -> Array:
    """Wire diameters (M,), m, that dealers keep, ascending."""
    found = [float(row["size"]) * MM for row in rows("wire_sizes.csv") if row["series"] == series]
    if not found:
        raise InputError(f"there is no series {series!r} of wire sizes", hint=nearest(series, ("metric", "inch")))
    return np.array(found)


def rows(name: str) -> Iterator[dict[str, str]]:
    """The rows of a table in data/, comments left out."""
    text = (files("equipoise") / "data" / name).read_text(encoding="utf-8")
    yield from csv.DictReader(line for line in text.splitlines() if line and not line.startswith("#"))
