"""Limits on a spring's force curve for every length of an interval, not only at samples.

A polynomial or a spline is a polynomial on each of its pieces, so a limit starts from Chebyshev lengths, is solved,
and the worst lengths, which are roots of a derivative, are added until none is outside.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, cast, runtime_checkable

import numpy as np
from numpy.polynomial import legendre

from equipoise import units
from equipoise.affine import Array
from equipoise.balancers.laws.law import Law
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError
from equipoise.limits.limit import Setting
from equipoise.limits.sides import path_unit, sides
from equipoise.solve.program import Rows

START = 4
"""Chebyshev lengths per coefficient of a piece to begin with."""
FORCE_PER_ORDER = ("N or N m", "N/m or N m/rad", "N/m^2 or N m/rad^2")
WORDS = ("force", "slope", "curvature")


@runtime_checkable
class Curve(Protocol):
    """A limit over an interval: the sum of derivatives of the force, `orders`, weighed by `weights`."""

    orders: ClassVar[tuple[int, ...]]
    """Which derivatives of the force are added up."""

    @property
    def spring(self) -> str:
        """The spring's name."""
        ...

    @property
    def min(self) -> float | None:
        """Lower bound."""
        ...

    @property
    def max(self) -> float | None:
        """Upper bound."""
        ...

    @property
    def over(self) -> tuple[float, float] | None:
        """The interval of lengths."""
        ...

    @property
    def samples(self) -> int | None:
        """How many equally spaced lengths are asked for, None for all."""
        ...


class OverInterval:
    """A limit that holds for every length of an interval: what is outside is found and added."""

    spring: str
    over: Any
    samples: int | None

    def rows_at(self, spring: Spring, lengths: Array) -> tuple[Rows, ...]:
        """Rows at given lengths."""
        return rows(cast("Curve", self), spring, lengths)

    def outside(self, spring: Spring, values: Mapping[str, float], tolerance: float) -> Array:
        """Local worst lengths (M,) that leave the limits by more than tolerance times their size."""
        return outside(cast("Curve", self), spring, values, tolerance)


@dataclass(frozen=True)
class Slope(OverInterval):
    """min <= df/dl <= max for every length over (low, high), N/m or N m/rad; min 0 makes the force monotone."""

    spring: str
    over: tuple[units.Extent, units.Extent]
    max: units.Rate | None = None
    min: units.Rate | None = None
    samples: int | None = None
    orders: ClassVar[tuple[int, ...]] = (1,)

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """Rows at Chebyshev lengths of every piece."""
        return rows(self, setting.find(self.spring, Spring, "slope"))


@dataclass(frozen=True)
class Curvature(OverInterval):
    """|d2f/dl2| <= max for every length over (low, high), N/m^2 or N m/rad^2."""

    spring: str
    over: tuple[units.Extent, units.Extent]
    max: units.Bend
    samples: int | None = None
    orders: ClassVar[tuple[int, ...]] = (2,)

    @property
    def min(self) -> float:
        """The same bound downwards."""
        return -self.max

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """Rows at Chebyshev lengths of every piece."""
        return rows(self, setting.find(self.spring, Spring, "curvature"))


@dataclass(frozen=True)
class Convex(OverInterval):
    """A cam beside a round drum stays convex: f + r^2 d2f/dl2 >= 0 for every length over (low, high).

    radius r of the drum, m (angles: 1 / its ratio). This is the cam of a soft spring, whose arm follows the force;
    of a stiffer one, see `make`. Linear in the coefficients, so convexity is part of the program.
    """

    spring: str
    over: tuple[units.Extent, units.Extent]
    radius: units.Length
    samples: int | None = None
    orders: ClassVar[tuple[int, ...]] = (0, 2)

    @property
    def min(self) -> float:
        """Convex from here on."""
        return 0.0

    @property
    def max(self) -> None:
        """No upper bound."""
        return

    @property
    def weights(self) -> tuple[float, float]:
        """Of the force and of its curvature."""
        return 1.0, self.radius**2

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """Rows at Chebyshev lengths of every piece."""
        if not self.radius > 0:
            raise InputError(f"the drum's radius is {self.radius:g} m", where="limit convex", hint="give it above 0")
        return rows(self, setting.find(self.spring, Spring, "convex"))


@dataclass(frozen=True, eq=False)
class Pieces:
    """A law's force over an interval as polynomials: edges (K + 1,), and per piece the Legendre coefficients.

    C (K, d + 1, P) theta + c0 (K, d + 1).
    """

    edges: Array
    C: Array
    c0: Array

    @staticmethod
    def of(law: Law, over: Sequence[float]) -> Pieces:
        """Cut an interval at the law's breaks; raises InputError for a law that is no polynomial between them."""
        low, high = (float(end) for end in over)
        if not low < high:
            raise InputError(f"the interval [{low:g}, {high:g}] is empty", where="limits", hint="lower end first")
        degree = getattr(law, "piece_degree", law.degree)
        if degree is None:
            raise InputError(
                f"the force of {type(law).__name__} is no polynomial: a limit over an interval cannot be certified",
                where="limits",
                hint="leave `over` out: the limit then holds at every state of the sweep",
            )
        inner = [float(edge) for edge in getattr(law, "breaks", ()) if low < edge < high]
        edges = np.array([low, *inner, high])
        x, w = legendre.leggauss(degree + 1)
        half = np.diff(edges) / 2
        lengths = (edges[:-1] + half)[:, None] + half[:, None] * x
        basis, known = law.force_basis(lengths)
        project = (legendre.legvander(x, degree) * w[:, None]).T * (np.arange(degree + 1) + 0.5)[:, None]
        return Pieces(edges, np.einsum("ij,kjp->kip", project, basis), known @ project.T)

    def start(self) -> Array:
        """Chebyshev lengths of every piece, its ends included; fewer where there are many pieces."""
        count = START * self.C.shape[1] + 1 if len(self.C) == 1 else max(2, self.C.shape[1])
        x = -np.cos(np.pi * np.arange(count) / (count - 1))
        half = np.diff(self.edges)[:, None] / 2
        return np.unique(np.concatenate([(self.edges[:-1, None] + half + half * x).ravel(), self.edges]))

    def derived(self, orders: Sequence[int], weights: Sequence[float]) -> Pieces:
        """The weighted sum of derivatives."""
        half = np.diff(self.edges)[:, None, None] / 2

        def derivative(part: Array, order: int) -> Array:
            whole = np.zeros_like(part)
            lower = legendre.legder(part, order, axis=1) if order < part.shape[1] else part[:, :1] * 0.0
            whole[:, : lower.shape[1]] = lower
            return whole / half**order

        C = sum(weight * derivative(self.C, order) for order, weight in zip(orders, weights, strict=True))
        c0 = sum(weight * derivative(self.c0[..., None], order) for order, weight in zip(orders, weights, strict=True))
        return Pieces(self.edges, np.asarray(C), np.asarray(c0)[..., 0])

    def at(self, lengths: Array) -> tuple[Array, Array]:
        """Basis (M, P) and known part (M,) at lengths (M,)."""
        piece = np.clip(np.searchsorted(self.edges, lengths, side="right") - 1, 0, len(self.edges) - 2)
        half = np.diff(self.edges)[piece] / 2
        x = (lengths - self.edges[piece]) / half - 1.0
        V = legendre.legvander(x, self.C.shape[1] - 1)
        return np.einsum("mi,mip->mp", V, self.C[piece]), np.einsum("mi,mi->m", V, self.c0[piece])

    def extremes(self, theta: Array, low: float = math.inf, high: float = -math.inf) -> tuple[Array, Array]:
        """Lengths (M,) of stationary points and edges, and the values (M,) there, each on its own piece.

        Pieces that stay within low .. high, because |P_i| <= 1, are not searched; by default all are.
        """
        lengths, values = [], []
        coefficients = self.C @ theta + self.c0
        swing = np.abs(coefficients[:, 1:]).sum(axis=1)
        safe = (coefficients[:, 0] - swing >= low) & (coefficients[:, 0] + swing <= high)
        for k, c in enumerate(coefficients):
            half = (self.edges[k + 1] - self.edges[k]) / 2
            slope = legendre.legtrim(legendre.legder(c), 1e-13 * max(float(np.abs(c).max()), 1e-300))
            roots = legendre.legroots(slope) if len(slope) > 1 and not safe[k] else np.zeros(0)
            real = np.real(roots[(np.abs(np.imag(roots)) < 1e-7) & (np.abs(np.real(roots)) < 1)])
            x = np.concatenate([[-1.0], real, [1.0]])
            lengths.append(self.edges[k] + half * (1 + x))
            values.append(legendre.legval(x, c))
        return np.concatenate(lengths), np.concatenate(values)


def pieces_of(limit: Curve, spring: Spring) -> Pieces:
    """What a limit bounds, over its interval."""
    assert limit.over is not None
    return Pieces.of(spring.law, limit.over).derived(limit.orders, _weights(limit))


def rows(limit: Curve, spring: Spring, lengths: Array | None = None) -> tuple[Rows, ...]:
    """Rows of a limit at given lengths; by default where it starts, or at the samples that it asks for."""
    pieces = pieces_of(limit, spring)
    if lengths is None:
        lengths = pieces.start() if limit.samples is None else _samples(limit)
    basis, known = pieces.at(lengths)
    unit = path_unit(FORCE_PER_ORDER[limit.orders[-1] if len(limit.orders) == 1 else 0], spring)
    what = WORDS[limit.orders[0]] if len(limit.orders) == 1 else "convexity"
    assert limit.over is not None
    ends = " to ".join(units.text(end, spring.path.unit) for end in limit.over)
    made = sides(f"{what} of {limit.spring} over {ends}", unit, basis, known, spring.unknowns, limit.min, limit.max)
    return tuple(Rows(r.limit, r.unit, r.G, r.h, r.unknowns, None, scale=_scale(limit, basis)) for r in made)


def outside(limit: Curve, spring: Spring, values: Mapping[str, float], tolerance: float) -> Array:
    """Lengths (M,) at which a limit is exceeded by more than tolerance times its scale: local worst points."""
    pieces = pieces_of(limit, spring)
    theta = np.array([values[unknown.name] for unknown in spring.unknowns])
    low = -math.inf if limit.min is None else limit.min
    lengths, value = pieces.extremes(theta, low, math.inf if limit.max is None else limit.max)
    beyond = np.maximum(
        np.zeros_like(value) if limit.min is None else limit.min - value,
        np.zeros_like(value) if limit.max is None else value - limit.max,
    )
    return np.unique(lengths[beyond > tolerance * _scale(limit, pieces.at(lengths)[0])])


def _weights(limit: Curve) -> tuple[float, ...]:
    return getattr(limit, "weights", (1.0,) * len(limit.orders))


def _samples(limit: Curve) -> Array:
    assert limit.over is not None
    assert limit.samples is not None
    if limit.samples < 1:
        raise InputError(f"{limit.samples} samples", where="limits.samples", hint="leave it out to certify all lengths")
    return np.linspace(*limit.over, limit.samples)


def _scale(limit: Curve, basis: Array) -> float:
    bounds = [abs(bound) for bound in (limit.min, limit.max) if bound]
    return min(bounds) if bounds else max(float(np.abs(basis).max(initial=0.0)), math.ulp(1.0))
