"""What is in a gas spring: its charge, how it is read, and what compression does to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws.law import Share
from equipoise.errors import InputError

STANDARD = 101325.0
"""Ambient pressure, Pa."""
ROOM = 293.15
"""Temperature of charging and work, K."""


@dataclass(frozen=True)
class Charge:
    """A pressure, Pa or None where unknown, with its name, how it is read, and the ambient pressure, Pa."""

    name: str
    given: Any
    reading: str
    ambient: Any

    @property
    def absolute(self) -> Any:
        """The absolute pressure, Pa, None where it is unknown."""
        return None if self.given is None else self.given + self.offset

    @property
    def offset(self) -> Any:
        """What the reading lacks to the absolute pressure, Pa."""
        return self.ambient if self.reading == "gauge" else 0.0

    def check(self, where: str) -> None:
        """Raise InputError for an ambient pressure that is negative, or an absolute one that is not positive."""
        if np.isrealobj(self.ambient) and np.any(np.less(self.ambient, 0)):
            raise InputError(f"the ambient pressure is {say(self.ambient)} Pa, it cannot be negative", where=where)
        if self.given is not None and np.isrealobj(self.absolute) and not np.all(np.greater(self.absolute, 0)):
            raise InputError(
                f"the {self.name} is {say(self.given)} Pa {self.reading}, {say(self.absolute)} Pa absolute, "
                "it must be positive",
                where=where,
                hint="state it `absolute`, or above the ambient pressure as `gauge`",
            )

    def shares(self, gas: Share, air: Share) -> tuple[Share, Share]:
        """Shares of the charge and, known, of the ambient pressure with what a gauge leaves out.

        gas and air are per Pa of absolute charge and of ambient pressure.
        """
        kept = 1.0 if self.reading == "gauge" else 0.0
        lower = -float(np.real(np.max(self.offset)))
        known = (kept * getattr(gas, what) + getattr(air, what) for what in ("basis", "integral", "slope"))
        charge = Share(self.name, "Pa", self.given, gas.basis, gas.integral, gas.slope, lower + 0.0)
        return charge, Share("ambient", "Pa", self.ambient, *known)


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


def gas_details(pressure: Array, volume: Array, ambient: float) -> dict[str, tuple[Any, str]]:
    """Absolute and gauge pressure, swept and auxiliary volume: what a maker asks for."""
    low, high = float(pressure.min()), float(pressure.max())
    return {
        "absolute pressure": ((low, high), "Pa"),
        "gauge pressure": ((low - ambient, high - ambient), "Pa"),
        "swept volume": (float(np.ptp(volume)), "m^3"),
        "auxiliary volume": (float(volume.min()), "m^3"),
    }


def positive(value: Any, name: str, where: str) -> None:
    """Raise InputError for a value that is not positive; those of candidates are not judged."""
    if np.isrealobj(value) and not np.all(np.greater(value, 0)):
        raise InputError(f"the {name} is {say(value)}, it must be positive", where=where)


def say(value: Any) -> str:
    """A number for a message."""
    return f"{float(np.ravel(value)[0]):.6g}"
