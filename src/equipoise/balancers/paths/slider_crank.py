"""The slider-crank dyad."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import bodies
from equipoise.balancers.paths.driven import Driven
from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.path import Need, Place, Sketch
from equipoise.balancers.paths.rub import Kind, turning
from equipoise.balancers.paths.shaft import Shaft
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.states import States
from equipoise.units import Angle, Length, Mass, Number

CLOSE = 1e-3
"""How near to the end of its reach, in rods, a rod that `shape` chooses may come."""


@dataclass(frozen=True)
class SliderCrank(Driven):
    """A slider-crank dyad: a crank, a rod and a slider that carries the spring's end.

        l = a cos w +- sqrt(b^2 - (a sin w - e)^2),   w = u + phase

    input gives u, rad; a = crank and b = rod, m; e = offset is the eccentricity of the slider's line, m, to the side
    of a x e (left of the direction in the plane); phase is the crank's lead on the input, rad: the beta of
    [zhang_arakelian_2023] is -phase. sense `forward` takes the plus sign. The slider moves along the mount's
    direction, in which w counts from zero. crank_mass and rod_mass sit at the fractions crank_com and rod_com of
    their lengths, from shaft and crank pin; slider_mass on the slider; kg. Raises InputError naming the angle and
    the lengths where the rod does not reach the slider's line. crank and rod may be None where `shape` or a `start`
    finds them.
    """

    input: Shaft
    crank: Length | None
    rod: Length | None
    offset: Length = 0.0
    phase: Angle = 0.0
    sense: Literal["forward", "backward"] = "forward"
    mount: Mount | None = None
    crank_mass: Mass = 0.0
    rod_mass: Mass = 0.0
    slider_mass: Mass = 0.0
    crank_com: Number = 0.5
    rod_com: Number = 0.5
    sources: ClassVar[tuple[str, ...]] = ("zhang_arakelian_2023",)

    @property
    def _sides(self) -> tuple[Any, Any]:
        """Crank and rod."""
        for what in ("crank", "rod"):
            if getattr(self, what) is None:
                bodies.positive_length(None, what, "slider_crank")
        return self.crank, self.rod

    def room(self, u: Any) -> Any:
        """The rod's length less what it has to span across the slider's line, m."""
        a, b = self._sides
        across = a * np.sin(u) - self.offset
        return b - across * np.where(np.real(across) < 0, -1.0, 1.0)

    def curve(self, u: Any) -> tuple[Any, Any]:
        """The slider's place and its derivative."""
        (a, _), (across, along) = self._sides, self._span(u)
        sine, cosine = a * np.sin(u), a * np.cos(u)
        return cosine + along, -sine - across / along * cosine

    def _span(self, u: Any) -> tuple[Any, Any]:
        """The rod's two sides: across the slider's line, and along it with its sign."""
        a, b = self._sides
        across = a * np.sin(u) - self.offset
        square = b * b - across * across
        # Candidates that do not close get a rod that nearly stands across, and a limit that says so.
        floor = CLOSE**2 * np.real(b) ** 2
        along = np.sqrt(square if square.ndim == 1 else np.where(np.real(square) > floor, square, floor))
        return across, along if self.sense == "forward" else -along

    def contacts(self, u: Array) -> tuple[tuple[Kind, Array, Array], ...]:
        """Shaft, both pins of the rod, which carries f / cos theta, and the slider that it presses aside."""
        (a, b), (across, along) = self._sides, self._span(u)
        _, slope = self.curve(u)
        rod, swing = b / along, -a * np.cos(u) / along
        return turning(
            u, ("pin", rod, 1.0), ("pin", rod, 1.0 - swing), ("pin", rod, swing), ("slide", across / along, slope)
        )

    def ends(self) -> tuple[tuple[Place, float], ...]:
        """The slider, and the frame on its line."""
        return ((self.spot(self._slider, "slider"), 0.5), (self.fixed(0.0, self.offset), 0.5))

    def weights(self) -> tuple[tuple[Place, Any], ...]:
        """Crank, rod and slider."""
        return (
            (self.spot(self._crank, "crank_middle"), self.crank_mass),
            (self.spot(self._rod, "rod_middle"), self.rod_mass),
            (self.spot(self._slider, "slider"), self.slider_mass),
        )

    def _crank(self, u: Any) -> Any:
        x, y = (self.crank_com * self._sides[0] * f(u) for f in (np.cos, np.sin))
        return (x, y), (-y, x)

    def _slider(self, u: Any) -> Any:
        length, slope = self.curve(u)
        return (length, self.offset + 0.0 * length), (slope, 0.0 * slope)

    def _rod(self, u: Any) -> Any:
        (x, y), (dx, dy) = self._slider(u)
        px, py = self._sides[0] * np.cos(u), self._sides[0] * np.sin(u)
        f = self.rod_com
        return (px + f * (x - px), py + f * (y - py)), (-py + f * (dx + py), px + f * (dy - px))

    @property
    def lengths(self) -> str:
        """The lengths in words."""
        a, b = self._sides
        return f"crank {a * 1e3:.5g} mm, rod {b * 1e3:.5g} mm, offset {self.offset * 1e3:.5g} mm"

    remedy = "make the rod longer or the crank shorter, bring the slider's line closer, or sweep less"

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for lengths that are not positive besides what every driven path refuses."""
        super().check(mechanism, name)
        for what in ("crank", "rod"):
            bodies.positive_length(getattr(self, what), what, name)
        for what in ("crank_com", "rod_com"):
            if not np.all(np.isfinite(getattr(self, what))):
                raise InputError(f"{what} of spring {name} is not finite", where=f"spring {name}")

    def needs(self, states: States) -> tuple[Need, ...]:
        """The rod reaches the slider's line."""
        room, (_, b) = self.room(self.crank_angle(states)[0]), self._sides
        if room.ndim == 1:
            return ()
        return (Need("reach of the rod", "m", room - CLOSE * b, float(np.real(np.ravel(b)[0]))),)

    def install(self, spec: mujoco.MjSpec, name: str, states: States) -> mujoco.MjsTendon:
        """Crank, rod and slider, pinned together; the tendon reads the slider's slide."""
        a, b, e = (float(size) for size in (*self._sides, self.offset))
        frame, crank = self.drive(spec, name, states, a)
        middle = crank.add_body(name=f"{name}_crank_middle", pos=[float(self.crank_com) * a, 0.0, 0.0])
        bodies.weigh(middle, float(self.crank_mass))
        rod = bodies.add_body(crank, f"{name}_rod", bodies.NOTHING, pos=(a, 0.0, 0.0), length=b)
        bodies.add_joint(rod, f"{name}_rod")
        bodies.weigh(
            rod.add_body(name=f"{name}_rod_middle", pos=[float(self.rod_com) * b, 0.0, 0.0]), float(self.rod_mass)
        )
        slider = bodies.add_body(frame, f"{name}_slider", bodies.mass(self.slider_mass), pos=(0.0, 0.0, e))
        bodies.add_joint(slider, f"{name}_slider", axis=bodies.SLIDING, slide=True)
        bodies.add_pin(spec, f"{name}_pin", (rod, (b, 0.0, 0.0)), (slider, (0.0, 0.0, 0.0)))
        return bodies.read_joint(spec, name, f"{name}_slider")

    def positions(self, states: States, name: str) -> dict[str, Array]:
        """Crank and rod angles and the slider's place."""
        u, _ = self.crank_angle(states)
        across, along = self._span(u)
        return {
            f"{name}_crank": u,
            f"{name}_rod": np.arctan2(-across, along) - u,
            f"{name}_slider": self.curve(u)[0],
        }

    def sketch(self, states: States, row: int) -> Sketch:
        """Crank and rod, the slider's line, and the spring along it."""
        u = float(self.crank_angle(states)[0][row])
        at, (a, b, e) = self.at(states.mechanism.model), (float(size) for size in (*self._sides, self.offset))
        length = float(self.curve(u)[0])

        def world(*places: tuple[float, float]) -> Array:
            return np.stack([states.point(at.point(*place))[0][row] for place in places])

        pin = (a * np.cos(u), a * np.sin(u))
        return Sketch(
            spring=world((length, e), (length + np.sign(length) * 0.6 * b, e)),
            bars=(world((0.0, 0.0), pin, (length, e)),),
            anchors=(at.at,),
        )
