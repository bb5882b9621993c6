"""What gas springs and hydro-pneumatic springs share: a pressure on an area, against the ambient one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from equipoise.affine import Array
from equipoise.balancers.laws.law import Law
from equipoise.units import Area, Pressure


class Piston(Law):
    """A pressure P behind an area A: f = s (P - Pa) A, s = +1 where it pulls its ends together, -1 where it pushes.

    area in m^2; ambient Pa in Pa; reading says how the charge is read.
    """

    area: Area
    action: Literal["pull", "push"]
    reading: Literal["absolute", "gauge"]
    ambient: Pressure

    @property
    def drag(self) -> float | None:
        """The seals' friction is not stated."""
        return None

    @property
    def degree(self) -> int | None:
        """No polynomial."""
        return None

    @property
    def remarks(self) -> tuple[str, ...]:
        """How it acts and how its charge is read."""
        return f"{self.action}es" if self.pushes else f"{self.action}s", f"{self.reading} charge"

    @property
    def pushes(self) -> bool:
        """Whether it is a strut that pushes its ends apart."""
        return self.action == "push"

    @property
    def side(self) -> float:
        """s: +1 where it pulls, -1 where it pushes."""
        return -1.0 if self.pushes else 1.0

    def pressures(self, length: Array, values: Mapping[str, Any]) -> Array:
        """Absolute pressure P (N,), Pa, at lengths (N,), m."""
        return self.side * self.force_at(length, values) / self.area + self.ambient
