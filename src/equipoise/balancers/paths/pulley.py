"""Pulleys."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import mujoco
import numpy as np

from equipoise.errors import InputError
from equipoise.mechanism import Mechanism, Point
from equipoise.units import Angle, Length, Mass, Number

Spatial = tuple[Length, Length, Length]


@dataclass(frozen=True)
class Pulley:
    """A pulley that a body carries and that turns freely about its own axis; radius 0 is a guide eye.

    at is its centre in the body's own frame, m; radius that of the cable's centre line, m. side says on which side
    of the cable, running from first to last, the pulley lies, seen with `axis` pointing at the viewer: at a pulley on
    the `left` the cable turns left. axis is a vector of the body; the default is that of planar mechanisms, seen with
    x to the right and z up. The wrapped angle is the one within half a turn of `nominal`, rad (by default from -150 to
    210 deg); where it is negative the cable has lifted off and runs straight past. mass in kg, at the centre.
    """

    body: str
    at: Spatial = (0.0, 0.0, 0.0)
    radius: Length = 0.0
    side: Literal["left", "right"] = "left"
    axis: tuple[Number, Number, Number] = (0.0, -1.0, 0.0)
    nominal: Angle = math.pi / 6
    mass: Mass = 0.0

    @property
    def centre(self) -> Point:
        """Its centre as a point of its body."""
        return Point(self.body, self.at)

    @property
    def sense(self) -> float:
        """1 where the cable turns counter-clockwise about the axis."""
        return 1.0 if self.side == "left" else -1.0

    def check(self, mechanism: Mechanism, where: str) -> None:
        """Raise InputError for a body that is not there, a negative radius or mass, an axis that points nowhere."""
        mechanism.body_id(self.body)
        check_wheel(self.radius, self.mass, where)
        if not np.linalg.norm(self.axis) > 0 or not np.isfinite(self.axis).all():
            raise InputError(f"the axis of the pulley is {tuple(self.axis)}, which points nowhere", where=where)

    def install(self, spec: mujoco.MjSpec, name: str) -> mujoco.MjsGeom:
        """Add the pulley to a model as a massless cylinder that tendons wrap around."""
        axis = np.asarray(self.axis, dtype=float) / np.linalg.norm(self.axis)
        quat = np.zeros(4)
        mujoco.mju_quatZ2Vec(quat, axis)
        radius = float(self.radius)
        return spec.body(self.body).add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=[radius, 0.2 * radius, 0.0],
            pos=[float(v) for v in self.at],
            quat=quat.tolist(),
            mass=0.0,
            contype=0,
            conaffinity=0,
        )


def check_wheel(radius: Any, mass: Any, where: str) -> None:
    """Raise InputError for a negative radius, m, or mass, kg, of a pulley."""
    for what, value, unit in (("radius", radius, "m"), ("mass", mass, "kg")):
        if np.any(np.real(value) < 0) or not np.all(np.isfinite(value)):
            raise InputError(f"the {what} of the pulley is {value:g} {unit}, it cannot be negative", where=where)
