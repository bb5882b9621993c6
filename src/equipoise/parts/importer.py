"""A user's catalogue: CSV whose columns and units are recognised, every fault told with its row and column."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError, nearest
from equipoise.parts import coil
from equipoise.parts.catalogue import Catalogue
from equipoise.parts.extension import ExtensionSpring
from equipoise.parts.headers import COLUMNS, FACTORS, IMPERIAL, KINDS, SYSTEMS, recognise, unit_of
from equipoise.parts.stock import Form
from equipoise.parts.wire import Grade, grade

MAX_BYTES = 64 * 1024 * 1024
NEEDED = ("part", "rate", "free_length")
LIMITS = ("longest", "force", "travel", "solid", "wire")
DEFAULT_GRADE = "ASTM A228"
_CELL = re.compile(r"\s*([-+]?[\d.,]+(?:[eE][-+]?\d+)?)\s*(.*?)\s*")
_EMPTY = ("", "-", "--", "n/a", "na", "none", "nan")


@dataclass(frozen=True)
class _Table:
    """The file's cells: header line, units by column, rows with their line numbers."""

    name: str
    header: tuple[str, ...]
    place: Mapping[str, int]
    units: Mapping[str, str]
    lines: tuple[int, ...]
    cells: tuple[tuple[str, ...], ...]
    comma: bool

    def refuse(self, message: str, row: int | None = None, column: str = "", hint: str = "") -> NoReturn:
        """Raise InputError at a row and column."""
        where = self.name + (f", row {self.lines[row]}" if row is not None else "")
        where += f", column {self.header[self.place[column]]!r}" if column in self.place else ""
        raise InputError(message, where=where, hint=hint)


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
    table = _read(Path(path), dict(columns or {}), units)
    numbers = {key: _numbers(table, key) for key in table.place if KINDS[key] != "text"}
    part = _parts(table)
    count = len(part)
    for key in ("rate", "free_length"):
        _insist(table, key, numbers[key])
    for key, values in numbers.items():
        bad = np.flatnonzero(values < 0)
        if len(bad):
            table.refuse(f"{_words(key)} is negative: {values[bad[0]]:.4g}{_more(bad)}", bad[0], key, "check the sign")
    nothing = np.full(count, np.nan)
    forms = _forms(table, form)
    made = _Made(table, part, forms, {key: numbers.get(key, nothing) for key in _NUMERIC}, grade_name)
    return made.catalogue()


_NUMERIC = tuple(column.key for column in COLUMNS if column.kind != "text")


def _words(key: str) -> str:
    return {"part": "part number", "outside": "outside diameter", "diameter": "mean diameter"}.get(
        key, key.replace("_", " ")
    )


def _more(bad: Sequence[int] | np.ndarray) -> str:
    return f" (and {len(bad) - 1} more rows)" if len(bad) > 1 else ""


def _read(path: Path, columns: dict[str, str], system: str | None) -> _Table:
    name = str(path)
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError("the file is larger than 64 MB", where=name)
        text = path.read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        raise InputError(f"the catalogue cannot be read: {error.strerror or error}", where=name) from None
    if "\0" in text:
        raise InputError("this is no text file", where=name, hint="save the table as CSV")
    kept = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip() and line[0] != "#"]
    if not kept:
        raise InputError("the catalogue is empty", where=name, hint="its first line names the columns")
    delimiter = max(";\t,|", key=lambda mark: (kept[0][1].count(mark), mark == ","))
    parsed = list(csv.reader([line for _, line in kept], delimiter=delimiter))
    header = tuple(cell.strip() for cell in parsed[0])
    place, units = _columns(name, header, columns)
    body, lines = parsed[1:], [number for number, _ in kept[1:]]
    if body and _is_units(body[0], place):
        units |= {
            key: unit for key, i in place.items() if i < len(body[0]) and (unit := unit_of(body[0][i], KINDS[key]))
        }
        body, lines = body[1:], lines[1:]
    if not body:
        raise InputError("the catalogue has no rows", where=name)
    for cells, line in zip(body, lines, strict=True):
        if len(cells) > len(header):
            raise InputError(
                f"{len(cells)} cells under {len(header)} headers", where=f"{name}, row {line}", hint="quote commas"
            )
    filled = tuple(tuple(cell.strip() for cell in (*cells, *[""] * (len(header) - len(cells)))) for cells in body)
    comma = delimiter != "," and not any("." in cells[i] for cells in filled for i in _number_places(place))
    table = _Table(name, header, place, units, tuple(lines), filled, comma)
    return _with_units(table, system)


def _number_places(place: Mapping[str, int]) -> list[int]:
    return [i for key, i in place.items() if KINDS[key] != "text"]


def _columns(name: str, header: tuple[str, ...], columns: dict[str, str]) -> tuple[dict[str, int], dict[str, str]]:
    place: dict[str, int] = {}
    units: dict[str, str] = {}
    for key, said in columns.items():
        if key not in KINDS:
            raise InputError(f"there is no column {key!r} to map", where=name, hint=nearest(key, list(KINDS)))
        if said not in header:
            raise InputError(f"there is no header {said!r} for {key}", where=name, hint=nearest(said, list(header)))
        place[key] = header.index(said)
        found = recognise(said)
        unit = found[1] if found else None
        if unit is None and (match := re.search(r"[\[(]([^\])]+)[\])]", said)):
            unit = unit_of(match.group(1), KINDS[key])
        if unit:
            units[key] = unit
    for i, said in enumerate(header):
        found = recognise(said)
        if found is None or i in place.values():
            continue
        key, unit = found
        if key in columns:
            continue
        if key in place:
            raise InputError(
                f"both {header[place[key]]!r} and {said!r} look like the {_words(key)}",
                where=name,
                hint=f"say which: columns {{{key}: {said!r}}}",
            )
        place[key] = i
        if unit:
            units[key] = unit
    missing = [key for key in NEEDED if key not in place]
    if missing:
        raise InputError(
            f"no column for the {' and the '.join(map(_words, missing))} among {', '.join(map(repr, header))}",
            where=f"{name}, row 1",
            hint=f"rename it, or map it: --column '{missing[0]}=HEADER'",
        )
    if not any(key in place for key in LIMITS):
        raise InputError(
            "no column says how far a spring may go: largest length, load, travel, or wire and diameter",
            where=f"{name}, row 1",
            hint="map one: --column 'force=HEADER', or longest, travel, wire",
        )
    return place, units


def _is_units(cells: Sequence[str], place: Mapping[str, int]) -> bool:
    """Whether the line below the header says units only."""
    found = [cells[i].strip(" []()") for i in _number_places(place) if i < len(cells) and cells[i].strip()]
    return bool(found) and not any(re.search(r"\d", cell) for cell in found)


def _with_units(table: _Table, system: str | None) -> _Table:
    """Units for columns that say none: those of the system that the others keep to, or of the one that is asked for."""
    if system is not None and system not in SYSTEMS:
        table.refuse(f"there is no system of units {system!r}", hint=nearest(system, list(SYSTEMS)))
    units = dict(table.units)
    open_ones = []
    for key, i in table.place.items():
        kind = KINDS[key]
        if kind in ("text", "number") or key in units:
            continue
        said = {unit_of(m.group(2), kind) for cells in table.cells if (m := _CELL.fullmatch(cells[i])) and m.group(2)}
        if len(said - {None}) == 1:
            units[key] = (said - {None}).pop() or ""
        elif any(cells[i].lower() not in _EMPTY for cells in table.cells):
            open_ones.append(key)
    if open_ones:
        kept = {"inch" if unit in IMPERIAL else "metric" for unit in units.values()}
        if system is None and len(kept) != 1:
            how = "the other columns are in both metric and inch units" if kept else "no column says its unit"
            table.refuse(
                f"in which unit is the {_words(open_ones[0])}? {how}",
                column=open_ones[0],
                hint="write it into the header, `Rate [N/mm]`, or say --units metric (mm, N, N/mm, g) or inch",
            )
        chosen = SYSTEMS[system or kept.pop()]
        units |= {key: chosen[KINDS[key]] for key in open_ones}
    return _Table(table.name, table.header, table.place, units, table.lines, table.cells, table.comma)


def _numbers(table: _Table, key: str) -> Array:
    """One column (C,), SI; nan where a cell is empty."""
    unit, i, kind = table.units.get(key, ""), table.place[key], KINDS[key]
    found = np.full(len(table.cells), np.nan)
    for row, cells in enumerate(table.cells):
        cell = cells[i]
        if cell.lower() in _EMPTY:
            continue
        match = _CELL.fullmatch(cell)
        number = _number(match.group(1), table.comma) if match else None
        if match is None or number is None:
            table.refuse(f"{cell!r} is not a number", row, key)
        if match.group(2):
            said = unit_of(match.group(2), kind)
            if said is None:
                table.refuse(f"{match.group(2)!r} is no unit of a {kind}", row, key)
            if said != unit:
                table.refuse(f"mixed units: {cell!r} in a column in {unit}", row, key, "write one column in one unit")
        found[row] = number * FACTORS[unit]
    return found


def _number(text: str, comma: bool) -> float | None:
    plain = text.replace(".", "").replace(",", ".") if comma else text.replace(",", "")
    try:
        value = float(plain)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _parts(table: _Table) -> tuple[str, ...]:
    names = tuple(cells[table.place["part"]] for cells in table.cells)
    first: dict[str, int] = {}
    for row, name in enumerate(names):
        if not name:
            table.refuse("there is no part number", row, "part")
        if name in first:
            table.refuse(
                f"part number {name!r} stands twice, first in row {table.lines[first[name]]}", row, "part",
                "keep one, or tell them apart",
            )  # fmt: skip
        first[name] = row
    return names


def _insist(table: _Table, key: str, values: Array) -> None:
    bad = np.flatnonzero(~(values > 0))
    if len(bad):
        value = values[bad[0]]
        said = (
            "is empty"
            if np.isnan(value)
            else f"is {value / FACTORS[table.units.get(key, '')]:.4g}, it must be positive"
        )
        table.refuse(f"the {_words(key)} {said}{_more(bad)}", bad[0], key, "check sign and unit")


def _forms(table: _Table, form: Form) -> tuple[Form, ...]:
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

    table: _Table
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
                f"nothing says how far spring {self.part[bad[0]]} may go{_more(bad)}", bad[0], "part",
                "give its largest length, load or travel, or wire and diameter",
            )  # fmt: skip
        travel = np.nanmin(np.where(np.isfinite(ways), ways, np.nan), axis=0)
        self._insist_on_travel(travel, ways)
        mass, remarks = self._mass(diameter)
        width = np.where(np.isnan(n["outside"]), diameter + n["wire"], n["outside"])
        return Catalogue(
            name=self.table.name, part=self.part, form=self.forms, rate=n["rate"], free_length=n["free_length"],
            initial_tension=tension, travel=travel, mass=mass, width=width,
            line=np.array(self.table.lines), remarks=(*remarks, *self._doubts(diameter)),
        )  # fmt: skip

    def _insist_on_travel(self, travel: Array, ways: Array) -> None:
        bad = np.flatnonzero(~(travel > 0))
        if not len(bad):
            return
        column = ("travel", "longest", "solid", "force")[int(np.nanargmin(ways[:, bad[0]]))]
        self.table.refuse(
            f"spring {self.part[bad[0]]} has no travel: {_words(column)} leaves {travel[bad[0]] * 1e3:.4g} mm"
            f"{_more(bad)}",
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
                found[row] = ExtensionSpring(np.array([d]), np.array([D]), 5.0, made.name).largest_force[0]
        return found

    def _mass(self, diameter: Array) -> tuple[Array, tuple[str, ...]]:
        n = self.numbers
        grades = self._grades()
        shear, density = (np.array([getattr(made, what) for made in grades]) for what in ("shear", "density"))
        coils = np.where(np.isnan(n["coils"]), coil.rate(n["wire"], diameter, n["rate"], shear), n["coils"])
        mass = np.where(np.isnan(n["mass"]), coil.wire_mass(n["wire"], diameter, coils + 2, density), n["mass"])
        unknown = int((~np.isfinite(mass)).sum())
        words = (f"{unknown} springs have no mass: taken as weightless",) if unknown else ()
        return np.where(np.isfinite(mass), mass, 0.0), words

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
            f"coils give{_more(odd)}",
        )
