"""A weight that hangs on a path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws.law import Law, Share
from equipoise.errors import InputError
from equipoise.units import Acceleration, Mass

STANDARD_GRAVITY = 9.81


@dataclass(frozen=True)
class Weight(Law):
    """A weight on the path's cable, which is lifted as l grows: f = m g, V = m g l.

    The counterweight over a pulley. m in kg, None where it is unknown; gravity g in m/s^2. A path that moves it over
    a tackle or a drum counts with its own ratio. Statics: in a motion it adds the inertia m (dl/dq)^2, which the
    saved model carries as the tendon's armature. Raises InputError for a mass below zero.
    """

    m: Mass | None = None
    gravity: Acceleration = STANDARD_GRAVITY
    along: ClassVar[tuple[str, ...]] = ("m",)

    def __post_init__(self) -> None:
        if isinstance(self.m, int | float) and self.m < 0:
            raise InputError(f"the weight has a mass of {self.m:g} kg, it cannot be negative", where="law weight")

    @property
    def degree(self) -> int:
        """The force does not follow the length."""
        return 0

    def shares(self, length: Array) -> tuple[Share, ...]:
        """One share: the mass."""
        pull = self.gravity * np.ones_like(length)
        return (Share("m", "kg", self.m, pull, pull * length, 0.0 * pull, lower=0.0),)
