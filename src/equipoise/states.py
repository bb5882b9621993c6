"""Kinematics of a sweep, computed once: positions, Jacobians in driven coordinates, weights, payloads."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.errors import InputError
from equipoise.loops import accelerations, ancestors, close_beside, close_loops, close_motion, tighten_loops
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
class Kinematics:
    """What MuJoCo says of postures q (N, nq): every array has N rows.

    xpos (N, nbody, 3), xmat (N, nbody, 3, 3), com (N, nbody, 3) the centre of the tree that cdof refers to,
    cdof (N, nv, 6) angular then linear, bias and spring (N, nv), energy (N,).
    """

    q: Array
    xpos: Array
    xmat: Array
    com: Array
    cdof: Array
    bias: Array
    spring: Array
    energy: Array


def kinematics(mechanism: Mechanism, q: Array) -> Kinematics:
    """Forward kinematics, gravity and file springs of all postures on all cores."""
    names = ("xpos", "xmat", "subtree_com", "cdof", "qfrc_bias", "qfrc_spring", "energy")
    xpos, xmat, com, cdof, bias, spring, energy = mechanism.forward(q, None, names)
    return Kinematics(
        q=q,
        xpos=xpos,
        xmat=xmat.reshape(len(q), -1, 3, 3),
        com=com[:, mechanism.model.body_rootid],
        cdof=cdof.reshape(len(q), -1, 6),
        bias=bias,
        spring=spring,
        energy=energy[:, 0],
    )


@dataclass(frozen=True, eq=False)
class Rates:
    """How the postures move: velocity and acceleration of the driven joints (N, nd) and of all dofs (N, nv).

    cdof_dot (N, nv, 6) are the rates of the motion axes, damper (N, nv) the file's own damping forces.
    """

    driven_velocity: Array
    driven_acceleration: Array
    velocity: Array
    acceleration: Array
    cdof_dot: Array
    damper: Array

    def take(self, rows: slice | Indices) -> Rates:
        """Some of the rows."""
        return Rates(*(getattr(self, field.name)[rows] for field in fields(Rates)))


def rates(mechanism: Mechanism, q: Array, transmission: Array, driven: tuple[Array, Array]) -> Rates:
    """Exact velocities D v and accelerations D a + Ddot v of all dofs, for driven (v, a) (N, nd) each."""
    v, a = driven
    velocity, start = ((transmission @ x[..., None])[..., 0] for x in (v, a))
    cdof_dot, damper = mechanism.forward(q, velocity, ("cdof_dot", "qfrc_damper"))
    cdof_dot = cdof_dot.reshape(len(q), -1, 6)
    acceleration = accelerations(mechanism, q, velocity, cdof_dot, start)
    return Rates(v, a, velocity, acceleration, cdof_dot, damper)


@dataclass(frozen=True, eq=False)
class Placement:
    """A body's frame X (N, 3, 4) = [R | o] with its first two time derivatives: a point x = (r, 1) is at X x.

    slope (N, nd, 3, 4) is dX/dq_driven; spin and push (N, 3) are angular velocity and acceleration.
    """

    frame: Array
    speed: Array
    bend: Array
    slope: Array
    spin: Array
    push: Array


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
    _placements: dict[int, Placement] = field(default_factory=dict, repr=False)
    _points: dict[int, tuple[Point, tuple[Array, Array]]] = field(default_factory=dict, repr=False)
    _affines: dict[int, tuple[Array, Array]] = field(default_factory=dict, repr=False)

    @staticmethod
    def of(mechanism: Mechanism, sweep: Sweep) -> States:
        """Close the loops of a sweep's poses and compute their kinematics, one row per pose and payload."""
        driven, weight, payload_mass = sweep.rows()
        points = tuple(payload.point for payload in sweep.payloads)
        moving = None
        if sweep.instants is None and sweep.beside is not None:
            q, transmission = close_beside(mechanism, sweep.beside, driven)
        elif sweep.instants is None:
            q, transmission = close_loops(mechanism, driven)
        else:
            time = np.tile(sweep.instants.time, len(sweep.scenarios))
            q, transmission = close_motion(mechanism, sweep.instants.motion, time)
        if sweep.moves is not None:
            _, v, a = (np.tile(part, (len(sweep.scenarios), 1)) for part in sweep.moves.rows)
            moving = rates(mechanism, q, transmission, (v, a))
        kin = kinematics(mechanism, q)
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
        kin = Kinematics(**{field.name: getattr(self.kin, field.name)[rows] for field in fields(Kinematics)})
        return States(
            self.mechanism,
            self.driven[rows],
            self.weight[rows],
            self.payload_points,
            self.payload_mass[rows],
            kin,
            self.D if len(self.D) == 1 else self.D[rows],
            None if self.rates is None else self.rates.take(rows),
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
        linear, angular = self._twist(body)
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
            linear, angular = self._twist(body)
            offset = xpos - self.kin.com[:, body] if ancestors(self.mechanism.model, body) else np.zeros_like(xpos)
            origin = np.concatenate([xpos[..., None], linear + np.cross(angular, offset[..., None], axis=1)], axis=2)
            turns = [
                np.concatenate([axis, np.cross(angular, axis, axis=1)], axis=2)
                for axis in np.split(xmat, 3, axis=2)
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
        return self.kin.xmat[:, index], self._twist(index)[1]

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
        places = {}
        for body in range(self.mechanism.model.nbody):
            place = self.placement(self.mechanism.model.body(body).name)
            places[body] = replace(place, bend=place.speed, push=place.spin)
        return replace(self, _placements=places)

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

    def placement(self, body: str) -> Placement:
        """Frame of a body with its time derivatives and its slope in driven coordinates."""
        index = self.mechanism.body_id(body)
        if index not in self._placements:
            self._placements[index] = self._place(index)
        return self._placements[index]

    def _place(self, body: int) -> Placement:
        moving, kin = self.moving, self.kin
        dofs = ancestors(self.mechanism.model, body)
        origin, turn = kin.xpos[:, body], kin.xmat[:, body]
        if not dofs:
            none = np.zeros((len(self), 3, 4))
            return Placement(np.concatenate([turn, origin[..., None]], axis=2), none, none,
                             np.zeros((len(self), self.driven.shape[1], 3, 4)), none[..., 0], none[..., 0])  # fmt: skip
        axes, v = kin.cdof[:, dofs], moving.velocity[:, dofs, None]
        twist = (axes * v).sum(axis=1)
        rate = (axes * moving.acceleration[:, dofs, None] + moving.cdof_dot[:, dofs] * v).sum(axis=1)
        arm = origin - kin.com[:, body]
        spin, push = skew(twist[:, :3]), skew(rate[:, :3])
        velocity = twist[:, 3:] + (spin @ arm[..., None])[..., 0]
        acceleration = rate[:, 3:] + (push @ arm[..., None] + spin @ velocity[..., None])[..., 0]
        linear, angular = self._twist(body)
        along = skew(np.swapaxes(angular, 1, 2))
        steer = np.swapaxes(linear, 1, 2) + (along @ arm[:, None, :, None])[..., 0]

        def joined(rotation: Array, translation: Array) -> Array:
            return np.concatenate([rotation, translation[..., None]], axis=-1)

        return Placement(
            joined(turn, origin),
            joined(spin @ turn, velocity),
            joined((push + spin @ spin) @ turn, acceleration),
            joined(along @ turn[:, None], steer),
            twist[:, :3],
            rate[:, :3],
        )

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

    def _twist(self, body: int) -> tuple[Array, Array]:
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


def skew(vector: Array) -> Array:
    """The matrices (..., 3, 3) that cross a vector (..., 3) with another."""
    x, y, z = (vector[..., i] for i in range(3))
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*vector.shape, 3)
