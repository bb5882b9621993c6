"""Coefficients of friction."""

from __future__ import annotations

from dataclasses import dataclass, fields

from equipoise.balancers.paths.rub import Kind
from equipoise.errors import InputError
from equipoise.units import Length, Number, text, unit_marks


@dataclass(frozen=True)
class Friction:
    """Coulomb friction of what balances; the defaults are unsourced.

    pin: coefficient of plain bearings of radius pin_radius (rolling ones: 0.002); slide: of guides, blocks and eyes;
    rope: share of the pull that a rope loses over half a turn of sheave; mesh: share of the power that a gear mesh or a
    belt loses; seal: share of the force that the seals of a gas spring without a data sheet take. Raises InputError
    for a negative value, or a share of 1 and more.
    """

    pin: Number = 0.1
    pin_radius: Length = 5e-3
    slide: Number = 0.1
    rope: Number = 0.03
    mesh: Number = 0.02
    seal: Number = 0.05

    def __post_init__(self) -> None:
        units = unit_marks(type(self))
        for field in fields(self):
            value, share = getattr(self, field.name), field.name in ("rope", "mesh", "seal")
            if not value >= 0 or (share and value >= 1):
                limit = "between 0 and 1" if share else "at least 0"
                raise InputError(
                    f"it is {text(value, units[field.name])}, {limit} is possible", where=f"friction.{field.name}"
                )

    def of(self, kind: Kind) -> float:
        """What load times pace is multiplied by."""
        return float(self.pin * self.pin_radius if kind == "pin" else getattr(self, kind))
