"""Profiles on which a cord winds: closed forms for a guide at infinity or at a finite distance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array, Mask
from equipoise.errors import InputError


@dataclass(frozen=True, eq=False)
class Winding:
    """How a cord's arm follows a rotation: travel c (N,), angle theta, arm rho with d/dtheta and d2/dtheta2.

    off: +1 where the cord comes off while theta grows (a drum that pays its cable out), -1 where it winds on
    (the cord of a spring that is drawn). knob says in words what to change where the profile cannot be cut.
    """

    c: Array
    angle: Array
    arm: Array
    slope: Array
    bend: Array
    off: int
    knob: str


@dataclass(frozen=True, eq=False)
class WoundProfile:
    """A profile in the body's frame at angle 0: contact points (N, 2), m, radius of curvature R and free cord (N,).

    The guide is at (D, 0) in the frame that the body turns in by +angle; D is None for a guide far away, whose cord
    leaves along one direction, and the free cord is then unknown (nan). crosses is the share of sampled poses at
    which the free cord meets another lobe of the flat profile.
    """

    winding: Winding
    points: Array
    curvature: Array
    free: Array
    guide: float | None
    crosses: float

    @property
    def turns(self) -> float:
        """How far the body turns over the whole travel."""
        return float(np.ptp(self.winding.angle) / (2 * np.pi))

    @property
    def helical(self) -> bool:
        """Whether the groove must climb along the axis: more than one turn, or a cord that meets another lobe."""
        return self.turns >= 1 or self.crosses > 0

    @property
    def arc(self) -> float:
        """Length of the profile, m."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())


def wind(winding: Winding, guide: float | None = None) -> WoundProfile:
    """The profile whose arm is the winding's.

        normal angle  phi = -theta - off arccos(rho / D),   contact  q = rho n + (drho/dphi) n_perp
        R = rho + d2rho/dphi2,   free cord = sqrt(D^2 - rho^2) - off drho/dphi

    phi = -theta with D at infinity. guide D in m. Raises InputError where the arm leaves (0, D), the body would
    turn back under the cord, the radius of curvature is not positive (the profile is undercut), or the cord would
    have to end inside the guide; it names the place and what to change.
    """
    theta, rho, slope, bend, off = winding.angle, winding.arm, winding.slope, winding.bend, winding.off
    _insist(rho > 0, rho, "the arm", winding)
    if guide is None:
        phi, turn, turn2 = -theta, -np.ones_like(rho), np.zeros_like(rho)
    else:
        if rho.max() >= guide:
            raise InputError(
                f"the arm reaches {rho.max() * 1e3:.4g} mm, the guide is at {guide * 1e3:.4g} mm",
                where="make",
                hint=f"move the guide out, or {winding.knob}",
            )
        root = np.sqrt(guide**2 - rho**2)
        phi = -theta - off * np.arccos(rho / guide)
        turn = -1 + off * slope / root
        turn2 = off * (bend / root + rho * slope**2 / root**3)
        _insist(-turn > 0, -turn, "the turning of the contact", winding)
    first = slope / turn
    second = (bend * turn - slope * turn2) / turn**3
    radius = rho + second
    _insist(radius > 0, radius, "the radius of curvature", winding)
    free = np.full_like(rho, np.nan)
    if guide is not None:
        free = np.sqrt(guide**2 - rho**2) - off * first
        _insist(free > 0, free, "the free cord", winding)
    normal = np.stack([np.cos(phi), np.sin(phi)], axis=1)
    across = np.stack([-np.sin(phi), np.cos(phi)], axis=1)
    points = rho[:, None] * normal + first[:, None] * across
    return WoundProfile(winding, points, radius, free, guide, _crossing(points, theta, guide))


def _insist(good: Mask, value: Array, what: str, winding: Winding) -> None:
    if not good.all():
        worst = int(value.argmin())
        raise InputError(
            f"{what} is {value[worst] * 1e3:.4g} mm at a travel of {winding.c[worst]:.4g}"
            if what != "the turning of the contact"
            else f"the body turns back under the cord at a travel of {winding.c[worst]:.4g}",
            where="make",
            hint=winding.knob,
        )


def _crossing(points: Array, theta: Array, guide: float | None, poses: int = 120, edges: int = 1500) -> float:
    """Share of poses at which the free cord crosses the profile elsewhere; 0, which says nothing, without a guide."""
    if guide is None:
        return 0.0
    coarse = points[np.linspace(0, len(points) - 1, edges).astype(int)]
    a, b = coarse[:-1], coarse[1:]
    hits = 0
    rows = np.linspace(0, len(points) - 1, poses).astype(int)
    for row in rows:
        eye = guide * np.array([np.cos(theta[row]), -np.sin(theta[row])])
        start = points[row] + 2e-3 * (eye - points[row])
        hits += bool(_meets(start, eye, a, b).any())
    return hits / poses


def _meets(p: Array, q: Array, a: Array, b: Array) -> Mask:
    def side(o: Array, d: Array, x: Array) -> Array:
        return d[..., 0] * (x[..., 1] - o[..., 1]) - d[..., 1] * (x[..., 0] - o[..., 0])

    return (side(p, q - p, a) * side(p, q - p, b) < 0) & (side(a, b - a, p) * side(a, b - a, q) < 0)
