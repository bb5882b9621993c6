"""What extension, compression and torsion springs share: wire, mean coil diameter, coils, grade."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError, nearest
from equipoise.parts import coil
from equipoise.parts.part import Fault, StraightPart
from equipoise.parts.wire import MM, Grade, grade
from equipoise.units import Length, Number

INDEX = (4.0, 20.0)
"""Spring index D / d that EN 13906 covers for cold coiling [caruso_en_springs]."""
LEAST_COILS = 2.0


@dataclass(frozen=True)
class Helical(StraightPart):
    """A spring of round wire: wire d and mean coil diameter D, m, active coils n, and the wire's grade.

    Faults: a wire outside the range in which the grade's strength is known, an index outside 4..20, fewer than two
    active coils.
    """

    wire: Length
    diameter: Length
    coils: Number
    grade: str = "EN 10270-1 SH"
    standard: ClassVar[str] = ""
    corrections: ClassVar[Mapping[str, Callable[[Any], Any]]] = coil.CORRECTIONS

    @property
    def material(self) -> Grade:
        """The wire's grade."""
        return grade(self.grade)

    @property
    def count(self) -> Any:
        """How many act in parallel."""
        return getattr(self, "number", 1)

    @property
    def index(self) -> Any:
        """Spring index w = D / d."""
        return coil.spring_index(self.wire, self.diameter)

    @property
    def total_coils(self) -> Any:
        """All coils, those at rest included."""
        return self.coils

    @property
    def strength(self) -> Any:
        """Minimum tensile strength Rm of the wire, Pa."""
        return self.material.strength(self.wire)

    @property
    def own_mass(self) -> Any:
        """Mass, kg, of all the springs in parallel."""
        return self.count * coil.wire_mass(self.wire, self.diameter, self.total_coils, self.material.density)

    @property
    def unsourced(self) -> tuple[str, ...]:
        """The grade, where its numbers have no opened source."""
        return (f"the data of {self.material.name}",) if self.material.unsourced else ()

    @abstractmethod
    def plain_stress(self, length: Array) -> Array:
        """Shear, or bending, stress of the wire (N,), Pa, at lengths (N,), m, or angles, without correction."""

    def stress(self, length: Array, correction: str) -> Array:
        """The same times k(w), the factor for the wire's curvature: `wahl` or `bergstraesser`, of torsion springs
        `curvature`.

        Raises InputError for a factor that the spring has not.
        """
        if correction not in self.corrections:
            hint = nearest(correction, list(self.corrections))
            raise InputError(f"there is no correction {correction!r}", where="stress", hint=hint)
        return self.corrections[correction](self.index) * self.plain_stress(length)

    def record(self, length: Array) -> dict[str, Any]:
        """With the largest stress of the wire, Pa, plain and by each factor for its curvature."""
        plain = float(np.abs(self.plain_stress(length)).max())
        found = {name: float(factor(self.index)) * plain for name, factor in self.corrections.items()}
        return super().record(length) | {"stress": {"plain": plain, **found}}

    def faults(self) -> Iterator[Fault]:
        """What no winder or standard covers."""
        low, high = self.material.range
        yield Fault(
            "wire outside its standard",
            coil.smallest(self.wire - low, high - self.wire),
            high,
            f"wire {first_of(self.wire) / MM:.4g} mm is outside {self.material.name}, whose strength is known for "
            f"{low / MM:g} to {high / MM:g} mm",
            "take a size within, or another grade",
            "m",
        )
        yield Fault(
            "spring index outside 4..20",
            coil.smallest(self.index - INDEX[0], INDEX[1] - self.index),
            INDEX[1],
            f"the spring index D / d is {first_of(self.index):.4g}, it must lie in {INDEX[0]:g}..{INDEX[1]:g}",
            "4 to 15 winds well: change diameter or wire",
        )
        yield Fault(
            "fewer than two coils",
            self.coils - LEAST_COILS,
            LEAST_COILS,
            f"{first_of(self.coils):.4g} active coils, at least {LEAST_COILS:g} are needed",
            "use a thinner wire or a smaller coil for the same rate",
        )

    def head(self) -> str:
        """Standard, grade, wire, diameter and coils, as an order begins."""
        count = f"{self.count:g} pieces, " if np.any(np.not_equal(self.count, 1)) else ""
        return (
            f"{count}{self.standard}, wire {self.material.name} {self.wire / MM:.4g}, D {self.diameter / MM:.4g}, "
            f"n {self.coils:.4g}"
        )


def first_of(value: Any) -> float:
    """The first of rows, or the number itself."""
    return float(np.real(np.ravel(value)[0]))
