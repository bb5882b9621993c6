"""A drum that winds a cable."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco

from equipoise.balancers.paths.inputs import check_angle
from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.rub import Rub, after
from equipoise.balancers.paths.turn import Terms, Turn
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.states import States
from equipoise.units import Length


@dataclass(frozen=True)
class Drum(Turn):
    """A round drum that winds or pays out a cable as an angle turns it; also the rack of a pinion.

        l = offset + radius u

    input gives the drum's angle u, rad; radius is the pitch radius of drum and cable, m, negative where the cable
    runs off the other side; offset in m. Raises InputError for an input that is no angle, or a radius of zero.
    """

    input: Turn
    radius: Length
    offset: Length = 0.0
    unit = "m"

    def rubs(self, states: States) -> tuple[Rub, ...]:
        """The cable on the drum, and what its input rubs."""
        return after("rope", self.deform(states)[1], self.radius, self.input.rubs(states))

    def terms(self, model: mujoco.MjModel) -> Terms:
        """The input's joints times the radius."""
        coefficients, constant = self.input.terms(model)
        return {joint: self.radius * c for joint, c in coefficients.items()}, self.radius * constant + self.offset

    def shaft(self, model: mujoco.MjModel) -> Mount:
        """The input's."""
        return self.input.shaft(model)

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for an input that is no angle, or a radius of zero."""
        check_angle(self.input, mechanism, name, "drum", Turn)
        if self.radius == 0:
            raise InputError(f"the drum of spring {name} has no radius: it winds nothing", where=f"spring {name}")
