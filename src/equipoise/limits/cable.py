"""Limits on springs behind a reel: the cable's tension, the wind-up of a torsion spring, transmission angles."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from equipoise import units
from equipoise.affine import Array
from equipoise.balancers.paths import FourBar
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError
from equipoise.limits.curve import OverInterval
from equipoise.limits.limit import Setting
from equipoise.limits.sides import sides, straight
from equipoise.sag import Sag
from equipoise.solve.program import Rows

START = 129
"""Chebyshev lengths that a tension limit starts from."""
FINE = 4001
"""Lengths among which the worst are looked for, before each is polished."""
POLISH = 40
DEGREE = math.pi / 180


@dataclass(frozen=True)
class Tension(OverInterval):
    """min <= t <= max of the cable's tension t = f(l) dl/dc for every cable length c over (low, high), N.

    The spring f sits behind the cable's reel on a path l(c). It starts from Chebyshev lengths; the worst of 4001
    lengths, each polished by golden section, are added until none is outside. On a bare reel t is f: there `force`
    certifies polynomials by the roots of their derivatives. A `Sag` as min asks for what keeps the cable straight.
    """

    spring: str
    over: tuple[units.Length, units.Length]
    max: units.Force | None = None
    min: units.Force | Sag | None = None
    samples: int | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "min", straight(self.min, self.over))

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """Rows at Chebyshev lengths, or at as many equally spaced ones as are asked for."""
        spring = setting.find(self.spring, Spring, "tension")
        low, high = self.over
        if not 0 <= low < high:
            raise InputError(
                f"the interval [{low:g}, {high:g}] m is no range of cable lengths",
                where="limit tension",
                hint="lower end first, both at least 0",
            )
        if self.samples is not None:
            return self.rows_at(spring, np.linspace(low, high, max(self.samples, 2)))
        x = -np.cos(np.pi * np.arange(START) / (START - 1))
        return self.rows_at(spring, low + (high - low) * (1 + x) / 2)

    def rows_at(self, spring: Spring, lengths: Array) -> tuple[Rows, ...]:
        """Rows at given cable lengths."""
        basis, known = _tension(spring, lengths)
        ends = " to ".join(units.text(end, "m") for end in self.over)
        what = f"tension of {self.spring} over {ends}"
        made = sides(what, "N", basis, known, spring.unknowns, self.min, self.max)
        return tuple(Rows(r.limit, r.unit, r.G, r.h, r.unknowns, None, scale=r.scale) for r in made)

    def outside(self, spring: Spring, values: Mapping[str, float], tolerance: float) -> Array:
        """Local worst lengths (M,) that leave the limits by more than tolerance times their size."""
        theta = np.array([values[unknown.name] for unknown in spring.unknowns])
        low, high = straight(self.min, self.over), self.max

        def beyond(lengths: Array) -> Array:
            basis, known = _tension(spring, lengths)
            value = basis @ theta + known
            below = np.full_like(value, -np.inf) if low is None else low - value
            above = np.full_like(value, -np.inf) if high is None else value - high
            return np.maximum(below, above)

        grid = np.linspace(*self.over, FINE)
        excess = np.concatenate([[-np.inf], beyond(grid), [-np.inf]])
        peaks = np.flatnonzero((excess[1:-1] >= excess[:-2]) & (excess[1:-1] >= excess[2:]))
        worst = _climb(beyond, grid[np.maximum(peaks - 1, 0)], grid[np.minimum(peaks + 1, FINE - 1)])
        found = np.concatenate([worst, grid[peaks]])
        bounds = [abs(bound) for bound in (low, high) if bound]
        return np.unique(found[beyond(found) > tolerance * (min(bounds) if bounds else 1.0)])


@dataclass(frozen=True)
class WindUp:
    """|T| <= k max: a torsion spring is wound up by at most max, rad (`2 turn`), at the ends of every cable length.

    T = T0 + k (l - rest) is the torque of law `torsion` or `linear`. Over (low, high), m, it holds at both ends of
    the cable's range, between which the wind-up of a spring that keeps its cable taut only grows or only falls;
    without it at every state.
    """

    spring: str
    max: units.Angle
    over: tuple[units.Length, units.Length] | None = None

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """B theta + f0 -+ max (S theta + s0) <= 0, one row per side and state."""
        spring = setting.find(self.spring, Spring, "wind_up")
        if spring.path.unit != "rad" or spring.law.degree != 1:
            raise InputError(
                f"spring {self.spring} is not wound up: it is no torsion spring on an angle",
                where="limit wind_up",
                hint="use law torsion on a path that is an angle, or limit `stroke`",
            )
        if not self.max > 0:
            raise InputError(f"the wind-up is at most {self.max:g} rad", where="limit wind_up", hint="give it above 0")
        if self.over is None:
            turn, _ = spring.path.deform(setting.states)
        else:
            turn, _ = spring.path.along(np.array(self.over, dtype=float))
        basis, known = spring.law.force_basis(turn)
        slope, rate = spring.law.slope_basis(turn)
        what = f"wind-up of {self.spring} <= {units.text(self.max, 'rad')}"
        state = np.arange(known.shape[-1]) if self.over is None else None
        return tuple(
            Rows(
                what,
                "N m",
                side * basis - self.max * slope,
                self.max * rate - side * known,
                spring.unknowns,
                state,
                scale=max(float(np.abs(np.real(basis)).max(initial=0.0)), 1e-9),
            )
            for side in (1.0, -1.0)
        )


@dataclass(frozen=True)
class Transmission:
    """min <= mu <= max of the angle between coupler and rocker of a four-bar path, rad; the geometry alone decides.

    Over (low, high), m, it holds for every cable length between: mu is extreme at the ends or where crank and
    ground are in line, and all of these are rows. Without it, at every state.
    """

    spring: str
    min: units.Angle = 30 * DEGREE
    max: units.Angle = 150 * DEGREE
    over: tuple[units.Length, units.Length] | None = None

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """Rows without unknowns."""
        spring = setting.find(self.spring, Spring, "transmission")
        path = spring.path
        if not isinstance(path, FourBar):
            raise InputError(
                f"the path of spring {self.spring} has no transmission angle",
                where="limit transmission",
                hint="it belongs to path four_bar",
            )
        if self.over is None:
            u, _ = path.crank_angle(setting.states)
        else:
            turn, _ = path.input.along(np.array(self.over, dtype=float))
            u = _with_dead_centres(turn + path.phase)
        angle = path.transmission(u)
        none = np.zeros((*angle.shape, 0), dtype=angle.dtype)
        made = sides(f"transmission angle of {self.spring}", "rad", none, angle, (), self.min, self.max)
        if self.over is None:
            return made
        return tuple(Rows(r.limit, r.unit, r.G, r.h, (), None, scale=r.scale) for r in made)


def _tension(spring: Spring, lengths: Array) -> tuple[Array, Array]:
    """Basis (..., M, P) and known part (..., M) of t = f(l) dl/dc at cable lengths (M,)."""
    output, rate = spring.path.along(lengths)
    basis, known = spring.law.force_basis(output)
    return basis * rate[..., None], known * rate


def _with_dead_centres(ends: Array) -> Array:
    """Both ends (..., 2) and the crank angles 2 k pi and (2 k + 1) pi nearest the first that lie between, else it."""
    first, last = ends[..., :1], ends[..., 1:]
    low, high = np.minimum(np.real(first), np.real(last)), np.maximum(np.real(first), np.real(last))
    inner: list[Any] = []
    for part in (0.0, np.pi):
        centre = part + 2 * np.pi * np.ceil((low - part) / (2 * np.pi))
        inner.append(np.where(centre <= high, centre + 0.0 * first, first))
    return np.concatenate([first, last, *inner], axis=-1)


def _climb(value: Any, low: Array, high: Array) -> Array:
    """Golden section for local maxima in brackets (M,)."""
    ratio = (math.sqrt(5) - 1) / 2
    for _ in range(POLISH):
        left, right = high - ratio * (high - low), low + ratio * (high - low)
        up = value(left) < value(right)
        low, high = np.where(up, left, low), np.where(up, high, right)
    return (low + high) / 2
