"""Gas struts between two bodies."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.balancers.laws import Gas, Law
from equipoise.discovery.kinds.lines import LineKind, Lines
from equipoise.errors import InputError
from equipoise.limits import Force, Length, Limit
from equipoise.units import Force as Newtons
from equipoise.units import Length as Metres
from equipoise.units import Number


@dataclass(frozen=True)
class GasStruts(LineKind):
    """Gas struts that push two bodies apart, slowly (isothermal).

        f = -p A V0 / (V0 + A (l - l_max)),   V0 = A stroke progression / (progression - 1)

    rod is the diameter on which the gas acts, m; progression the force pushed in over that pushed out; reach the
    extended over the compressed length, which must stay below 2 with the fittings, neither with a unit; force in N
    the most that a strut may push. Raises InputError for a progression or reach that is not above 1.
    """

    force: Newtons = 2500.0
    rod: Metres = 0.010
    progression: Number = 1.3
    reach: Number = 1.7

    def __post_init__(self) -> None:
        for name in ("progression", "reach"):
            if not getattr(self, name) > 1:
                raise InputError(f"{name} is {getattr(self, name):g}, it must be above 1", where="discover")
        if not self.rod > 0:
            raise InputError(f"the rod is {self.rod:g} m, it must be positive", where="discover")

    @property
    def words(self) -> str:
        """Gas strut."""
        return "gas strut"

    @property
    def most(self) -> float:
        """The largest force, N."""
        return self.force

    def refuses(self, lines: Lines) -> Mapping[str, NDArray[np.bool_]]:
        """Couples farther apart than a strut that fits the shortest length can reach."""
        words = f"longest over {self.reach:g} times the shortest length of a strut"
        return {words: lines.longest > self.reach * lines.shortest}

    def laws(self, lines: Lines) -> list[Mapping[str, Array]]:
        """Gas volume and length when extended."""
        stroke = lines.longest - lines.shortest
        return [{"volume": self._area * stroke * self.progression / (self.progression - 1), "length": lines.longest}]

    @property
    def _area(self) -> float:
        return math.pi * self.rod**2 / 4

    def open(self, numbers: Mapping[str, Array]) -> Law:
        """The charge is open."""
        volume, length = numbers["volume"], numbers["length"]
        return Gas(self._area, volume, length, exponent=1.0, reading="gauge")  # type: ignore[arg-type]

    def settled(self, one: Lines) -> Law:
        """The charge is open."""
        numbers = {name: float(value[0]) for name, value in self.laws(one)[0].items()}
        return Gas(self._area, numbers["volume"], numbers["length"], exponent=1.0, reading="gauge")

    def limits(self, name: str, one: Lines) -> tuple[Limit, ...]:
        """It pushes, within its force and between its two lengths."""
        longest = float(one.longest[0])
        return Force(name, min=-self.force, max=0.0), Length(name, max=longest, min=longest / self.reach)
