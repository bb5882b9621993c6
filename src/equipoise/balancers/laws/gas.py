"""Gas springs: a polytrope in a cylinder, with or without an auxiliary volume."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws.charge import ROOM, STANDARD, Charge, gas_details, polytrope, positive, say
from equipoise.balancers.laws.law import Share
from equipoise.balancers.laws.nitrogen import Nitrogen
from equipoise.balancers.laws.piston import Piston
from equipoise.errors import InputError
from equipoise.units import Area, Length, Number, Pressure, Temperature, Volume

LEAST = 1e-2
"""Share of the reference volume below which the pressure stays as it is, so that searches stay finite."""


@dataclass(frozen=True)
class Gas(Piston):
    """A gas spring or strut: gas in a cylinder, and whatever bottle is connected to it.

        V = V0 - s A (l - l0),   P = P0 (T / T0)^h (V0 / V)^n,   f = s (P - Pa) A,   s = +1 `pull`, -1 `push`
        E = P0 (T / T0)^h V0 ln(V0 / V) phi((n - 1) ln(V0 / V)) + Pa (V - V0),   phi(z) = (exp(z) - 1) / z

    area A in m^2 is what the gas acts on: the piston's, less the rod's on the rod's side, the rod's alone where
    the piston lets the gas pass; volume V0 in m^3, swept and auxiliary together, at the length l0 in m; action says
    whether the gas pulls the ends together (it is compressed by lengthening) or pushes them apart; pressure P0 in Pa
    is that at l0 and the temperature T0 of charging, None where it is unknown, read as `absolute` or `gauge`
    (above ambient Pa, Pa). T in K is the temperature at work: at constant volume the pressure follows it
    (Gay-Lussac, h = 1). exponent n is 1 for slow (isothermal) and 1.4 for quick (adiabatic) motion of air or nitrogen
    as ideal gases, or Nitrogen as a real gas, which brings its own h. The force is affine in P0. E counts from l0.

    Raises InputError for an area, volume, absolute pressure or temperature that is not positive, a negative ambient
    pressure, or an exponent outside 1..2. The volume must stay positive over the sweep. After Quaglia & Yin 2015,
    Eqs. 37-38 [quaglia_yin_2015], with the ambient pressure, and the exponent for what they call adiabatic.
    """

    area: Area
    volume: Volume
    length: Length
    pressure: Pressure | None = None
    exponent: Number | Nitrogen = 1.4
    action: Literal["pull", "push"] = "push"
    reading: Literal["absolute", "gauge"] = "absolute"
    ambient: Pressure = STANDARD
    charged_at: Temperature = ROOM
    temperature: Temperature = ROOM
    sources: ClassVar[tuple[str, ...]] = ("quaglia_yin_2015",)

    def __post_init__(self) -> None:
        for name in ("area", "volume", "charged_at", "temperature"):
            positive(getattr(self, name), name, "law gas")
        self._charge.check("law gas")
        n, low, high = self.exponent, 1, 2
        if not isinstance(n, Nitrogen) and np.isrealobj(n) and np.any(np.less(n, low) | np.greater(n, high)):
            raise InputError(
                f"the exponent is {say(n)}, it must lie in {low}..{high}",
                where="law gas",
                hint="1 for slow, isothermal motion, 1.4 for quick, adiabatic motion of nitrogen or air",
            )
        self.exponents()

    @property
    def _charge(self) -> Charge:
        return Charge("pressure", self.pressure, self.reading, self.ambient)

    @property
    def span(self) -> tuple[Any, Any]:
        """Lengths at which some gas volume is left."""
        end = self.length + self.side * self.volume / self.area * (1 - LEAST)
        return (end, None) if self.pushes else (None, end)

    @property
    def span_words(self) -> str:
        """What ends the span."""
        return "gas volume"

    def exponents(self) -> tuple[Any, Any]:
        """n and the isothermal n_T."""
        if not isinstance(self.exponent, Nitrogen):
            return self.exponent, 1.0
        return self.exponent.working(self._charge.absolute).exponents(self.temperature)

    def warmth(self) -> Any:
        """(T / T0)^h: what the temperature makes of the charge; a real gas's h is that at the mean of both."""
        if not isinstance(self.exponent, Nitrogen):
            return self.temperature / self.charged_at
        gas = self.exponent.working(self._charge.absolute)
        return (self.temperature / self.charged_at) ** gas.heating((self.temperature + self.charged_at) / 2)

    def gas_volume(self, length: Array) -> Array:
        """V (..., N), m^3, at lengths (..., N), m."""
        return self.volume - self.side * self.area * (length - self.length)

    def shares(self, length: Array) -> tuple[Share, ...]:
        """The charge, affine, and the ambient pressure, known."""
        return self._charge.shares(*self.per_pascal(length))

    def per_pascal(self, length: Array) -> tuple[Share, Share]:
        """Force, energy and rate per Pa of absolute P0 and per Pa of ambient pressure."""
        real = self.gas_volume(length)
        least = LEAST * np.abs(np.real(self.volume)) + 0.0 * np.real(real)
        inside = np.real(real) > least
        volume = np.where(inside, real, least)
        push = self.side * self.area
        (n, _), heat = self.exponents(), self.warmth()
        ratio, work = polytrope(self.volume / volume, n)
        energy = heat * (self.volume * work + ratio * (volume - real))
        slope = np.where(inside, push**2 * heat * n * ratio / volume, 0.0)
        gas = Share("gas", "Pa", None, push * heat * ratio, energy, slope)
        one = np.ones_like(real)
        return gas, Share("air", "Pa", None, -push * one, real - self.volume, 0.0 * one)

    def details(self, values: Mapping[str, float], length: Array) -> dict[str, tuple[Any, str]]:
        """Pressures and volumes over the lengths, and where a real gas's exponent was read."""
        found = gas_details(self.pressures(length, values), self.gas_volume(length), self.ambient)
        if isinstance(self.exponent, Nitrogen):
            gas = self.exponent.working(self._charge.absolute)
            found["exponent of nitrogen at, absolute"] = float(gas.at or 0.0), "Pa"
        return found

    def parameters(self, values: Mapping[str, float]) -> dict[str, float]:
        """All parameters; the exponent as the number that acts."""
        return super().parameters(values) | {"exponent": float(np.real(self.exponents()[0]))}
