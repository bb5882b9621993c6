"""Nitrogen as a real gas: exponents by pressure and temperature, from data."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from importlib import resources
from typing import Any, ClassVar

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.units import Number, Pressure

COLUMNS = ("isothermal", "isentropic", "heating")


@dataclass(frozen=True)
class Nitrogen:
    """The exponent of nitrogen at its working pressure, which above some 50 bar is far from an ideal gas's.

        n = n_T + adiabatic (n_s - n_T),   n_T = -(V / P) (dP/dV)_T,   n_s = -(V / P) (dP/dV)_S

    adiabatic is 0 for slow (isothermal) motion and 1 for quick (isentropic) motion; at is the working pressure, Pa
    absolute, None for that of the charge, which must then be given. n_T, n_s and the heating exponent
    (T / P) (dP/dT)_V are interpolated linearly between rows of data for 0 to 400 bar and -20 to 60 deg C; raises
    InputError outside. The exponent is taken as constant over the stroke: at 170 bar and a pressure that swings by
    +-12 % the force is right to 0.15 % [coolprop, span_2000].
    """

    adiabatic: Number = 1.0
    at: Pressure | None = None
    sources: ClassVar[tuple[str, ...]] = ("span_2000", "coolprop")

    def __post_init__(self) -> None:
        if np.isrealobj(self.adiabatic) and np.any(np.abs(np.asarray(self.adiabatic) - 0.5) > 0.5):
            raise InputError(
                f"adiabatic is {float(np.ravel(self.adiabatic)[0]):g}, it must lie in 0..1",
                where="nitrogen",
                hint="0 for slow, isothermal motion, 1 for quick, isentropic motion",
            )

    def working(self, pressure: Any) -> Nitrogen:
        """The same gas at a pressure, Pa absolute, where none was said."""
        if self.at is None and pressure is None:
            raise InputError(
                "the exponent of nitrogen follows its pressure, so one of them must be known",
                where="nitrogen",
                hint="say the working pressure, {nitrogen: {at: 170 bar}}, or the pressure of the charge",
            )
        return self if self.at is not None else replace(self, at=pressure)

    def exponents(self, temperature: Any) -> tuple[Any, Any]:
        """n and the isothermal n_T at the working pressure and a temperature, K."""
        isothermal, isentropic = (_interpolate(name, self.at, temperature) for name in ("isothermal", "isentropic"))
        return isothermal + self.adiabatic * (isentropic - isothermal), isothermal

    def heating(self, temperature: Any) -> Any:
        """(T / P) (dP/dT)_V at the working pressure and a temperature, K."""
        return _interpolate("heating", self.at, temperature)


@functools.cache
def table() -> tuple[Array, Array, dict[str, Array]]:
    """Pressures (P,), Pa, temperatures (T,), K, and the columns (T, P) of the data."""
    text = resources.files("equipoise").joinpath("data/nitrogen.csv").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    names = lines[0].split(",")
    rows = np.array([[float(value) for value in line.split(",")] for line in lines[1:]])
    pressures, temperatures = np.unique(rows[:, 0]), np.unique(rows[:, 1])
    shape = len(temperatures), len(pressures)
    return pressures, temperatures, {name: rows[:, names.index(name)].reshape(shape) for name in COLUMNS}


def _interpolate(column: str, pressure: Any, temperature: Any) -> Any:
    pressures, temperatures, columns = table()
    cell, share = _place(pressures, pressure, "pressure", "Pa")
    row, part = _place(temperatures, temperature, "temperature", "K")
    values = columns[column]
    low = values[row, cell] * (1 - share) + values[row, cell + 1] * share
    high = values[row + 1, cell] * (1 - share) + values[row + 1, cell + 1] * share
    return low * (1 - part) + high * part


def _place(knots: Array, value: Any, what: str, unit: str) -> tuple[Any, Any]:
    """The interval of knots that holds a value, and the share of the way through it."""
    real = np.real(value)
    if np.any(real < knots[0]) or np.any(real > knots[-1]):
        worst = float(np.ravel(real)[np.argmax(np.abs(np.ravel(real) - knots.mean()))])
        raise InputError(
            f"the {what} {worst:.6g} {unit} is outside the data on nitrogen, {knots[0]:g} to {knots[-1]:g} {unit}",
            where="nitrogen",
            hint="give the exponent as a number",
        )
    index = np.clip(np.searchsorted(knots, real, side="right") - 1, 0, len(knots) - 2)
    return index, (value - knots[index]) / (knots[index + 1] - knots[index])
