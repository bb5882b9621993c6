"""Where the peak rises above its level between the samples of a sweep."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from equipoise.affine import Array, Block, Indices, magnitudes
from equipoise.assemble import effort
from equipoise.objective import goal_blocks, minimised
from equipoise.peaks import polish
from equipoise.solve.exchange import Solution
from equipoise.solve.program import Program
from equipoise.states import States
from equipoise.steepness import steepness
from equipoise.tasks.task import Task

BETWEEN = 1e-7
"""Relative excess over the level that counts."""
NEAR = 0.5
"""Share of the level below which a hill is left alone."""


def between(
    task: Task, states: States, program: Program, solution: Solution, starts: int, level: float | None = None
) -> Array:
    """Poses between the samples whose peak exceeds a level, the solved one by default; none for grids and lists."""
    aims = minimised(task.objective)
    if not task.sweep.sampled or len(aims) > 1 or aims[0].norm != "peak" or aims[0].goal == "mass":
        return task.sweep.coordinates[:0]
    aim = aims[0]
    bare = effort(task.mechanism, (), states, aim.goal, aim.pole)
    blocks = goal_blocks(task.mechanism, aim.goal)
    counted = np.array([blocks.index(block) for block in aim.blocks(task.mechanism)])
    factor = aim.scales(task.mechanism) / aim.before(task.mechanism, np.ones(len(states)), bare)

    def whole(other: States) -> tuple[Sequence[Block], Array]:
        found = effort(task.mechanism, task.balancers, other, aim.goal, aim.pole).expand(program.unknowns)
        return blocks, found.at(solution.theta)

    size = magnitudes(whole(states)[1], [block.size for block in blocks])[:, counted] * factor
    sampled = size.reshape(len(task.sweep.scenarios), len(task.sweep.poses), -1).max(axis=0)
    if level is None:
        level = max(term.value(solution.theta) for term in program.terms if term.cap is None)
    # A row far below the level at every sample does not reach it between them.
    near = np.flatnonzero(sampled.max(axis=0) >= NEAR * level)
    probe = steepness(task.mechanism, task.sweep, blocks, whole)

    def scaled(places: Array, rows: Indices) -> tuple[Array, Array]:
        value, slope = probe(places, counted[near[rows]])
        return value * factor[near[rows]], slope * factor[near[rows], None]

    peaks = polish(scaled, task.sweep.coordinates, sampled[:, near], task.sweep.domain, starts)
    load = max(float(np.abs(term.b).max()) for term in program.terms)
    if not (peaks.value > level * (1 + BETWEEN) + 1e-12 * load).any():
        return peaks.hills[:0]
    # Lower hills come along: they rise as soon as the highest are pressed down.
    return _apart(peaks.hills[peaks.height >= NEAR * level], task.sweep.domain)


def _apart(places: Array, domain: Array | None) -> Array:
    """Coordinates that differ from each other by more than 1e-4 of the domain somewhere."""
    if domain is None or not len(places):
        return places
    span = np.where(domain[:, 1] > domain[:, 0], domain[:, 1] - domain[:, 0], 1.0)
    _, first = np.unique(np.round((places - domain[:, 0]) / span, 4), axis=0, return_index=True)
    return places[np.sort(first)]
