"""What a solver sees: norms of affine residuals to make small, linear rows to keep, bounds on unknowns."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from equipoise.affine import Array, Indices, Unknown, magnitudes

Norm = Literal["rms", "peak", "mean"]
NORMS: tuple[Norm, ...] = ("rms", "peak", "mean")
ROUNDING = 1e-12
"""Share of the largest slope of its unit below which an unknown does not move a residual."""
NEGLIGIBLE = 1e-6
"""A constant residual this small beside what the limits call up does not set the scale."""


@dataclass(frozen=True, eq=False)
class Term:
    """factor * N(b + A theta), or the cap N(b + A theta) <= cap where one is given.

    b (..., N, R), A (..., N, R, P) already divided by motor limits where asked; weight (N,) sums to one;
    sizes (B,) rows per block; norms over states n and blocks B:
    rms = sqrt(sum_n w_n sum_B |r_nB|^2), mean = sum_n w_n sum_B |r_nB|, peak = max_nB |r_nB|.
    """

    name: str
    norm: Norm
    b: Array
    A: Array
    weight: Array
    sizes: tuple[int, ...]
    factor: float = 1.0
    cap: float | None = None

    @cached_property
    def triangle(self) -> Array:
        """R (P + 1, P + 1), upper triangular, with |R [theta; 1]| equal to the rms norm of b + A theta."""
        width = self.A.shape[-1] + 1
        stacked = np.concatenate([self.A, self.b[..., None]], axis=-1) * np.sqrt(self.weight)[:, None, None]
        factor = np.linalg.qr(stacked.reshape(-1, width), mode="r")
        return np.vstack([factor, np.zeros((width - len(factor), width))])

    def residual(self, theta: Array) -> Array:
        """r (N, R)."""
        return self.b + self.A @ theta

    def magnitudes(self, r: Array) -> Array:
        """Block norms (N, B) of a residual (N, R)."""
        return magnitudes(r, self.sizes)

    def value(self, theta: Array) -> float:
        """The norm at theta, without the factor."""
        return float(norm_value(self.norm, self.magnitudes(self.residual(theta)), self.weight))


def norm_value(norm: Norm, magnitudes: Array, weight: Array) -> Array:
    """A norm (...) of block magnitudes (..., N, B) under weights (N,) that sum to one."""
    if norm == "peak":
        return magnitudes.max(axis=(-2, -1))
    if norm == "rms":
        return np.sqrt((magnitudes**2).sum(-1) @ weight)
    return magnitudes.sum(-1) @ weight


@dataclass(frozen=True, eq=False)
class Rows:
    """G theta <= h, or = h for equality rows, that one limit answers.

    G (..., M, P) over the program's unknowns, h (..., M); limit says in words what is kept, unit is that
    of h, state (M,) the sweep row behind each (-1: none); scale > 0 makes violations comparable.
    """

    limit: str
    unit: str
    G: Array
    h: Array
    unknowns: tuple[Unknown, ...] = ()
    state: Indices | None = None
    equality: bool = False
    scale: float = 1.0

    def expand(self, unknowns: tuple[Unknown, ...]) -> Rows:
        """The same rows over the program's list of unknowns."""
        if not self.unknowns:
            # One zero that stands for all: there may be a row for each of a million states.
            nothing = np.broadcast_to(np.zeros((), dtype=self.G.dtype), (*self.h.shape, len(unknowns)))
            return replace(self, G=nothing, unknowns=unknowns)
        place = {unknown.name: index for index, unknown in enumerate(unknowns)}
        wide = np.zeros((*self.h.shape, len(unknowns)), dtype=self.G.dtype)
        wide[..., [place[unknown.name] for unknown in self.unknowns]] = self.G
        return replace(self, G=wide, unknowns=unknowns)

    @property
    def fixed(self) -> bool:
        """Whether no unknown moves any row, as `expand` says it."""
        return not any(self.G.strides)

    def excess(self, theta: Array) -> Array:
        """How far each row is beyond its limit (M,), in the limit's unit; negative is slack."""
        gap = -self.h if self.fixed else self.G @ theta - self.h
        return np.abs(gap) if self.equality else gap


@dataclass(frozen=True, eq=False)
class Definite:
    """S0 + sum_p theta_p S_p positive semidefinite: mass parameters that a body can have.

    S (P, k, k) symmetric over `unknowns`, S0 (k, k); limit says in words what is kept.
    """

    limit: str
    S: Array
    S0: Array
    unknowns: tuple[Unknown, ...] = ()

    def expand(self, unknowns: tuple[Unknown, ...]) -> Definite:
        """The same condition over the program's list of unknowns."""
        place = {unknown.name: index for index, unknown in enumerate(unknowns)}
        wide = np.zeros((len(unknowns), *self.S0.shape))
        wide[[place[unknown.name] for unknown in self.unknowns]] = self.S
        return replace(self, S=wide, unknowns=unknowns)

    def matrix(self, theta: Array) -> Array:
        """S0 + sum theta S (k, k)."""
        return self.S0 + np.tensordot(theta, self.S, axes=1)

    def excess(self, theta: Array) -> float:
        """How negative the least eigenvalue is, as a share of the largest."""
        values = np.linalg.eigvalsh(self.matrix(theta))
        return float(-values[0] / max(values[-1], 1e-9))


@dataclass(frozen=True, eq=False)
class Program:
    """min sum of terms over theta, subject to caps, rows, definite matrices and the unknowns' own bounds."""

    unknowns: tuple[Unknown, ...]
    terms: tuple[Term, ...]
    rows: tuple[Rows, ...] = ()
    definite: tuple[Definite, ...] = ()

    @cached_property
    def scale(self) -> Array:
        """Units (P,) in which every unknown moves the residuals, or else the limits, about equally."""
        size = np.zeros(len(self.unknowns))
        for term in self.terms:
            load, slope = float(np.sqrt((term.b**2).mean())), np.sqrt((term.A**2).mean(axis=(0, 1)))
            if load > NEGLIGIBLE * self._called_up(slope):
                size = np.maximum(size, self._felt(slope) / load)
        for rows in self.rows:
            if rows.h.size and not rows.fixed:
                size = np.where(size > 0, size, np.abs(rows.G).max(axis=0) / rows.scale)
        for definite in self.definite:
            # one kg of matrix: an inertia that no residual feels must not be counted in rounding errors
            size = np.maximum(size, np.abs(definite.S).max(axis=(1, 2)))
        return 1.0 / np.where(size > 0, size, 1.0)

    def _felt(self, slope: Array) -> Array:
        """Slopes (P,) without those that are rounding errors beside the largest of their unit."""
        largest: dict[str, float] = {}
        for unknown, value in zip(self.unknowns, slope.tolist(), strict=True):
            largest[unknown.unit] = max(largest.get(unknown.unit, 0.0), value)
        floor = np.array([ROUNDING * largest[unknown.unit] for unknown in self.unknowns])
        return np.where(slope > floor, slope, 0.0)

    @property
    def called_up(self) -> float:
        """What the limits make of the objective where zero does not keep them, to its order of magnitude."""
        slopes = [(term.factor, np.sqrt((term.A**2).mean(axis=(0, 1)))) for term in self.terms if term.cap is None]
        return sum(factor * self._called_up(slope) for factor, slope in slopes)

    def _called_up(self, slope: Array) -> float:
        """Residual that the limits ask for where zero does not keep them, through the cheapest unknown of each row."""
        found = 0.0
        for rows in self.rows:
            wanting = rows.h < 0
            if wanting.any() and rows.G.shape[-1] and not rows.fixed:
                reach = np.abs(rows.G[wanting])
                with np.errstate(divide="ignore", invalid="ignore"):
                    price = np.where(reach > 0, -rows.h[wanting][:, None] * slope / reach, np.inf).min(axis=1)
                found = max(found, float(price[np.isfinite(price)].max(initial=0.0)))
        return found

    @cached_property
    def loads(self) -> tuple[float, ...]:
        """What each term's residual is measured by: its largest constant, or what scaled unknowns make of it."""
        found = []
        for term in self.terms:
            constant, moved = (float(np.abs(part).max(initial=0.0)) for part in (term.b, term.A * self.scale))
            found.append((constant if constant > NEGLIGIBLE * moved else moved) or 1.0)
        return tuple(found)

    def bounded(self, unknowns: tuple[Unknown, ...]) -> Program:
        """The same program with other bounds of its unknowns, on which neither scale nor loads depend."""
        other = replace(self, unknowns=unknowns)
        vars(other).update(scale=self.scale, loads=self.loads)
        return other

    @property
    def lower(self) -> Array:
        """Lower bounds (P,)."""
        return np.array([unknown.lower for unknown in self.unknowns])

    @property
    def upper(self) -> Array:
        """Upper bounds (P,)."""
        return np.array([unknown.upper for unknown in self.unknowns])

    def objective(self, theta: Array) -> float:
        """The weighted sum of norms without caps."""
        return sum(term.factor * term.value(theta) for term in self.terms if term.cap is None)

    def violation(self, theta: Array) -> float:
        """The largest scaled excess over rows, caps and bounds; zero where all are kept."""
        worst = [0.0]
        worst += [float(rows.excess(theta).max()) / rows.scale for rows in self.rows if rows.h.shape[-1]]
        worst += [term.value(theta) / term.cap - 1 for term in self.terms if term.cap]
        worst += [definite.excess(theta) for definite in self.definite]
        if len(theta):
            span = np.maximum(1.0, np.abs(theta))
            worst += [float(((self.lower - theta) / span).max()), float(((theta - self.upper) / span).max())]
        return max(worst)

    def take(self, index: int) -> Program:
        """One candidate of a program with a leading candidate axis."""
        terms = tuple(replace(t, b=_pick(t.b, 2, index), A=_pick(t.A, 3, index)) for t in self.terms)
        rows = tuple(replace(r, G=_pick(r.G, 2, index), h=_pick(r.h, 1, index)) for r in self.rows)
        return replace(self, terms=terms, rows=rows)


def _pick(array: Array, rank: int, index: int) -> Array:
    return array[index] if array.ndim > rank else array
