"""What shall be small: goals, norms, weights and caps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Affine, Array
from equipoise.errors import InputError, nearest
from equipoise.mechanism import Mechanism
from equipoise.solve.program import NORMS, Norm, Term
from equipoise.units import Effort, Number

GOALS = ("hold",)


@dataclass(frozen=True)
class Aim:
    """weight * norm of a goal, or its cap.

    goal `hold`: holding effort of the driven joints; norm rms, peak or mean over the weighted states;
    joints that count (default all); divisor `motor` divides each joint by its motor limit; a cap, in the
    goal's unit, keeps the norm below a value instead of making it small; target is the value that the
    finished design must reach.
    """

    goal: str = "hold"
    norm: Norm = "rms"
    weight: Number = 1.0
    cap: Effort | None = None
    joints: tuple[str, ...] | None = None
    divisor: str | None = None
    target: Effort | None = None

    def __post_init__(self) -> None:
        if self.goal not in GOALS:
            raise InputError(f"there is no goal {self.goal!r}", where="objective", hint=nearest(self.goal, GOALS))
        if self.norm not in NORMS:
            raise InputError(f"there is no norm {self.norm!r}", where="objective", hint=nearest(self.norm, NORMS))
        if self.divisor not in (None, "motor"):
            raise InputError(f"there is no divisor {self.divisor!r}", where="objective", hint="use motor, or leave out")
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

    def scales(self, mechanism: Mechanism) -> Array:
        """Factor of every counted joint's row: 1, or one over its motor limit."""
        joints = self.counted(mechanism)
        if self.divisor is None:
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

    def term(self, mechanism: Mechanism, effort: Affine, weight: Array) -> Term:
        """The term of a program: the counted rows of an effort, scaled; weights (N,) need not sum to one."""
        joints = self.counted(mechanism)
        columns = [effort.rows(joint).start for joint in joints]
        scale = self.scales(mechanism)
        b, A = effort.b[..., columns] * scale, effort.A[..., columns, :] * scale[:, None]
        return Term(self.goal, self.norm, b, A, weight / weight.sum(), (1,) * len(joints), self.weight, self.cap)

    def unit(self, mechanism: Mechanism) -> str:
        """Unit of the norm's value."""
        units = {mechanism.driven_units[mechanism.driven.index(joint)] for joint in self.counted(mechanism)}
        return "of the motor limit" if self.divisor else " or ".join(sorted(units))


def as_objective(norm: Norm | None, objective: Aim | Sequence[Aim] | None) -> tuple[Aim, ...]:
    """A list of aims from a norm word or from aims; at least one must not be a cap."""
    if objective is None:
        return (Aim(norm=norm or "rms"),)
    if norm is not None:
        raise InputError("both norm and objective are given", where="objective", hint="say the norm in the objective")
    aims = (objective,) if isinstance(objective, Aim) else tuple(objective)
    if not any(aim.cap is None for aim in aims):
        raise InputError("the objective has only caps", where="objective", hint="one aim must be without a cap")
    return aims
