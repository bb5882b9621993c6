"""Kinematics of a sweep, computed once: positions, Jacobians in driven coordinates, weights, payloads."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.loops import ancestors, close_loops
from equipoise.mechanism import Mechanism, Point
from equipoise.models.notices import errors

if TYPE_CHECKING:
    from equipoise.sweep import Sweep


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
    batch = mechanism.batch(len(q))
    batch.bind("qpos")[:] = q
    names = ("xpos", "xmat", "subtree_com", "cdof", "qfrc_bias", "qfrc_spring", "energy")
    bound = [batch.bind(name) for name in names]
    with errors(mechanism.name):
        batch.forward(stage=int(mujoco.mjtStage.mjSTAGE_VEL))
    xpos, xmat, com, cdof, bias, spring, energy = (np.array(array) for array in bound)
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
    _bodies: dict[int, tuple[Array, Array]] = field(default_factory=dict, repr=False)

    @staticmethod
    def of(mechanism: Mechanism, sweep: Sweep) -> States:
        """Close the loops of a sweep's poses and compute their kinematics, one row per pose and payload."""
        driven, weight, payload_mass = sweep.rows()
        q, transmission = close_loops(mechanism, driven)
        kin = kinematics(mechanism, q)
        points = tuple(payload.point for payload in sweep.payloads)
        return States(mechanism, driven, weight, points, payload_mass, kin, transmission)

    def __len__(self) -> int:
        return len(self.driven)

    def take(self, rows: slice) -> States:
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
        )

    def point(self, point: Point | Spot) -> tuple[Array, Array]:
        """World position p (..., N, 3) and its Jacobian dp/dq_driven (..., N, 3, nd) of a body's point, or of a spot.

        Coordinates may be complex, carry leading candidate axes (C, 1) or differ from row to row (N,).
        """
        if not isinstance(point, Point):
            return point.locate(self)
        body = self.mechanism.body_id(point.body)
        local = np.stack(np.broadcast_arrays(*point.at), axis=-1)
        xpos, xmat = self.kin.xpos[:, body], self.kin.xmat[:, body]
        arm = xmat @ local if local.ndim == 1 else (xmat @ local[..., None])[..., 0]
        position = xpos + arm
        linear, angular = self._twist(body)
        if not ancestors(self.mechanism.model, body):
            return position, linear
        offset = position - self.kin.com[:, body]
        x, y, z = (offset[..., i, None] for i in range(3))
        wx, wy, wz = (angular[:, i] for i in range(3))
        turn = np.stack([wy * z - wz * y, wz * x - wx * z, wx * y - wy * x], axis=-2)
        return position, linear + turn

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
