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
    axes, v, a = (np.ascontiguousarray(part.T) for part in (kin.cdof, rates.velocity, rates.acceleration))
    own, change = axes * v, axes * a + np.ascontiguousarray(rates.cdof_dot.T) * v
    twist, rate = np.zeros((2, 6, model.nbody, len(kin.q)))
    for body in range(1, model.nbody):  # parents come first; a tree's bodies share the centre that axes refer to
        above, first = model.body_parentid[body], model.body_dofadr[body]
        dofs = slice(first, first + model.body_dofnum[body])
        twist[:, body] = twist[:, above] + own[:, dofs].sum(axis=1)
        rate[:, body] = rate[:, above] + change[:, dofs].sum(axis=1)
    frame = np.empty((3, 4, *twist.shape[1:]))
    frame[:, :3], frame[:, 3] = parts_of(kin.xmat), kin.xpos.T
    arms = frame.copy()
    arms[:, 3] -= kin.com.T
    spin, push = twist[:3], rate[:3]
    speed = cross_parts(spin[:, None], arms)
    speed[:, 3] += twist[3:]
    bend = cross_parts(push[:, None], arms) + cross_parts(spin[:, None], speed)
    bend[:, 3] += rate[3:]
    frame, speed, bend = (part.transpose(3, 2, 0, 1) for part in (frame, speed, bend))
    return Placement(frame, speed, bend, spin.T, push.T)


def parts_of(matrices: Array) -> Array:
    """Matrices (N, B, i, k) with their parts first (i, k, B, N), so that numpy's loops are long."""
    return matrices.transpose(2, 3, 1, 0)


def cross_parts(first: Array, second: Array) -> Array:
    """The cross product over the first axis (3, ...)."""
    found = np.empty(np.broadcast_shapes(first.shape, second.shape), dtype=np.result_type(first, second))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.multiply(first[j], second[k], out=found[i])
        found[i] -= first[k] * second[j]
    return found


def columns_crossed(first: Array, second: Array) -> Array:
    """The cross products (..., 3, k) of the columns of two matrices (..., 3, k); a single one crosses with all."""
    (x, y, z), (a, b, c) = ([part[..., i, :] for i in range(3)] for part in (first, second))
    return np.stack([y * c - z * b, z * a - x * c, x * b - y * a], axis=-2)


def skew(vector: Array) -> Array:
    """The matrices (..., 3, 3) that cross a vector (..., 3) with another."""
    x, y, z = (vector[..., i] for i in range(3))
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*vector.shape, 3)
