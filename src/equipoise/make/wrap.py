"""A wrapped cord simulated by geometry alone: tangent search on a polygon, summed lengths, differences for arms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.make.cams import CamWithSpring, ConstantForceCam, DrumWithTorsion
from equipoise.make.curves import ForceCurve
from equipoise.make.profile import WoundProfile

WINDOW = 1.2
"""How far, in rad of polygon angle, the tangent is searched: a spiral's other turns must not catch the cord."""
DELTA = 1e-4


@dataclass(frozen=True, eq=False)
class Wrapped:
    """What the cord of a finished profile does: at travels c (M,), force and the wanted one (M,), N or N m."""

    c: Array
    force: Array
    wanted: Array

    @property
    def error(self) -> float:
        """Largest difference, N or N m."""
        return float(np.abs(self.force - self.wanted).max())


def simulate(
    kind: DrumWithTorsion | CamWithSpring | ConstantForceCam, curve: ForceCurve, profile: WoundProfile, poses: int = 400
) -> Wrapped:
    """Force of the part from its polygon: cord length by tangents, arm = d(length)/d(angle), force by the spring.

    drum: f = kappa psi / rho;  cam: f = F(x) h / r with x from the simulated length. Nothing of the closed forms but
    the polygon's corners enters. Raises InputError for a profile without a guide.
    """
    if profile.guide is None:
        raise InputError("the wrap needs a guide at a finite distance", where="make", hint="give `guide`")
    winding = profile.winding
    inner = np.linspace(0, len(winding.angle) - 1, poses + 2).astype(int)[1:-1]
    turned = np.concatenate([winding.angle[inner] + side * DELTA for side in (1, -1, 0)])
    length = cord(profile, turned, np.tile(inner, 3)).reshape(3, -1)
    arm = winding.off * (length[0] - length[1]) / (2 * DELTA) * -1.0
    arm = np.abs(arm)
    if isinstance(kind, DrumWithTorsion):
        force = kind.pull(winding.angle[inner]) / arm
    else:
        start = kind.travel(curve)[inner[0]]
        stretch = start + np.abs(length[2] - length[2][0])
        force = kind.pull(stretch) * arm / kind.radius
    return Wrapped(winding.c[inner], force, curve.force[inner])


def cord(profile: WoundProfile, angles: Array, near: Array) -> Array:
    """Cord from the profile's end to the guide (M,), m, at angles (M,) of the body, searched near vertices (M,).

    The wrapped end is the first vertex for a cord that winds on, the last for one that comes off.
    """
    assert profile.guide is not None
    points, winding = profile.points, profile.winding
    edge = np.diff(points, axis=0)
    run = np.concatenate([[0.0], np.cumsum(np.linalg.norm(edge, axis=1))])
    angle = winding.angle
    found = np.empty(len(angles))
    for j, (theta, row) in enumerate(zip(angles, near, strict=True)):
        eye = profile.guide * np.array([np.cos(theta), -np.sin(theta)])
        first = max(0, int(np.searchsorted(angle, angle[row] - WINDOW)))
        last = min(len(edge), int(np.searchsorted(angle, angle[row] + WINDOW)) + 1)
        part = slice(first, last)
        to_eye = eye - (points[:-1][part] + points[1:][part]) / 2
        cross = edge[part][:, 0] * to_eye[:, 1] - edge[part][:, 1] * to_eye[:, 0]
        changes = np.flatnonzero(cross[:-1] * cross[1:] <= 0) + first
        if not len(changes):
            raise InputError("the cord finds no tangent on the profile", where="make", hint="move the guide out")
        at = changes[np.abs(changes - row).argmin()] + 1
        wrapped = run[at] if winding.off < 0 else run[-1] - run[at]
        found[j] = wrapped + np.linalg.norm(eye - points[at])
    return found
