"""What every real spring answers: it is a law whose numbers are those of a part one can buy or make."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Self

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws.law import Law, Share
from equipoise.errors import InputError

TOLERANCE = 1e-6
"""Share of its scale by which a part may miss what it needs before it is refused: what `shape` leaves at a bound."""


@dataclass(frozen=True)
class Fault:
    """What a part needs to be made: room >= 0, a number or rows, of the size `scale`, in `unit`.

    reason names the fault where the room is negative, said tells it of the first row, hint what to do.
    """

    reason: str
    room: Any
    scale: float
    said: str
    hint: str
    unit: str = ""

    @property
    def rows(self) -> Any:
        """Which rows have the fault."""
        return ~(np.real(np.asarray(self.room)) >= -TOLERANCE * self.scale)


@dataclass(frozen=True)
class Clause:
    """One clause of a part's strength: what acts, what is allowed, both SI, and where the allowance comes from."""

    name: str
    acts: float
    allowed: float
    unit: str
    source: str

    @property
    def used(self) -> float:
        """The share of the allowance that is used."""
        return self.acts / self.allowed


@dataclass(frozen=True)
class Part(Law):
    """Common ground of real springs: all their numbers are known, none is left to the program.

    Fields may be numbers or arrays of rows. `number` springs act in parallel; `leader` is a rod or wire, m, between
    spring and hook, so that the spring's own length is l - leader. A number that cannot be made raises InputError; in
    arrays of rows `faults` says which rows and why.
    """

    def __post_init__(self) -> None:
        numbers = [getattr(self, field.name) for field in fields(self)]
        if all(np.ndim(value) == 0 and np.isrealobj(value) for value in numbers if not isinstance(value, str)):
            for fault in self.faults():
                if np.any(fault.rows):
                    raise InputError(fault.said, where=f"part {self.kind}", hint=fault.hint)

    kind: ClassVar[str] = ""

    @classmethod
    def of_rows(cls, **columns: Any) -> Self:
        """Many parts at once: every field a column of rows (C,), or one value that all share."""
        return cls(**columns)

    @property
    def defined_beyond(self) -> bool:
        """The force line goes on where the part would break or touch: a limit not kept, not a law without a value."""
        return True

    @property
    def span_words(self) -> str:
        """What ends the working range."""
        return "working range"

    def faults(self) -> Iterator[Fault]:
        """Every reason for which the part cannot be made, with the room that is left before it."""
        yield from ()

    def clauses(self, length: Array) -> Iterator[Clause]:  # noqa: ARG002
        """What the part bears over lengths (N,)."""
        yield from ()

    @property
    def unsourced(self) -> tuple[str, ...]:
        """What of its numbers has no source that was opened."""
        return ()

    @abstractmethod
    def order_line(self) -> str:
        """How the part is ordered."""

    def record(self, length: Array) -> dict[str, Any]:
        """Order line, utilisation over lengths (N,) and what is unsourced, as design.json holds them."""
        used = {clause.name: vars(clause) | {"used": clause.used} for clause in self.clauses(length)}
        return {
            "order": self.order_line(),
            "part_number": getattr(self, "part", "") or None,
            "number": float(np.real(getattr(self, "number", 1.0))),
            "clauses": used,
            "unsourced": list(self.unsourced),
        }


@dataclass(frozen=True)
class StraightPart(Part):
    """A part with a straight force line f = tension + k (l - rest)."""

    @property
    @abstractmethod
    def k(self) -> Any:
        """Rate, N/m or N m/rad, of all the springs in parallel."""

    @property
    @abstractmethod
    def rest(self) -> Any:
        """Length, m or angle, rad, at which the tension acts."""

    @property
    def tension(self) -> Any:
        """Force at rest, N or N m, of all the springs in parallel."""
        return 0.0

    def shares(self, length: Array) -> tuple[Share, ...]:
        """Rate and tension, both given."""
        one = np.ones_like(length)
        stretch = length - self.rest
        return (
            Share("k", "N/m or N m/rad", self.k, stretch, stretch * stretch / 2, one),
            Share("tension", "N or N m", self.tension, one, stretch, 0.0 * one),
        )

    def parameters(self, values: Mapping[str, float]) -> dict[str, float]:
        """All parameters, and the length at rest."""
        return super().parameters(values) | {"rest": float(np.real(self.rest))}

    def parameter_units(self, along: str = "m") -> dict[str, str]:
        """SI units of everything that `parameters` may name."""
        return super().parameter_units(along) | {"rest": along}

    def details(self, values: Mapping[str, float], length: Array) -> dict[str, tuple[Any, str]]:
        """How far the part's material and working range are used over lengths (N,)."""
        found = {f"{clause.name}, used": (100 * clause.used, "%") for clause in self.clauses(length)}
        low, high = self.span
        if low is not None and high is not None:
            ends = (length.min() - self.rest, length.max() - self.rest)
            reach = max(high - self.rest, self.rest - low)
            found["working range, used"] = (100 * float(max(map(abs, ends)) / reach), "%")
        return found | super().details(values, length)
