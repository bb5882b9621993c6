"""Friction of the parts, and the dead band that it makes: where the mechanism stays, drifts or runs away."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from equipoise.affine import Array, Mask
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.errors import InputError
from equipoise.friction import Friction
from equipoise.objective import leading
from equipoise.states import States

POSES = 500
STEP = 1e-4


@dataclass(frozen=True)
class Drag:
    """Friction of one joint over the poses, moved by itself: largest and root mean square, in `unit`."""

    peak: float
    rms: float
    unit: str


@dataclass(frozen=True)
class DeadBand:
    """What friction holds: shares of the poses in which the mechanism stays, drifts and runs away.

    rows {joint: Drag} and parts {what rubs: its largest share at any joint}, both of all springs together with the
    friction loss that the robot's file states; it stays where friction is at least the residual in every joint;
    where it is not, the joint that exceeds it most drifts if its residual falls on the way, else it runs away.
    """

    rows: Mapping[str, Drag]
    parts: Mapping[str, float]
    stays: float
    drifts: float
    runs: float
    poses: int
    friction: Friction

    def json(self) -> dict[str, Any]:
        """The dead band as design.json holds it."""
        rows = {joint: dict(vars(row)) for joint, row in self.rows.items()}
        return dict(vars(self)) | {"rows": rows, "parts": dict(self.parts), "friction": dict(vars(self.friction))}


def drags(spring: Spring, states: States, values: Mapping[str, float], friction: Friction) -> Array:
    """Friction torque (N, nd) of a spring's path and law, each joint moved by itself, N m or N.

        t_j = sum_c mu_c |f| n_c |ds_c/dq_j| + F_r |dl/dq_j|

    f (N,) is the spring's force, n_c what presses on the contact per newton of it, ds_c/dq_j how fast it slides; mu_c
    the coefficient (times the pin's radius for pins), F_r the friction force of the spring itself.
    """
    length, force = spring.force(states, values)
    size = np.abs(np.real(force))
    total = np.zeros_like(states.driven)
    for rub in spring.path.rubs(states):
        total = total + friction.of(rub.kind) * (size * rub.load)[:, None] * rub.pace
    drag = spring.law.drag
    own = friction.seal * size if drag is None else np.full(len(length), drag)
    return total + own[:, None] * np.abs(spring.path.deform(states)[1])


def held(design: Design) -> bool:
    """Whether a dead band says anything: the objective is what holds the joints at rest."""
    return leading(design.objective).goal == "hold"


def dead_band(design: Design, friction: Friction | None = None) -> DeadBand:
    """How far friction covers what balancing leaves, at no more than 500 of the design's poses.

    Raises InputError where the objective is not `hold`.
    """
    friction = friction or Friction()
    if not held(design):
        raise InputError("a dead band is one of holding still", where="friction", hint="use the goal hold")
    mechanism, sweep = design.mechanism, design.sweep
    keep = np.unique(np.linspace(0, len(sweep.poses) - 1, min(POSES, len(sweep.poses))).astype(int))
    states = mechanism.states(sweep.thinned(keep))
    joints = [mechanism.driven.index(name) for name in design.objective[0].counted(mechanism)]
    springs = [balancer for balancer in design.balancers if isinstance(balancer, Spring)]
    by_part = {spring.name: drags(spring, states, design.values, friction) for spring in springs}
    loss = np.abs(np.swapaxes(states.D, 1, 2)) @ mechanism.model.dof_frictionloss
    if np.any(loss):
        by_part["the robot's own joints"] = np.broadcast_to(loss, states.driven.shape)
    total = sum(by_part.values(), np.zeros_like(states.driven))
    left = np.abs(design.residual(states))[:, joints] - total[:, joints]
    worst = left.argmax(axis=1)
    moves = left.max(axis=1) > 0
    falling = _falling(design, states)[np.arange(len(states)), np.array(joints)[worst]]
    units = dict(zip(mechanism.driven, mechanism.driven_units, strict=True))
    rows = {
        mechanism.driven[j]: Drag(
            float(total[:, j].max()), float(np.sqrt((total[:, j] ** 2).mean())), units[mechanism.driven[j]]
        )
        for j in joints
    }
    return DeadBand(
        rows=rows,
        parts={name: float(part[:, joints].max()) for name, part in by_part.items() if part[:, joints].any()},
        stays=float((~moves).mean()),
        drifts=float((moves & falling).mean()),
        runs=float((moves & ~falling).mean()),
        poses=len(states),
        friction=friction,
    )


def _falling(design: Design, states: States) -> Mask:
    """Whether each joint's residual (N, nd) falls as it gives way: the joint's own stiffness is positive."""
    found = np.zeros(states.driven.shape, dtype=bool)
    for joint, step in enumerate(STEP * np.eye(states.driven.shape[1])):
        there, back = (design.residual(states.nearby(states.driven + sign * step))[:, joint] for sign in (1, -1))
        found[:, joint] = there > back
    return found
