"""One balancing question, and the same question solved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from equipoise.affine import Array, Block
from equipoise.assemble import Balancer, account, build, check
from equipoise.errors import InfeasibleError, InputError
from equipoise.limits import Limit
from equipoise.mechanism import Mechanism
from equipoise.objective import Aim, as_objective, minimised
from equipoise.solve.exchange import Solution
from equipoise.solve.program import Norm, Program
from equipoise.states import States
from equipoise.sweep import Sweep


@dataclass(frozen=True, eq=False)
class Task:
    """One balancing question: what moves, what is added, where, and what shall be small or kept."""

    mechanism: Mechanism
    balancers: tuple[Balancer, ...]
    sweep: Sweep
    objective: tuple[Aim, ...]
    limits: tuple[Limit, ...]

    def program(self, states: States, balancers: Sequence[Balancer] | None = None) -> Program:
        """The program over given states, at this or another geometry."""
        return build(self.mechanism, balancers or self.balancers, self.sweep, states, self.objective, self.limits)


@dataclass(frozen=True, eq=False)
class Balanced:
    """A solved task: its states (those found between the samples included), program and solution.

    refined counts the poses found between the samples; broken says which limits cannot be kept at the last of them,
    which task and states have and the solution does not know.
    """

    task: Task
    states: States
    program: Program
    solution: Solution
    refined: int
    broken: InfeasibleError | None = None

    @property
    def values(self) -> dict[str, float]:
        """The solution by name."""
        return {u.name: float(v) for u, v in zip(self.program.unknowns, self.solution.theta, strict=True)}

    def account(self, states: States) -> tuple[tuple[Block, ...], Array]:
        """Blocks and residual (N, R) that the design reports, with the solution's values, at any states."""
        task = self.task
        return account(task.mechanism, task.balancers, states, task.objective, self.values)


def task_of(
    mechanism: Mechanism,
    balancers: Sequence[Balancer],
    sweep: Sweep,
    norm: Norm | None,
    objective: Aim | Sequence[Aim] | None,
    limits: Sequence[Limit],
) -> Task:
    """Check the pieces of a question and put them together."""
    if not balancers:
        raise InputError("there is no balancer", where="balancers", hint="add a spring or a counterweight")
    check(mechanism, balancers)
    return Task(mechanism, tuple(balancers), sweep, as_objective(norm, objective), tuple(limits))


def unit_of(task: Task) -> str:
    """Unit of the objective; a sum over goals of different units says so."""
    units = list(dict.fromkeys(aim.unit(task.mechanism) for aim in minimised(task.objective)))
    return units[0] if len(units) == 1 else f"weighted sum of {', '.join(units)}"
