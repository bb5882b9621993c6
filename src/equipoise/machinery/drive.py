"""What each motor does over a motion: torque, heat and work, split by what asks for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from equipoise.affine import Array, Block
from equipoise.assemble import Balancer, settled
from equipoise.balancers.spring import Spring
from equipoise.machinery.rubbed import Rubbed
from equipoise.machinery.supply import Supply
from equipoise.mechanism import Mechanism
from equipoise.momentum import bare_drive
from equipoise.row import Row
from equipoise.states import States

PARTS = ("inertial", "gravity", "springs", "friction")


@dataclass(frozen=True)
class Share:
    """Peak and rms of one part of a motor's effort, in the joint's unit."""

    peak: float
    rms: float


@dataclass(frozen=True)
class Drive:
    """One motor over a motion: effort, its parts {inertial, gravity, springs, friction}, work and power.

    effort = inertial + gravity + springs + friction at every instant: M qacc + c(q, qvel), weights, springs of the
    file and added ones, dampers of the file. work is None for states that are no motion in time; of several payloads
    the worst counts. power (W) is the largest that the motor supplies. What rubs in springs, paths and the robot's own
    joints is told apart in rubbed (None where nothing does), and is no part of the others.
    """

    effort: Row
    parts: Mapping[str, Share]
    power: float
    work: Supply | None
    rubbed: Rubbed | None = None

    def json(self) -> dict[str, Any]:
        """The drive as design.json holds it."""
        return {
            "peak": self.effort.peak,
            "rms": self.effort.rms,
            "unit": self.effort.unit,
            "parts": {name: {"peak": part.peak, "rms": part.rms} for name, part in self.parts.items()},
            "power": self.power,
            "work": self.work.json() if self.work else None,
            "with_friction": self.rubbed.json() if self.rubbed else None,
        }


def effort_parts(states: States, balancers: Sequence[Balancer], values: Mapping[str, float]) -> dict[str, Array]:
    """The driven joints' effort (N, nd) split by what asks for it; the sum is the goal `drive`."""
    fixed, moving = settled(balancers, values), states.moving

    def of(balancer: Balancer, goal: str) -> Array:
        share = balancer.effort(states, goal)
        return share.at(np.array([values[unknown.name] for unknown in share.unknowns]))

    def driven(force: Array) -> Array:
        return (force[:, None, :] @ states.D)[:, 0]

    springs = -driven(states.kin.spring)
    parts = {
        "inertial": bare_drive(states)[0],
        "gravity": states.holding - springs,
        "springs": springs,
        "friction": -driven(moving.damper),
    }
    for balancer in fixed:
        held = of(balancer, "hold")
        parts["inertial"] = parts["inertial"] + of(balancer, "drive") - held
        if isinstance(balancer, Spring):
            own = sum((states.weight_effort(place, mass) for place, mass in balancer.masses), np.zeros(1))
            parts["springs"], held = parts["springs"] + held - own, own
        parts["gravity"] = parts["gravity"] + held
    return parts


def drive_blocks(mechanism: Mechanism) -> list[Block]:
    """What is told of every motor: its effort, the parts of it, its power."""
    joints, units = mechanism.driven, mechanism.driven_units
    names = [f"{what} {joint}" for what in ("effort", *PARTS, "power") for joint in joints]
    every = [*units * (1 + len(PARTS)), *["W"] * len(joints)]
    return [Block(name, unit) for name, unit in zip(names, every, strict=True)]


def drive_sizes(states: States, parts: Mapping[str, Array]) -> Array:
    """Magnitudes (N, R) of the drive's blocks from the parts of the effort; of power what the motor supplies."""
    power = np.maximum(power_of(states, parts), 0.0)
    return np.concatenate([np.abs(sum(parts.values())), *(np.abs(parts[part]) for part in PARTS), power], axis=1)


def power_of(states: States, parts: Mapping[str, Array]) -> Array:
    """Power (N, nd) of the motors, W."""
    return sum(parts.values()) * states.moving.driven_velocity


def drives(
    mechanism: Mechanism, rows: Mapping[str, Row], work: Mapping[str, Supply], friction: Mapping[str, Rubbed]
) -> dict[str, Drive]:
    """What each motor does over a motion, from the rows of its blocks."""
    return {
        joint: Drive(
            effort=rows[f"effort {joint}"],
            parts={part: Share(rows[f"{part} {joint}"].peak, rows[f"{part} {joint}"].rms) for part in PARTS},
            power=rows[f"power {joint}"].peak,
            work=work.get(joint),
            rubbed=friction.get(joint),
        )
        for joint in mechanism.driven
    }
