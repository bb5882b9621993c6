"""How a part was chosen for a spring: what stands in design.json of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Tried:
    """A part that was shaped around, `number` in parallel: the objective's value, and the 95 % value where that judges.

    value and high are in the objective's unit.
    """

    part: str
    number: int
    value: float
    high: float | None = None

    @property
    def judged(self) -> float:
        """What decides."""
        return self.value if self.high is None else self.high

    @property
    def name(self) -> str:
        """The part with its number, as one says it: `2 x E-0360`."""
        return f"{self.number} x {self.part}" if self.number > 1 else self.part


@dataclass(frozen=True)
class Choice:
    """What stands in for one spring, and why: its order line, and the parts tried with what they reached, best first.

    The first of them is taken. candidates counts what the source (catalogue or grid) held after its filters, removed
    what these took out, refused what limits refused, by reason; outranked what the closed form put behind the others.
    """

    spring: str
    order: str
    source: str
    candidates: int
    outranked: int
    removed: Mapping[str, int]
    refused: Mapping[str, int]
    tried: tuple[Tried, ...]
    remarks: tuple[str, ...]

    @property
    def taken(self) -> Tried:
        """The part that stands in the design."""
        return self.tried[0]

    def counted(self) -> list[str]:
        """The candidates in words: how many there were, and what took how many out."""
        said = [f"{self.candidates} candidates of {self.source}"]
        said += [f"{count} left out by {words}" for words, count in self.removed.items()]
        said += [f"{self.outranked} put behind the others by the closed form"] if self.outranked else []
        return said + [f"{count} refused: {words}" for words, count in self.refused.items()]

    def json(self) -> dict[str, Any]:
        """The choice as design.json holds it."""
        return vars(self) | {"tried": [dict(vars(one)) for one in self.tried], "remarks": list(self.remarks)}

    @staticmethod
    def read(entry: Mapping[str, Any]) -> Choice:
        """The choice from what design.json holds; raises TypeError or KeyError for an entry that is none."""
        tried = tuple(Tried(**one) for one in entry["tried"])
        return Choice(**{**entry, "tried": tried, "remarks": tuple(entry["remarks"])})
