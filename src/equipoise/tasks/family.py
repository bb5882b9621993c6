"""The tasks of several cases as one program: what they share, and what each sets for itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from equipoise.affine import Array, Geometry
from equipoise.assemble import Balancer
from equipoise.cases import called, joined, share_of
from equipoise.parameters import candidates, write
from equipoise.solve.exchange import Solution
from equipoise.solve.program import Program
from equipoise.solve.shape import Build, Freedom, Local
from equipoise.states import States
from equipoise.tasks.task import Balanced, Task


@dataclass(frozen=True, eq=False)
class Family:
    """The tasks of all cases, what they share, and what each sets for itself."""

    labels: tuple[str, ...]
    tasks: tuple[Task, ...]
    shared: tuple[Freedom, ...]
    adjusted: tuple[Freedom, ...]
    unknowns: Mapping[str, tuple[float, float] | None]

    @property
    def freedoms(self) -> tuple[Freedom, ...]:
        """Shared geometry first, then every case's own."""
        own = [replace(f, name=called(f.name, label)) for label in self.labels for f in self.adjusted]
        return (*self.shared, *own)

    def columns(self, case: int) -> list[int]:
        """Which of all freedoms a case sees."""
        first = len(self.shared) + case * len(self.adjusted)
        return [*range(len(self.shared)), *range(first, first + len(self.adjusted))]

    def placed(self, case: int, gamma: Geometry) -> tuple[Balancer, ...]:
        """The balancers of a case at candidates gamma (C, G)."""
        names = [f.name for f in (*self.shared, *self.adjusted)]
        return candidates(self.tasks[case].balancers, names, gamma[:, self.columns(case)])

    def programs(self, states: Sequence[States], gamma: Geometry) -> list[Program]:
        """Every case's own program at candidates gamma."""
        return [
            task.program(states[i], self.placed(i, gamma) if len(self.freedoms) else None)
            for i, task in enumerate(self.tasks)
        ]

    def builder(self, states: Sequence[States]) -> Build:
        """gamma (C, G) -> the common program."""
        return lambda gamma: joined(self.programs(states, gamma), self.labels, self.unknowns)

    def at(self, gamma: Array) -> tuple[Task, ...]:
        """The tasks at one geometry."""
        names = [f.name for f in (*self.shared, *self.adjusted)]
        found = []
        for i, task in enumerate(self.tasks):
            values = {name: float(v) for name, v in zip(names, gamma[self.columns(i)], strict=True)}
            found.append(replace(task, balancers=write(task.balancers, values)))
        return tuple(found)

    @cached_property
    def states(self) -> list[States]:
        """The states of every case's sweep."""
        return [task.mechanism.states(task.sweep) for task in self.tasks]

    def parted(self, best: Local) -> list[Balanced]:
        """Every case's own program with its share of the common solution."""
        states = self.states
        tasks, common = self.at(best.gamma), best.solution
        found = []
        for i, (task, own) in enumerate(zip(tasks, states, strict=True)):
            program = task.program(own)
            theta = share_of(common.program, common.theta, program, self.labels[i], self.unknowns)
            theta = np.clip(theta, program.lower, program.upper)
            solution = Solution(theta, program, common.working, common.answer)
            found.append(Balanced(task, own, program, solution, 0))
        return found
