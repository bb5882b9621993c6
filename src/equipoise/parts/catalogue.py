"""A table of springs: part numbers and the numbers that decide, as arrays of rows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array, Indices
from equipoise.errors import InputError
from equipoise.parts.part import StraightPart
from equipoise.parts.stock import Form, StockSpring

Rows = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Catalogue:
    """Springs by rows (C,): part numbers, and rate, N/m, free length, m, initial tension, N, travel, m, mass, kg.

    travel is how far a spring may be moved from its free length; form tells springs that are stretched from those
    that are pressed; line (C,) is where a row stands in its file; make builds row i as the part it is; remarks are
    what the reader noticed; width (C,) is the outside diameter, m, nan where it is not known.
    """

    name: str
    part: tuple[str, ...]
    form: tuple[Form, ...]
    rate: Array
    free_length: Array
    initial_tension: Array
    travel: Array
    mass: Array
    width: Array
    line: Rows
    make: Callable[[int], StraightPart] | None = None
    remarks: tuple[str, ...] = field(default=())

    def __len__(self) -> int:
        return len(self.part)

    def take(self, rows: Sequence[int] | Indices) -> Catalogue:
        """Some of the rows."""
        index = np.asarray(rows, dtype=np.intp)
        arrays = ("rate", "free_length", "initial_tension", "travel", "mass", "width", "line")
        make = self.make
        return replace(
            self,
            part=tuple(self.part[i] for i in index),
            form=tuple(self.form[i] for i in index),
            make=None if make is None else lambda i: make(int(index[i])),
            **{name: getattr(self, name)[index] for name in arrays},
        )

    def law(self, rows: Rows, number: Array) -> StockSpring:
        """The springs of rows (K,), number (K,) of each in parallel, as one law with arrays (K, 1); of one form."""
        forms = {self.form[i] for i in rows}
        if len(forms) != 1:
            raise InputError("rows of stretched and of pressed springs are no one law", where=self.name)
        form = forms.pop()
        side = -1.0 if form == "compression" else 1.0
        columns: dict[str, Any] = {
            name: getattr(self, name)[rows][:, None] for name in ("rate", "free_length", "initial_tension", "mass")
        }
        limit = columns["free_length"] + side * self.travel[rows][:, None]
        return StockSpring.of_rows(part=self.name, limit=limit, number=number[:, None], form=form, **columns)

    def spring(self, row: int, number: float = 1.0) -> StraightPart:
        """One row as the part it is, `number` of it in parallel."""
        if self.make is not None:
            return replace(self.make(row), number=float(number))
        side = -1.0 if self.form[row] == "compression" else 1.0
        return StockSpring(
            part=self.part[row],
            rate=float(self.rate[row]),
            free_length=float(self.free_length[row]),
            limit=float(self.free_length[row] + side * self.travel[row]),
            initial_tension=float(self.initial_tension[row]),
            mass=float(self.mass[row]),
            number=float(number),
            form=self.form[row],
        )


def filtered(catalogue: Catalogue, keep: Mapping[str, NDArray[np.bool_]]) -> tuple[Catalogue, dict[str, int]]:
    """The rows that pass every filter {words: rows that pass (C,)}, and how many each filter was the first to remove.

    Raises InputError where none is left, with what each removed.
    """
    left, removed = np.ones(len(catalogue), dtype=bool), {}
    for words, passing in keep.items():
        gone = left & ~passing
        if gone.any():
            removed[words] = int(gone.sum())
        left &= passing
    if not left.any():
        told = "; ".join(f"{count} by {words}" for words, count in removed.items())
        raise InputError(
            f"none of its {len(catalogue)} springs is left: {told or 'it is empty'}",
            where=catalogue.name,
            hint="relax the filter that removed most",
        )
    return catalogue.take(np.flatnonzero(left)), removed
