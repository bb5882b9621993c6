"""The turn of a reel on which a cable winds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import bodies
from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.path import Moving, Place, Sketch
from equipoise.balancers.paths.reel import Reel
from equipoise.balancers.paths.rub import Rub, after
from equipoise.balancers.paths.shaft import Shaft
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism, cable_ends
from equipoise.states import States
from equipoise.units import Angle, Length


@dataclass(frozen=True)
class Winding(Shaft):
    """The angle by which the round reel of a platform's cable has paid it out.

        l = c / radius + offset

    cable names it; c is its length, m; radius that of the reel, m, negative where it turns the other way; offset in
    rad; l in rad. Raises InputError for a radius of zero.
    """

    cable: str
    radius: Length
    offset: Angle = 0.0
    unit = "rad"

    def turned(self, length: Any) -> Any:
        """The angle, rad, at cable lengths, m."""
        return length / self.radius + self.offset

    def deform(self, states: States) -> tuple[Array, Array]:
        """Angle l (..., N), rad, and dl/dq (..., N, nd)."""
        length, rate = Reel(self.cable).deform(states)
        return self.turned(length), rate / np.asarray(self.radius)[..., None]

    def along(self, length: Any) -> tuple[Any, Any]:
        """The angle at cable lengths and its derivative."""
        return self.turned(length), 1.0 / self.radius + 0.0 * length

    def shaft(self, model: mujoco.MjModel) -> Mount:
        """At the cable's anchor, in the plane of planar mechanisms."""
        return Mount(cable_ends(model, self.cable)[0])

    def rubs(self, states: States) -> tuple[Rub, ...]:
        """The cable on its reel."""
        return after("rope", self.deform(states)[1])

    def ends(self) -> tuple[tuple[Place, float], ...]:
        """The spring is wound about the reel, and its mass sits there."""

        def where(states: States) -> tuple[Array, Array]:
            return states.point(self.shaft(states.mechanism.model).at)

        return ((Moving(where, lambda model, _: self.shaft(model).at), 1.0),)

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for a cable that is not there, or a radius of zero."""
        Reel(self.cable).check(mechanism, name)
        if not (self.radius != 0):
            raise InputError(f"the reel of spring {name} has no radius: it winds nothing", where=f"spring {name}")

    def crank(self, spec: mujoco.MjSpec, frame: Any, name: str, states: States, phase: Any, length: float) -> Any:
        """A crank that the cable turns: its hinge is an affine function of the cable's length."""
        made = bodies.add_body(frame, name, bodies.NOTHING, length=length)
        bodies.add_joint(made, name)
        belt = bodies.read_joint(spec, f"{name}_drive", name)
        law = spec.add_equality(
            name=f"{name}_drive",
            type=mujoco.mjtEq.mjEQ_TENDON,
            objtype=mujoco.mjtObj.mjOBJ_TENDON,
            name1=belt.name,
            name2=self.cable,
        )
        # MuJoCo counts both from their lengths at the zero posture.
        model = states.mechanism.model
        zero = float(model.tendon_length0[model.tendon(self.cable).id])
        law.data[:2] = [float(self.turned(zero) + phase), 1.0 / float(self.radius)]
        return made

    def install(self, spec: mujoco.MjSpec, name: str, states: States) -> mujoco.MjsTendon:
        """Add a shaft `<name>_shaft` that the cable turns, and a tendon that reads its angle."""
        frame = bodies.add_frame(spec, self.shaft(states.mechanism.model), f"{name}_frame")
        self.crank(spec, frame, f"{name}_shaft", states, 0.0, float(self.radius))
        return bodies.read_joint(spec, name, f"{name}_shaft")

    def positions(self, states: States, name: str) -> dict[str, Array]:
        """The shaft's position."""
        return {f"{name}_shaft": self.deform(states)[0]}

    def sketch(self, states: States, row: int) -> Sketch:
        """The reel, and the cable that runs off it."""
        mount = self.shaft(states.mechanism.model)
        centre, axis = states.point(mount.at)[0][row], states.rotation(mount.at.body)[0][row] @ mount.frame[2]
        cable = Reel(self.cable).sketch(states, row).spring
        assert cable is not None
        return Sketch(lines=(cable,), discs=((centre, abs(float(self.radius)), axis),))
