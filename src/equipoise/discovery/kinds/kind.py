"""What every kind of candidate answers: columns of effort, bounds, and the balancer that a chosen one becomes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.assemble import Balancer
from equipoise.balancers.spring import Spring
from equipoise.discovery.ground import Ground
from equipoise.limits import Limit
from equipoise.mechanism import Point
from equipoise.states import States

if TYPE_CHECKING:
    from equipoise.discovery.lattice import Spots
    from equipoise.parts.makeable import Makeable

Counted = Callable[[Array], Array]
"""Effort (..., N, nd) to the rows (..., N R) that the objective counts, scaled."""


@dataclass(frozen=True, eq=False)
class Scene:
    """What columns are computed over: the ground, states of one payload scenario, the rows that count, filters.

    keep says which candidates may stay, by what they were refused, from places (C, 3) on both bodies of a pair (and
    the gap, m, that their lines need to bodies); meets whether coils on a body, from a to b (C, 3), run into another;
    refused counts the others by reason.
    """

    ground: Ground
    states: States
    counted: Counted
    pairs: tuple[tuple[Spots, Spots], ...]
    joints: tuple[str, ...]
    bodies: tuple[Spots, ...]
    keep: Callable[..., Mapping[str, NDArray[np.bool_]]]
    meets: Callable[[str, Array, Array, float], NDArray[np.bool_]]
    refused: Counter[str] = field(default_factory=Counter)

    def weights(self, body: str) -> Array:
        """Counted efforts (rows, 4) of a mass of 1 kg at (1, x, y, z) of a body, m: at its origin, and per metre."""
        corners = np.vstack([np.zeros(3), np.eye(3)])
        there = self.states.weight_effort(Point.many(body, corners), 1.0)
        found = self.counted(np.broadcast_to(there, (4, *there.shape[-2:])))
        return np.vstack([found[:1], found[1:] - found[0]]).T

    def sift(self, count: int, reasons: Mapping[str, NDArray[np.bool_]]) -> NDArray[np.bool_]:
        """Which of `count` candidates no reason refuses; the first reason that refuses one is counted."""
        kept = np.ones(count, dtype=bool)
        for reason, bad in reasons.items():
            self.refused[reason] += int((kept & bad).sum())
            kept &= ~bad
        return kept


@dataclass(frozen=True, eq=False)
class Proposal:
    """A candidate as a balancer: its limits, the geometry that may move {parameter: (low, high)}, its own unknowns.

    measured makes of the shaped spring and its values what is built: what a search leaves open (the cable's length)
    is cut to measure, and limits follow. None where nothing is. mass, kg, is the own mass at the most of its unknown,
    which goes with it.
    """

    balancer: Balancer
    limits: tuple[Limit, ...] = ()
    free: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    measured: Callable[[Spring, Mapping[str, float]], tuple[Spring, tuple[Limit, ...]]] | None = None
    mass: float = 0.0


@dataclass(frozen=True, eq=False)
class Batch:
    """C candidates of one kind at one place: column c is generators @ coefficients[:, c], per unit of its unknown.

    generators (rows, g) and coefficients (g, C), or None for as many columns as generators; upper (C,) is the most
    of each unknown; spot (C,) numbers the places, which variants of one place share; propose(index, name) makes the
    balancer of a candidate.
    """

    place: str
    generators: Array
    coefficients: Array | None
    upper: Array
    spot: NDArray[np.intp]
    propose: Callable[[int, str], Proposal]
    letter: str = "s"

    def __len__(self) -> int:
        return len(self.upper)

    def times(self, right: Array) -> Array:
        """Columns (rows, C) times a matrix (C, m)."""
        return self.generators @ (right if self.coefficients is None else self.coefficients @ right)

    def under(self, left: Array) -> Array:
        """A matrix (m, rows) times the columns."""
        return left @ self.generators if self.coefficients is None else (left @ self.generators) @ self.coefficients

    def column(self, index: int) -> Array:
        """One column (rows,)."""
        if self.coefficients is None:
            return self.generators[:, index]
        return self.generators @ self.coefficients[:, index]


class Kind(ABC):
    """A kind of candidate: it makes batches of columns on a scene."""

    sources: ClassVar[tuple[str, ...]] = ()
    lines: ClassVar[bool] = False
    """Whether its candidates are couples of points on pairs of bodies."""

    def made(self, make: Makeable) -> Kind:  # noqa: ARG002 - kinds that are no wound springs stay
        """The kind with springs that can be wound."""
        return self

    @abstractmethod
    def batches(self, scene: Scene) -> list[Batch]:
        """All candidates of this kind."""

    @property
    @abstractmethod
    def words(self) -> str:
        """What the kind is called in reports."""
