"""What shall be small: goals, norms, weights and caps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from equipoise import platform
from equipoise.affine import Affine, Array, Block
from equipoise.errors import InputError, nearest
from equipoise.mechanism import Mechanism
from equipoise.momentum import FORCE, MASS, MOMENT
from equipoise.solve.program import NORMS, Norm, Term
from equipoise.units import Effort, Length, Number

ORIGIN = (0.0, 0.0, 0.0)
GOALS = ("hold", "drive", "force", "moment", "mass", "wrench")
JOINT_GOALS = ("hold", "drive")
JUDGED = ("nominal", "band")
Judged = Literal["nominal", "band"]


@dataclass(frozen=True)
class Aim:
    """weight * norm of a goal, or its cap.

    goal `hold`: holding effort of the driven joints at rest, `drive`: what their motors supply over a motion;
    `force`, `moment`: the wrench of the base on the mechanism, moment about `pole` (world axes, m); `mass`: all
    that is added; `wrench`: the resultant on a platform. norm rms, peak or mean over the weighted states; joints
    that count (default all); divisor `motor` divides each joint by its motor limit, `before` everything by the
    same norm without balancers; a cap, in the goal's unit, keeps the norm below a value instead of making it
    small; target is the value that the finished design must reach. judged says by which value designs are chosen among
    others and measured against the target: `nominal`, or `band`, the 95 % value under the `tolerances`.
    """

    goal: str = "hold"
    norm: Norm = "rms"
    weight: Number = 1.0
    cap: Effort | None = None
    joints: tuple[str, ...] | None = None
    divisor: str | None = None
    target: Effort | None = None
    pole: tuple[Length, Length, Length] = ORIGIN
    judged: Judged = "nominal"

    def __post_init__(self) -> None:
        if self.goal not in GOALS:
            raise InputError(f"there is no goal {self.goal!r}", where="objective", hint=nearest(self.goal, GOALS))
        if self.norm not in NORMS:
            raise InputError(f"there is no norm {self.norm!r}", where="objective", hint=nearest(self.norm, NORMS))
        if self.divisor not in (None, "motor", "before"):
            hint = "use motor or before, or leave it out"
            raise InputError(f"there is no divisor {self.divisor!r}", where="objective", hint=hint)
        for what, given in (("joints", self.joints), ("divisor", self.divisor == "motor")):
            if self.goal not in JOINT_GOALS and given:
                raise InputError(f"goal {self.goal} has no {what}", where=f"objective.{what}", hint="leave it out")
        if self.judged not in JUDGED:
            raise InputError(
                f"{self.judged!r} is no value to judge by", where="objective.judged", hint="nominal or band"
            )
        if self.judged == "band" and (self.cap is not None or self.goal not in JOINT_GOALS):
            what = "a cap" if self.cap is not None else f"the goal {self.goal}"
            hint = "errors are followed where hold or drive is made small"
            raise InputError(f"{what} has no tolerance band", where="objective.judged", hint=hint)
        if self.goal != "moment" and tuple(self.pole) != ORIGIN:
            raise InputError(f"{self.goal} has no pole", where="objective", hint="a pole belongs to goal: moment")
        for what, value in (("weight", self.weight), ("cap", self.cap), ("target", self.target)):
            if value is not None and not value > 0:
                raise InputError(f"the {what} is {value:g}, it must be positive", where="objective")

    def blocks(self, mechanism: Mechanism) -> tuple[Block, ...]:
        """The blocks of rows that count: driven joints, or the resultant."""
        found = {block.name: block for block in goal_blocks(mechanism, self.goal)}
        return tuple(found[name] for name in self.counted(mechanism))

    def counted(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Names of the driven joints, or of the goal's own rows, that count."""
        if self.goal not in JOINT_GOALS:
            return tuple(block.name for block in goal_blocks(mechanism, self.goal))
        for place, joint in enumerate(self.joints or ()):
            if joint not in mechanism.driven:
                hint = nearest(joint, mechanism.driven)
                raise InputError(f"joint {joint!r} is not driven", where="objective.joints", hint=hint)
            if joint in (self.joints or ())[:place]:
                raise InputError(f"joint {joint!r} is named twice", where="objective.joints", hint="name it once")
        return self.joints or mechanism.driven

    def scales(self, mechanism: Mechanism) -> Array:
        """Factor of every counted block: 1, or one over the joint's motor limit."""
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

    def term(self, mechanism: Mechanism, effort: Affine, weight: Array, bare: Affine | None = None) -> Term:
        """The term of a program: the counted rows of an effort, scaled; weights (N,) need not sum to one.

        bare is the same goal without balancers, which `before` divides by.
        """
        columns, scale = self.columns(mechanism)
        sizes = tuple(block.size for block in self.blocks(mechanism))
        weight = weight / weight.sum() if effort.b.shape[-2] == len(weight) else np.ones(1)
        scale = scale / self.before(mechanism, weight, bare)
        b, A = effort.b[..., columns] * scale, effort.A[..., columns, :] * scale[:, None]
        return Term(self.goal, self.norm, b, A, weight, sizes, self.weight, self.cap)

    def before(self, mechanism: Mechanism, weight: Array, bare: Affine | None) -> float:
        """What the divisor `before` divides by: the norm without balancers; 1 for other divisors."""
        if self.divisor != "before" or bare is None:
            return 1.0
        known = bare.b[..., self.columns(mechanism)[0]]
        sizes = tuple(block.size for block in self.blocks(mechanism))
        norm = Term(self.goal, self.norm, known, np.zeros((*known.shape, 0)), weight, sizes).value(np.zeros(0))
        if not norm > 0:
            raise InputError(f"the {self.goal} is zero before balancing", where="objective", hint="no divisor")
        return float(norm)

    def columns(self, mechanism: Mechanism) -> tuple[NDArray[np.int_], Array]:
        """Numbers (R,) of the counted rows among the goal's, and the factor (R,) of each."""
        counted, every = self.blocks(mechanism), goal_blocks(mechanism, self.goal)
        first = dict(zip([block.name for block in every], np.cumsum([0, *[b.size for b in every]]), strict=False))
        rows = [np.arange(block.size) + first[block.name] for block in counted]
        return np.concatenate(rows), np.repeat(self.scales(mechanism), [block.size for block in counted])

    def unit(self, mechanism: Mechanism) -> str:
        """Unit of the norm's value."""
        units = {block.unit for block in self.blocks(mechanism)}
        shares = {"motor": "of the motor limit", "before": "of the value before"}
        return shares[self.divisor] if self.divisor else " or ".join(sorted(units))


def goal_blocks(mechanism: Mechanism, goal: str) -> tuple[Block, ...]:
    """All blocks of rows of a goal."""
    if goal == "wrench":
        return platform.blocks(mechanism)
    own = {"force": FORCE, "moment": MOMENT, "mass": MASS}
    return (own[goal],) if goal in own else mechanism.driven_blocks


def as_objective(norm: Norm | None, objective: Aim | Sequence[Aim] | None) -> tuple[Aim, ...]:
    """A list of aims from a norm word or from aims; at least one must not be a cap."""
    if objective is None:
        return (Aim(norm=norm or "rms"),)
    if norm is not None:
        raise InputError("both norm and objective are given", where="objective", hint="say the norm in the objective")
    aims = (objective,) if isinstance(objective, Aim) else tuple(objective)
    if not any(aim.cap is None for aim in aims):
        raise InputError("the objective has only caps", where="objective", hint="one aim must be without a cap")
    made_small = [aim for aim in aims if aim.cap is None]
    if any(aim.judged == "band" for aim in made_small[1:]):
        hint = "say `judged: band` in the first aim that is not a cap"
        raise InputError("the tolerance band is that of the first aim", where="objective.judged", hint=hint)
    if {"hold", "drive"} <= {aim.goal for aim in aims}:
        raise InputError("hold is a part of drive: only one of them can count", where="objective", hint="keep drive")
    return aims


def minimised(objective: Sequence[Aim]) -> Sequence[Aim]:
    """The aims that are made small: those without a cap."""
    return tuple(aim for aim in objective if aim.cap is None)


def leading(objective: Sequence[Aim]) -> Aim:
    """The first aim that is made small: its norm and unit speak for the objective."""
    return minimised(objective)[0]


def joint_goal(objective: Sequence[Aim], moving: bool) -> str:
    """What the rows of the driven joints mean: what motors supply over a motion, unless `hold` was asked for."""
    asked = {aim.goal for aim in objective}
    return "drive" if "drive" in asked or (moving and "hold" not in asked) else "hold"


def pole_of(objective: Sequence[Aim]) -> tuple[float, float, float]:
    """Where moments are counted: the pole of the first aim that has one, else the world origin."""
    return next((aim.pole for aim in objective if aim.goal == "moment"), ORIGIN)
