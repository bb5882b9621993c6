"""Limits on the spring index: the ratio of coil to wire, in the rate that is found or in the wire that is shaped."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from equipoise import units
from equipoise.affine import Unknown
from equipoise.balancers.laws import WireMass
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError
from equipoise.limits.limit import Setting
from equipoise.parts.helical import Helical
from equipoise.solve.program import Rows

STEEL = 81.5e9


@dataclass(frozen=True)
class SpringIndex:
    """min <= D / d <= max of a coil spring's index, mean coil diameter over wire.

    A part has its wire, so the limit is one on its numbers. Else the wire follows the rate, d^4 = 8 D^3 n k / G, and
    the limit is linear in the rate, found or given:

        G D / (8 n max^4) <= k <= G D / (8 n min^4)

    with diameter D, m, active coils n and shear_modulus G, Pa, from the spring's WireMass where they are left out.
    Raises InputError for a spring without a rate, without a wire, and for reversed or missing bounds.
    """

    spring: str
    min: units.Number | None = None
    max: units.Number | None = None
    diameter: units.Length | None = None
    coils: units.Number | None = None
    shear_modulus: units.Pressure | None = None

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """One row per side."""
        bounds = [(value, side) for value, side in ((self.min, -1.0), (self.max, 1.0)) if value is not None]
        if not bounds or any(not value > 0 for value, _ in bounds) or (len(bounds) > 1 and self.min >= self.max):  # type: ignore[operator]
            raise InputError(
                "the spring index needs positive bounds, min below max", where="limits", hint="4 to 15 winds well"
            )
        spring = setting.find(self.spring, Spring, "spring_index")
        law = spring.law
        if isinstance(law, Helical) and self.diameter is None:
            index = np.atleast_1d(np.asarray(law.index))
            return tuple(self._row(value, side, index, value, None, "") for value, side in bounds)
        if not hasattr(law, "k") or spring.path.unit != "m":
            raise InputError(
                f"spring {self.spring} has no rate that a coil's wire follows",
                where="limit spring_index",
                hint="limit a coil, a zero-free-length spring or an extension or compression spring",
            )
        per = self._rate_at_one(spring)
        rate: Any = getattr(law, "k")  # noqa: B009 - laws without one were refused above
        unknown = next((u for u in spring.unknowns if u.name == f"{spring.owner}.k"), None)
        # The larger the index, the softer the coil: an upper bound on the index is a lower one on the rate.
        return tuple(self._row(value, -side, rate, per / value**4, unknown, "N/m") for value, side in bounds)

    def _row(self, bound: float, side: float, given: Any, limit: Any, unknown: Unknown | None, unit: str) -> Rows:
        """side (x - limit) <= 0 of the index or the rate x, given or found."""
        words = f"spring index of {self.spring} {'<=' if bound == self.max else '>='} {bound:g}"
        limit = np.atleast_1d(np.asarray(limit))
        size = float(np.abs(np.real(limit)).max())
        if unknown is not None:
            return Rows(words, unit, np.full((1, 1), side), side * limit, (unknown,), scale=size)
        room = side * (limit - np.atleast_1d(np.asarray(given)))
        return Rows(words, unit, np.zeros((*room.shape, 0), dtype=room.dtype), room, (), scale=size)

    def _rate_at_one(self, spring: Spring) -> Any:
        """G D / (8 n), N/m: the rate of a coil of index one."""
        wire = spring.mass if isinstance(spring.mass, WireMass) else None
        diameter = self.diameter if self.diameter is not None or wire is None else wire.diameter
        coils = self.coils if self.coils is not None or wire is None else wire.coils
        if diameter is None or coils is None:
            raise InputError(
                f"nothing says what coil spring {self.spring} has",
                where="limit spring_index",
                hint="give the limit a diameter and coils, the spring a wire_mass, or a law extension_spring",
            )
        shear = self.shear_modulus or (wire.shear_modulus if wire is not None else STEEL)
        return shear * diameter / (8 * coils)
