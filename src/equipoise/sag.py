"""The tension that keeps a rope from sagging."""

from __future__ import annotations

from dataclasses import dataclass

from equipoise.errors import InputError
from equipoise.units import Length, LinearDensity

EARTH = 9.81


def sag_tension(mass_per_metre: float, span: float, sag: float, gravity: float = EARTH) -> float:
    """Tension t, N, that keeps a taut rope's sag below a bound: t = mu g L^2 / (8 s), the flat parabola.

    mu in kg/m; L, the straight distance between the ends, and s, measured upright, in m; good to 1 % for s < L / 20.
    Raises InputError for numbers that are not positive or a sag beyond that.
    """
    for name, value in (("mass_per_metre", mass_per_metre), ("span", span), ("sag", sag)):
        if not value > 0:
            raise InputError(f"{name} is {value:g}, it must be positive", where="sag")
    if sag > span / 20:
        raise InputError(f"a sag of {sag:g} m over {span:g} m is not flat", where="sag", hint="ask for less than L/20")
    return mass_per_metre * gravity * span**2 / (8 * sag)


@dataclass(frozen=True)
class Sag:
    """A least tension said by the sag that it leaves: t = mu g L^2 / (8 s), see `sag_tension`.

    sag s in m; rope is its mass per length mu, kg/m; span L in m, by default the longest that the cable can be where
    the limit stands: the end of its interval, or the largest distance between two anchors of a platform.
    """

    sag: Length
    rope: LinearDensity
    span: Length | None = None

    def tension(self, longest: float) -> float:
        """The tension, N, of a rope whose longest span is `longest`, m, unless `span` says otherwise."""
        return sag_tension(self.rope, longest if self.span is None else self.span, self.sag)
