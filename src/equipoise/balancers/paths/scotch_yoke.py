"""The Scotch yoke, or cross mechanism."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import bodies
from equipoise.balancers.paths.driven import Driven
from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.path import Place, Sketch
from equipoise.balancers.paths.rub import Kind, turning
from equipoise.balancers.paths.shaft import Shaft
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.states import States
from equipoise.units import Angle, Length, Mass


@dataclass(frozen=True)
class ScotchYoke(Driven):
    """A Scotch yoke (cross mechanism): a crank pin in the slot of a slider that moves square to it.

        l = offset + radius sin(u + phase),   dl/du = radius cos(u + phase)

    input gives u, rad; radius is the crank's, m, phase the crank's lead on the input, rad, offset in m. The crank
    points along the mount's direction e at u + phase = 0 and the yoke slides along a x e, so that an angle from the
    horizontal moves a vertical yoke, as in [quaglia_yin_2015]. crank_mass (at half the radius) and yoke_mass (on the
    slider at l) in kg. A negative radius turns the yoke's sense round.
    """

    input: Shaft
    radius: Length
    phase: Angle = 0.0
    offset: Length = 0.0
    mount: Mount | None = None
    crank_mass: Mass = 0.0
    yoke_mass: Mass = 0.0
    sources: ClassVar[tuple[str, ...]] = ("quaglia_yin_2015",)

    def curve(self, u: Any) -> tuple[Any, Any]:
        """The yoke's place and its derivative."""
        return self.offset + self.radius * np.sin(u), self.radius * np.cos(u)

    def contacts(self, u: Array) -> tuple[tuple[Kind, Array, Array], ...]:
        """Shaft and crank pin, and the block in the slot: it slides radius |sin w| under the spring's force."""
        return turning(u, ("pin", 1.0, 1.0), ("pin", 1.0, 1.0), ("slide", 1.0, self.radius * np.sin(u)))

    def ends(self) -> tuple[tuple[Place, float], ...]:
        """The yoke, and the frame at l = 0."""
        return ((self.spot(self._yoke, "yoke"), 0.5), (self.fixed(0.0, 0.0), 0.5))

    def weights(self) -> tuple[tuple[Place, Any], ...]:
        """The crank at half its radius, the yoke at l."""
        return (
            (self.spot(self._middle, "crank_middle"), self.crank_mass),
            (self.spot(self._yoke, "yoke"), self.yoke_mass),
        )

    def _middle(self, u: Any) -> Any:
        x, y = 0.5 * self.radius * np.cos(u), 0.5 * self.radius * np.sin(u)
        return (x, y), (-y, x)

    def _yoke(self, u: Any) -> Any:
        length, slope = self.curve(u)
        return (0.0 * length, length), (0.0 * slope, slope)

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for a crank without radius besides what every driven path refuses."""
        super().check(mechanism, name)
        if np.ndim(self.radius) == 0 and self.radius == 0:
            raise InputError(f"the yoke of spring {name} has a crank of radius 0", where=f"spring {name}")

    def install(self, spec: mujoco.MjSpec, name: str, states: States) -> mujoco.MjsTendon:
        """Crank, yoke and the block in its slot, pinned to the crank; the tendon reads the yoke's slide."""
        radius, offset = float(self.radius), float(self.offset)
        frame, crank = self.drive(spec, name, states, abs(radius))
        middle = crank.add_body(name=f"{name}_crank_middle", pos=[0.5 * radius, 0.0, 0.0])
        bodies.weigh(middle, float(self.crank_mass))
        yoke = bodies.add_body(frame, f"{name}_yoke", bodies.mass(self.yoke_mass))
        bodies.add_joint(yoke, f"{name}_yoke", axis=(0.0, 0.0, 1.0), slide=True)
        block = bodies.add_body(yoke, f"{name}_block", bodies.NOTHING, pos=(0.0, 0.0, -offset))
        bodies.add_joint(block, f"{name}_block", axis=bodies.SLIDING, slide=True)
        bodies.add_pin(spec, f"{name}_pin", (crank, (radius, 0.0, 0.0)), (block, (0.0, 0.0, 0.0)))
        return bodies.read_joint(spec, name, f"{name}_yoke")

    def positions(self, states: States, name: str) -> dict[str, Array]:
        """Crank angle, yoke and block."""
        u, _ = self.crank_angle(states)
        return {
            f"{name}_crank": u,
            f"{name}_yoke": self.curve(u)[0],
            f"{name}_block": self.radius * np.cos(u),
        }

    def sketch(self, states: States, row: int) -> Sketch:
        """Crank, slot and the spring along the yoke's slide."""
        u = float(self.crank_angle(states)[0][row])
        r, length = float(self.radius), float(self.curve(u)[0])
        at = self.at(states.mechanism.model)

        def world(*places: tuple[float, float]) -> Array:
            return np.stack([states.point(at.point(*place))[0][row] for place in places])

        x, y = r * np.cos(u), r * np.sin(u)
        tail = y + 2.5 * abs(r) if length == y else 0.0
        return Sketch(
            spring=world((0.0, tail), (0.0, length)),
            bars=(world((0.0, 0.0), (x, y)), world((-1.2 * r, y), (1.2 * r, y))),
            anchors=(at.at,),
        )
