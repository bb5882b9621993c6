"""Tables of joint positions: the columns of a CSV file, and poses written by name."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError, nearest
from equipoise.mechanism import Mechanism
from equipoise.units import to_si

RESULTS = ("before ", "after ", "payload ")
"""Heads of columns that a report's residuals.csv holds beside the poses."""
BESIDE = ("time", "weight")
"""Columns that a list of poses or a motion does not need."""


def held(mechanism: Mechanism) -> Array:
    """Reference positions of the driven joints (nd,), brought inside their limits."""
    model, joints = mechanism.model, mechanism.driven_ids
    reference = mechanism.reference[model.jnt_qposadr[joints]]
    limited = model.jnt_limited[joints].astype(bool)
    low, high = model.jnt_range[joints].T
    return np.clip(reference, np.where(limited, low, -np.inf), np.where(limited, high, np.inf))


def read_columns(mechanism: Mechanism, path: Path, own: Mapping[str, str]) -> dict[str, Array]:
    """Columns {name: (N,)} of a CSV file, SI: driven joints, and those of `own` {name: unit}.

    A column is headed `joint` (rad or m), `joint [deg]`, or by a name of its own; columns that reports write
    beside the poses are left out. Raises InputError naming line and column.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as stream:
            lines = [line for line in csv.reader(stream) if any(cell.strip() for cell in line)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"cannot read the file: {reason}", where=str(path), hint="check the path") from None
    if len(lines) < 2:
        raise InputError(
            "the file has a header, but no poses or instants",
            where=str(path),
            hint="one line for each below the header",
        )
    heads = [_header(cell, mechanism, path, own) for cell in lines[0]]
    columns = {name: np.empty(len(lines) - 1) for name, _ in heads if name}
    for row, line in enumerate(lines[1:]):
        where = f"{path}, line {row + 2}"
        if len(line) != len(heads):
            raise InputError(f"{len(line)} values for {len(heads)} columns", where=where)
        for (name, unit), cell in zip(heads, line, strict=True):
            if name:
                columns[name][row] = _number(cell, unit, own.get(name, "rad or m"), f"{where}, column {name}")
    return columns


def _number(cell: str, unit: str, wanted: str, where: str) -> float:
    if not cell.strip():
        raise InputError("the value is missing", where=where, hint="fill the gap or leave the line out")
    try:
        value = float(cell)
    except ValueError:
        raise InputError(f"{cell!r} is not a number", where=where) from None
    if not math.isfinite(value):
        raise InputError(f"{cell.strip()} is not a finite number", where=where)
    return float(to_si(f"{value!r} {unit}", wanted, where)) if unit else value


def _header(cell: str, mechanism: Mechanism, path: Path, own: Mapping[str, str]) -> tuple[str, str]:
    name, _, unit = cell.partition("[")
    name, unit = name.strip(), unit.strip().rstrip("]").strip()
    if name in own or name in mechanism.driven:
        return name, unit
    if name.startswith(RESULTS) or name in BESIDE:
        return "", ""
    hint = nearest(name, [*mechanism.driven, *own])
    raise InputError(f"column {name!r} is not a driven joint", where=f"{path}, line 1", hint=hint)
