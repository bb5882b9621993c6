"""Kinematics of a sweep, computed once: positions, Jacobians in driven coordinates, weights, payloads."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.errors import InputError
from equipoise.frames import Placement, columns_crossed, placements
from equipoise.kinematics import Kinematics, Rates, in_motion, kinematics
from equipoise.loops import ancestors, close_beside, close_loops, close_motion, tighten_loops
from equipoise.loops.posture import integrate
from equipoise.mechanism import Mechanism, Point

if TYPE_CHECKING:
    import mujoco

    from equipoise.sweep import Sweep

REMEMBERED = 12
"""Points whose places are kept for the next who asks."""


class Spot(Protocol):
    """A point that no body of the mechanism carries, such as a slider: it says where it is and what carries it."""

    def locate(self, states: States) -> tuple[Array, Array]:
        """World position p (..., N, 3), m, and its Jacobian dp/dq_driven (..., N, 3, nd)."""
        ...

    def seat(self, model: mujoco.MjModel, name: str) -> Point:
        """The point of the body that carries the spot in a model in which the part `name` was installed."""
        ...


@dataclass(frozen=True, eq=False)
class States:
    """The states x of a sweep: N rows of posture, weight and payload with their kinematics.

    driven (N, nd) positions of the driven joints; weight (N,) positive; payload_mass (N, K) kg of the
    K payload points; D (N or 1, nv, nd) = dq/dq_driven, applied here and nowhere else.
    """

    mechanism: Mechanism
    driven: Array
    weight: Array
    payload_points: tuple[Point, ...]
    payload_mass: Array
    kin: Kinematics
    D: Array
    rates: Rates | None = None
    _bodies: dict[int, tuple[Array, Array]] = field(default_factory=dict, repr=False)
    _frames: list[Placement] = field(default_factory=list, repr=False)
    _points: dict[int, tuple[Point, tuple[Array, Array]]] = field(default_factory=dict, repr=False)
    _affines: dict[int, tuple[Array, Array]] = field(default_factory=dict, repr=False)

    @staticmethod
    def of(mechanism: Mechanism, sweep: Sweep) -> States:
        """Close the loops of a sweep's poses and compute their kinematics, one row per pose and payload."""
        driven, weight, payload_mass = sweep.rows()
        points = tuple(payload.point for payload in sweep.payloads)
        if sweep.instants is None and sweep.beside is not None:
            q, transmission = close_beside(mechanism, sweep.beside, driven)
        elif sweep.instants is None:
            q, transmission = close_loops(mechanism, driven)
        else:
            time = np.tile(sweep.instants.time, len(sweep.scenarios))
            q, transmission = close_motion(mechanism, sweep.instants.motion, time, driven)
        if sweep.moves is None:
            kin, moving = kinematics(mechanism, q), None
        else:
            _, v, a = (np.tile(part, (len(sweep.scenarios), 1)) for part in sweep.moves.rows)
            kin, moving = in_motion(mechanism, q, transmission, (v, a))
        return States(mechanism, driven, weight, points, payload_mass, kin, transmission, moving)

    def __len__(self) -> int:
        return len(self.driven)

    def nearby(self, driven: Array) -> States:
        """The states at rest with driven joints (N, nd) a small step away; loops are closed from where they stand.

        Raises LoopError where they do not close there.
        """
        model = self.mechanism.model
        q = integrate(model, self.kin.q, (self.D @ (driven - self.driven)[..., None])[..., 0])
        q[:, model.jnt_qposadr[self.mechanism.driven_ids]] = driven
        q, transmission = tighten_loops(self.mechanism, q)
        kin = kinematics(self.mechanism, q)
        return States(self.mechanism, driven, self.weight, self.payload_points, self.payload_mass, kin, transmission)

    def take(self, rows: slice | Indices) -> States:
        """Some of the rows."""
        return States(
            self.mechanism,
            self.driven[rows],
            self.weight[rows],
            self.payload_points,
            self.payload_mass[rows],
            self.kin.take(rows),
            self.D if len(self.D) == 1 else self.D[rows],
            None if self.rates is None else self.rates.take(rows),
            _frames=[frames.take(rows) for frames in self._frames],
        )

    def point(self, point: Point | Spot) -> tuple[Array, Array]:
        """World position p (..., N, 3) and its Jacobian dp/dq_driven (..., N, 3, nd) of a body's point, or of a spot.

        Coordinates may be complex, carry leading candidate axes (C, 1) or differ from row to row (N,).
        """
        if not isinstance(point, Point):
            return point.locate(self)
        # Path, law, limits and own mass of a spring ask for the same two points in turn.
        known = self._points.get(id(point))
        if known is None:
            # Threads may share the states: what one of them takes away, another must not miss.
            if len(self._points) >= REMEMBERED:
                self._points.pop(next(iter(tuple(self._points))), None)
            known = self._points[id(point)] = (point, self._point(point))
        return known[1]

    def _point(self, point: Point) -> tuple[Array, Array]:
        body = self.mechanism.body_id(point.body)
        local = np.stack(np.broadcast_arrays(*point.at), axis=-1)
        if local.ndim == 3 and local.shape[1] == 1:
            fixed, turn = self._affine(body)
            both = (fixed + local[:, 0] @ turn).reshape(len(local), -1, 3, len(self))
            return np.swapaxes(both[:, 0], 1, 2), both[:, 1:].transpose(0, 3, 2, 1)
        xpos, xmat = self.kin.xpos[:, body], self.kin.xmat[:, body]
        arm = xmat @ local if local.ndim == 1 else sum(local[..., i, None] * xmat[..., :, i] for i in range(3))
        position = xpos + arm
        linear, angular = self.twist(body)
        if not ancestors(self.mechanism.model, body):
            return position, linear
        offset = position - self.kin.com[:, body]
        x, y, z = (offset[..., i, None] for i in range(3))
        wx, wy, wz = (angular[:, i] for i in range(3))
        moved = np.empty((*position.shape, linear.shape[-1]), dtype=position.dtype)
        moved[..., 0, :] = linear[:, 0] + wy * z - wz * y
        moved[..., 1, :] = linear[:, 1] + wz * x - wx * z
        moved[..., 2, :] = linear[:, 2] + wx * y - wy * x
        return position, moved

    def _affine(self, body: int) -> tuple[Array, Array]:
        """Position and Jacobian ((1 + nd) * 3 * N,) of a body's origin, and what local coordinates add to them (3, .).

        With it points of many candidates are one product of matrices.
        """
        if body not in self._affines:
            xpos, xmat = self.kin.xpos[:, body], self.kin.xmat[:, body]
            linear, angular = self.twist(body)
            offset = xpos - self.kin.com[:, body] if ancestors(self.mechanism.model, body) else np.zeros_like(xpos)
            origin = np.concatenate([xpos[..., None], linear + np.cross(angular, offset[..., None], axis=1)], axis=2)
            turns = [
                np.concatenate([axis, np.cross(angular, axis, axis=1)], axis=2) for axis in np.split(xmat, 3, axis=2)
            ]
            self._affines[body] = origin.T.reshape(-1), np.stack([turn.T.reshape(-1) for turn in turns])
        return self._affines[body]

    def angle(self, joint: str) -> tuple[Array, Array]:
        """Position (N,) of a hinge or slide and its Jacobian (N, nd)."""
        index = self.mechanism.joint_id(joint)
        model = self.mechanism.model
        row = np.broadcast_to(self.D[:, model.jnt_dofadr[index]], self.driven.shape)
        return self.kin.q[:, model.jnt_qposadr[index]], row

    def rotation(self, body: str) -> tuple[Array, Array]:
        """World rotation (N, 3, 3) of a body and its angular-velocity Jacobian (N, 3, nd)."""
        index = self.mechanism.body_id(body)
        return self.kin.xmat[:, index], self.twist(index)[1]

    @property
    def moving(self) -> Rates:
        """Velocities and accelerations; raises InputError for states at rest."""
        if self.rates is None:
            raise InputError(
                "inertia needs a motion, and the sweep is a set of poses",
                where="sweep",
                hint="sweep: {motion: {joint: expression in t}, duration: 1 s}",
            )
        return self.rates

    @property
    def momenta(self) -> States:
        """The same states with velocities in the place of accelerations: `force` and `moment` then answer p and L.

        F = dp/dt and p are the same linear function of Xddot and of Xdot.
        """
        return replace(self, _frames=[self.frames.delayed])

    def carried(self, body: int) -> bool:
        """Whether any joint moves a body (by number)."""
        return bool(ancestors(self.mechanism.model, body))

    def acceleration(self, point: Point) -> Array:
        """World acceleration (..., N, 3) of a body's point; coordinates may be complex or carry candidates."""
        bend = self.placement(point.body).bend
        local = np.stack(np.broadcast_arrays(*point.at), axis=-1)
        return bend[..., 3] + (bend[..., :3] @ local[..., None])[..., 0]

    def point_wrench(self, point: Point, mass: Any) -> Array:
        """Rate of linear and angular momentum (..., N, 6) of a point mass, kg, about the world origin."""
        position, acceleration = self.point(point)[0], self.acceleration(point)
        x, y, z = (position[..., i] for i in range(3))
        a, b, c = (acceleration[..., i] for i in range(3))
        rate = np.stack(np.broadcast_arrays(a, b, c, y * c - z * b, z * a - x * c, x * b - y * a), axis=-1)
        return np.asarray(mass)[..., None] * rate

    def point_inertia(self, point: Point, mass: Any) -> Array:
        """Effort (..., N, nd) of the driven joints that accelerates a point mass, kg, weight left out."""
        jacobian = self.point(point)[1]
        pull = np.einsum("...i,...ij->...j", self.acceleration(point), jacobian)
        return np.asarray(mass)[..., None] * pull

    @property
    def frames(self) -> Placement:
        """Frames of all bodies with their time derivatives."""
        if not self._frames:
            self._frames.append(placements(self.mechanism.model, self.kin, self.moving))
        return self._frames[0]

    def placement(self, body: str) -> Placement:
        """Frame of a body with its time derivatives."""
        return self.frames.of(self.mechanism.body_id(body))

    def worked(self, body: str, wrench: Array) -> Array:
        """Effort (N, nd, P) of the driven joints that gives a body wrenches (N, 6, P) about the world origin."""
        index = self.mechanism.body_id(body)
        linear, angular = self.twist(index)
        force = wrench[..., :3, :]
        moment = wrench[..., 3:, :] - columns_crossed(self.kin.com[:, index, :, None], force)
        return np.swapaxes(linear, 1, 2) @ force + np.swapaxes(angular, 1, 2) @ moment

    @cached_property
    def holding(self) -> Array:
        """Holding effort of the bare mechanism and its payload (N, nd): D^T (bias - spring) - sum m g . J."""
        free = np.squeeze((self.kin.bias - self.kin.spring)[:, None, :] @ self.D, axis=1)
        for point, mass in zip(self.payload_points, self.payload_mass.T, strict=True):
            free = free + self.weight_effort(point, mass)
        return free

    @property
    def potential(self) -> Array:
        """Potential energy (N,), J, of all weights, payloads and springs in the file."""
        total = self.kin.energy.copy()
        for point, mass in zip(self.payload_points, self.payload_mass.T, strict=True):
            total = total + self.weight_energy(point, mass)
        return total

    def weight_effort(self, point: Point | Spot, mass: Any) -> Array:
        """Holding effort (..., N, nd) of a point mass (kg, scalar or per row): -m g . J."""
        _, jacobian = self.point(point)
        lift = np.einsum("i,...ij->...j", -self.mechanism.gravity, jacobian)
        return np.asarray(mass)[..., None] * lift

    def weight_energy(self, point: Point | Spot, mass: Any) -> Array:
        """Potential energy (..., N) of a point mass, J: -m g . p."""
        position, _ = self.point(point)
        return np.asarray(mass) * (position @ -self.mechanism.gravity)

    def twist(self, body: int) -> tuple[Array, Array]:
        """Linear (at the tree's centre) and angular Jacobians (N, 3, nd) of a body in driven coordinates."""
        if body not in self._bodies:
            dofs = ancestors(self.mechanism.model, body)
            if not dofs:
                none = np.zeros((len(self), 3, self.driven.shape[1]))
                self._bodies[body] = (none, none)
            else:
                motion = np.swapaxes(self.kin.cdof[:, dofs], 1, 2) @ self.D[:, dofs]
                self._bodies[body] = (motion[:, 3:], motion[:, :3])
        return self._bodies[body]
