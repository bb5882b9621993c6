"""Three ways to make a force curve: a drum with a torsion spring, a cam with a coil, a cam with a constant force.

All follow from energy alone: what the spring stores is E(c) + E0, so no differential equation is solved.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equipoise import units
from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.make.curves import ForceCurve
from equipoise.make.profile import Winding
from equipoise.units import Length, Stiffness, TorsionRate


def _above_zero(value: float, what: str) -> None:
    if not value > 0:
        raise InputError(f"the {what} is {value:g}, it must be above 0", where="make")


@dataclass(frozen=True)
class DrumWithTorsion:
    """A non-circular drum on a linear torsion spring: the cable itself winds on the profile.

        kappa psi^2 / 2 = E(c) + E0,   arm rho = dc/dpsi = kappa psi / f

    rate kappa in N m/rad; preload E0 in J, what the spring stores at the shortest cable.
    """

    rate: TorsionRate
    preload: units.Energy

    def winding(self, curve: ForceCurve) -> Winding:
        """Arm over angle, closed form in f, df/dc, d2f/dc2; raises InputError without preload or for an angle."""
        for value, what in ((self.rate, "rate"), (self.preload, "preload energy")):
            _above_zero(value, what)
        if curve.unit != "m":
            raise InputError("a torque over an angle needs a cam, not a drum", where="make", hint="use cam")
        k, f, energy = self.rate, curve.force, curve.energy + self.preload
        psi = np.sqrt(2 * energy / k)
        rho = k * psi / f
        by_c = k * (1 / rho / f - psi * curve.slope / f**2)
        radius = rho * self._curvature(curve)
        most = self.largest_rate(curve)
        knob = (
            f"the rate can be at most {units.text(most, 'N m/rad')} at this preload: lower `rate` or change `preload`"
        )
        return Winding(curve.c, psi, rho, rho * by_c, radius - rho, 1, knob)

    def _curvature(self, curve: ForceCurve) -> Array:
        """R / rho = 1 + kappa [E y'' + 3/2 f y'] with y = f^-2."""
        return 1 + self.rate * self._bracket(curve)

    def _bracket(self, curve: ForceCurve) -> Array:
        f, slope, bend = curve.force, curve.slope, curve.bend
        y1, y2 = -2 * slope / f**3, 6 * slope**2 / f**4 - 2 * bend / f**3
        return (curve.energy + self.preload) * y2 + 1.5 * f * y1

    def largest_rate(self, curve: ForceCurve) -> float:
        """kappa_max, N m/rad, at which the drum, its guide far away, is just not undercut; linear, so closed form."""
        worst = float(self._bracket(curve).min())
        return np.inf if worst >= 0 else -1.0 / worst

    def travel(self, curve: ForceCurve) -> Array:
        """Angle of the spring, rad."""
        return np.sqrt(2 * (curve.energy + self.preload) / self.rate)

    def pull(self, travel: Array) -> Array:
        """Torque of the spring, N m, at its angle."""
        return self.rate * travel


@dataclass(frozen=True)
class CamWithSpring:
    """A round drum for the cable and a cam on its shaft, on which the cord of an extension spring winds.

        k x^2 / 2 = E(c) + E0,   arm h = dx/dphi = r f / (k x),   phi = c / r

    radius r of the drum in m (a gear ratio is absorbed in it); over an angle, as for an arm, 1 means the cam sits on
    the joint itself. rate k in N/m; preload E0 in J at the curve's start; x counts from the spring's slack.
    """

    radius: Length
    rate: Stiffness
    preload: units.Energy

    def winding(self, curve: ForceCurve) -> Winding:
        """Arm over angle, closed form in f, df/dc and d2f/dc2."""
        for value, what in ((self.radius, "drum radius"), (self.rate, "rate"), (self.preload, "preload energy")):
            _above_zero(value, what)
        r, (x1, x2, x3) = self.radius, self._derivatives(curve)
        most = self.largest_radius(curve)
        knob = (
            f"the drum radius can be at most {units.text(most, 'm')} at this preload: lower `radius`, raise `preload`"
            if curve.unit == "m"
            else f"the ratio must be at least {1 / most:.4g} at this preload: raise `ratio` or `preload`, narrow `over`"
        )
        return Winding(curve.c, (curve.c - curve.c[0]) / r, r * x1, r**2 * x2, r**3 * x3, -1, knob)

    def _derivatives(self, curve: ForceCurve) -> tuple[Array, Array, Array]:
        """x', x'', x''' of the spring's stretch over the travel."""
        k, f, x = self.rate, curve.force, self.travel(curve)
        first = f / (k * x)
        second = (curve.slope - k * first**2) / (k * x)
        third = (curve.bend - 3 * k * first * second) / (k * x)
        return first, second, third

    def largest_radius(self, curve: ForceCurve) -> float:
        """r_max: r^2 = min x' / (-x''') where x''' < 0, for a guide far away; it does not depend on the rate."""
        first, _, third = self._derivatives(curve)
        sharp = third < 0
        return float(np.sqrt((first[sharp] / -third[sharp]).min())) if sharp.any() else np.inf

    def travel(self, curve: ForceCurve) -> Array:
        """Stretch of the spring, m."""
        return np.sqrt(2 * (curve.energy + self.preload) / self.rate)

    def pull(self, travel: Array) -> Array:
        """Force of the spring, N, at its stretch."""
        return self.rate * travel


@dataclass(frozen=True)
class ConstantForceCam:
    """A round drum for the cable and a cam on its shaft, on which a constant-force spring pulls.

        F x = E(c),   arm h = r f / F,   R = (r / F)(f + r^2 d2f/dc2)

    radius r of the drum in m; pull_force F in N. With f constant it is the plain reel with a constant-force spring.
    """

    radius: Length
    pull_force: units.Force

    def winding(self, curve: ForceCurve) -> Winding:
        """Arm over angle."""
        for value, what in ((self.radius, "drum radius"), (self.pull_force, "force")):
            _above_zero(value, what)
        r, share = self.radius, 1 / self.pull_force
        most = self.largest_radius(curve)
        knob = (
            f"the drum radius can be at most {units.text(most, 'm')}: lower `radius`, or ask for `convex` in the limits"
        )
        arm, slope, bend = r * share * curve.force, r**2 * share * curve.slope, r**3 * share * curve.bend
        return Winding(curve.c, (curve.c - curve.c[0]) / r, arm, slope, bend, -1, knob)

    def largest_radius(self, curve: ForceCurve) -> float:
        """r_max: r^2 = min f / (-d2f/dc2), for a guide far away."""
        sharp = curve.bend < 0
        return float(np.sqrt((curve.force[sharp] / -curve.bend[sharp]).min())) if sharp.any() else np.inf

    def travel(self, curve: ForceCurve) -> Array:
        """Travel of the spring's end, m."""
        return curve.energy / self.pull_force

    def pull(self, travel: Array) -> Array:
        """Force of the spring, N: constant."""
        return np.full_like(travel, self.pull_force)
