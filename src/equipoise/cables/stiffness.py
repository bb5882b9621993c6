"""How stiffly a platform stands: the second derivative of what springs, cables and weight store."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from equipoise.affine import Array, Mask
from equipoise.balancers.paths import Line
from equipoise.cables.distribution import Distribution
from equipoise.design import Design
from equipoise.mechanism import Mechanism
from equipoise.platform import platform_of
from equipoise.states import States
from equipoise.sweep import Sweep

STEP = 1e-5


def stiffness(design: Design, poses: Array) -> Array:
    """K (N, nd, nd) = d2V/dq2 at poses (N, nd): springs, weight and payload, motors off; N/m, N or N m/rad.

    Central differences of the holding effort, extrapolated (Richardson).
    """
    return richardson(lambda other: hold(design, other), poses)


def held_stiffness(states: States, motors: Distribution, design: Design | None = None) -> Array:
    """K (N, nd, nd) while motors keep their tensions: d2V/dq2 + sum_i t_M,i d2c_i/dq2; N/m, N or N m/rad.

    motors are the tensions at the same states; the design's springs count in V, weight and payload always.
    """
    mechanism = states.mechanism
    lines = [Line(*mechanism.cable(cable)) for cable in platform_of(mechanism).cables]
    tension = motors.motors

    def effort(poses: Array) -> Array:
        other = _moved(states, poses)
        own = other.holding if design is None else design.residual(other)
        rates = np.stack([line.deform(other)[1] for line in lines], axis=1)
        return own + np.einsum("nij,ni->nj", rates, np.repeat(tension, len(poses) // len(tension), axis=0))

    return richardson(effort, states.driven)


def principal(mechanism: Mechanism, K: Array, free: Mask | None = None) -> Array:
    """Eigenvalues (N, nd) of stiffness matrices, least first, N/m, of the coordinates that are free (nd,), or of all.

    An angle counts as the arc at the platform's length.
    """
    length = 1.0 if mechanism.platform is None else mechanism.platform.length
    per = np.where(np.array(mechanism.driven_units) == "N", 1.0, 1.0 / length)
    scaled = K * per[:, None] * per
    values = np.linalg.eigvalsh(scaled if free is None else scaled[:, free][:, :, free])
    return np.asarray(values, dtype=float)


def richardson(effort: Callable[[Array], Array], poses: Array) -> Array:
    """Symmetric slopes (N, nd, nd) of an effort, extrapolated from two steps."""
    K = (4 * slopes(effort, poses, STEP / 2) - slopes(effort, poses)) / 3
    return (K + np.swapaxes(K, 1, 2)) / 2


def slopes(effort: Callable[[Array], Array], poses: Array, step: float = STEP) -> Array:
    """Central differences (N, nd, nd) of an effort (N, nd) at poses (N, nd)."""
    nd = poses.shape[1]
    moves = step * np.concatenate([np.eye(nd), -np.eye(nd)])
    there = effort((poses[:, None] + moves).reshape(-1, nd)).reshape(len(poses), 2, nd, nd)
    return np.swapaxes((there[:, 0] - there[:, 1]) / (2 * step), 1, 2)


def hold(design: Design, poses: Array) -> Array:
    """Holding effort (N, nd), of the first payload."""
    states = design.mechanism.states(design.sweep.at_poses(poses))
    return design.residual(states)[: len(poses)]


def _moved(states: States, poses: Array) -> States:
    """As many poses near each state, with its payload."""
    other = states.mechanism.states(Sweep(poses, np.ones(len(poses)), "near by"))
    masses = np.repeat(states.payload_mass, len(poses) // len(states), axis=0)
    return replace(other, payload_points=states.payload_points, payload_mass=masses)
