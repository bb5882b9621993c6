"""A force that is a polynomial of the length, in Legendre's basis of its interval."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws.law import FORCE, Law, Share
from equipoise.errors import InputError
from equipoise.units import Extent, Pull

MOST = 60


@dataclass(frozen=True)
class Polynomial(Law):
    """f = sum_i c_i P_i(x), x = (2 l - low - high) / (high - low), with P_i Legendre's polynomials, i = 0 .. degree.

    interval (low, high) in m or rad holds all lengths of the sweep; c_i in N or N m, coefficients None where the
    program finds them. The energy counts from low:

        V = (high - low) / 2 sum_i c_i (P_{i+1} - P_{i-1}) / (2 i + 1), with x + 1 for i = 0

    Raises InputError for an empty interval, a degree outside 0..60, or coefficients that are not degree + 1.
    """

    interval: tuple[Extent, Extent]
    degree: int = 3  # type: ignore[assignment]
    coefficients: tuple[Pull, ...] | None = None
    along: ClassVar[tuple[str, ...]] = ("m", "rad")

    def __post_init__(self) -> None:
        low, high = self.interval
        where = "law polynomial"
        if np.isrealobj(low) and np.isrealobj(high) and not np.all(np.less(low, high)):
            raise InputError(f"the interval [{low}, {high}] is empty", where=where, hint="write the lower end first")
        if not 0 <= self.degree <= MOST:
            raise InputError(f"the degree is {self.degree}, it must lie in 0..{MOST}", where=where)
        if self.coefficients is not None and len(self.coefficients) != self.degree + 1:
            raise InputError(
                f"{len(self.coefficients)} coefficients for degree {self.degree}, it takes {self.degree + 1}",
                where=where,
                hint="give them from the constant term up, on Legendre's basis of the interval",
            )

    @property
    def span(self) -> tuple[Any, Any]:
        """The interval."""
        return self.interval

    @property
    def span_words(self) -> str:
        """What the ends of the span are called."""
        return "interval"

    def shares(self, length: Array) -> tuple[Share, ...]:
        """One share per coefficient."""
        low, high = self.interval
        half = (high - low) / 2
        value, slope = legendre((length - low) / half - 1.0, self.degree + 1)
        given = self.coefficients or (None,) * (self.degree + 1)
        return tuple(
            Share(
                f"c{i}",
                FORCE,
                given[i],
                value[i],
                half * ((value[i + 1] - value[i - 1]) / (2 * i + 1) if i else value[1] + 1.0),
                slope[i] / half,
            )
            for i in range(self.degree + 1)
        )

    @property
    def remarks(self) -> tuple[str, ...]:
        """On which basis the coefficients stand."""
        return (f"degree {self.degree} on Legendre's basis of the interval",)

    def parameter_units(self, along: str = "m") -> dict[str, str]:
        """Units of the coefficients and of the interval's ends."""
        return super().parameter_units(along) | {"from": along, "to": along}

    def parameters(self, values: Mapping[str, float]) -> dict[str, float]:
        """The interval and the coefficients."""
        low, high = (float(np.real(end)) for end in self.interval)
        found = super().parameters(values)
        del found["degree"]
        return {"from": low, "to": high} | found

    def details(self, values: Mapping[str, float], length: Array) -> dict[str, tuple[Any, str]]:  # noqa: ARG002
        """The same force in powers of the length, which are for reading and not for computing."""
        middle, powers = self.monomials(values)
        return {"force in powers of (length - middle)": (tuple(float(a) for a in powers), f"SI, middle {middle:.6g}")}

    def monomials(self, values: Mapping[str, float]) -> tuple[float, Array]:
        """(middle, a) of the same force as sum_i a_i (l - middle)^i, a_i in N/m^i or N m/rad^i: for reports."""
        low, high = self.interval
        found = self.parameters(values)
        legendre_ = np.array([found[f"c{i}"] for i in range(self.degree + 1)])
        powers = np.polynomial.legendre.leg2poly(legendre_)
        return (low + high) / 2, powers / ((high - low) / 2) ** np.arange(len(powers))


def legendre(x: Array, most: int) -> tuple[list[Array], list[Array]]:
    """Legendre's polynomials P_0 .. P_most at x, and their slopes, by the three-term recurrence."""
    value, slope = [np.ones_like(x), x], [np.zeros_like(x), np.ones_like(x)]
    for i in range(1, most):
        value.append(((2 * i + 1) * x * value[i] - i * value[i - 1]) / (i + 1))
        slope.append(slope[i - 1] + (2 * i + 1) * value[i])
    return value[: most + 1], slope[: most + 1]
