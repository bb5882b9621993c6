"""Gear pairs and belts."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco

from equipoise.balancers.paths.inputs import check_angle
from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.rub import Rub, after
from equipoise.balancers.paths.turn import Terms, Turn
from equipoise.mechanism import Mechanism
from equipoise.states import States
from equipoise.units import Angle, Number


@dataclass(frozen=True)
class Gear(Turn):
    """A gear pair or belt between an angle and a shaft.

        l = ratio u + offset

    input gives the angle u, rad: a joint, an absolute angle or another gear. ratio is the shaft's turns per turn
    of the input: negative for an external mesh, positive for an internal mesh or an open belt. offset in rad.
    Raises InputError for an input that is no angle.
    """

    input: Turn
    ratio: Number
    offset: Angle = 0.0
    unit = "rad"

    def rubs(self, states: States) -> tuple[Rub, ...]:
        """Its own mesh, and what its input rubs."""
        return after("mesh", self.deform(states)[1], self.ratio, self.input.rubs(states))

    def terms(self, model: mujoco.MjModel) -> Terms:
        """The input's joints times the ratio."""
        coefficients, constant = self.input.terms(model)
        return {joint: self.ratio * c for joint, c in coefficients.items()}, self.ratio * constant + self.offset

    def shaft(self, model: mujoco.MjModel) -> Mount:
        """The input's."""
        return self.input.shaft(model)

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for an input that is no angle."""
        check_angle(self.input, mechanism, name, "gear", Turn)
