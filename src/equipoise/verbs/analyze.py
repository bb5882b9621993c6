"""analyze: what the motors hold, and which joints are worth a spring."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from equipoise import chunks
from equipoise.affine import Array, magnitudes
from equipoise.assemble import Balancer, effort
from equipoise.design import Row
from equipoise.mechanism import Mechanism
from equipoise.objective import goal_blocks
from equipoise.peaks import polish
from equipoise.states import States
from equipoise.sweep import Sweep

Evaluate = Callable[[States], Array]

WORTH_SHARE = 0.1
WORTH_MOTOR = 0.02


@dataclass(frozen=True, eq=False)
class Analysis:
    """Holding effort of the bare mechanism per driven joint, which are worth a spring and why, the mass audit."""

    mechanism: Mechanism
    sweep: Sweep
    rows: dict[str, Row]
    reasons: dict[str, str]

    @property
    def worth(self) -> tuple[str, ...]:
        """Driven joints that are worth a spring."""
        return tuple(joint for joint, reason in self.reasons.items() if not reason)

    def json(self) -> dict[str, object]:
        """The analysis as `analyze --json` prints it."""
        return {
            "mass": self.mechanism.mass,
            "sweep": self.sweep.describe(),
            "rows": {
                joint: row.json() | {"worth_a_spring": not self.reasons[joint], "reason": self.reasons[joint]}
                for joint, row in self.rows.items()
            },
            "audit": list(self.mechanism.remarks),
        }

    def __str__(self) -> str:
        from equipoise.reporting.words import analysis

        return analysis(self)


def analyze(mechanism: Mechanism, sweep: Sweep | None = None) -> Analysis:
    """Holding effort of every driven joint over a sweep (default: 2048 Sobol poses over the joint limits).

    A joint is not worth a spring where gravity loads it with less than 10 % of the largest effort of its
    unit and less than 2 % of its motor limit. Peaks are polished between the samples.
    """
    sweep = sweep or Sweep.sobol(mechanism)
    states = mechanism.states(sweep)
    rows = table(mechanism, sweep, states, states.holding, lambda other: other.holding)
    return Analysis(mechanism, sweep, rows, {joint: _reason(joint, rows) for joint in rows})


def _reason(joint: str, rows: dict[str, Row]) -> str:
    row = rows[joint]
    largest = max(other.peak for other in rows.values() if other.unit == row.unit)
    if row.peak <= 1e-6 * max(largest, 1e-9):
        return "gravity does not load it"
    share = row.peak / largest
    if row.limit is not None:
        used = row.peak / row.limit
        if used < WORTH_MOTOR:
            return f"gravity uses {100 * used:.2g} % of its motor"
    if share < WORTH_SHARE and (row.limit is None or row.peak / row.limit < WORTH_SHARE):
        return f"gravity loads it with {100 * share:.2g} % of the largest joint's load"
    return ""


def table(
    mechanism: Mechanism, sweep: Sweep, states: States, residual: Array, evaluate: Evaluate, goal: str = "hold"
) -> dict[str, Row]:
    """A row per block of a goal's residual (N, R): norms over the sweep's weights, peaks polished.

    evaluate(states) -> (N, R) answers the residual at other states.
    """
    weight = states.weight / states.weight.sum()
    limits = dict(zip(mechanism.driven, mechanism.motor_limits, strict=True)) if goal == "hold" else {}
    blocks = goal_blocks(mechanism, goal)
    sizes = tuple(block.size for block in blocks)
    size = magnitudes(residual, sizes)
    sampled = size.reshape(len(sweep.scenarios), len(sweep.poses), -1).max(axis=0)
    peaks = polish(lambda poses: worst(mechanism, sweep, poses, evaluate, sizes), sweep.poses, sampled, sweep.box)
    return {
        block.name: Row(
            peak=float(peaks.value[i]),
            sample_peak=float(peaks.sample[i]),
            rms=float(np.sqrt(weight @ size[:, i] ** 2)),
            mean=float(weight @ size[:, i]),
            unit=block.unit,
            limit=float(limits[block.name]) if np.isfinite(limits.get(block.name, np.inf)) else None,
        )
        for i, block in enumerate(blocks)
    }


def tables(
    mechanism: Mechanism,
    sweep: Sweep,
    states: States,
    balancers: Sequence[Balancer],
    theta: Array,
    goals: Sequence[str],
) -> dict[str, Row]:
    """The rows of several goals, with balancers at given values."""
    found: dict[str, Row] = {}
    for goal in goals:

        def evaluate(other: States, goal: str = goal) -> Array:
            if chunks.is_big(balancers, other, len(theta)):
                return chunks.residual(mechanism, balancers, other, goal, theta)
            return effort(mechanism, balancers, other, goal).at(theta)

        found |= table(mechanism, sweep, states, evaluate(states), evaluate, goal)
    return found


def worst(mechanism: Mechanism, sweep: Sweep, poses: Array, evaluate: Evaluate, sizes: Sequence[int]) -> Array:
    """Magnitudes (M, B) of blocks of the given sizes at poses (M, nd), the worst over the payload scenarios."""
    states = mechanism.states(sweep.at_poses(poses))
    return magnitudes(evaluate(states), sizes).reshape(len(sweep.scenarios), len(poses), -1).max(axis=0)
