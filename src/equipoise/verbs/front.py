"""front: what the objective can become for every amount of something that costs, such as added mass."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from equipoise.assemble import Balancer
from equipoise.errors import InfeasibleError, InputError
from equipoise.limits import Limit
from equipoise.mechanism import Mechanism
from equipoise.objective import Aim, as_objective, goal_blocks
from equipoise.sweep import Sweep
from equipoise.tasks import task_of, tightened, unit_of

ABOVE = 1e-6
"""How far above the least amount the front begins, relatively: at the least itself nothing is free."""
SPAN = 7.0
"""How far beyond the least amount it goes by itself, in units of that amount or of a share of what moves."""
SHARE = 0.2


@dataclass(frozen=True, eq=False)
class Step:
    """One point of a front: at most `cap`, then at best `value` (a proven bound is `dual`), with these unknowns.

    price is what one more unit of the cap takes off the value.
    """

    cap: float
    value: float
    dual: float
    price: float
    values: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Front:
    """Steps of growing caps on a goal: the convex curve below which no design of these parts can get."""

    objective: str
    unit: str
    against: str
    against_unit: str
    least: float
    steps: tuple[Step, ...]

    def json(self) -> dict[str, Any]:
        """Plain data."""
        about = {"objective": self.objective, "unit": self.unit, "against": self.against, "least": self.least}
        return about | {"against_unit": self.against_unit, "steps": [vars(step) for step in self.steps]}

    def write(self, out: Path) -> list[Path]:
        """Write `front.json` and `front.png` to a folder."""
        from equipoise.reporting import style
        from equipoise.reporting.jsonfile import dumps

        data, picture = out / "front.json", out / "front.png"
        data.write_text(dumps(self.json()), encoding="utf-8")
        with style.styled():
            made = style.figure(6.4, 3.8)
            axes = made.add_subplot()
            axes.plot([s.cap for s in self.steps], [s.value for s in self.steps], "o-", color=style.AFTER)
            axes.set_xlabel(f"{self.against}, {self.against_unit}")
            axes.set_ylabel(f"{self.objective}, {self.unit}")
            axes.set_ylim(0, None)
            made.savefig(picture, dpi=150)
        return [data, picture]

    def __str__(self) -> str:
        from equipoise.reporting.balance import front_text

        return front_text(self)


def front(
    mechanism: Mechanism,
    balancers: Sequence[Balancer],
    sweep: Sweep,
    *,
    objective: Aim | Sequence[Aim],
    against: str = "mass",
    caps: Sequence[float] | None = None,
    points: int = 8,
    limits: Sequence[Limit] = (),
) -> Front:
    """The best value of an objective under caps on a goal: moment against added mass, by default.

        f(c) = min_theta sum of the objective's norms   subject to the limits and N(goal `against`) <= c

    f is convex and falls, every point is a cone program with its own dual bound. caps are in the goal's unit (kg for
    mass; the peak norm of others); without them `points` caps grow from the least amount that the limits allow.
    Where the objective has a cap on the same goal, it is left out.

    Raises InputError for caps that do not grow or are not positive, InfeasibleError for one below the least amount.
    """
    aims = tuple(a for a in as_objective(None, objective) if not (a.cap is not None and a.goal == against))
    named = " + ".join(f"{a.norm} {a.goal}" for a in aims if a.cap is None)
    if any(a.goal == against and a.cap is None for a in aims):
        raise InputError(f"{against} is the objective itself", where="front.against", hint="name what it costs")
    if caps is not None and (not len(caps) or any(c <= 0 for c in caps) or any(np.diff(caps) <= 0)):
        raise InputError(f"the caps {list(caps)} do not grow", where="front.caps", hint="give positive, growing ones")
    if not 2 <= points <= 200:
        raise InputError(f"{points} points", where="front.points", hint="use 2 to 200")
    price = Aim(against, norm="peak", cap=1.0)
    task = task_of(mechanism, balancers, sweep, None, (*aims, price), limits)
    states = mechanism.states(sweep)
    whole = task.program(states)
    *wanted, cost = whole.terms
    cheap = replace(whole, terms=(*(term for term in wanted if term.cap is not None), replace(cost, cap=None)))
    least = tightened(task, cheap)[1].objective
    if caps is None:
        step = max(least, SHARE * mechanism.mass) if against == "mass" else max(least, 1e-3 * cost.value(_zero(whole)))
        grown = least + step * (np.geomspace(1.0, 1.0 + SPAN, points) - 1.0)
        caps = np.maximum(grown, (least or 1e-3 * step) * (1 + ABOVE)).tolist()
    elif caps[0] < least:
        raise InfeasibleError(
            f"{against} cannot be kept at {caps[0]:.6g}: the limits ask for {least:.6g} at least",
            where="front.caps",
            hint="begin higher",
        )
    steps = []
    for cap in caps or ():
        program, solution = tightened(
            task, replace(whole, terms=(*wanted, replace(cost, cap=max(cap, least * (1 + ABOVE)))))
        )
        values = {u.name: float(v) for u, v in zip(program.unknowns, solution.theta, strict=True)}
        steps.append(Step(float(cap), solution.objective, solution.gap.dual, solution.answer.cap[-1], values))
    unit = goal_blocks(mechanism, against)[0].unit
    return Front(named, unit_of(task), against, unit, least, tuple(steps))


def _zero(program: Any) -> np.ndarray:
    return np.clip(np.zeros(len(program.unknowns)), program.lower, program.upper)
