"""Frames of all bodies in motion: where every point of a body is and how it is accelerated."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from equipoise.affine import Array, Indices
from equipoise.kinematics import Kinematics, Rates


@dataclass(frozen=True, eq=False)
class Placement:
    """A body's frame X (N, 3, 4) = [R | o] with its first two time derivatives: a point x = (r, 1) is at X x.

    spin and push (N, 3) are angular velocity and acceleration. Of all bodies together every array has an axis of
    bodies after the first.
    """

    frame: Array
    speed: Array
    bend: Array
    spin: Array
    push: Array

    def of(self, body: int) -> Placement:
        """One of all bodies."""
        return self.take((slice(None), body))

    def take(self, rows: slice | Indices | tuple[slice, int]) -> Placement:
        """Some of the rows."""
        return Placement(*(part[rows] for part in (self.frame, self.speed, self.bend, self.spin, self.push)))

    @property
    def delayed(self) -> Placement:
        """Velocities in the place of accelerations."""
        return Placement(self.frame, self.speed, self.speed, self.spin, self.spin)


def placements(model: mujoco.MjModel, kin: Kinematics, rates: Rates) -> Placement:
    """Frames of all bodies, from the motion axes of the joints that move them."""
    twist, rate = np.zeros((2, len(kin.q), model.nbody, 6))
    own = kin.cdof * rates.velocity[..., None]
    change = kin.cdof * rates.acceleration[..., None] + rates.cdof_dot * rates.velocity[..., None]
    for body in range(1, model.nbody):  # parents come first; a tree's bodies share the centre that axes refer to
        above, first = model.body_parentid[body], model.body_dofadr[body]
        dofs = slice(first, first + model.body_dofnum[body])
        twist[:, body] = twist[:, above] + own[:, dofs].sum(axis=1)
        rate[:, body] = rate[:, above] + change[:, dofs].sum(axis=1)
    frame = np.concatenate([kin.xmat, kin.xpos[..., None]], axis=-1)
    arms = frame.copy()
    arms[..., 3] -= kin.com
    spin, push = twist[..., :3], rate[..., :3]
    speed = columns_crossed(spin, arms)
    speed[..., 3] += twist[..., 3:]
    bend = columns_crossed(push, arms) + columns_crossed(spin, speed)
    bend[..., 3] += rate[..., 3:]
    return Placement(frame, speed, bend, spin, push)


def columns_crossed(vector: Array, matrix: Array) -> Array:
    """The cross product (..., 3, k) of a vector (..., 3), or of columns (..., 3, k), with each column of a matrix."""
    (x, y, z) = (vector[..., i, None] if vector.ndim < matrix.ndim else vector[..., i, :] for i in range(3))
    a, b, c = (matrix[..., i, :] for i in range(3))
    return np.stack([y * c - z * b, z * a - x * c, x * b - y * a], axis=-2)


def skew(vector: Array) -> Array:
    """The matrices (..., 3, 3) that cross a vector (..., 3) with another."""
    x, y, z = (vector[..., i] for i in range(3))
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*vector.shape, 3)
