"""Hydro-pneumatic springs: a hydraulic cylinder on an accumulator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws.charge import ROOM, STANDARD, Charge, gas_details, positive, say
from equipoise.balancers.laws.gas import LEAST, Gas
from equipoise.balancers.laws.law import Share
from equipoise.balancers.laws.nitrogen import Nitrogen
from equipoise.balancers.laws.piston import Piston
from equipoise.errors import InputError
from equipoise.units import Area, Length, Number, Pressure, Temperature, Volume

NITROGEN = Nitrogen()


@dataclass(frozen=True)
class HydroPneumatic(Piston):
    """A hydraulic cylinder on an accumulator: the oil does not give, the gas behind the bladder does.

        V = V0 - s A (l - l0),   P0 = Pc (T / T0)^h (Va / V0)^nT,   P = P0 (V0 / V)^n,   f = s (P - Pa) A

    area A in m^2 is what the oil acts on; accumulator Va in m^3 its gas volume without oil; volume V0 < Va in m^3
    the gas volume left at the length l0 in m, set by the filling of oil; precharge Pc in Pa the pressure of the gas
    without oil at the temperature T0 of charging, None where it is unknown, read as `absolute` or `gauge`. Oil is
    filled slowly, along the isotherm (nT = 1 of an ideal gas); the spring then moves with the exponent n, by default
    nitrogen's own at the working pressure. Action, ambient pressure Pa, temperatures and energy are those of Gas. The
    force is affine in Pc. Pressures stay below those the data covers, the gas volume within (0, Va] over the sweep.

    Raises InputError for what Gas refuses, a precharge that is not positive, and V0 above Va. After Quaglia & Yin
    2015, section 3.2.2 [quaglia_yin_2015].
    """

    area: Area
    accumulator: Volume
    volume: Volume
    length: Length
    precharge: Pressure | None = None
    exponent: Number | Nitrogen = NITROGEN
    action: Literal["pull", "push"] = "push"
    reading: Literal["absolute", "gauge"] = "absolute"
    ambient: Pressure = STANDARD
    charged_at: Temperature = ROOM
    temperature: Temperature = ROOM
    sources: ClassVar[tuple[str, ...]] = ("quaglia_yin_2015",)

    def __post_init__(self) -> None:
        where = "law hydro_pneumatic"
        positive(self.accumulator, "accumulator", where)
        self._charge.check(where)
        real = np.isrealobj(self.volume) and np.isrealobj(self.accumulator)
        if real and np.any(np.greater(self.volume, self.accumulator)):
            raise InputError(
                f"the gas volume {say(self.volume)} m^3 is above the accumulator's {say(self.accumulator)} m^3",
                where=where,
                hint="the oil takes what the gas leaves: give a larger accumulator or a smaller volume",
            )
        self.gas  # noqa: B018 - what no gas can have is refused at once

    @cached_property
    def gas(self) -> Gas:
        """The gas behind the bladder, its charge at l0 unknown; a real gas at the pressure of a given charge."""
        known = self._charge.absolute
        exponent = self.exponent
        if isinstance(exponent, Nitrogen) and exponent.at is None:
            if known is not None:
                # The exponent is that of the filled accumulator, whose pressure depends on it in turn.
                working = known * self.accumulator / self.volume
                for _ in range(20):
                    working = known * self._filling(replace(exponent, at=working))
                known = working
            exponent = exponent.working(known)
        return Gas(
            self.area,
            self.volume,
            self.length,
            exponent=exponent,
            action=self.action,
            ambient=self.ambient,
            charged_at=self.charged_at,
            temperature=self.temperature,
        )

    def _filling(self, exponent: Number | Nitrogen) -> Any:
        """P0 / Pc of the oil's filling, at the temperature of charging."""
        isothermal = exponent.exponents(self.temperature)[1] if isinstance(exponent, Nitrogen) else 1.0
        return (self.accumulator / self.volume) ** isothermal

    @property
    def _charge(self) -> Charge:
        return Charge("precharge", self.precharge, self.reading, self.ambient)

    @property
    def span(self) -> tuple[Any, Any]:
        """Lengths at which there are both gas and oil in the accumulator."""
        full = self.length + self.side * self.volume / self.area * (1 - LEAST)
        empty = self.length - self.side * (self.accumulator - self.volume) / self.area
        return (full, empty) if self.pushes else (empty, full)

    @property
    def span_words(self) -> str:
        """What ends the span."""
        return "accumulator's oil or gas"

    def shares(self, length: Array) -> tuple[Share, ...]:
        """The precharge, affine, and the ambient pressure, known."""
        gas = self.gas
        per_charge, air = gas.per_pascal(length)
        lift = self._filling(gas.exponent)
        lifted = {what: lift * getattr(per_charge, what) for what in ("basis", "integral", "slope")}
        return self._charge.shares(replace(per_charge, **lifted), air)

    def details(self, values: Mapping[str, float], length: Array) -> dict[str, tuple[Any, str]]:
        """Pressures, gas volume and oil over the lengths."""
        gas = self.gas
        volume = gas.gas_volume(length)
        found = gas_details(self.pressures(length, values), volume, self.ambient)
        del found["auxiliary volume"]
        found |= {
            "gas volume": (_ends(volume), "m^3"),
            "oil in the accumulator": (_ends(self.accumulator - volume), "m^3"),
        }
        if isinstance(gas.exponent, Nitrogen):
            found["exponent of nitrogen at, absolute"] = float(gas.exponent.at or 0.0), "Pa"
        return found

    def parameters(self, values: Mapping[str, float]) -> dict[str, float]:
        """All parameters; the exponent as the number that acts."""
        return super().parameters(values) | {"exponent": float(np.real(self.gas.exponents()[0]))}


def _ends(values: Array) -> tuple[float, float]:
    return float(values.min()), float(values.max())
