"""A spring from a catalogue, by the numbers that catalogues print."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from equipoise.affine import Array
from equipoise.parts.helical import first_of
from equipoise.parts.part import Clause, Fault, StraightPart
from equipoise.parts.wire import MM
from equipoise.units import Force, Length, Mass, Number, Stiffness

LEAST = 1e-9
"""The least rate, N/m, and the least length, m."""
Form = Literal["extension", "compression"]


@dataclass(frozen=True)
class StockSpring(StraightPart):
    """A catalogue's spring: f = N (F0 + R (l - leader - L0)).

    part is its number; rate R in N/m, free_length L0 in m, initial_tension F0 in N, mass in kg, each of one spring;
    limit, m, is the longest (extension) or shortest (compression) length of one spring under load, force the largest
    load, N, in size; at least one of the two must be known. form says whether it is stretched or pressed. number N
    act in parallel; leader, m, is a rod or wire between spring and hook. Raises InputError for a rate or length that
    is not positive, a negative tension, and a limit on the wrong side of the free length.
    """

    part: str
    rate: Stiffness
    free_length: Length
    limit: Length | None = None
    force: Force | None = None
    initial_tension: Force = 0.0
    mass: Mass = 0.0
    number: Number = 1.0
    leader: Length = 0.0
    form: Form = "extension"
    kind: ClassVar[str] = "stock spring"

    @property
    def pushes(self) -> bool:
        """Whether it can only push."""
        return self.form == "compression"

    @property
    def k(self) -> Any:
        """Rate, N/m, of all in parallel."""
        return self.number * self.rate

    @property
    def rest(self) -> Any:
        """Free length and leader, m."""
        return self.free_length + self.leader

    @property
    def tension(self) -> Any:
        """Initial tension, N, of all in parallel."""
        return self.number * self.initial_tension

    @property
    def own_mass(self) -> Any:
        """Mass, kg, of all in parallel."""
        return self.number * self.mass

    @property
    def travel(self) -> Any:
        """How far one spring may be moved from its free length, m."""
        side = -1.0 if self.pushes else 1.0
        ways = [] if self.limit is None else [side * (self.limit - self.free_length)]
        if self.force is not None:
            ways.append((self.force - self.initial_tension) / self.rate)
        return ways[0] if len(ways) == 1 else np.where(np.real(ways[0]) < np.real(ways[1]), *ways)[()]

    @property
    def span(self) -> tuple[Any, Any]:
        """Between the free length and the end of its travel, leader included."""
        end = self.rest + (-self.travel if self.pushes else self.travel)
        return (end, self.rest) if self.pushes else (self.rest, end)

    def faults(self) -> Iterator[Fault]:
        """What no spring can be."""
        if self.limit is None and self.force is None:
            yield Fault(
                "no limit",
                -1.0,
                1.0,
                f"spring {self.part} has neither a largest length nor a largest force",
                "catalogues print one of them: `limit` in m or `force` in N",
            )
            return
        for name, value, least, unit in (
            ("rate", self.rate, LEAST, "N/m"),
            ("free_length", self.free_length, LEAST, "m"),
            ("initial_tension", self.initial_tension, 0.0, "N"),
        ):
            words = name.replace("_", " ")
            yield Fault(
                f"{words} not positive",
                value - least,
                1.0 if least == 0 else least,
                f"the {words} of {self.part} is {first_of(value):.4g}",
                "it must be positive",
                unit,
            )
        yield Fault(
            "no travel",
            self.travel - LEAST,
            LEAST,
            f"spring {self.part} has no travel: its end is {first_of(self.travel) / MM:.4g} mm from its free length",
            "check limit, force and form",
            "m",
        )

    def clauses(self, length: Array) -> Iterator[Clause]:
        """The travel that lengths (N,) use, by the catalogue's own limit."""
        used = float(np.abs(length - self.rest).max())
        yield Clause("travel", used, float(self.travel), "m", "catalogue")

    def details(self, values: Any, length: Array) -> dict[str, tuple[Any, str]]:  # noqa: ARG002
        """The travel used."""
        return {f"{clause.name}, used": (100 * clause.used, "%") for clause in self.clauses(length)}

    def order_line(self) -> str:
        """`ABC-123 (R 1.2 N/mm, L0 50, F0 5 N)`, mm."""
        count = f"{self.number:g} pieces, " if self.number != 1 else ""
        tension = f", F0 {self.initial_tension:.4g} N" if self.initial_tension else ""
        return f"{count}{self.part} (R {self.rate / 1e3:.4g} N/mm, L0 {self.free_length / MM:.4g}{tension})"
