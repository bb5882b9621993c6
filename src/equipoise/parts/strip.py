"""Constant-force springs of rolled strip."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from equipoise.parts.helical import first_of
from equipoise.parts.part import Fault, StraightPart
from equipoise.parts.wire import MM
from equipoise.units import Density, Length, Number, Pressure

ON_DRUM = 1.5
"""Turns that stay on the drum at full travel [springipedia_strip]."""


def strip_force(width: Any, thickness: Any, radius: Any, young: Any) -> Any:
    """F = E b t^3 / (26.4 R^2), N, of strip b x t, m, with the natural radius R, m [springipedia_strip]."""
    return young * width * thickness**3 / (26.4 * radius**2)


@dataclass(frozen=True)
class ConstantForceSpring(StraightPart):
    """A constant-force spring of rolled strip: f = N E b t^3 / (26.4 R^2) over its travel.

    width b, thickness t, natural radius R (half the free inside diameter) and travel in m; retracted is the path's
    length, m, at which it is rolled up; number N act together; young E in Pa and density, kg/m^3, are those of
    stainless strip (unsourced). The force is constant to about 10 % (unsourced), and falls over the first turn.
    Raises InputError for strip thicker than a tenth of the radius [springipedia_strip].
    """

    width: Length
    thickness: Length
    radius: Length
    travel: Length
    retracted: Length = 0.0
    number: Number = 1.0
    young: Pressure = 193e9
    density: Density = 7900.0
    kind: ClassVar[str] = "constant force spring"
    sources: ClassVar[tuple[str, ...]] = ("springipedia_strip",)

    @property
    def degree(self) -> int:
        """The force does not follow the length."""
        return 0

    @property
    def k(self) -> Any:
        """No rate."""
        return 0.0

    @property
    def rest(self) -> Any:
        """Length at which it is rolled up, m."""
        return self.retracted

    @property
    def tension(self) -> Any:
        """The force, N, of all together."""
        return self.number * strip_force(self.width, self.thickness, self.radius, self.young)

    @property
    def span(self) -> tuple[Any, Any]:
        """Rolled up to full travel."""
        return self.retracted, self.retracted + self.travel

    @property
    def own_mass(self) -> Any:
        """Mass, kg, of the strip: its travel and the turns that stay on the drum."""
        strip = self.travel + ON_DRUM * 2 * np.pi * self.radius
        return self.number * self.density * self.width * self.thickness * strip

    @property
    def unsourced(self) -> tuple[str, ...]:
        """E, density and the constancy of the force."""
        return ("E and density of the strip", "how constant the force is")

    def faults(self) -> Iterator[Fault]:
        """Strip that could not be rolled flat and back."""
        yield Fault(
            "strip too thick",
            0.1 * self.radius - self.thickness,
            abs(first_of(self.radius)),
            f"strip of {first_of(self.thickness) / MM:.4g} mm cannot roll to a radius of "
            f"{first_of(self.radius) / MM:.4g} mm",
            "take thinner strip or a larger radius",
            "m",
        )

    def order_line(self) -> str:
        """`constant force spring, strip 20 x 0.2, natural inside diameter 25, travel 500, 11.7 N`, mm."""
        count = f"{self.number:g} pieces, " if self.number != 1 else ""
        return (
            f"{count}constant force spring, strip {self.width / MM:.4g} x {self.thickness / MM:.4g}, natural inside "
            f"diameter {2 * self.radius / MM:.4g}, travel {self.travel / MM:.4g}, {self.tension / self.number:.4g} N"
        )
