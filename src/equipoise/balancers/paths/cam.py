"""A cam with a follower."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import bodies
from equipoise.balancers.paths.driven import Driven
from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.path import Need, Place, Sketch
from equipoise.balancers.paths.profile import Lift
from equipoise.balancers.paths.shaft import Shaft
from equipoise.states import States
from equipoise.units import Angle, Length, Mass, Number

OUTLINE, FITTED = 97, 400


@dataclass(frozen=True)
class Cam(Driven):
    """A cam that an angle turns, with a follower that slides along the mount's direction.

        l = offset + scale lift(u + phase)

    input gives u, rad; profile the lift by angle, m; scale stretches it, offset is in m. follower_mass rides on the
    follower, kg.
    """

    input: Shaft
    profile: Lift
    phase: Angle = 0.0
    offset: Length = 0.0
    scale: Number = 1.0
    mount: Mount | None = None
    follower_mass: Mass = 0.0

    def curve(self, u: Any) -> tuple[Any, Any]:
        """The follower's place and its derivative."""
        lift, slope = self.profile(u)
        return self.offset + self.scale * lift, self.scale * slope

    def ends(self) -> tuple[tuple[Place, float], ...]:
        """The follower, and the frame at l = 0."""
        return ((self.spot(self._follower, "follower"), 0.5), (self.fixed(0.0, 0.0), 0.5))

    def weights(self) -> tuple[tuple[Place, Any], ...]:
        """The follower."""
        return ((self.spot(self._follower, "follower"), self.follower_mass),)

    def _follower(self, u: Any) -> Any:
        length, slope = self.curve(u)
        return (length, 0.0 * length), (slope, 0.0 * slope)

    def needs(self, states: States) -> tuple[Need, ...]:
        """The cam turns within its profile."""
        room = self.profile.room(self.crank_angle(states)[0])
        return () if room.ndim == 1 or np.isinf(room).all() else (Need("profile of the cam", "rad", room, 1.0),)

    def install(self, spec: mujoco.MjSpec, name: str, states: States) -> mujoco.MjsTendon:
        """Cam and follower; the file's coupling is the quartic nearest to the profile over the states."""
        frame, _ = self.drive(spec, name, states, 0.02)
        follower = bodies.add_body(frame, f"{name}_follower", bodies.mass(self.follower_mass))
        bodies.add_joint(follower, f"{name}_follower", axis=bodies.SLIDING, slide=True)
        quartic, _ = self._quartic(states)
        spec.add_equality(
            name=f"{name}_lift",
            type=mujoco.mjtEq.mjEQ_JOINT,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            name1=f"{name}_follower",
            name2=f"{name}_crank",
        ).data[:5] = quartic.tolist()
        return bodies.read_joint(spec, name, f"{name}_follower")

    def _quartic(self, states: States) -> tuple[Array, float]:
        """Coefficients (5,) of the quartic nearest to the profile over the states, and how far off it is, m."""
        u, _ = self.crank_angle(states)
        at = np.linspace(u.min(), u.max() + 1e-9, FITTED)
        place = self.curve(at)[0]
        quartic = np.polynomial.Polynomial.fit(at, place, 4)
        coefficients = np.zeros(5)
        found = quartic.convert().coef
        coefficients[: len(found)] = found
        return coefficients, float(np.abs(quartic(at) - place).max())

    def notes(self, states: States, name: str) -> tuple[str, ...]:
        """How far the file's cam is from the profile."""
        error = self._quartic(states)[1]
        return (f"the file holds the cam of {name} as a quartic, off by up to {error * 1e3:.3g} mm; judged exactly",)

    def positions(self, states: States, name: str) -> dict[str, Array]:
        """Cam angle and follower."""
        u, _ = self.crank_angle(states)
        return {f"{name}_crank": u, f"{name}_follower": self.curve(u)[0]}

    def laws(self, states: States, name: str) -> dict[str, Array]:
        """The profile's cubic at each cam angle, in powers of the angle itself."""
        start, cubic = self.profile.pieces(self.crank_angle(states)[0])
        c3, c2, c1, c0 = (self.scale * c for c in cubic)
        whole = [
            self.offset + c0 - start * (c1 - start * (c2 - start * c3)),
            c1 - start * (2 * c2 - 3 * start * c3),
            c2 - 3 * start * c3,
            c3,
            0.0 * c0,
        ]
        return {f"{name}_lift": np.stack(whole, axis=1)}

    def sketch(self, states: States, row: int) -> Sketch:
        """The pitch curve of the in-line follower, and the spring beyond it."""
        u = float(self.crank_angle(states)[0][row])
        at = self.at(states.mechanism.model)
        turns = np.linspace(*(self.profile.turn or (u, u + 2 * np.pi)), OUTLINE)
        radius = self.curve(turns)[0]
        places = [(r * np.cos(u - t), r * np.sin(u - t)) for r, t in zip(radius, turns, strict=True)]
        length = float(self.curve(u)[0])

        def world(*where: tuple[float, float]) -> Array:
            return np.stack([states.point(at.point(*place))[0][row] for place in where])

        far = length + np.sign(length or 1.0) * 1.5 * max(float(np.abs(radius).max()), 1e-3)
        return Sketch(spring=world((length, 0.0), (far, 0.0)), lines=(world(*places),), anchors=(at.at,))
