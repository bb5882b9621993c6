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
from equipoise.balancers.paths.path import Need, Place, Sketch
from equipoise.balancers.paths.rub import Kind, turning
from equipoise.balancers.paths.shaft import Shaft
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.states import States
from equipoise.units import Angle, Length, Mass


@dataclass(frozen=True)
class InvertedSliderCrank(Driven):
    """A rod from a crank pin through a swivelling pivot, or a spring between the two.

        t = sqrt(a^2 + d^2 - 2 a d cos w),   w = u + phase
        l = t,   or   l = rod - t   with a spring behind the pivot

    input gives u, rad; a = crank, m; d = distance of the pivot from the shaft, m, along the mount's direction, from
    which w counts; phase is the crank's lead on the input, rad; t is the distance of crank pin and pivot, m. Without
    a rod the spring stretches between the two. With one, of length `rod`, m, from the pin through the pivot to its
    seat, the spring is held between pivot and seat: an ordinary compression spring of free length `rod` presses with
    k t, like one of zero free length between pin and pivot. crank_mass sits at half the crank, rod_mass on the rod at
    rod_com from the crank pin towards the pivot (and beyond), m; kg. Raises InputError where pin and pivot meet, and
    where the seat would pass through the pivot.
    """

    input: Shaft
    crank: Length
    distance: Length
    phase: Angle = 0.0
    mount: Mount | None = None
    crank_mass: Mass = 0.0
    rod_mass: Mass = 0.0
    rod_com: Length = 0.0
    rod: Length | None = None
    remedy = "make the rod longer, the crank or the distance shorter, or sweep less"

    def curve(self, u: Any) -> tuple[Any, Any]:
        """The spring's length and its derivative."""
        apart, slope = self._apart(u)
        return (apart, slope) if self.rod is None else (self.rod - apart, -slope)

    def room(self, u: Any) -> Any:
        """How far the rod's seat stays behind the pivot, m."""
        return super().room(u) if self.rod is None else self.rod - self._apart(u)[0]

    @property
    def lengths(self) -> str:
        """The lengths in words."""
        sizes = {"crank": self.crank, "distance": self.distance, "rod": self.rod}
        return ", ".join(f"{name} {size * 1e3:.5g} mm" for name, size in sizes.items() if size is not None)

    def needs(self, states: States) -> tuple[Need, ...]:
        """The rod's seat stays behind the pivot."""
        room = self.room(self.crank_angle(states)[0])
        if self.rod is None or room.ndim == 1:
            return ()
        return (Need("seat of the rod", "m", room, float(np.real(np.ravel(self.rod)[0]))),)

    def _apart(self, u: Any) -> tuple[Any, Any]:
        """The distance of pin and pivot and its derivative."""
        length = np.sqrt((self.crank - self.distance) ** 2 + 4 * self.crank * self.distance * np.sin(0.5 * u) ** 2)
        slope = self.crank * self.distance * np.sin(u)
        return length, slope / np.where(length == 0, 1.0, length)

    def contacts(self, u: Array) -> tuple[tuple[Kind, Array, Array], ...]:
        """Shaft, crank pin and swivel under the spring's force, which runs along the rod."""
        a, (apart, _) = self.crank, self._apart(u)
        swing = a * (a - self.distance * np.cos(u)) / apart**2
        return turning(u, ("pin", 1.0, 1.0), ("pin", 1.0, 1.0 - swing), ("pin", 1.0, swing))

    def ends(self) -> tuple[tuple[Place, float], ...]:
        """The crank pin, or the rod's seat, and the pivot."""
        moving = self.spot(self._pin, "pin") if self.rod is None else self.spot(self._seat, "seat")
        return ((moving, 0.5), (self.fixed(self.distance, 0.0), 0.5))

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
        return self._on_rod(u, self.rod_com)

    def _seat(self, u: Any) -> Any:
        return self._on_rod(u, self.rod)

    def _on_rod(self, u: Any, along: Any) -> Any:
        (x, y), (dx, dy) = self._pin(u)
        length, slope = self._apart(u)
        share = along / length
        pace = -share * slope / length
        tx, ty = self.distance - x, -y
        return (x + share * tx, y + share * ty), (
            dx * (1 - share) + pace * tx,
            dy * (1 - share) + pace * ty,
        )

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for lengths that are not positive besides what every driven path refuses."""
        super().check(mechanism, name)
        for what in ("crank", "distance", *(("rod",) if self.rod is not None else ())):
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
        # The rod's own slide is the spring's length: from the pivot to the pin, or, along a rod, to its seat.
        back = 0.0 if self.rod is None else float(self.rod)
        rod = bodies.add_body(swivel, f"{name}_rod", bodies.NOTHING, pos=(back, 0.0, 0.0))
        bodies.add_joint(rod, f"{name}_rod", axis=(-1.0 if back else 1.0, 0.0, 0.0), slide=True)
        bodies.weigh(rod.add_body(name=f"{name}_seat", pos=[-back, 0.0, 0.0]), 0.0)
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
        """The crank, and the spring from its pin to the pivot, or from the pivot to the rod's seat."""
        u = float(self.crank_angle(states)[0][row])
        at = self.at(states.mechanism.model)
        pin = (float(self.crank) * np.cos(u), float(self.crank) * np.sin(u))
        places = [(0.0, 0.0), pin, (float(self.distance), 0.0), pin if self.rod is None else self._seat(u)[0]]
        shaft, end, pivot, seat = (states.point(at.point(*place))[0][row] for place in places)
        rod = () if self.rod is None else (np.stack([end, seat]),)
        anchors = (at.at, at.point(self.distance, 0.0))
        return Sketch(spring=np.stack([seat, pivot]), bars=(np.stack([shaft, end]), *rod), anchors=anchors)
