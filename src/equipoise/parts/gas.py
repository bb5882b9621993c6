"""Gas springs by the numbers of their data sheets."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws.charge import ROOM
from equipoise.balancers.laws.gas import Gas
from equipoise.balancers.laws.law import Share
from equipoise.parts.coil import smallest
from equipoise.parts.helical import first_of
from equipoise.parts.part import Clause, Fault, Part
from equipoise.parts.wire import MM
from equipoise.units import Force, Length, Mass, Number, Temperature

LEAST = 1e-3
"""Share by which forces must rise, and strokes exceed what they must."""
NEAR_STROKE = 0.08
"""Up to this stroke, m, forces are measured 5 mm from the ends, above it 10 mm [yeswin_gas]."""


def measuring_distance(stroke: Any) -> Any:
    """How far from the ends of its stroke a gas spring's forces are measured, m [yeswin_gas]."""
    return np.where(np.real(stroke) <= NEAR_STROKE, 0.005, 0.010)[()]


def friction_of(extending: Any, compressing: Any) -> Any:
    """Fr = (F3 - F1) / 2, N, from the forces at the same place [jp_gas_spring]."""
    return (compressing - extending) / 2


@dataclass(frozen=True)
class GasSpring(Part):
    """A gas spring that pushes, as its data sheet gives it.

        F(x) = (T / 293 K) F1 (1 - u (x - c) / (s - 2c))^-n,   u = 1 - (F1 / F2)^(1/n),   x = L - l

    f1, f2 in N are the forces while it extends, c from the extended and from the compressed end (5 mm to a stroke of
    80 mm, else 10 mm [yeswin_gas]); stroke s and extended length L between the eyes in m; friction Fr in N is what
    compressing adds and extending lacks beside the mean, 0 where the sheet gives static forces; temperature T in K;
    exponent n is 1 for slow motion, which is how sheets are measured; number act in parallel. The law is the mean
    between extending and compressing. Raises InputError for forces that are not 0 < f1 < f2, a stroke that is no
    longer than twice c, and an extended length below the stroke. No standard covers these gas springs
    [yeswin_gas, jp_gas_spring].
    """

    f1: Force
    f2: Force
    stroke: Length
    length: Length
    friction: Force = 0.0
    temperature: Temperature = ROOM
    exponent: Number = 1.0
    number: Number = 1.0
    mass: Mass = 0.0
    part: str = ""
    kind: ClassVar[str] = "gas spring"
    sources: ClassVar[tuple[str, ...]] = ("yeswin_gas", "jp_gas_spring")

    @property
    def drag(self) -> float | None:
        """Fr of all pieces."""
        return float(self.number * self.friction)

    @property
    def degree(self) -> int | None:
        """No polynomial."""
        return None

    @property
    def pushes(self) -> bool:
        """It can only push."""
        return True

    @property
    def own_mass(self) -> Any:
        """Mass, kg, of all in parallel."""
        return self.number * self.mass

    @property
    def span(self) -> tuple[Any, Any]:
        """Compressed and extended length."""
        return self.length - self.stroke, self.length

    @property
    def gas(self) -> Gas:
        """The gas that has these forces: an area of 1 cm^2 per spring stands for all."""
        c, area = measuring_distance(self.stroke), 1e-4 * self.number
        low, high = self.f1 + self.friction, self.f2 + self.friction
        share = 1 - (low / high) ** (1 / self.exponent)
        return Gas(
            area=area,
            volume=area * (self.stroke - 2 * c) / share,
            length=self.length - c,
            pressure=self.number * low / area,
            exponent=self.exponent,
            ambient=0.0,
            temperature=self.temperature,
        )

    def shares(self, length: Array) -> tuple[Share, ...]:
        """The charge, given."""
        return self.gas.shares(length)

    def force_of_one(self, length: Array) -> Array:
        """Mean push (N,), N, of one spring at lengths (N,)."""
        return -self.force_at(length, {}) / self.number

    def faults(self) -> Iterator[Fault]:
        """What no data sheet says."""
        scale = max(abs(first_of(self.f2)), 1e-3)
        yield Fault(
            "forces in the wrong order",
            smallest(self.f1, self.f2 - self.f1) - LEAST * self.f2,
            scale,
            f"f1 is {first_of(self.f1):.4g} N and f2 {first_of(self.f2):.4g} N, a gas spring has 0 < f1 < f2",
            "f1 is measured extended, f2 compressed",
            "N",
        )
        stroke = first_of(self.stroke)
        yield Fault(
            "stroke too short",
            self.stroke - (2 + LEAST) * measuring_distance(self.stroke),
            abs(stroke),
            f"the stroke {stroke / MM:.4g} mm is not longer than twice the distance at which forces are measured",
            "check the stroke's unit",
            "m",
        )
        yield Fault(
            "extended length below the stroke",
            self.length - (1 + LEAST) * self.stroke,
            abs(stroke),
            f"the extended length {first_of(self.length) / MM:.4g} mm is not above the stroke {stroke / MM:.4g} mm",
            "give the length between the eyes",
            "m",
        )

    def clauses(self, length: Array) -> Iterator[Clause]:
        """The stroke that lengths (N,) use."""
        used = float(self.length - length.min())
        yield Clause("stroke", used, float(self.stroke), "m", "data sheet")

    def details(self, values: Any, length: Array) -> dict[str, tuple[Any, str]]:  # noqa: ARG002
        """Stroke used, and the friction band."""
        found: dict[str, tuple[Any, str]] = {
            f"{clause.name}, used": (100 * clause.used, "%") for clause in self.clauses(length)
        }
        return found | {"friction, either way": (float(self.number * self.friction), "N")}

    def order_line(self) -> str:
        """`gas spring ABC, F1 200 N, F2 260 N, stroke 150, extended length 400`, mm."""
        count = f"{self.number:g} pieces, " if self.number != 1 else ""
        name = f" {self.part}" if self.part else ""
        return (
            f"{count}gas spring{name}, F1 {self.f1:.4g} N, F2 {self.f2:.4g} N, stroke {self.stroke / MM:.4g}, "
            f"extended length {self.length / MM:.4g}"
        )
