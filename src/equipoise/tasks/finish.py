"""A solved task as a design."""

from __future__ import annotations

from collections.abc import Mapping

from equipoise.affine import Array, Block
from equipoise.assemble import account
from equipoise.certificate import Certificate
from equipoise.design import Design
from equipoise.states import States
from equipoise.tasks.task import Balanced
from equipoise.verbs.analyze import before_and_after


def finish(
    balanced: Balanced,
    certificate: Certificate,
    geometry: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    units: Mapping[str, str] | None = None,
    seed: int = 0,
) -> Design:
    """Put a solved task into words and tables."""
    task, states, unknowns = balanced.task, balanced.states, balanced.program.unknowns

    def bare(other: States) -> tuple[tuple[Block, ...], Array]:
        return account(task.mechanism, (), other, task.objective, {})

    before, after = before_and_after(task.mechanism, task.sweep, states, bare, balanced.account)
    return Design(
        mechanism=task.mechanism,
        balancers=task.balancers,
        sweep=task.sweep,
        states=states,
        objective=task.objective,
        limits=task.limits,
        values={u.name: float(value) for u, value in zip(unknowns, balanced.solution.theta, strict=True)},
        units={u.name: u.unit for u in unknowns} | dict(units or {}),
        before=before,
        after=after,
        certificate=certificate,
        geometry=dict(geometry or {}),
        bounds=dict(bounds or {}),
        seed=seed,
        refined=balanced.refined,
    )
