"""What shall be small: goals, norms, weights and caps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Affine, Array
from equipoise.errors import InputError, nearest
from equipoise.mechanism import Mechanism
from equipoise.solve.program import NORMS, Norm, Term
from equipoise.units import Effort, Length, Number

ORIGIN = (0.0, 0.0, 0.0)
GOALS = ("hold", "drive", "force", "moment", "mass")
JOINT_GOALS = ("hold", "drive")
UNITS = {"force": "N", "moment": "N m", "mass": "kg"}


@dataclass(frozen=True)
class Aim:
    """weight * norm of a goal, or its cap.

    goal `hold`: holding effort of the driven joints at rest, `drive`: what their motors supply over a motion;
    `force`, `moment`: the wrench of the base on the mechanism, moment about `pole` (world axes, m); `mass`: all
    that is added. norm rms, peak or mean over the weighted states; joints that count (default all); divisor
    `motor` divides each joint by its motor limit, `before` everything by the same norm without balancers; a cap,
    in the goal's unit, keeps the norm below a value instead of making it small; target is the value that the
    finished design must reach.
    """

    goal: str = "hold"
    norm: Norm = "rms"
    weight: Number = 1.0
    cap: Effort | None = None
    joints: tuple[str, ...] | None = None
    divisor: str | None = None
    target: Effort | None = None
    pole: tuple[Length, Length, Length] = ORIGIN

    def __post_init__(self) -> None:
        if self.goal not in GOALS:
            raise InputError(f"there is no goal {self.goal!r}", where="objective", hint=nearest(self.goal, GOALS))
        if self.norm not in NORMS:
            raise InputError(f"there is no norm {self.norm!r}", where="objective", hint=nearest(self.norm, NORMS))
        if self.divisor not in (None, "motor", "before"):
            hint = "use motor or before, or leave it out"
            raise InputError(f"there is no divisor {self.divisor!r}", where="objective", hint=hint)
        if self.goal not in JOINT_GOALS and (self.joints or self.divisor == "motor"):
            raise InputError(f"{self.goal} has no joints and no motors", where="objective", hint="leave them out")
        if self.goal != "moment" and tuple(self.pole) != ORIGIN:
            raise InputError(f"{self.goal} has no pole", where="objective", hint="a pole belongs to goal: moment")
        for what, value in (("weight", self.weight), ("cap", self.cap), ("target", self.target)):
            if value is not None and not value > 0:
                raise InputError(f"the {what} is {value:g}, it must be positive", where="objective")

    def counted(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Names of the driven joints that count."""
        for joint in self.joints or ():
            if joint not in mechanism.driven:
                hint = nearest(joint, mechanism.driven)
                raise InputError(f"joint {joint!r} is not driven", where="objective.joints", hint=hint)
        return self.joints or mechanism.driven

    def rows(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Names of a design's rows that count: joints, or the goal itself."""
        return self.counted(mechanism) if self.goal in JOINT_GOALS else (self.goal,)

    def scales(self, mechanism: Mechanism) -> Array:
        """Factor of every counted joint's row: 1, or one over its motor limit."""
        joints = self.counted(mechanism)
        if self.divisor != "motor":
            return np.ones(len(joints))
        limits = np.array([mechanism.motor_limits[mechanism.driven.index(joint)] for joint in joints])
        missing = [joint for joint, limit in zip(joints, limits, strict=True) if not np.isfinite(limit)]
        if missing:
            raise InputError(
                f"the file states no motor limit for {', '.join(missing)}",
                where="objective.divisor",
                hint="leave the divisor out, or name the `joints` that have one",
            )
        return 1.0 / limits

    def term(self, mechanism: Mechanism, effort: Affine, bare: Affine, weight: Array) -> Term:
        """The term of a program: the counted rows of an effort, scaled; weights (N,) need not sum to one.

        bare is the same goal without balancers, which `before` divides by.
        """
        weight = weight / weight.sum() if effort.b.shape[-2] == len(weight) else np.ones(1)
        if self.goal in JOINT_GOALS:
            columns = [effort.rows(joint).start for joint in self.counted(mechanism)]
            scale, sizes = self.scales(mechanism), (1,) * len(columns)
        else:
            columns, sizes = list(range(effort.b.shape[-1])), tuple(block.size for block in effort.blocks)
            scale = np.ones(len(columns))
        known = bare.b[..., columns] * scale
        if self.divisor == "before":
            before = Term(self.goal, self.norm, known, np.zeros((*known.shape, 0)), weight, sizes).value(np.zeros(0))
            if not before > 0:
                raise InputError(f"the {self.goal} is zero before balancing", where="objective", hint="no divisor")
            scale = scale / before
        b, A = effort.b[..., columns] * scale, effort.A[..., columns, :] * scale[:, None]
        return Term(self.goal, self.norm, b, A, weight, sizes, self.weight, self.cap)

    def unit(self, mechanism: Mechanism) -> str:
        """Unit of the norm's value."""
        if self.divisor:
            return "of the motor limit" if self.divisor == "motor" else "of the value before"
        if self.goal not in JOINT_GOALS:
            return UNITS[self.goal]
        return " or ".join(
            sorted({mechanism.driven_units[mechanism.driven.index(joint)] for joint in self.counted(mechanism)})
        )


def as_objective(norm: Norm | None, objective: Aim | Sequence[Aim] | None) -> tuple[Aim, ...]:
    """A list of aims from a norm word or from aims; at least one must not be a cap."""
    if objective is None:
        return (Aim(norm=norm or "rms"),)
    if norm is not None:
        raise InputError("both norm and objective are given", where="objective", hint="say the norm in the objective")
    aims = (objective,) if isinstance(objective, Aim) else tuple(objective)
    if not any(aim.cap is None for aim in aims):
        raise InputError("the objective has only caps", where="objective", hint="one aim must be without a cap")
    if {"hold", "drive"} <= {aim.goal for aim in aims}:
        raise InputError("hold is a part of drive: only one of them can count", where="objective", hint="keep drive")
    return aims


def joint_goal(objective: Sequence[Aim], moving: bool) -> str:
    """What the rows of the driven joints mean: what motors supply over a motion, unless `hold` was asked for."""
    asked = {aim.goal for aim in objective}
    return "drive" if "drive" in asked or (moving and "hold" not in asked) else "hold"


def pole_of(objective: Sequence[Aim]) -> tuple[float, float, float]:
    """Where moments are counted: the pole of the first aim that has one, else the world origin."""
    return next((aim.pole for aim in objective if aim.goal == "moment"), ORIGIN)
