"""balance: the best values of all unknowns at a given geometry, with a certificate."""

from __future__ import annotations

from collections.abc import Sequence

from equipoise.assemble import Balancer
from equipoise.balancers.counterweight import Counterweight
from equipoise.design import Design
from equipoise.errors import InfeasibleError
from equipoise.limits import Balanced as InAllMotions
from equipoise.limits import Limit
from equipoise.limits.balanced import WORDS
from equipoise.mechanism import Mechanism
from equipoise.objective import Aim
from equipoise.solve.program import Norm
from equipoise.sweep import Sweep
from equipoise.tasks import Task, certify, finish, settle, task_of


def balance(
    mechanism: Mechanism,
    balancers: Sequence[Balancer],
    sweep: Sweep,
    *,
    norm: Norm | None = None,
    objective: Aim | Sequence[Aim] | None = None,
    limits: Sequence[Limit] = (),
) -> Design:
    """Find all unknowns of the balancers at their given geometry: one convex program with a certificate.

    min_theta N(b + A theta) subject to the limits; norm rms, peak or mean (default rms), or `objective` for
    weights, caps, joints and divisors. With a Sobol sweep and the peak norm, poses between the samples that
    exceed the peak are added until none does. Raises InfeasibleError naming the limits that conflict.
    """
    task = task_of(mechanism, balancers, sweep, norm, objective, limits)
    try:
        balanced = settle(task)
    except InfeasibleError as error:
        raise _reasoned(task, error) from None
    return finish(balanced, certify(balanced))


def _reasoned(task: Task, error: InfeasibleError) -> InfeasibleError:
    """Why balance for all motions is out of reach, where added mass alone shall bring it."""
    asked = next((limit for limit in task.limits if isinstance(limit, InAllMotions)), None)
    if asked is None or not all(isinstance(balancer, Counterweight) for balancer in task.balancers):
        return error
    from equipoise.reporting.balance import completion_text
    from equipoise.verbs.conditions import conditions

    on = list(dict.fromkeys(b.at.body for b in task.balancers if isinstance(b, Counterweight)))
    found = conditions(task.mechanism, asked.balanced, on=on).completion
    if found.possible:
        return error
    more = (
        "put counterweights on other bodies too" if asked.balanced == "force" else "add a counter-rotor or a flywheel"
    )
    return InfeasibleError(
        f"{error.message}\n{completion_text(found, WORDS[asked.balanced])}",
        where=error.where,
        hint=f"{more}; `equipoise conditions` lists what masses must keep",
    )
