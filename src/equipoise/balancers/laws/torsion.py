"""The torsion spring, on a path that is an angle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws.law import Law, Share
from equipoise.errors import InputError
from equipoise.units import Angle, Torque, TorsionRate


@dataclass(frozen=True)
class Torsion(Law):
    """A torsion spring: T = T0 + k (theta - rest), V = T0 (theta - rest) + k (theta - rest)^2 / 2.

    theta is the path's angle, rad; T > 0 turns towards smaller angles. k in N m/rad; rest in rad; preload T0 in N m.
    None marks k, rest or T0 as unknown: an unknown rest angle enters as the product k rest. Rest angle and preload
    say the same of an unknown, so only one of them may be None; raises InputError for both.
    """

    k: TorsionRate | None = None
    rest: Angle | None = 0.0
    preload: Torque | None = 0.0
    along: ClassVar[tuple[str, ...]] = ("rad",)

    def __post_init__(self) -> None:
        if self.rest is None and self.preload is None:
            raise InputError(
                "rest and preload are both unknown, but only their sum acts",
                where="law torsion",
                hint="give one of them, for example `rest: 0`",
            )

    def shares(self, length: Array) -> tuple[Share, ...]:
        """Rate, rest angle where it is unknown, and preload."""
        one = np.ones_like(length)
        turn = length if self.rest is None else length - self.rest
        product = (Share("k_rest", "N m", None, -one, -length, 0.0 * one),) if self.rest is None else ()
        return (
            Share("k", "N m/rad", self.k, turn, turn * turn / 2, one, lower=0.0),
            *product,
            Share("preload", "N m", self.preload, one, turn, 0.0 * one),
        )

    def parameters(self, values: Mapping[str, float]) -> dict[str, float]:
        """All parameters; an unknown rest angle is read from its product."""
        found = super().parameters(values)
        if found["k"] > 0 and "k_rest" in found:
            found["rest"] = found["k_rest"] / found["k"]
        return found
