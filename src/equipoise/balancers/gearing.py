"""Meshes of gears: the torque they pass, pitch circles, and the force on the teeth."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from equipoise.affine import Array

SLIGHT = 1e-9
"""Share of the largest torque below which its sign is rounding, and of a length below which two axes are one."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """A mesh or belt and the torque (N,), N m, that it passes over a motion, counted at the driven side.

    radius is the driven gear's pitch radius, m, None for belts and where it is not known; pressure_angle in rad.
    """

    name: str
    torque: Array
    radius: float | None = None
    pressure_angle: float = 0.0

    @property
    def reversals(self) -> int:
        """How often the torque changes its sign, so that the teeth change sides."""
        size = float(np.abs(self.torque).max(initial=0.0))
        signs = np.sign(self.torque[np.abs(self.torque) > SLIGHT * max(size, 1e-300)])
        return int((np.diff(signs) != 0).sum())

    @property
    def preload(self) -> float:
        """The least torque of an anti-backlash spring that keeps the teeth on one side throughout, N m."""
        return float(max(0.0, min(self.torque.max(), -self.torque.min())))

    @property
    def tooth_force(self) -> Array | None:
        """|T| / (r cos alpha) (N,), N: the force along the line of action, which the gears' own shafts carry too."""
        return None if self.radius is None else np.abs(self.torque) / (self.radius * np.cos(self.pressure_angle))


def meshing(model: mujoco.MjModel, body: int, carrier: int) -> int | None:
    """The hinge that a body's gear turns on, beside a shaft on the carrier: None where the centres do not keep apart.

    They do where that hinge alone leads from the carrier, or from what is fixed to it, to the body.
    """
    held = _rigid(model, body)
    if model.body_jntnum[held] != 1 or _rigid(model, int(model.body_parentid[held])) != _rigid(model, carrier):
        return None
    joint = int(model.body_jntadr[held])
    return joint if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE else None


def _rigid(model: mujoco.MjModel, body: int) -> int:
    """The body with joints, or the world, that a body is fixed to."""
    while body and model.body_dofnum[body] == 0:
        body = int(model.body_parentid[body])
    return body


def teeth(torque: Array, radius: float, pressure_angle: float, centres: Array, axis: Array) -> Array:
    """Force (N, 3) of a body's gear on the rotor's, N: tangential, and radial as if to part them.

        F = -(T / r) n x e + |T| / r tan(alpha) e

    torque T (N,), N m, of the mesh on the rotor about the axis n (3,); radius r, m, of the rotor's pitch circle,
    pressure_angle alpha, rad; centres (N, 3) lead from the body's axis to the rotor's, e along them.
    """
    e = centres / np.linalg.norm(centres, axis=1, keepdims=True)
    push = np.abs(torque) * np.tan(pressure_angle)
    return (push[:, None] * e - torque[:, None] * np.cross(axis, e)) / radius
