"""A task with geometry left free, and what a search over it needs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from equipoise.affine import Array
from equipoise.assemble import Balancer, effort
from equipoise.errors import InputError
from equipoise.objective import minimised
from equipoise.parameters import candidates, reaches, read, unit_of, write
from equipoise.solve.shape import Build, Freedom
from equipoise.states import States
from equipoise.sweep import Sweep
from equipoise.tasks.task import Task

COARSE = 400
"""Poses that most of a search is done on."""


@dataclass(frozen=True, eq=False)
class Search:
    """A task with its freedoms: builders over few and over all states."""

    task: Task
    freedoms: tuple[Freedom, ...]

    def builder(self, states: States) -> Build:
        """gamma (C, G) -> the program of all candidates at once."""
        names = [freedom.name for freedom in self.freedoms]
        return lambda gamma: self.task.program(states, candidates(self.task.balancers, names, gamma))

    def over(self, sweep: Sweep) -> Search:
        """The same search over another sweep."""
        return replace(self, task=replace(self.task, sweep=sweep))

    def at(self, gamma: Array) -> Task:
        """The task at one geometry."""
        values = {freedom.name: float(value) for freedom, value in zip(self.freedoms, gamma, strict=True)}
        return replace(self.task, balancers=write(self.task.balancers, values))

    @property
    def present(self) -> Array | None:
        """The given geometry (1, G) as a start, where it lies inside the bounds."""
        gamma = [read(self.task.balancers, freedom.name) for freedom in self.freedoms]
        inside = [v is not None and f.lower <= v <= f.upper for f, v in zip(self.freedoms, gamma, strict=True)]
        return np.array([gamma], dtype=float) if all(inside) else None


def freedom_of(balancers: Sequence[Balancer], name: str, bounds: tuple[float, float]) -> Freedom:
    """One parameter with its bounds; raises InputError where they are none."""
    low, high = (float(bound) for bound in bounds)
    if not (np.isfinite(low) and np.isfinite(high)):
        raise InputError(f"the bounds of {name} are not finite", where=f"shape.{name}")
    if low >= high:
        raise InputError(
            f"the bounds of {name} are reversed or equal: [{low:g}, {high:g}]",
            where=f"shape.{name}",
            hint="write the lower bound first, or give the value in the balancer instead",
        )
    return Freedom(name, unit_of(balancers, name), low, high)


def once(balancers: Sequence[Balancer], free: Mapping[str, tuple[float, float]]) -> None:
    """Raise InputError where two names free the same parameter."""
    owner: dict[str, str] = {}
    for name in free:
        for parameter in reaches(balancers, name):
            if parameter in owner:
                raise InputError(
                    f"{owner[parameter]} and {name} free the same parameter", where=f"shape.{name}", hint="keep one"
                )
            owner[parameter] = name


def load_of(task: Task, states: States) -> float:
    """The objective of the bare mechanism, which makes tolerances and penalties relative; zero without any load."""
    load = 0.0
    for aim in minimised(task.objective):
        bare = effort(task.mechanism, (), states, aim.goal, aim.pole)
        if np.any(bare.b):
            load += aim.weight * aim.term(task.mechanism, bare, states.weight, bare).value(np.zeros(0))
    return load


def thinned(sweep: Sweep, states: States, count: int = COARSE) -> Sweep:
    """About `count` of the sweep's poses: an even choice and the most loaded ones."""
    even = np.linspace(0, len(sweep.poses) - 1, count * 3 // 4).astype(int)
    loads = np.abs(states.holding).reshape(len(sweep.scenarios), len(sweep.poses), -1).max(axis=0)
    heavy = np.argsort(-loads, axis=0)[: max(1, count // 4 // loads.shape[1])].ravel()
    keep = np.union1d(even, heavy)
    return sweep.thinned(keep)
