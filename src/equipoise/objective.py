"""What shall be small: goals, norms, weights and caps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from equipoise import platform
from equipoise.affine import Affine, Array, Block
from equipoise.errors import InputError, nearest
from equipoise.mechanism import Mechanism
from equipoise.solve.program import NORMS, Norm, Term
from equipoise.units import Effort, Number

GOALS = ("hold", "wrench")


@dataclass(frozen=True)
class Aim:
    """weight * norm of a goal, or its cap.

    goal `hold`: holding effort of the driven joints; `wrench`: the resultant on a platform;
    norm rms, peak or mean over the weighted states;
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

    def blocks(self, mechanism: Mechanism) -> tuple[Block, ...]:
        """The blocks of rows that count: driven joints, or the resultant."""
        names = self.counted(mechanism)
        return tuple(block for block in goal_blocks(mechanism, self.goal) if block.name in names)

    def counted(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Names of the driven joints, in the mechanism's order, or of the resultant, that count."""
        if self.goal != "hold":
            if self.joints or self.divisor:
                what = "joints" if self.joints else "divisor"
                raise InputError(f"goal {self.goal} has no {what}", where=f"objective.{what}", hint="leave it out")
            return tuple(block.name for block in goal_blocks(mechanism, self.goal))
        for place, joint in enumerate(self.joints or ()):
            if joint not in mechanism.driven:
                hint = nearest(joint, mechanism.driven)
                raise InputError(f"joint {joint!r} is not driven", where="objective.joints", hint=hint)
            if joint in (self.joints or ())[:place]:
                raise InputError(f"joint {joint!r} is named twice", where="objective.joints", hint="name it once")
        return tuple(joint for joint in mechanism.driven if not self.joints or joint in self.joints)

    def scales(self, mechanism: Mechanism) -> Array:
        """Factor of every counted block: 1, or one over the joint's motor limit."""
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
        columns, scale = self.columns(mechanism)
        sizes = tuple(block.size for block in self.blocks(mechanism))
        b, A = effort.b[..., columns] * scale, effort.A[..., columns, :] * scale[:, None]
        return Term(self.goal, self.norm, b, A, weight / weight.sum(), sizes, self.weight, self.cap)

    def columns(self, mechanism: Mechanism) -> tuple[NDArray[np.int_], Array]:
        """Numbers (R,) of the counted rows among the goal's, and the factor (R,) of each."""
        counted, every = self.blocks(mechanism), goal_blocks(mechanism, self.goal)
        first = dict(zip([block.name for block in every], np.cumsum([0, *[b.size for b in every]]), strict=False))
        rows = [np.arange(block.size) + first[block.name] for block in counted]
        return np.concatenate(rows), np.repeat(self.scales(mechanism), [block.size for block in counted])

    def unit(self, mechanism: Mechanism) -> str:
        """Unit of the norm's value."""
        units = {block.unit for block in self.blocks(mechanism)}
        return "of the motor limit" if self.divisor else " or ".join(sorted(units))


def goals_of(objective: Sequence[Aim]) -> tuple[str, ...]:
    """Goals that a design speaks of: `hold` always, then those of its objective."""
    return tuple(dict.fromkeys(["hold", *(aim.goal for aim in objective)]))


def goal_blocks(mechanism: Mechanism, goal: str) -> tuple[Block, ...]:
    """All blocks of rows of a goal."""
    return platform.blocks(mechanism) if goal == "wrench" else mechanism.driven_blocks


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
