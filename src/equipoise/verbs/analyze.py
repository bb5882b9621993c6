"""analyze: what the motors hold, and which joints are worth a spring."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from equipoise.affine import magnitudes
from equipoise.assemble import account
from equipoise.instants import between
from equipoise.mechanism import Mechanism
from equipoise.peaks import polish
from equipoise.row import Row
from equipoise.states import States
from equipoise.steepness import Account, steepness
from equipoise.sweep import Sweep

if TYPE_CHECKING:
    from equipoise.cables.survey import Survey
    from equipoise.machinery import Machine

WORTH_SHARE = 0.1
WORTH_MOTOR = 0.02
NOTHING = 1e-9


@dataclass(frozen=True, eq=False)
class Analysis:
    """Holding effort of the bare mechanism per driven joint, which are worth a spring and why, the mass audit."""

    mechanism: Mechanism
    sweep: Sweep
    rows: dict[str, Row]
    reasons: dict[str, str]
    states: States

    @cached_property
    def machine(self) -> Machine | None:
        """Motors and bearings over a motion; None for poses at rest."""
        from equipoise.machinery import machine

        return machine(self.mechanism, self.sweep, self.states)

    @cached_property
    def cables(self) -> Survey | None:
        """Where cables hold a platform and how well, at up to 400 poses; None for anything else."""
        platform = self.mechanism.platform
        if platform is None or not platform.cables:
            return None
        from equipoise.cables.survey import looked_at, survey

        return survey(self.mechanism.states(self.sweep.at_poses(looked_at(self.sweep))))

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
            "cables": None if self.cables is None else self.cables.json(),
            **({"machine": self.machine.json()} if self.machine else {}),
        }

    def __str__(self) -> str:
        from equipoise.reporting.words import analysis

        return analysis(self)


def analyze(mechanism: Mechanism, sweep: Sweep | None = None) -> Analysis:
    """Effort of every driven joint over a sweep (default: 2048 Sobol poses over the joint limits).

    Over poses it is what motors hold; over a motion what they supply, inertia included, and the wrench of the
    base on the mechanism is told beside it (moment about the world origin).
    A joint is not worth a spring where gravity loads it with less than 10 % of the largest effort of its
    unit and less than 2 % of its motor limit. Peaks are polished between the samples. Of a cable platform up to 400
    poses are surveyed: wrench closure, feasibility, clearance, stiffness.
    """
    sweep = sweep or Sweep.sobol(mechanism)
    states = mechanism.states(sweep)
    rows = table(mechanism, sweep, states, lambda other: account(mechanism, (), other, (), {}))
    loads = {joint: rows[joint] for joint in mechanism.driven}
    if states.rates is not None:
        loads = table(mechanism, sweep, states, lambda other: (mechanism.driven_blocks, other.holding))
    return Analysis(mechanism, sweep, rows, {joint: _reason(joint, loads) for joint in loads}, states)


def _reason(joint: str, rows: dict[str, Row]) -> str:
    row = rows[joint]
    largest = max(other.peak for other in rows.values() if other.unit == row.unit)
    if row.peak <= max(1e-6 * largest, NOTHING):
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
    mechanism: Mechanism, sweep: Sweep, states: States, account: Account, known: Mapping[str, Row] | None = None
) -> dict[str, Row]:
    """A row per block of an account: norms over the sweep's weights, peaks polished; known rows stay as they are."""
    known = known or {}
    weight = states.weight / states.weight.sum()
    blocks, residual = account(states)
    magnitude = magnitudes(residual, [block.size for block in blocks])
    new = np.array([place for place, block in enumerate(blocks) if block.name not in known], dtype=int)
    sampled = magnitude[:, new].reshape(len(sweep.scenarios), len(sweep.poses), -1).max(axis=0)
    if sweep.instants is None:
        probe = steepness(mechanism, sweep, blocks, account)
        peak = polish(lambda places, rows: probe(places, new[rows]), sweep.coordinates, sampled, sweep.domain).value
    else:
        sizes = [block.size for block in blocks]
        peak = between(mechanism, sweep, sampled, lambda other: magnitudes(account(other)[1], sizes)[:, new])
    limits = dict(zip(mechanism.driven, mechanism.motor_limits, strict=True))
    found = {
        blocks[i].name: Row(
            peak=float(high),
            sample_peak=float(sample),
            rms=float(np.sqrt(weight @ magnitude[:, i] ** 2)),
            mean=float(weight @ magnitude[:, i]),
            unit=blocks[i].unit,
            limit=float(limits[blocks[i].name]) if np.isfinite(limits.get(blocks[i].name, np.inf)) else None,
        )
        for i, high, sample in zip(new, peak, sampled.max(axis=0), strict=True)
    }
    return {block.name: known.get(block.name) or found[block.name] for block in blocks}


def before_and_after(
    mechanism: Mechanism, sweep: Sweep, states: States, bare: Account, balanced: Account
) -> tuple[dict[str, Row], dict[str, Row]]:
    """Tables without and with balancers; rows that no balancer touches are judged once."""
    before = table(mechanism, sweep, states, bare)
    (blocks, without), (_, with_them) = bare(states), balanced(states)
    starts = np.cumsum([0, *[block.size for block in blocks[:-1]]])
    alike = np.logical_and.reduceat((without == with_them).all(axis=0), starts)
    untouched = {block.name: before[block.name] for block, same in zip(blocks, alike, strict=True) if same}
    return before, table(mechanism, sweep, states, balanced, untouched)
