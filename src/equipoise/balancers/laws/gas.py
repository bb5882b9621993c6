"""Gas springs: a polytrope in a cylinder, with or without an auxiliary volume."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws.law import Law, Share
from equipoise.errors import InputError
from equipoise.units import Area, Length, Number, Pressure, Temperature, Volume

STANDARD = 101325.0
ROOM = 293.15
LEAST = 1e-3
"""Share of the reference volume below which the law is carried on unchanged, so that searches stay finite."""


@dataclass(frozen=True)
class Gas(Law):
    """A gas spring or strut: gas in a cylinder, and whatever bottle is connected to it.

        V = V0 - s A (l - l0),   P = P0 (T / T0) (V0 / V)^n,   f = s (P - Pa) A,   s = +1 `pull`, -1 `push`
        E = P0 (T / T0) V0 ln(V0 / V) phi((n - 1) ln(V0 / V)) + Pa (V - V0),   phi(z) = (exp(z) - 1) / z

    area A in m^2 is what the gas acts on: the piston's, less the rod's on the rod's side, the rod's alone where
    the piston lets the gas pass; volume V0 in m^3, swept and auxiliary together, at the length l0 in m; action says
    whether the gas pulls the ends together (it is compressed by lengthening) or pushes them apart; pressure P0 in Pa
    is that at l0 and the temperature T0 of charging, None where it is unknown, read as `absolute` or `gauge`
    (above ambient Pa, Pa). T in K is the temperature at work: at constant volume the pressure follows it
    (Gay-Lussac). exponent n is 1 for slow (isothermal) and 1.4 for quick (adiabatic) motion of air or nitrogen as
    ideal gases. The force is affine in P0. E counts from l0.

    Raises InputError for an area, volume, absolute pressure or temperature that is not positive, a negative ambient
    pressure, or an exponent outside 1..2. The volume must stay positive over the sweep. After Quaglia & Yin 2015,
    Eqs. 37-38 [quaglia_yin_2015], with the ambient pressure, and the exponent for what they call adiabatic.
    """

    area: Area
    volume: Volume
    length: Length
    pressure: Pressure | None = None
    exponent: Number = 1.4
    action: Literal["pull", "push"] = "push"
    reading: Literal["absolute", "gauge"] = "absolute"
    ambient: Pressure = STANDARD
    charged_at: Temperature = ROOM
    temperature: Temperature = ROOM
    sources: ClassVar[tuple[str, ...]] = ("quaglia_yin_2015",)

    def __post_init__(self) -> None:
        check_gas(self, "law gas", ("area", "volume", "charged_at", "temperature"))
        absolute = None if self.pressure is None else self.pressure + self._offset
        if absolute is not None and np.isrealobj(absolute) and not np.all(np.greater(absolute, 0)):
            raise InputError(
                f"the pressure is {_say(self.pressure)} Pa {self.reading}, {_say(absolute)} Pa absolute: it must be "
                "positive",
                where="law gas",
                hint="state the pressure `absolute`, or above the ambient one as `gauge`",
            )

    @property
    def degree(self) -> int | None:
        """No polynomial."""
        return None

    @property
    def pushes(self) -> bool:
        """Whether it is a strut that pushes its ends apart."""
        return self.action == "push"

    @property
    def side(self) -> float:
        """s: +1 where the gas pulls, -1 where it pushes."""
        return -1.0 if self.pushes else 1.0

    @property
    def span(self) -> tuple[Any, Any]:
        """Lengths at which some gas volume is left."""
        end = self.length + self.side * self.volume / self.area * (1 - LEAST)
        return (end, None) if self.pushes else (None, end)

    @property
    def span_words(self) -> str:
        """What ends the span."""
        return "gas volume"

    @property
    def _offset(self) -> Any:
        return self.ambient if self.reading == "gauge" else 0.0

    def gas_volume(self, length: Array) -> Array:
        """V (..., N), m^3, at lengths (..., N), m."""
        return self.volume - self.side * self.area * (length - self.length)

    def shares(self, length: Array) -> tuple[Share, ...]:
        """The charge, affine, and the ambient pressure, known."""
        volume = self.gas_volume(length)
        least = LEAST * np.abs(np.real(self.volume)) + 0.0 * np.real(volume)
        volume = np.where(np.real(volume) > least, volume, least)
        push, heat = self.side * self.area, self.temperature / self.charged_at
        ratio, work = polytrope(self.volume / volume, self.exponent)
        rise = push * heat * self.exponent * ratio / volume * self.side * self.area
        force, energy = push * heat * ratio, heat * self.volume * work
        kept = 1.0 if self.reading == "gauge" else 0.0
        return (
            Share("pressure", "Pa", self.pressure, force, energy, rise, lower=-float(np.real(np.max(self._offset)))),
            Share(
                "ambient",
                "Pa",
                self.ambient,
                kept * force - push,
                kept * energy + (volume - self.volume),
                kept * rise,
            ),
        )

    def pressures(self, length: Array, values: Mapping[str, float]) -> Array:
        """Absolute pressure P (N,), Pa, at lengths (N,), m."""
        return self.side * self.force_at(length, values) / self.area + self.ambient


def polytrope(ratio: Any, exponent: Any) -> tuple[Any, Any]:
    """r^n, and the work (r^(n-1) - 1) / (n - 1) = ln r phi((n - 1) ln r) on a gas compressed by r = V0 / V.

    The work is per P0 V0 and goes to ln r, the isothermal one, as n goes to 1, without loss of digits.
    """
    log = np.log(ratio)
    z = (exponent - 1) * log
    small = np.abs(z) < 1e-2
    series = 1 + z / 2 * (1 + z / 3 * (1 + z / 4 * (1 + z / 5 * (1 + z / 6 * (1 + z / 7)))))
    safe = np.where(small, 1.0, z)
    return np.exp(exponent * log), log * np.where(small, series, (np.exp(safe) - 1) / safe)


def check_gas(law: Any, where: str, positive: tuple[str, ...]) -> None:
    """Raise InputError for what no gas can have; values of candidates are not judged."""
    for name in positive:
        value = getattr(law, name)
        if np.isrealobj(value) and not np.all(np.greater(value, 0)):
            raise InputError(f"the {name} is {_say(value)}, it must be positive", where=where)
    if np.isrealobj(law.ambient) and not np.all(np.greater_equal(law.ambient, 0)):
        raise InputError(f"the ambient pressure is {_say(law.ambient)} Pa, it cannot be negative", where=where)
    if np.isrealobj(law.exponent) and not np.all((np.greater_equal(law.exponent, 1)) & np.less_equal(law.exponent, 2)):
        raise InputError(
            f"the exponent is {_say(law.exponent)}, it must lie in 1..2",
            where=where,
            hint="1 for slow, isothermal motion, 1.4 for quick, adiabatic motion of nitrogen or air",
        )


def _say(value: Any) -> str:
    return f"{float(np.ravel(value)[0]):.6g}"
