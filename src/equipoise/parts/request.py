"""What a problem file may ask of `pick`: where parts come from, and which of them are welcome."""

from __future__ import annotations

import fnmatch
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from equipoise.errors import InputError
from equipoise.parts.catalogue import Catalogue, filtered
from equipoise.parts.grid import MakeableGrid
from equipoise.parts.importer import read_catalogue
from equipoise.parts.stock import Form
from equipoise.units import Length, Mass, text


@dataclass(frozen=True)
class Pick:
    """Real parts for the springs of a design: from a catalogue, a CSV file, or from the grid of what can be wound.

    springs names those that get a part (default: all along a length whose law is no part yet); parallel is how many of
    one part may act side by side; keep how many of the best are shaped with the objective's own norm; leader (low,
    high), m, frees a rod or wire between spring and hook. Filters: part, a pattern of part numbers with `*`; mass and
    width (outside diameter) at most. columns maps what the reader does not recognise {what: header}, units is that of
    columns that say none, form that of rows that say none.
    """

    catalogue: Path | None = None
    grid: MakeableGrid | None = None
    springs: tuple[str, ...] | None = None
    parallel: int = 2
    keep: int = 3
    leader: tuple[Length, Length] | None = None
    part: str | None = None
    mass: Mass | None = None
    width: Length | None = None
    columns: Mapping[str, str] | None = None
    units: Literal["metric", "inch"] | None = None
    form: Form = "extension"

    def __post_init__(self) -> None:
        for name, value in (("parallel", self.parallel), ("keep", self.keep)):
            if value < 1:
                raise InputError(f"{name} is {value}, it must be at least 1", where="pick")
        if self.catalogue is not None and self.grid is not None:
            raise InputError("a catalogue and a grid are both asked for", where="pick", hint="keep one")

    def table(self) -> tuple[Catalogue, dict[str, int]]:
        """The welcome parts, and how many each filter removed; raises InputError where none is left."""
        if self.catalogue is None:
            found = (self.grid or MakeableGrid()).catalogue()
        else:
            found = read_catalogue(self.catalogue, columns=self.columns, units=self.units, form=self.form)
        keep = {}
        if self.part is not None:
            pattern = self.part
            keep[f"part {pattern}"] = np.array([fnmatch.fnmatchcase(name, pattern) for name in found.part])
        if self.mass is not None:
            keep[f"mass <= {text(self.mass, 'kg')}"] = found.mass <= self.mass
        if self.width is not None:
            # A width that the catalogue does not print is no reason to leave a spring out.
            keep[f"width <= {text(1e3 * self.width, 'mm')}"] = ~(found.width > self.width)
        return filtered(found, keep)
