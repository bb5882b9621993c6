"""What a counterweight is made of: which inertia goes with its mass."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.units import Density, Length

Axis = Literal["x", "y", "z"]
AXES: tuple[Axis, ...] = ("x", "y", "z")


@dataclass(frozen=True)
class PointMass:
    """All mass at one point: inertia m |r|^2 alone."""

    def own(self) -> Array:
        """Second moments (3, 3) of one kilogram about its own centre, m^2."""
        return np.zeros((3, 3))


@dataclass(frozen=True)
class Disc:
    """A round disc: m radius^2 / 2 about its axis, m (radius^2 / 4 + thickness^2 / 12) across it.

    axis is a coordinate axis of the body that carries it; density (kg/m^3) tells the thickness that a mass needs,
    m / (density pi radius^2), which is reported and must be known as `thickness` (m) where inertia across counts.
    """

    radius: Length
    thickness: Length = 0.0
    density: Density | None = None
    axis: Axis = "y"

    def __post_init__(self) -> None:
        for what, value in (("radius", self.radius), ("density", self.density)):
            if value is not None and not value > 0:
                raise InputError(f"the {what} is {value:g}, it must be positive", where="disc")
        if self.thickness < 0:
            raise InputError(f"the thickness is {self.thickness:g} m, it must not be negative", where="disc")

    def own(self) -> Array:
        """Second moments (3, 3) of one kilogram about its own centre, m^2."""
        along = AXES.index(self.axis)
        moments = np.full(3, self.radius**2 / 4)
        moments[along] = self.thickness**2 / 12
        return np.diag(moments)

    def thickness_of(self, mass: float) -> float | None:
        """What thickness (m) a mass needs; None without a density."""
        return None if self.density is None else mass / (self.density * np.pi * self.radius**2)


@dataclass(frozen=True)
class Plate:
    """Any distribution in the plane of motion: m J >= |m r|^2 and J <= m reach^2 about the point `at`.

    J is the polar second moment about the axis (a coordinate axis of the body) through `at`; exact for bodies
    that move in a plane, and convex, so the best realisable counterweight is found globally.
    """

    axis: Axis = "y"


@dataclass(frozen=True)
class Solid:
    """Any distribution within a ball: [[S, m r], [m r', m]] positive semidefinite, tr S <= m reach^2.

    S (3, 3) are the second moments about the point `at`; convex, so the best realisable body is found globally.
    """


Shape = PointMass | Disc | Plate | Solid
