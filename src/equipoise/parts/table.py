"""A CSV file as cells with units: delimiter, headers, units and numbers, every fault told with row and column."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError, nearest
from equipoise.parts.csvfile import rows_of, text_of
from equipoise.parts.headers import FACTORS, IMPERIAL, KINDS, SYSTEMS, recognise, unit_of

LEAST, MOST = 1e-12, 1e12
"""Between them, in SI, lie all numbers of springs that are not zero."""
SHOWN = 40
"""Letters of a cell that a message quotes."""
NEEDED = ("part", "rate", "free_length")
LIMITS = ("longest", "force", "travel", "solid", "wire")
_CELL = re.compile(r"\s*([-+]?[\d.,]+(?:[eE][-+]?\d+)?)\s*(.*?)\s*")
_EMPTY = ("", "-", "--", "n/a", "na", "none", "nan")


@dataclass(frozen=True)
class Table:
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


def words_of(key: str) -> str:
    """What messages call a column."""
    return {"part": "part number", "outside": "outside diameter", "diameter": "mean diameter"}.get(
        key, key.replace("_", " ")
    )


def more(bad: Sequence[int] | np.ndarray) -> str:
    """How many more rows have a fault than the one that is told."""
    return f" (and {len(bad) - 1} more rows)" if len(bad) > 1 else ""


def read_table(path: Path, columns: dict[str, str], system: str | None) -> Table:
    """Cells, columns and units of a file; raises InputError for what is no table of springs."""
    name = str(path)
    text = text_of(path, name)
    kept = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip() and line[0] != "#"]
    if not kept:
        raise InputError("the catalogue is empty", where=name, hint="its first line names the columns")
    delimiter = max(";\t,|", key=lambda mark: (kept[0][1].count(mark), mark == ","))
    numbered = rows_of(kept, delimiter, name)
    starts, parsed = [number for number, _ in numbered], [cells for _, cells in numbered]
    header = tuple(cell.strip() for cell in parsed[0])
    place, units = _columns(name, header, columns)
    body, lines = parsed[1:], starts[1:]
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
    comma = delimiter != "," and _decimal_comma([cells[i] for cells in filled for i in _number_places(place)])
    table = Table(name, header, place, units, tuple(lines), filled, comma)
    return _with_units(table, system)


def _decimal_comma(cells: Sequence[str]) -> bool:
    """Whether numbers have decimal commas: none has a point, or points stand before the comma, as in 1.234,5."""
    return any(re.search(r"\d\.\d{3},\d", cell) for cell in cells) or not any("." in cell for cell in cells)


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
                f"both {header[place[key]]!r} and {said!r} look like the {words_of(key)}",
                where=name,
                hint=f"say which: columns {{{key}: {said!r}}}",
            )
        place[key] = i
        if unit:
            units[key] = unit
    missing = [key for key in NEEDED if key not in place]
    if missing:
        raise InputError(
            f"no column for the {' and the '.join(map(words_of, missing))} among {', '.join(map(repr, header))}",
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


def _with_units(table: Table, system: str | None) -> Table:
    """Units for columns that say none: those of the system that the others keep to, or of the one that is asked for."""
    if system is not None and system not in SYSTEMS:
        table.refuse(f"there is no system of units {system!r}", hint=nearest(system, list(SYSTEMS)))
    units = dict(table.units)
    open_ones = []
    for key, i in table.place.items():
        kind = KINDS[key]
        if kind in ("text", "number") or key in units:
            continue
        written = [m.group(2) for cells in table.cells if (m := _CELL.fullmatch(cells[i])) and m.group(2)]
        said = [unit for word in written if (unit := unit_of(word, kind)) is not None]
        if said:
            # Where others stand beside the first, the numbers are refused by row.
            units[key] = said[0]
        elif any(cells[i].lower() not in _EMPTY for cells in table.cells):
            open_ones.append(key)
    if open_ones:
        kept = {"inch" if unit in IMPERIAL else "metric" for unit in units.values()}
        if system is None and len(kept) != 1:
            how = "the other columns are in both metric and inch units" if kept else "no column says its unit"
            table.refuse(
                f"in which unit is the {words_of(open_ones[0])}? {how}",
                column=open_ones[0],
                hint="write it into the header, `Rate [N/mm]`, or say --units metric (mm, N, N/mm, g) or inch",
            )
        chosen = SYSTEMS[system or kept.pop()]
        units |= {key: chosen[KINDS[key]] for key in open_ones}
    return Table(table.name, table.header, table.place, units, table.lines, table.cells, table.comma)


def numbers_of(table: Table, key: str) -> Array:
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
            table.refuse(f"{_short(cell)} is not a number", row, key, _hint(cell, table.comma))
        if match.group(2):
            said = unit_of(match.group(2), kind)
            if said is None:
                table.refuse(f"{_short(match.group(2))} is no unit of a {kind}", row, key)
            if said != unit:
                table.refuse(
                    f"mixed units: {_short(cell)} in a column in {unit}", row, key, "write one column in one unit"
                )
        found[row] = number * FACTORS[unit]
        if not LEAST < abs(found[row]) < MOST and number:
            table.refuse(f"{_short(cell)} is beyond all springs", row, key, "check the number and its unit")
    return found


def _short(cell: str) -> str:
    """A cell as messages quote it."""
    return repr(cell if len(cell) <= SHOWN else f"{cell[:SHOWN]}...")


def _hint(cell: str, comma: bool) -> str:
    if cell.startswith("="):
        return "this is a formula: save the table with its values"
    if re.search(r"\d[.,]\d", cell):
        said = "commas are read as decimal and points as thousands" if comma else "points are read as decimal"
        return (
            f"{said}: write all numbers of a file in one way, and columns apart by semicolons where commas are decimal"
        )
    return ""


def _number(text: str, comma: bool) -> float | None:
    """A number whose groups of thousands, if it has any, are whole; None for what reads in no one way."""
    group, point = (".", ",") if comma else (",", ".")
    pattern = rf"[-+]?(\d{{1,3}}(\{group}\d{{3}})+|\d*)(\{point}\d*)?([eE][-+]?\d+)?"
    if not re.fullmatch(pattern, text, re.ASCII):
        return None
    try:
        value = float(text.replace(group, "").replace(point, "."))
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def part_numbers(table: Table) -> tuple[str, ...]:
    """Part numbers as they stand; raises InputError where one is missing or stands twice."""
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


def insist_positive(table: Table, key: str, values: Array) -> None:
    """Raise InputError where a column is empty, zero or negative."""
    bad = np.flatnonzero(~(values > 0))
    if len(bad):
        value = values[bad[0]]
        said = (
            "is empty"
            if np.isnan(value)
            else f"is {value / FACTORS[table.units.get(key, '')]:.4g}, it must be positive"
        )
        table.refuse(f"the {words_of(key)} {said}{more(bad)}", bad[0], key, "check sign and unit")
