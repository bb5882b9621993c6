"""Loop equations: residual and Jacobian of a model's active equalities, for many postures at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import mujoco
import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.loops.posture import Pose, ancestors, cross, quat_product

_SLIDE = int(mujoco.mjtJoint.mjJNT_SLIDE)


class Equality(Protocol):
    """One active equality: its rows, the dofs it can tie together and how its rows become dimensionless.

    A row is multiplied by its `factor` and, where `lengths` is true, divided by the characteristic length.
    """

    @property
    def dofs(self) -> frozenset[int]:
        """The dofs that it can tie together."""
        ...

    @property
    def factor(self) -> Array:
        """What each row (rows,) is multiplied by."""
        ...

    @property
    def lengths(self) -> NDArray[np.bool_]:
        """Which rows (rows,) are lengths."""
        ...

    def rows(self, pose: Pose) -> tuple[Array, Array]:
        """Residual (N, rows) and Jacobian (N, rows, nv) in MuJoCo's units and order."""
        ...

    def points(self, pose: Pose, /) -> list[Array]:
        """World points (N, 3) that the equality joins; none for joints and tendons."""
        ...


@dataclass(frozen=True, eq=False)
class Connect:
    """p1 - p2 = 0: two bodies share a point."""

    model: mujoco.MjModel
    bodies: tuple[int, int]
    anchors: tuple[Array, Array]
    dofs: frozenset[int]
    factor: Array
    lengths: NDArray[np.bool_]

    def points(self, pose: Pose) -> list[Array]:
        """Where each body holds the shared point, (N, 3) twice."""
        return [pose.point(body, anchor) for body, anchor in zip(self.bodies, self.anchors, strict=True)]

    def rows(self, pose: Pose) -> tuple[Array, Array]:
        """p1 - p2 (N, 3), m, and its Jacobian (N, 3, nv)."""
        first, second = self.points(pose)
        jacobian = np.zeros((len(first), 3, self.model.nv))
        for sign, body, place in ((1.0, self.bodies[0], first), (-1.0, self.bodies[1], second)):
            dofs = ancestors(self.model, body)
            motion = pose.cdof[:, dofs]
            turn = cross(motion[..., :3], (place - pose.com[:, body])[:, None])
            jacobian[:, :, dofs] += sign * np.swapaxes(motion[..., 3:] + turn, 1, 2)
        return first - second, jacobian


@dataclass(frozen=True, eq=False)
class Weld:
    """Three rows of a shared point, three of the vector part of conj(q2) q1, times torquescale."""

    point: Connect
    turns: tuple[Array, Array]
    scale: float
    factor: Array
    lengths: NDArray[np.bool_]

    @property
    def dofs(self) -> frozenset[int]:
        """The dofs that move one body and not the other."""
        return self.point.dofs

    def points(self, pose: Pose) -> list[Array]:
        """Where each body holds the shared point, (N, 3) twice."""
        return self.point.points(pose)

    def rows(self, pose: Pose) -> tuple[Array, Array]:
        """Position rows, m, then rotation rows, (N, 6), and their Jacobian (N, 6, nv)."""
        gap, slope = self.point.rows(pose)
        first, second = self.point.bodies
        one = quat_product(pose.xquat[:, first], self.turns[0])
        back = quat_product(pose.xquat[:, second], self.turns[1]) * np.array([1.0, -1.0, -1.0, -1.0])
        angular = np.zeros_like(slope)
        for sign, body in ((1.0, first), (-1.0, second)):
            dofs = ancestors(self.point.model, body)
            angular[:, :, dofs] += sign * np.swapaxes(pose.cdof[:, dofs, :3], 1, 2)
        turns = quat_product(quat_product(back[:, None], np.eye(4)[1:]), one[:, None])[..., 1:]
        turn = self.scale * quat_product(back, one)[:, 1:]
        spin = 0.5 * self.scale * np.swapaxes(turns, 1, 2) @ angular
        return np.concatenate([gap, turn], axis=1), np.concatenate([slope, spin], axis=1)


@dataclass(frozen=True, eq=False)
class Couple:
    """y1 - y1_0 = c0 + c1 d + ... + c4 d^4 with d = y2 - y2_0, for two joints or two tendons (or one, d = 0)."""

    model: mujoco.MjModel
    tendon: bool
    items: tuple[int, ...]
    references: Array
    coefficients: Array
    dofs: frozenset[int]
    factor: Array
    lengths: NDArray[np.bool_]

    @property
    def head(self) -> int:
        """The dof of the first joint, the one that the law gives."""
        return int(self.model.jnt_dofadr[self.items[0]])

    @property
    def linear(self) -> bool:
        """Whether the coupling is linear in both items."""
        return not self.tendon and (len(self.items) == 1 or not self.coefficients[2:].any())

    def points(self, _pose: Pose) -> list[Array]:
        """No points are joined."""
        return []

    def rows(self, pose: Pose) -> tuple[Array, Array]:
        """The residual (N, 1), rad or m, and its Jacobian (N, 1, nv)."""
        values, slopes = zip(*(self._item(pose, item) for item in self.items), strict=True)
        residual = values[0] - self.references[0] - self.coefficients[0]
        jacobian = slopes[0].copy()
        if len(self.items) == 2:
            offset = values[1] - self.references[1]
            law = np.polynomial.Polynomial(self.coefficients)
            residual = values[0] - self.references[0] - law(offset)
            jacobian -= law.deriv()(offset)[:, None] * slopes[1]
        return residual[:, None], jacobian[:, None, :]

    def _item(self, pose: Pose, item: int) -> tuple[Array, Array]:
        if self.tendon:
            return pose.ten_length[:, item], pose.ten_J[:, item]
        slope = np.zeros((len(pose.q), self.model.nv))
        slope[:, self.model.jnt_dofadr[item]] = 1.0
        return pose.q[:, self.model.jnt_qposadr[item]], slope


def equalities(model: mujoco.MjModel) -> list[Equality]:
    """The active equalities of a model; raises InputError for a kind that closes no loop (flex)."""
    kinds = mujoco.mjtEq
    found: list[Equality] = []
    for index in map(int, np.flatnonzero(model.eq_active0)):
        kind = int(model.eq_type[index])
        if kind == kinds.mjEQ_CONNECT:
            found.append(_connect(model, index, (slice(0, 3), slice(3, 6))))
        elif kind == kinds.mjEQ_WELD:
            found.append(_weld(model, index))
        elif kind in (kinds.mjEQ_JOINT, kinds.mjEQ_TENDON):
            found.append(_couple(model, index, tendon=kind == kinds.mjEQ_TENDON))
        else:
            name = model.equality(index).name or f"number {index + 1}"
            raise InputError(
                f"equality {name} is of kind {kinds(kind).name[5:].lower()}, which no rigid loop has",
                hint="use connect, weld, joint or tendon equalities",
            )
    return found


def residual(found: list[Equality], pose: Pose) -> tuple[Array, Array]:
    """All rows stacked: residual (N, m) and Jacobian (N, m, nv), as `efc_pos` and `efc_J` in MuJoCo."""
    parts = [equality.rows(pose) for equality in found]
    return np.concatenate([r for r, _ in parts], axis=1), np.concatenate([J for _, J in parts], axis=1)


def _connect(model: mujoco.MjModel, index: int, place: tuple[slice, slice]) -> Connect:
    objects = int(model.eq_obj1id[index]), int(model.eq_obj2id[index])
    if model.eq_objtype[index] == mujoco.mjtObj.mjOBJ_SITE:
        bodies = int(model.site_bodyid[objects[0]]), int(model.site_bodyid[objects[1]])
        anchors = model.site_pos[objects[0]].copy(), model.site_pos[objects[1]].copy()
    else:
        bodies = objects
        anchors = model.eq_data[index, place[0]].copy(), model.eq_data[index, place[1]].copy()
    # a common ancestor moves both ends alike, so a closed loop never constrains it
    dofs = frozenset(ancestors(model, bodies[0])) ^ frozenset(ancestors(model, bodies[1]))
    return Connect(model, bodies, anchors, dofs, np.ones(3), np.ones(3, dtype=bool))


def _weld(model: mujoco.MjModel, index: int) -> Weld:
    point = _connect(model, index, (slice(3, 6), slice(0, 3)))
    if model.eq_objtype[index] == mujoco.mjtObj.mjOBJ_SITE:
        turns = model.site_quat[model.eq_obj1id[index]].copy(), model.site_quat[model.eq_obj2id[index]].copy()
    else:
        turns = model.eq_data[index, 6:10].copy(), np.array([1.0, 0.0, 0.0, 0.0])
    scale = float(model.eq_data[index, 10])
    # the quaternion's vector part is half the angle: undo that and torquescale to read radians
    factor = np.array([1.0] * 3 + [2.0 / scale if scale else 0.0] * 3)
    return Weld(point, turns, scale, factor, np.arange(6) < 3)


def _couple(model: mujoco.MjModel, index: int, *, tendon: bool) -> Couple:
    items = (int(model.eq_obj1id[index]), int(model.eq_obj2id[index]))
    items = items if items[1] >= 0 else items[:1]
    law = model.eq_data[index, :5].copy()
    factor, length = np.ones(1), True
    if tendon:
        references = model.tendon_length0[list(items)]
        dofs = frozenset(int(dof) for item in items for dof in _tendon_dofs(model, item))
        coupled = model.wrap_type[model.tendon_adr[items[0]]] == mujoco.mjtWrap.mjWRAP_JOINT
        if coupled:
            start, number = model.tendon_adr[items[0]], model.tendon_num[items[0]]
            factor, length = 1.0 / np.abs(model.wrap_prm[start : start + number]).max(keepdims=True), False
    else:
        references = model.qpos0[model.jnt_qposadr[list(items)]]
        dofs = frozenset(int(model.jnt_dofadr[item]) for item in items)
        length = bool(model.jnt_type[items[0]] == _SLIDE)
    lengths = np.array([length])
    return Couple(model, tendon, items, np.array(references), law, dofs, factor, lengths)


def _tendon_dofs(model: mujoco.MjModel, tendon: int) -> NDArray[np.int_]:
    start = model.ten_J_rowadr[tendon]
    return model.ten_J_colind[start : start + model.ten_J_rownnz[tendon]]
