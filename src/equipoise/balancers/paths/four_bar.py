"""The four-bar linkage between a shaft and the angle of its rocker."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import bodies
from equipoise.balancers.paths.driven import Driven
from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.path import Need, Place, Sketch
from equipoise.balancers.paths.rub import Kind, turning
from equipoise.balancers.paths.shaft import Shaft
from equipoise.mechanism import Mechanism
from equipoise.states import States
from equipoise.units import Angle, Length, Mass

LINKS = ("ground", "crank", "coupler", "rocker")


@dataclass(frozen=True)
class FourBar(Driven):
    """A four-bar linkage that an angle drives; the spring, a torsion spring for one, sits on the rocker.

        C = D + c (cos l, sin l),   D = (g, 0),   B = a (cos w, sin w),   |C - B| = b,   w = u + phase

    input gives u, rad; g = ground, a = crank, b = coupler, c = rocker, m; phase is the crank's lead on the input,
    rad. l is the rocker's angle, rad, which counts on through whole turns; both angles count from the mount's
    direction, in which D lies. branch `open` has C to the left of the way from B to D, `crossed` to the right.
    coupler_mass and rocker_mass sit at mid-length, kg. Raises InputError naming the angle at which the lengths do
    not close.
    """

    input: Shaft
    ground: Length
    crank: Length
    coupler: Length
    rocker: Length
    phase: Angle = 0.0
    branch: Literal["open", "crossed"] = "open"
    mount: Mount | None = None
    coupler_mass: Mass = 0.0
    rocker_mass: Mass = 0.0
    unit = "rad"

    def _gap(self, u: Any) -> Any:
        """The distance d of B and D, m."""
        g, a = self.ground, self.crank
        return np.sqrt((g - a) ** 2 + 4 * g * a * np.sin(u / 2) ** 2)

    def _excesses(self, u: Any) -> tuple[Any, Any, Any]:
        """b + c - d, d + b - c and d + c - b, m: what the triangle B, C, D needs to be positive."""
        d, b, c = self._gap(u), self.coupler, self.rocker
        return b + c - d, d + b - c, d + c - b

    def room(self, u: Any) -> Any:
        """How far the linkage is from standing stretched or folded, m; negative where it does not close."""
        least, *others = self._excesses(u)
        for other in others:
            least = np.where(np.real(other) < np.real(least), other, least)
        return least

    def _half_tangents(self, u: Any) -> tuple[Any, Any]:
        """tan(gamma / 2) at D and tan(mu / 2) at C of the triangle B, C, D."""
        tiny = 1e-6 * np.real(self.rocker)
        # Candidates that do not close get a sliver of a triangle, and a limit that says so.
        p, q, r = (np.where(np.real(side) > tiny, side, tiny + 0.0 * side) for side in self._excesses(u))
        around = p + q + r
        return np.sqrt(p * q / (r * around)), np.sqrt(q * r / (p * around))

    def transmission(self, u: Any) -> Any:
        """The angle mu between coupler and rocker at crank angles u, rad: 0 folded, pi stretched."""
        return 2 * np.arctan(self._half_tangents(u)[1])

    def _towards_crank(self, u: Any) -> Any:
        """The angle of the way from D to B, rad, which counts on where B circles round D."""
        g, a = self.ground, self.crank
        round_it = np.real(a) > np.real(g)
        share = np.where(round_it, g / a, a / g)
        # |share| < 1, so that 1 - share exp(+-i u) stays right of the origin and its argument is continuous.
        turn = np.arctan(share * np.sin(u) / (1 - share * np.cos(u)))
        return np.where(round_it, u + turn, np.pi - turn)

    def curve(self, u: Any) -> tuple[Any, Any]:
        """The rocker's angle and its derivative."""
        side = -1.0 if self.branch == "open" else 1.0
        angle = self._towards_crank(u) + side * 2 * np.arctan(self._half_tangents(u)[0])
        g, a, c = self.ground, self.crank, self.rocker
        sine, cosine = np.sin(angle), np.cos(angle)
        x, y = g + c * cosine - a * np.cos(u), c * sine - a * np.sin(u)
        return angle, a * (y * np.cos(u) - x * np.sin(u)) / (c * (y * cosine - x * sine))

    def contacts(self, u: Array) -> tuple[tuple[Kind, Array, Array], ...]:
        """All four pins under the coupler's force, one newton metre over rocker times sin of the transmission angle."""
        _, slope = self.curve(u)
        (x, y), (dx, dy) = self._pin(u)
        bx, by = self.crank * np.cos(u), self.crank * np.sin(u)
        swing = ((x - bx) * (dy - bx) - (y - by) * (dx + by)) / self.coupler**2
        lever = self.rocker * np.sin(self.transmission(u))
        force = 1.0 / lever
        return turning(
            u, ("pin", force, 1.0), ("pin", force, 1.0 - swing), ("pin", force, slope - swing), ("pin", force, slope)
        )

    def ends(self) -> tuple[tuple[Place, float], ...]:
        """The spring is wound about the rocker's shaft, and its mass sits there."""
        return ((self.fixed(self.ground, 0.0), 1.0),)

    def weights(self) -> tuple[tuple[Place, Any], ...]:
        """Coupler and rocker."""
        return (
            (self.spot(self._coupler, "coupler_middle"), self.coupler_mass),
            (self.spot(self._rocker, "rocker_middle"), self.rocker_mass),
        )

    def _pin(self, u: Any) -> Any:
        """C and its derivative."""
        angle, slope = self.curve(u)
        x, y = self.rocker * np.cos(angle), self.rocker * np.sin(angle)
        return (self.ground + x, y), (-y * slope, x * slope)

    def _rocker(self, u: Any) -> Any:
        (x, y), (dx, dy) = self._pin(u)
        return ((x + self.ground) / 2, y / 2), (dx / 2, dy / 2)

    def _coupler(self, u: Any) -> Any:
        (x, y), (dx, dy) = self._pin(u)
        bx, by = self.crank * np.cos(u), self.crank * np.sin(u)
        return ((x + bx) / 2, (y + by) / 2), ((dx - by) / 2, (dy + bx) / 2)

    @property
    def lengths(self) -> str:
        """The lengths in words."""
        return ", ".join(f"{link} {getattr(self, link) * 1e3:.5g} mm" for link in LINKS)

    remedy = "lengthen coupler or rocker, shorten the crank, or let it turn less"

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for lengths that are not positive besides what every driven path refuses."""
        super().check(mechanism, name)
        for what in LINKS:
            bodies.positive_length(getattr(self, what), what, name)

    def needs(self, states: States) -> tuple[Need, ...]:
        """The linkage closes."""
        u, _ = self.crank_angle(states)
        size = float(np.real(np.ravel(self.rocker)[0]))
        return (Need("closing of the four-bar", "m", self.room(u) - 1e-3 * self.rocker, size),)

    def install(self, spec: mujoco.MjSpec, name: str, states: States) -> mujoco.MjsTendon:
        """Crank, coupler and rocker, pinned together; the tendon reads the rocker's angle."""
        g, a, b, c = (float(getattr(self, link)) for link in LINKS)
        frame, crank = self.drive(spec, name, states, a)
        coupler = bodies.add_body(crank, f"{name}_coupler", bodies.NOTHING, pos=(a, 0.0, 0.0), length=b)
        bodies.add_joint(coupler, f"{name}_coupler")
        rocker = bodies.add_body(frame, f"{name}_rocker", bodies.NOTHING, pos=(g, 0.0, 0.0), length=c)
        bodies.add_joint(rocker, f"{name}_rocker")
        for link, part, length, mass in (
            ("coupler", coupler, b, self.coupler_mass),
            ("rocker", rocker, c, self.rocker_mass),
        ):
            bodies.weigh(part.add_body(name=f"{name}_{link}_middle", pos=[length / 2, 0.0, 0.0]), float(mass))
        bodies.add_pin(spec, f"{name}_pin", (coupler, (b, 0.0, 0.0)), (rocker, (c, 0.0, 0.0)))
        return bodies.read_joint(spec, name, f"{name}_rocker")

    def positions(self, states: States, name: str) -> dict[str, Array]:
        """Crank, coupler and rocker angles."""
        u, _ = self.crank_angle(states)
        (x, y), _ = self._pin(u)
        along = np.arctan2(y - self.crank * np.sin(u), x - self.crank * np.cos(u))
        return {f"{name}_crank": u, f"{name}_coupler": along - u, f"{name}_rocker": self.curve(u)[0]}

    def sketch(self, states: States, row: int) -> Sketch:
        """The three bars, and the shaft of the spring."""
        u = float(self.crank_angle(states)[0][row])
        mount = self.at(states.mechanism.model)
        pin = (float(self.crank) * np.cos(u), float(self.crank) * np.sin(u))
        (x, y), _ = self._pin(u)
        places = [(0.0, 0.0), pin, (float(x), float(y)), (float(self.ground), 0.0)]
        bars = np.stack([states.point(mount.point(*place))[0][row] for place in places])
        axis = states.rotation(mount.at.body)[0][row] @ mount.frame[2]
        return Sketch(bars=(bars,), discs=((bars[-1], 0.3 * float(self.rocker), axis),))
