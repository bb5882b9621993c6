"""Turns: deformations that are sums of joint positions, which is what gears, belts and parallelograms transmit."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import bodies
from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.path import Moving, Place, Sketch
from equipoise.balancers.paths.shaft import Shaft
from equipoise.mechanism import Point
from equipoise.states import States

Terms = tuple[Mapping[str, Any], Any]
SHOWN = 0.04


class Turn(Shaft):
    """A deformation l = sum_j c_j q_j + c of hinges and slides: the common ground of angles, gears and drums."""

    @abstractmethod
    def terms(self, model: mujoco.MjModel) -> Terms:
        """Coefficients c_j by joint name, and the constant c."""

    def crank(self, spec: mujoco.MjSpec, frame: Any, name: str, states: States, phase: Any, length: float) -> Any:
        """A crank that a belt or gears turn with the joints."""
        coefficients, constant = self.terms(states.mechanism.model)
        return bodies.add_shaft(spec, frame, name, (coefficients, constant + phase), length, states)

    def deform(self, states: States) -> tuple[Array, Array]:
        """l (..., N) and dl/dq (..., N, nd)."""
        coefficients, constant = self.terms(states.mechanism.model)
        length, rate = np.zeros(len(states)) + constant, np.zeros_like(states.driven)
        for joint, coefficient in coefficients.items():
            position, jacobian = states.angle(joint)
            length = length + coefficient * position
            rate = rate + np.asarray(coefficient)[..., None] * jacobian
        return length, rate

    def ends(self) -> tuple[tuple[Place, float], ...]:
        """The spring is wound about the shaft, and its mass sits there."""

        def where(states: States) -> tuple[Array, Array]:
            return states.point(self.shaft(states.mechanism.model).at)

        return ((Moving(where, lambda model, _: self.shaft(model).at), 1.0),)

    def install(self, spec: mujoco.MjSpec, name: str, states: States) -> mujoco.MjsTendon:
        """Add a shaft `<name>_shaft` that the joints turn, and a tendon that reads its position."""
        frame = bodies.add_frame(spec, self.shaft(states.mechanism.model), f"{name}_frame")
        self.crank(spec, frame, f"{name}_shaft", states, 0.0, SHOWN)
        return bodies.read_joint(spec, name, f"{name}_shaft")

    def positions(self, states: States, name: str) -> dict[str, Array]:
        """The shaft's position."""
        return {f"{name}_shaft": self.deform(states)[0]}

    def sketch(self, states: States, row: int) -> Sketch:
        """A spiral about the shaft."""
        mount = self.shaft(states.mechanism.model)
        centre, axis = states.point(mount.at)[0][row], states.rotation(mount.at.body)[0][row] @ mount.frame[2]
        return Sketch(spirals=((centre, axis),), anchors=(mount.at,))


def joint_shaft(model: mujoco.MjModel, joint: int) -> Mount:
    """A joint's own axis seen from the body before it, pointing where the moving body's x axis does at zero."""
    body = int(model.jnt_bodyid[joint])
    parent = int(model.body_parentid[body])
    turned = np.zeros(9)
    mujoco.mju_quat2Mat(turned, model.body_quat[body])
    rotation = turned.reshape(3, 3)
    at = model.body_pos[body] + rotation @ model.jnt_pos[joint]
    axis = rotation @ model.jnt_axis[joint]
    across = next(v for v in (rotation[:, 0], rotation[:, 2]) if np.linalg.norm(np.cross(axis, v)) > 0.5)
    across = across - (across @ axis) * axis
    return Mount(Point(model.body(parent).name, tuple(at.tolist())), tuple(across.tolist()), tuple(axis.tolist()))
