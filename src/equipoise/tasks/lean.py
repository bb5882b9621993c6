"""Of equally good geometries the one that stores least energy."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from equipoise.affine import Geometry
from equipoise.assemble import thrift
from equipoise.errors import InfeasibleError
from equipoise.objective import minimised
from equipoise.parameters import candidates
from equipoise.solve.exchange import solve
from equipoise.solve.program import Program
from equipoise.solve.shape import Local, descend
from equipoise.tasks.refine import BRIEF, REFINED, refine
from equipoise.tasks.search import COARSE, Search, thinned
from equipoise.tasks.settle import attempt, eased
from equipoise.tasks.starts import NOTHING
from equipoise.tasks.task import Balanced

ALIKE = 1e-3
"""Share by which values may differ and the stored energy still decide."""

PATIENCE = 0.01
"""Share of the stored energy that a few steps of a detour must gain: what it ends at is no optimum anyway."""
SLACK = 2e-7
"""Share of the objective that may be given for less stored energy."""


def spare(search: Search, best: Local, balanced: Balanced, load: float) -> tuple[Local, Balanced]:
    """Among equally good geometries the one with the least stored energy, equally good between the samples too."""
    value = max(balanced.solution.objective, 1e-9 * load)
    if len(minimised(search.task.objective)) > 1:
        return best, balanced
    for _ in range(REFINED):
        # Half of the slack is left to what the search between the samples finds.
        thrifty = _thrifty(search, best, value * (1 + SLACK / 2))
        if thrifty is None:
            break
        try:
            found = attempt(search.at(thrifty.gamma))
        except InfeasibleError:
            break
        if found.broken is None and found.solution.objective <= value * (1 + SLACK):
            return thrifty, found
        if not found.refined:
            break
        search = search.over(found.task.sweep)
    return best, balanced


def relaxed(
    search: Search, best: Local, balanced: Balanced, load: float, detour: float
) -> tuple[Search, Local, Balanced]:
    """As `spare`, by way of geometries that are worse by a share of the load: curved valleys have no other way."""
    states = search.task.mechanism.states(search.task.sweep)
    few = thinned(search.task.sweep, states) if len(search.task.sweep.poses) > COARSE else search.task.sweep
    value = max(balanced.solution.objective, NOTHING * load)
    thrifty = _thrifty(search.over(few), best, value + detour * load, patience=PATIENCE)
    if thrifty is None:
        return search, best, balanced
    options: dict[str, Any] = {"precision": 0.1 * ALIKE * value / load, "iterations": BRIEF}
    back = descend(search.builder(states), search.freedoms, thrifty.gamma, load, radius=0.02, **options)
    try:
        wider, back, found = refine(search, back, load, **options)
    except InfeasibleError:
        return search, best, balanced
    as_good = back.excess <= 1e-6 and found.solution.objective <= value * (1 + ALIKE)
    spared = _stored(search, back, found) < _stored(search, best, balanced)
    return (wider, back, found) if as_good and spared else (search, best, balanced)


def _stored(search: Search, at: Local, balanced: Balanced) -> float:
    """The largest stored energy of a solution, J."""
    energy = thrift(balanced.program, search.at(at.gamma).balancers, balanced.states, 1.0).terms[0]
    return float(energy.value(balanced.solution.theta))


def _thrifty(search: Search, best: Local, value: float, patience: float = 0.0) -> Local | None:
    """The geometry that keeps the objective below a value with the least stored energy, if that is worth a move.

    patience is the share of the energy that a few steps together must gain for the next.
    """
    states = search.task.mechanism.states(search.task.sweep)
    names = [freedom.name for freedom in search.freedoms]
    plain = search.builder(states)

    def lean(gamma: Geometry) -> Program:
        return thrift(plain(gamma), candidates(search.task.balancers, names, gamma), states, value)

    start = lean(best.gamma[None]).take(0)
    present = solve(eased(plain(best.gamma[None]).take(0)))
    stored = start.terms[0].value(present.theta)
    if not stored > 0:
        return None
    options: dict[str, Any] = {"radius": 0.1, "iterations": 30, "precision": 1e-5, "patience": patience}
    thrifty = descend(lean, search.freedoms, best.gamma, stored, **options)
    worth = thrifty.solution.objective <= 0.99 * stored or present.objective > value
    return replace(best, gamma=thrifty.gamma) if thrifty.excess <= 1e-6 and worth else None
