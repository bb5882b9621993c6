"""analyze: what the motors hold, and which joints are worth a spring."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
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
from equipoise.steepness import steepness
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
    mechanism: Mechanism,
    sweep: Sweep,
    states: States,
    residual: Array,
    evaluate: Evaluate,
    *,
    goal: str = "hold",
    known: Mapping[str, Row] | None = None,
) -> dict[str, Row]:
    """A row per block of a goal's residual (N, R): norms over the sweep's weights, peaks polished.

    evaluate(states) -> (N, R) answers the residual at other states; known rows are taken as they are.
    """
    known = known or {}
    weight = states.weight / states.weight.sum()
    limits = dict(zip(mechanism.driven, mechanism.motor_limits, strict=True)) if goal == "hold" else {}
    blocks = goal_blocks(mechanism, goal)
    sizes = tuple(block.size for block in blocks)
    size = magnitudes(residual, sizes)
    new = np.array([place for place, block in enumerate(blocks) if block.name not in known], dtype=int)
    sampled = size[:, new].reshape(len(sweep.scenarios), len(sweep.poses), -1).max(axis=0)
    every = np.arange(residual.shape[1])
    probe = steepness(mechanism, sweep, goal, evaluate, columns=every, scale=np.ones(len(every)), sizes=sizes)
    peaks = polish(lambda poses, rows: probe(poses, new[rows]), sweep.poses, sampled, sweep.box)
    found = {
        blocks[i].name: Row(
            peak=float(peak),
            sample_peak=float(sample),
            rms=float(np.sqrt(weight @ size[:, i] ** 2)),
            mean=float(weight @ size[:, i]),
            unit=blocks[i].unit,
            limit=float(limits[blocks[i].name]) if np.isfinite(limits.get(blocks[i].name, np.inf)) else None,
        )
        for i, peak, sample in zip(new, peaks.value, peaks.sample, strict=True)
    }
    return {block.name: known.get(block.name) or found[block.name] for block in blocks}


def tables(
    mechanism: Mechanism,
    sweep: Sweep,
    states: States,
    balancers: Sequence[Balancer],
    theta: Array,
    goals: Sequence[str],
) -> tuple[dict[str, Row], dict[str, Row]]:
    """The rows of several goals, without balancers and with them at given values."""
    before: dict[str, Row] = {}
    after: dict[str, Row] = {}
    for goal in goals:

        def bare(other: States, goal: str = goal) -> Array:
            return effort(mechanism, (), other, goal).b

        def evaluate(other: States, goal: str = goal) -> Array:
            if chunks.is_big(balancers, other, len(theta)):
                return chunks.residual(mechanism, balancers, other, goal, theta)
            return effort(mechanism, balancers, other, goal).at(theta)

        without, with_them = bare(states), evaluate(states)
        rows = table(mechanism, sweep, states, without, bare, goal=goal)
        ends = np.cumsum([block.size for block in goal_blocks(mechanism, goal)])
        same = np.logical_and.reduceat((without == with_them).all(axis=0), np.append(0, ends[:-1]))
        untouched = {name: row for (name, row), alike in zip(rows.items(), same, strict=True) if alike}
        before |= rows
        after |= table(mechanism, sweep, states, with_them, evaluate, goal=goal, known=untouched)
    return before, after
