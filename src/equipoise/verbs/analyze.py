"""analyze: what the motors hold, and which joints are worth a spring."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array, Block, magnitudes
from equipoise.assemble import account
from equipoise.design import Row
from equipoise.mechanism import Mechanism
from equipoise.peaks import polish
from equipoise.states import States
from equipoise.sweep import Sweep

Account = Callable[[States], tuple[Sequence[Block], Array]]

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
                joint: row.json() | {"worth_a_spring": joint in self.worth, "reason": self.reasons.get(joint, "")}
                for joint, row in self.rows.items()
            },
            "audit": list(self.mechanism.remarks),
        }

    def __str__(self) -> str:
        from equipoise.reporting.words import analysis

        return analysis(self)


def analyze(mechanism: Mechanism, sweep: Sweep | None = None) -> Analysis:
    """Effort of every driven joint over a sweep (default: 2048 Sobol poses over the joint limits).

    Over poses it is what motors hold; over a motion what they supply, inertia included, and the wrench of the
    base on the mechanism is told beside it (moment about the world origin).
    A joint is not worth a spring where gravity loads it with less than 10 % of the largest effort of its
    unit and less than 2 % of its motor limit. Peaks are polished between the samples.
    """
    sweep = sweep or Sweep.sobol(mechanism)
    states = mechanism.states(sweep)
    rows = table(mechanism, sweep, states, lambda other: account(mechanism, (), other, (), {}))
    loads = {joint: rows[joint] for joint in mechanism.driven}
    if states.rates is not None:
        loads = table(mechanism, sweep, states, lambda other: (mechanism.driven_blocks, other.holding))
    return Analysis(mechanism, sweep, rows, {joint: _reason(joint, loads) for joint in loads})


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


def table(mechanism: Mechanism, sweep: Sweep, states: States, account: Account) -> dict[str, Row]:
    """A row per block of an account (states) -> (blocks, residual): norms over the sweep's weights, peaks polished."""
    weight = states.weight / states.weight.sum()
    blocks, residual = account(states)
    magnitude = magnitudes(residual, [block.size for block in blocks])
    sampled = magnitude.reshape(len(sweep.scenarios), len(sweep.poses), -1).max(axis=0)
    peaks = polish(lambda found: worst(mechanism, sweep, found, account), sweep.coordinates, sampled, sweep.domain)
    limits = dict(zip(mechanism.driven, mechanism.motor_limits, strict=True))
    return {
        block.name: Row(
            peak=float(peaks.value[i]),
            sample_peak=float(peaks.sample[i]),
            rms=float(np.sqrt(weight @ magnitude[:, i] ** 2)),
            mean=float(weight @ magnitude[:, i]),
            unit=block.unit,
            limit=float(limits[block.name]) if np.isfinite(limits.get(block.name, np.inf)) else None,
        )
        for i, block in enumerate(blocks)
    }


def worst(mechanism: Mechanism, sweep: Sweep, coordinates: Array, account: Account) -> Array:
    """Block norms (M, B) at coordinates (M, c) of the sweep, the worst over the payload scenarios."""
    blocks, residual = account(mechanism.states(sweep.at(coordinates)))
    size = magnitudes(residual, [block.size for block in blocks])
    return size.reshape(len(sweep.scenarios), len(coordinates), -1).max(axis=0)
