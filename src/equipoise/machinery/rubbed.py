"""Friction of springs, of their paths and of the robot's own joints in motion: what motors supply beside the effort."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from equipoise.affine import Array, Block
from equipoise.assemble import Balancer
from equipoise.balancers.spring import Spring
from equipoise.friction import Friction
from equipoise.machinery.supply import Supply
from equipoise.mechanism import Mechanism
from equipoise.row import Row
from equipoise.states import States

WHAT = ("rubbing", "rubbed effort")


@dataclass(frozen=True)
class Rubbed:
    """What friction adds to one motor over a motion.

    peak and rms of the friction effort, in the joint's unit; those of the whole effort with it; lost is the energy
    that friction takes, J, work what the motor supplies with it (None for states that are no motion in time).
    """

    peak: float
    rms: float
    effort_peak: float
    effort_rms: float
    lost: float | None
    work: Supply | None

    def json(self) -> dict[str, Any]:
        """The friction as design.json holds it."""
        return {
            "peak": self.peak,
            "rms": self.rms,
            "with_it": {"peak": self.effort_peak, "rms": self.effort_rms},
            "lost": self.lost,
            "work": self.work.json() if self.work else None,
        }


def rubbing(states: States, balancers: Sequence[Balancer], values: Mapping[str, float], friction: Friction) -> Array:
    """Effort (N, nd) that overcomes friction in motion, N m or N.

        t = sum_c mu_c |f| n_c S_c' (S_c v / |S_c v|) + F_r sign(dl/dt) dl/dq + D' (F_loss sign(qvel))

    f is a spring's force, n_c what presses on a contact per newton of it, S_c (k, nd) how it slides, v the driven
    joints' velocity; F_r the friction force of the spring itself, F_loss `frictionloss` of the robot's file. Nothing
    rubs where nothing moves.
    """
    v = states.moving.driven_velocity
    loss = np.sign(states.moving.velocity) * states.mechanism.model.dof_frictionloss
    total = (loss[:, None, :] @ states.D)[:, 0]
    for spring in balancers:
        if not isinstance(spring, Spring):
            continue
        force = np.abs(np.real(spring.force(states, values)[1]))
        for rub in spring.path.rubs(states):
            total = total + (friction.of(rub.kind) * force * rub.load)[:, None] * _against(rub.slide, v)
        drag = spring.law.drag
        own = friction.seal * force if drag is None else np.full(len(force), drag)
        total = total + own[:, None] * _against(spring.path.deform(states)[1][:, None], v)
    return total


def _against(slide: Array, v: Array) -> Array:
    """S' (S v / |S v|) (N, nd) of contacts that slide by S (N, k, nd)."""
    pace = (slide @ v[..., None])[..., 0]
    size = np.linalg.norm(pace, axis=1, keepdims=True)
    along = np.divide(pace, size, out=np.zeros_like(pace), where=size > 0)
    return (along[:, None, :] @ slide)[:, 0]


def rubbed_blocks(mechanism: Mechanism) -> list[Block]:
    """Friction, and effort with friction, of every motor."""
    joints = list(zip(mechanism.driven, mechanism.driven_units, strict=True))
    return [Block(f"{what} {joint}", unit) for what in WHAT for joint, unit in joints]


def rubbed(
    mechanism: Mechanism, rows: Mapping[str, Row], lost: Mapping[str, Supply], work: Mapping[str, Supply]
) -> dict[str, Rubbed]:
    """What friction adds to each motor, from the rows of its blocks, what it takes and what motors supply with it."""
    found = {}
    for joint in mechanism.driven:
        own, whole = (rows[f"{what} {joint}"] for what in WHAT)
        taken = lost[joint].net if joint in lost else None
        found[joint] = Rubbed(own.peak, own.rms, whole.peak, whole.rms, taken, work.get(joint))
    return found
