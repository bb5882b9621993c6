"""A user's catalogue: CSV whose columns and units are recognised, every fault told with its row and column."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.parts import coil
from equipoise.parts.catalogue import Catalogue
from equipoise.parts.extension import ExtensionSpring
from equipoise.parts.headers import COLUMNS, KINDS
from equipoise.parts.stock import Form
from equipoise.parts.table import Table, insist_positive, more, numbers_of, part_numbers, read_table, words_of
from equipoise.parts.wire import Grade, grade

DEFAULT_GRADE = "ASTM A228"
_NUMERIC = tuple(column.key for column in COLUMNS if column.kind != "text")


def read_catalogue(
    path: str | Path,
    *,
    columns: Mapping[str, str] | None = None,
    units: str | None = None,
    form: Form = "extension",
    grade_name: str = DEFAULT_GRADE,
) -> Catalogue:
    """Read a catalogue from CSV; part numbers are kept as they are.

    Needed: part number, rate, free length, and what limits a spring: its largest length, load or travel, its solid
    length, or wire and coil diameter. Headers are recognised in English and German, with units in brackets, behind a
    comma or as the last word, in a line of units below, or in the cells; columns {what: header} maps what is not.
    units (`metric`: mm, N, N/mm, g; `inch`: in, lbf, lbf/in, lb) holds where nothing says a unit. form is that of
    springs whose row does not say, grade_name the wire of rows without material.

    Raises InputError with row and column for a missing column, mixed units, a number that is none or not positive,
    and a part number that stands twice.
    """
    table = read_table(Path(path), dict(columns or {}), units)
    numbers = {key: numbers_of(table, key) for key in table.place if KINDS[key] != "text"}
    part = part_numbers(table)
    count = len(part)
    for key in ("rate", "free_length"):
        insist_positive(table, key, numbers[key])
    for key, values in numbers.items():
        bad = np.flatnonzero(values < 0)
        if len(bad):
            table.refuse(f"{words_of(key)} is negative: {values[bad[0]]:.4g}{more(bad)}", bad[0], key, "check the sign")
    nothing = np.full(count, np.nan)
    forms = _forms(table, form)
    made = _Made(table, part, forms, {key: numbers.get(key, nothing) for key in _NUMERIC}, grade_name)
    return made.catalogue()


def _forms(table: Table, form: Form) -> tuple[Form, ...]:
    if "form" not in table.place:
        return (form,) * len(table.cells)
    found: list[Form] = []
    for row, cells in enumerate(table.cells):
        said = cells[table.place["form"]].lower()
        if not said:
            found.append(form)
        elif re.search(r"ext|tension|zug|traction", said):
            found.append("extension")
        elif re.search(r"comp|press|druck", said):
            found.append("compression")
        else:
            table.refuse(f"{said!r} is no kind of spring", row, "form", "extension or compression")
    return tuple(found)


@dataclass(frozen=True)
class _Made:
    """Rows read, about to become a catalogue."""

    table: Table
    part: tuple[str, ...]
    forms: tuple[Form, ...]
    numbers: Mapping[str, Array]
    grade_name: str

    def catalogue(self) -> Catalogue:
        """Travel and mass where the file does not print them, from wire and coil."""
        n, pressed = self.numbers, np.array([form == "compression" for form in self.forms])
        tension = np.nan_to_num(n["initial_tension"])
        diameter = np.where(np.isnan(n["diameter"]), n["outside"] - n["wire"], n["diameter"])
        load = np.where(np.isnan(n["force"]), self._bears(diameter), n["force"])
        ways = np.stack([
            n["travel"],
            np.where(pressed, np.nan, n["longest"] - n["free_length"]),
            np.where(pressed, n["free_length"] - n["solid"], np.nan),
            (load - tension) / n["rate"],
        ])  # fmt: skip
        known = np.isfinite(ways).any(axis=0)
        if not known.all():
            bad = np.flatnonzero(~known)
            self.table.refuse(
                f"nothing says how far spring {self.part[bad[0]]} may go{more(bad)}", bad[0], "part",
                "give its largest length, load or travel, or wire and diameter",
            )  # fmt: skip
        travel = np.nanmin(np.where(np.isfinite(ways), ways, np.nan), axis=0)
        self._insist_on_travel(travel, ways)
        mass, remarks = self._mass(diameter)
        width = np.where(np.isnan(n["outside"]), diameter + n["wire"], n["outside"])
        return Catalogue(
            name=self.table.name, part=self.part, form=self.forms, rate=n["rate"], free_length=n["free_length"],
            initial_tension=tension, travel=travel, mass=mass, width=width,
            line=np.array(self.table.lines), remarks=(*remarks, *self._doubts(diameter), *self._unread()),
        )  # fmt: skip

    def _insist_on_travel(self, travel: Array, ways: Array) -> None:
        bad = np.flatnonzero(~(travel > 0))
        if not len(bad):
            return
        column = ("travel", "longest", "solid", "force")[int(np.nanargmin(ways[:, bad[0]]))]
        self.table.refuse(
            f"spring {self.part[bad[0]]} has no travel: {words_of(column)} leaves {travel[bad[0]] * 1e3:.4g} mm"
            f"{more(bad)}",
            bad[0], column, "check the columns and their units",
        )  # fmt: skip

    def _grades(self) -> list[Grade]:
        place = self.table.place.get("grade")
        names = [self.grade_name if place is None else cells[place] or self.grade_name for cells in self.table.cells]
        found, known = [], {}
        for name in names:
            if name not in known:
                try:
                    known[name] = grade(name)
                except InputError:
                    known[name] = grade(self.grade_name)
            found.append(known[name])
        return found

    def _bears(self, diameter: Array) -> Array:
        """Largest load (C,), N, from wire and coil; nan where they are not known."""
        found = np.full(len(self.part), np.nan)
        for row, made in enumerate(self._grades()):
            d, D = self.numbers["wire"][row], diameter[row]
            if np.isfinite(d * D) and d > 0 and d < D:
                one = ExtensionSpring.of_rows(wire=np.array([d]), diameter=np.array([D]), coils=5.0, grade=made.name)
                found[row] = one.largest_force[0]
        return found

    def _mass(self, diameter: Array) -> tuple[Array, tuple[str, ...]]:
        n = self.numbers
        grades = self._grades()
        shear, density = (np.array([getattr(made, what) for made in grades]) for what in ("shear", "density"))
        coils = np.where(np.isnan(n["coils"]), coil.rate(n["wire"], diameter, n["rate"], shear), n["coils"])
        mass = np.where(np.isnan(n["mass"]), coil.wire_mass(n["wire"], diameter, coils + 2, density), n["mass"])
        unknown = int((~np.isfinite(mass)).sum())
        said = f"{unknown} springs have no mass: taken as weightless; a column for it, or wire and diameter, gives it"
        words = (said,) if unknown else ()
        return np.where(np.isfinite(mass), mass, 0.0), words

    def _unread(self) -> tuple[str, ...]:
        """Columns that nobody here knows: a user may have thought that they count."""
        table = self.table
        names = [repr(said) for i, said in enumerate(table.header) if said and i not in table.place.values()]
        return (f"columns that are not read: {', '.join(names)}",) if names else ()

    def _doubts(self, diameter: Array) -> tuple[str, ...]:
        """Rows whose rate is far from what wire, coil and coils give."""
        n = self.numbers
        shear = np.array([made.shear for made in self._grades()])
        with np.errstate(invalid="ignore", divide="ignore"):
            ratio = n["rate"] / coil.rate(n["wire"], diameter, n["coils"], shear)
        odd = np.flatnonzero((ratio > 1.5) | (ratio < 1 / 1.5))
        if not len(odd):
            return ()
        row = odd[0]
        return (
            f"row {self.table.lines[row]}: the rate of {self.part[row]} is {ratio[row]:.3g} times what its wire and "
            f"coils give{more(odd)}",
        )
