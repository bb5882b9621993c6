"""The angle of a pinion on a rack, or of a drum that a slide's cable turns."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco

from equipoise.balancers.paths.angle import Angle as Position
from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.rub import Rub, after
from equipoise.balancers.paths.turn import Terms, Turn
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.states import States
from equipoise.units import Angle, Length


@dataclass(frozen=True)
class Pinion(Turn):
    """The angle of a pinion that a slide turns through a rack, or of a drum through its cable.

        l = u / radius + offset

    input gives the slide's position u, m (an angle path with `unit: m`); radius is the pitch radius, m, negative
    where it turns the other way; offset in rad; l in rad. Raises InputError for an input that is no slide, or a radius
    of zero.
    """

    input: Turn
    radius: Length
    offset: Angle = 0.0
    unit = "rad"

    def rubs(self, states: States) -> tuple[Rub, ...]:
        """Its own mesh, and what its input rubs."""
        return after("mesh", self.deform(states)[1], 1.0 / self.radius, self.input.rubs(states))

    def terms(self, model: mujoco.MjModel) -> Terms:
        """The slide over the radius."""
        coefficients, constant = self.input.terms(model)
        turned = {joint: c / self.radius for joint, c in coefficients.items()}
        return turned, constant / self.radius + self.offset

    def shaft(self, model: mujoco.MjModel) -> Mount:
        """The input's."""
        return self.input.shaft(model)

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for an input that is no slide, or a radius of zero."""
        if not isinstance(self.input, Position) or self.input.unit != "m":
            raise InputError(
                f"the pinion of spring {name} is driven by something that is no slide's position",
                where=f"spring {name}",
                hint="write input: {angle: {joint: NAME, unit: m}}",
            )
        self.input.check(mechanism, name)
        if isinstance(self.radius, int | float) and self.radius == 0:
            raise InputError(f"the pinion of spring {name} has no radius", where=f"spring {name}")
