"""What a survey found: a line per candidate, ranked, on disk while it grows."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from equipoise.errors import InputError
from equipoise.parts.catalogue import Catalogue


@dataclass(frozen=True)
class Line:
    """One candidate at its best geometry: the objective's value and all norms, and why it is refused, if it is."""

    part: str
    number: int
    value: float
    peak: float
    rms: float
    mean: float
    geometry: tuple[float, ...]
    refused: str = ""
    excess: float = 0.0


@dataclass(frozen=True, eq=False)
class Ranking:
    """All lines of a survey for one spring; free names the geometry, units its SI units, norm what ranks.

    outranked counts the candidates that the closed form put behind those that were worked on.
    """

    catalogue: Catalogue
    spring: str
    free: tuple[str, ...]
    units: tuple[str, ...]
    norm: str
    lines: tuple[Line, ...]
    outranked: int = 0

    @property
    def ranked(self) -> list[Line]:
        """The lines that keep every limit, best first."""
        return sorted((line for line in self.lines if not line.refused), key=lambda line: (line.value, line.number))

    @property
    def refused(self) -> dict[str, int]:
        """How many candidates were refused, by reason, the commonest first."""
        return dict(Counter(line.refused for line in self.lines if line.refused).most_common())

    def row(self, line: Line) -> int:
        """Where the line's part stands in the catalogue."""
        return self.catalogue.part.index(line.part)

    def table(self) -> str:
        """The ranked table as CSV, those that are refused last, with the reason; SI units in the header."""
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["rank", *header(self.free, self.units)])
        refused = sorted((line for line in self.lines if line.refused), key=lambda line: line.excess)
        for rank, line in enumerate([*self.ranked, *refused], 1):
            writer.writerow(["" if line.refused else rank, *cells(line)])
        return out.getvalue()


def header(free: Sequence[str], units: Sequence[str]) -> list[str]:
    """Names of a line's cells."""
    geometry = [f"{name} [{unit}]" if unit else name for name, unit in zip(free, units, strict=True)]
    return ["part", "number", "value", "peak", "rms", "mean", "refused", "excess", *geometry]


def cells(line: Line) -> list[str]:
    """A line as text that reads back exactly."""
    numbers = [repr(float(v)) for v in (line.value, line.peak, line.rms, line.mean)]
    return [line.part, str(line.number), *numbers, line.refused, repr(line.excess), *map(repr, line.geometry)]


class Ledger:
    """Finished lines on disk: appended and flushed chunk by chunk, read back when a survey goes on.

    The first line of the file is the survey's signature, so that lines of another problem or catalogue are not taken
    up; a last line that was cut short is dropped.
    """

    def __init__(self, path: Path, signature: str, free: Sequence[str], units: Sequence[str]) -> None:
        self.path = path
        self._head = [f"# survey {signature}", ",".join(header(free, units))]
        self._width = len(header(free, units))

    def load(self) -> list[Line]:
        """The lines of an earlier run of the same survey; none where there is no file.

        Raises InputError where the file belongs to another survey, or has a row that no survey wrote.
        """
        if not self.path.exists():
            return []
        try:
            text = self.path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError):
            text = ""
        *kept, _ = text.split("\n")
        if not kept or kept[0] != self._head[0]:
            raise InputError(
                "this file belongs to another survey",
                where=str(self.path),
                hint="the problem or the catalogue has changed: choose another --out, or remove the file",
            )
        self.path.write_text("".join(f"{line}\n" for line in kept), encoding="utf-8")
        return [self._line(number, row) for number, row in enumerate(csv.reader(kept[2:]), 3)]

    def _line(self, number: int, row: Sequence[str]) -> Line:
        try:
            if len(row) != self._width:
                raise ValueError
            return _read(row)
        except ValueError:
            raise InputError(
                "this row is not as it was written",
                where=f"{self.path}, row {number}",
                hint="remove the row, and its candidate is worked on again",
            ) from None

    def append(self, lines: Sequence[Line]) -> None:
        """Write lines at the end, so that they are on disk when this returns."""
        try:
            fresh = not self.path.exists()
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("a", encoding="utf-8", newline="") as stream:
                if fresh:
                    stream.write("".join(f"{line}\n" for line in self._head))
                csv.writer(stream, lineterminator="\n").writerows(cells(line) for line in lines)
                stream.flush()
        except OSError as error:
            said = f"cannot write: {error.strerror or error}"
            raise InputError(said, where=str(self.path), hint="choose another --out") from None


def _read(row: Sequence[str]) -> Line:
    """A line from its cells; raises ValueError where they are none of a line's."""
    part, number, value, peak, rms, mean, refused, excess, *geometry = row
    return Line(
        part, int(number), float(value), float(peak), float(rms), float(mean), tuple(map(float, geometry)), refused,
        float(excess),
    )  # fmt: skip
