"""The inverted slider-crank: a rod through a swivelling pivot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import bodies
from equipoise.balancers.paths.driven import Driven
from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.path import Place, Sketch
from equipoise.balancers.paths.shaft import Shaft
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.states import States
from equipoise.units import Angle, Length, Mass


@dataclass(frozen=True)
class InvertedSliderCrank(Driven):
    """A rod from a crank pin through a swivelling pivot, or a spring between the two.

        l = sqrt(a^2 + d^2 - 2 a d cos w),   w = u + phase

    input gives u, rad; a = crank, m; d = distance of the pivot from the shaft, m, along the mount's direction, from
    which w counts; phase is the crank's lead on the input, rad. l is the distance of crank pin and pivot, m.
    crank_mass sits at half the crank, rod_mass on the rod at rod_com from the crank pin towards the pivot (and
    beyond), m; kg. Raises InputError where pin and pivot meet.
    """

    input: Shaft
    crank: Length
    distance: Length
    phase: Angle = 0.0
    mount: Mount | None = None
    crank_mass: Mass = 0.0
    rod_mass: Mass = 0.0
    rod_com: Length = 0.0

    def curve(self, u: Any) -> tuple[Any, Any]:
        """The distance of pin and pivot and its derivative."""
        length = np.sqrt((self.crank - self.distance) ** 2 + 4 * self.crank * self.distance * np.sin(0.5 * u) ** 2)
        slope = self.crank * self.distance * np.sin(u)
        return length, slope / np.where(length == 0, 1.0, length)

    def ends(self) -> tuple[tuple[Place, float], ...]:
        """The crank pin and the pivot."""
        return ((self.spot(self._pin, "pin"), 0.5), (self.fixed(self.distance, 0.0), 0.5))

    def weights(self) -> tuple[tuple[Place, Any], ...]:
        """Crank and rod."""
        return (
            (self.spot(lambda u: self._on_crank(u, 0.5), "crank_middle"), self.crank_mass),
            (self.spot(self._rod, "rod_middle"), self.rod_mass),
        )

    def _on_crank(self, u: Any, share: float) -> Any:
        x, y = (share * self.crank * f(u) for f in (np.cos, np.sin))
        return (x, y), (-y, x)

    def _pin(self, u: Any) -> Any:
        return self._on_crank(u, 1.0)

    def _rod(self, u: Any) -> Any:
        (x, y), (dx, dy) = self._pin(u)
        length, slope = self.curve(u)
        share = self.rod_com / length
        pace = -share * slope / length
        tx, ty = self.distance - x, -y
        return (x + share * tx, y + share * ty), (
            dx * (1 - share) + pace * tx,
            dy * (1 - share) + pace * ty,
        )

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for lengths that are not positive besides what every driven path refuses."""
        super().check(mechanism, name)
        for what in ("crank", "distance"):
            bodies.positive_length(getattr(self, what), what, name)

    def install(self, spec: mujoco.MjSpec, name: str, states: States) -> mujoco.MjsTendon:
        """Crank, swivelling pivot and the rod that slides in it; the tendon reads the slide."""
        a, d = float(self.crank), float(self.distance)
        if a == d:
            raise InputError("crank and distance are equal: pin and pivot may meet", where=f"spring {name}")
        frame, crank = self.drive(spec, name, states, a)
        bodies.weigh(crank.add_body(name=f"{name}_crank_middle", pos=[0.5 * a, 0.0, 0.0]), float(self.crank_mass))
        pin = crank.add_body(name=f"{name}_pin", pos=[a, 0.0, 0.0])
        bodies.weigh(pin, 0.0)
        swivel = bodies.add_body(frame, f"{name}_swivel", bodies.NOTHING, pos=(d, 0.0, 0.0))
        bodies.add_joint(swivel, f"{name}_swivel")
        rod = bodies.add_body(swivel, f"{name}_rod", bodies.NOTHING)
        bodies.add_joint(rod, f"{name}_rod", axis=bodies.SLIDING, slide=True)
        bodies.weigh(
            rod.add_body(name=f"{name}_rod_middle", pos=[-float(self.rod_com), 0.0, 0.0]), float(self.rod_mass)
        )
        bodies.add_pin(spec, f"{name}_joint", (pin, (0.0, 0.0, 0.0)), (rod, (0.0, 0.0, 0.0)))
        return bodies.read_joint(spec, name, f"{name}_rod")

    def positions(self, states: States, name: str) -> dict[str, Array]:
        """Crank and swivel angles, and the rod's slide."""
        u, _ = self.crank_angle(states)
        (x, y), _ = self._pin(u)
        return {
            f"{name}_crank": u,
            f"{name}_swivel": np.arctan2(y, x - self.distance),
            f"{name}_rod": self.curve(u)[0],
        }

    def sketch(self, states: States, row: int) -> Sketch:
        """The crank, and the spring from its pin to the pivot."""
        u = float(self.crank_angle(states)[0][row])
        at = self.at(states.mechanism.model)
        pin = (float(self.crank) * np.cos(u), float(self.crank) * np.sin(u))
        places = [(0.0, 0.0), pin, (float(self.distance), 0.0)]
        shaft, end, pivot = (states.point(at.point(*place))[0][row] for place in places)
        return Sketch(
            spring=np.stack([end, pivot]), bars=(np.stack([shaft, end]),), anchors=(at.at, at.point(self.distance, 0.0))
        )
