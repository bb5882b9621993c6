"""Momentum at postures: what each drive's velocity brings, and whether angular momentum is a sum of rotations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from equipoise.affine import Array
from equipoise.assemble import Balancer, effort, settled
from equipoise.balancers.counter_rotor import turning
from equipoise.balancers.flywheel import Flywheel
from equipoise.kinematics import in_motion
from equipoise.mechanism import Mechanism
from equipoise.regressor import frame, free_states
from equipoise.states import States
from equipoise.sweep import Sweep

EXACT = 1e-9
"""Share of the momentum that a closed form may miss."""


def momentum_forms(
    mechanism: Mechanism, q: Array, transmission: Array, balancers: Sequence[Balancer], values: Mapping[str, float]
) -> tuple[Array, Array]:
    """p and L about the world origin (N, 3, nd) that one unit of each drive's velocity brings at postures q (N, nq)."""
    count, drives = len(q), len(mechanism.driven)
    driven = q[:, mechanism.model.jnt_qposadr[mechanism.driven_ids]]
    many = np.repeat(q, drives, axis=0)
    D = np.broadcast_to(transmission, (count, *transmission.shape[1:]))
    D = np.repeat(D, drives, axis=0)
    v = np.tile(np.eye(drives), (count, 1))
    kin, moving = in_motion(mechanism, many, D, (v, np.zeros_like(v)))
    none = np.zeros((count * drives, 0))
    repeated = np.repeat(driven, drives, axis=0)
    states = States(mechanism, repeated, np.ones(len(many)), (), none, kin, D, moving).momenta
    fixed = [b for b in settled(balancers, values) if not isinstance(b, Flywheel)]

    def of(goal: str) -> Array:
        whole = effort(mechanism, fixed, states, goal)
        found = whole.at(np.array([values[u.name] for u in whole.unknowns]))
        return np.swapaxes(found.reshape(count, drives, 3), 1, 2)

    return of("force"), of("moment")


def spin_form(
    mechanism: Mechanism, balancers: Sequence[Balancer], values: Mapping[str, float], sweep: Sweep | None = None
) -> dict[str, float] | None:
    """K {body: kg m^2} with L = sum K_b omega_b in all motions of a planar mechanism; None where there are none.

    Then angular momentum is a total derivative, d/dt sum K_b alpha_b, as it is once the force is balanced by masses on
    the lines of the joints: the angle of a flywheel, and the orientation that keeps L zero, follow from postures alone.
    """
    whole = frame(mechanism)
    if whole.plane is None:
        return None
    states = free_states(mechanism, sweep, 48)
    fixed = [b for b in settled(balancers, values) if not isinstance(b, Flywheel)]
    spin = effort(mechanism, fixed, states, "moment")
    momentum = spin.at(np.array([values[u.name] for u in spin.unknowns])) @ whole.plane
    bodies = [b for b in dict.fromkeys(p.body for p in whole.parameters) if turning(mechanism, b)]
    omega = np.stack([states.placement(body).push @ whole.plane for body in bodies], axis=1)
    found = np.linalg.lstsq(omega, momentum, rcond=1e-12)[0]
    size = float(np.abs(momentum).max(initial=0.0))
    if np.abs(omega @ found - momentum).max() > EXACT * max(size, 1e-300):
        return None
    floor = 1e-9 * float(np.abs(found).max(initial=0.0))
    return {body: float(K) for body, K in zip(bodies, found, strict=True) if abs(K) > floor}


def turned(mechanism: Mechanism, q: Array, form: Mapping[str, float]) -> Array:
    """sum K_b alpha_b (N,) at postures q (N, nq), alpha_b the body's absolute angle about the plane's axis."""
    whole = frame(mechanism)
    assert whole.plane is not None
    total = np.zeros(len(q))
    for body, K in form.items():
        sense = _sense(mechanism, body, whole.plane)
        for joint, sign in turning(mechanism, body).items():
            total += K * sense * sign * q[:, mechanism.model.jnt_qposadr[mechanism.joint_id(joint)]]
    return total


def _sense(mechanism: Mechanism, body: str, plane: Array) -> float:
    """Whether the axis that `turning` counts about is the plane's own or its opposite."""
    import mujoco

    model = mechanism.model
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    joint, sign = next(iter(turning(mechanism, body).items()))
    return float(np.sign(sign * (data.xaxis[mechanism.joint_id(joint)] @ plane)))
