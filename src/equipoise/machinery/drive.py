"""What each motor does over a motion: torque, heat and work, split by what asks for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from equipoise.affine import Array, Block
from equipoise.assemble import Balancer, settled
from equipoise.balancers.spring import Spring
from equipoise.mechanism import Mechanism
from equipoise.momentum import bare_drive
from equipoise.row import Row
from equipoise.states import States
from equipoise.sweep import Sweep

HALVINGS = 40
PARTS = ("inertial", "gravity", "springs", "friction")


@dataclass(frozen=True)
class Share:
    """Peak and rms of one part of a motor's effort, in the joint's unit."""

    peak: float
    rms: float


@dataclass(frozen=True)
class Supply:
    """Energy over the motion, J: `positive` is supplied where nothing is regenerated, `braking` is taken back.

    With perfect regeneration the motor draws `net` = positive - braking.
    """

    positive: float
    braking: float

    @property
    def net(self) -> float:
        """positive - braking, J."""
        return self.positive - self.braking

    def json(self) -> dict[str, float]:
        """The supply as design.json holds it."""
        return {
            "without_regeneration": self.positive,
            "with_regeneration": self.net,
            "braking": self.braking,
        }


@dataclass(frozen=True)
class Drive:
    """One motor over a motion: effort, its parts {inertial, gravity, springs, friction}, work and power.

    effort = inertial + gravity + springs + friction at every instant: M qacc + c(q, qvel), weights, springs of the
    file and added ones, dampers of the file. work is None for states that are no motion in time; of several payloads
    the worst counts. power (W) is the largest that the motor supplies.
    """

    effort: Row
    parts: Mapping[str, Share]
    power: float
    work: Supply | None

    def json(self) -> dict[str, Any]:
        """The drive as design.json holds it."""
        return {
            "peak": self.effort.peak,
            "rms": self.effort.rms,
            "unit": self.effort.unit,
            "parts": {name: {"peak": part.peak, "rms": part.rms} for name, part in self.parts.items()},
            "power": self.power,
            "work": self.work.json() if self.work else None,
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


def drives(mechanism: Mechanism, rows: Mapping[str, Row], work: Mapping[str, Supply]) -> dict[str, Drive]:
    """What each motor does over a motion, from the rows of its blocks."""
    return {
        joint: Drive(
            effort=rows[f"effort {joint}"],
            parts={part: Share(rows[f"{part} {joint}"].peak, rows[f"{part} {joint}"].rms) for part in PARTS},
            power=rows[f"power {joint}"].peak,
            work=work.get(joint),
        )
        for joint in mechanism.driven
    }


def supplies(mechanism: Mechanism, sweep: Sweep, power: Array) -> dict[str, Supply]:
    """Energy that each motor supplies and takes back over a motion in time, and `all` of them on one supply.

    The integral of the positive part of quintic splines through the powers (N, nd), W, between their roots; of several
    payloads the one that asks for most.
    """
    instants = sweep.instants
    if instants is None or len(instants.time) < 4:
        return {}
    order = np.argsort(instants.time, kind="stable")
    power = np.concatenate([power, power.sum(axis=1, keepdims=True)], axis=1)
    scenarios = power.reshape(len(sweep.scenarios), len(order), -1)[:, order]
    runs = [_split(instants.time[order], run) for run in scenarios]
    names = (*mechanism.driven, "all")
    return {name: max(column, key=_positive) for name, column in zip(names, zip(*runs, strict=True), strict=True)}


def _positive(supply: Supply) -> float:
    return supply.positive


def _split(time: Array, power: Array) -> list[Supply]:
    """The integrals of the positive and the negative parts of quintic splines through powers (N, k), W, at times, s."""
    from scipy.interpolate import make_interp_spline

    law = make_interp_spline(time, power, k=min(5, (len(time) - 2) // 2 * 2 + 1))
    turns, column = np.nonzero(np.sign(power[1:]) * np.sign(power[:-1]) < 0)
    low, high, each = time[turns], time[turns + 1], np.arange(len(turns))
    ahead = power[turns, column]
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        same = law(middle)[each, column] * ahead > 0
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    store = law.antiderivative()
    whole, roots = store(time), store(low)[each, column]
    found = []
    for k in range(power.shape[1]):
        here = column == k
        places = np.concatenate([time, low[here]])
        pieces = np.diff(np.concatenate([whole[:, k], roots[here]])[np.argsort(places, kind="stable")])
        found.append(Supply(float(pieces[pieces > 0].sum()), float(-pieces[pieces < 0].sum())))
    return found
