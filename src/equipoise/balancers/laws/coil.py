"""The coil spring with its free length, initial tension and closed length."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws.law import Law, Share
from equipoise.errors import InputError
from equipoise.units import Force, Length, Stiffness


@dataclass(frozen=True)
class Coil(Law):
    """A coil spring: f = F0 + k (l - L0), rigid below its closed length.

    k in N/m; free_length L0 in m, the length at which the force is the initial tension; initial_tension
    F0 >= 0 in N; closed_length in m, below which the coils touch (an extension spring with initial
    tension is closed at its free length unless another value is given). None marks k, L0 or F0 as unknown;
    an unknown free length enters as the product k L0, in which the force is affine.
    """

    free_length: Length | None
    k: Stiffness | None = None
    initial_tension: Force | None = 0.0
    closed_length: Length | None = None

    def __post_init__(self) -> None:
        for name in ("free_length", "initial_tension", "closed_length"):
            value = getattr(self, name)
            if isinstance(value, int | float) and value < 0:
                raise InputError(f"{name} is {value:g}, it cannot be negative", where="law coil")
        real = all(isinstance(value, int | float) for value in (self.closed_length, self.free_length))
        if real and self.closed_length > self.free_length:  # type: ignore[operator]
            raise InputError(
                f"the closed length {self.closed_length:g} m is above the free length {self.free_length:g} m",
                where="law coil",
                hint="a coil cannot be longer closed than free",
            )

    @property
    def span(self) -> tuple[Any, Any]:
        """The coils touch below the closed length."""
        return (self.free_length if self.closes_free else self.closed_length), None

    @property
    def defined_beyond(self) -> bool:
        """A coil that would have to be shorter than closed is a limit not kept, not a law without a value."""
        return True

    @property
    def span_words(self) -> str:
        """What is reached at the end of the span."""
        return "closed length"

    @property
    def closes_free(self) -> bool:  # type: ignore[override]
        """Whether the coils touch at the free length, as those of an extension spring with initial tension do."""
        return self.closed_length is None and (self.initial_tension is None or bool(np.any(self.initial_tension)))

    def shares(self, length: Array) -> tuple[Share, ...]:
        """Rate, free length where it is unknown, and initial tension."""
        one = np.ones_like(length)
        zero = 0.0 * one
        if self.free_length is not None:
            stretch = length - self.free_length
            return (
                Share("k", "N/m", self.k, stretch, stretch * stretch / 2, one, lower=0.0),
                Share("initial_tension", "N", self.initial_tension, one, stretch, zero, lower=0.0),
            )
        return (
            Share("k", "N/m", self.k, length, length * length / 2, one, lower=0.0),
            Share("k_free_length", "N", None, -one, -length, zero, lower=0.0),
            Share("initial_tension", "N", self.initial_tension, one, length, zero, lower=0.0),
        )

    def parameters(self, values: Mapping[str, float]) -> dict[str, float]:
        """All parameters; an unknown free length is read from its product."""
        found = super().parameters(values)
        if found.get("k", 0.0) > 0 and "k_free_length" in found:
            found["free_length"] = found["k_free_length"] / found["k"]
        return found
