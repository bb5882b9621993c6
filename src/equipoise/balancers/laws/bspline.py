"""A force that is a spline of the length, in B-splines of its interval."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.balancers.laws.law import FORCE, Law, Share
from equipoise.errors import InputError
from equipoise.units import Extent, Pull

MOST_PIECES = 4096


@dataclass(frozen=True)
class BSpline(Law):
    """f = sum_i c_i N_i(l), N_i the B-splines of a degree on an interval cut into pieces, clamped at its ends.

    interval (low, high) in m or rad holds all lengths of the sweep; pieces of equal length, or given interior
    knots; piece_degree d is 0 .. 5 (3: continuous curvature, as a cam needs it); c_i in N or N m,
    i = 0 .. pieces + d - 1, coefficients None where the program finds them.
    All N_i >= 0 and sum_i N_i = 1. The energy counts from low:

        V = sum_i c_i (t_{i+d+1} - t_i) / (d + 1) sum_{j > i} N_j^{d+1},   t the knots

    Beyond the interval the end pieces go on. Raises InputError for an empty interval, no piece, a degree outside
    0..5, knots that do not increase inside the interval, or coefficients of another number.
    """

    interval: tuple[Extent, Extent]
    pieces: int = 8
    piece_degree: int = 3
    knots: tuple[Extent, ...] | None = None
    coefficients: tuple[Pull, ...] | None = None
    along: ClassVar[tuple[str, ...]] = ("m", "rad")

    def __post_init__(self) -> None:
        low, high = self.interval
        where = "law bspline"
        if not low < high:
            raise InputError(f"the interval [{low}, {high}] is empty", where=where, hint="write the lower end first")
        if not 0 <= self.piece_degree <= 5:
            raise InputError(f"the degree is {self.piece_degree}, it must lie in 0..5", where=where)
        if not 1 <= self.pieces <= MOST_PIECES:
            raise InputError(f"{self.pieces} pieces, it must be 1 to {MOST_PIECES}", where=where)
        inner = np.array([low, *(self.knots or ()), high])
        if (np.diff(inner) <= 0).any():
            raise InputError("the knots must increase inside the interval", where=where)
        if self.coefficients is not None and len(self.coefficients) != self.count:
            raise InputError(f"{len(self.coefficients)} coefficients, this spline takes {self.count}", where=where)

    @property
    def degree(self) -> None:
        """A spline is no polynomial."""
        return

    @property
    def breaks(self) -> tuple[float, ...]:
        """Lengths between which the force is one polynomial, the interval's ends left out."""
        low, high = self.interval
        return self.knots if self.knots is not None else tuple(np.linspace(low, high, self.pieces + 1)[1:-1].tolist())

    @property
    def count(self) -> int:
        """Number of coefficients."""
        return len(self.breaks) + 1 + self.piece_degree

    @property
    def span(self) -> tuple[float, float]:
        """The interval."""
        return self.interval

    @property
    def span_words(self) -> str:
        """What the ends of the span are called."""
        return "interval"

    @cached_property
    def _clamped(self) -> Array:
        low, high = self.interval
        return np.array(
            [*[low] * (self.piece_degree + 1), *self.breaks, *[high] * (self.piece_degree + 1)], dtype=float
        )

    def shares(self, length: Array) -> tuple[Share, ...]:
        """One share per coefficient."""
        given = self.coefficients or (None,) * self.count
        basis, integral, slope = (
            np.moveaxis(self._columns(length, what), -1, 0) for what in ("basis", "integral", "slope")
        )
        return tuple(Share(f"c{i}", FORCE, given[i], basis[i], integral[i], slope[i]) for i in range(self.count))

    def _split(self, length: Array, what: str) -> tuple[Array, Array]:
        columns = self._columns(length, what)
        if self.coefficients is None:
            return columns, np.zeros_like(length)
        return np.zeros((*length.shape, 0), dtype=length.dtype), columns @ np.array(self.coefficients)

    def _columns(self, length: Array, what: str) -> Array:
        """Basis, integral or slope (..., N, P) of every coefficient."""
        knots, d, n = self._clamped, self.piece_degree, self.count
        if what == "basis":
            return spline_basis(length, knots, d)
        if what == "slope":
            if d == 0:
                return np.zeros((*length.shape, n), dtype=length.dtype)
            lower = spline_basis(length, knots[1:-1], d - 1) * (d / (knots[d + 1 : n + d] - knots[1:n]))
            zero = np.zeros((*length.shape, 1), dtype=length.dtype)
            return np.concatenate([zero, lower], axis=-1) - np.concatenate([lower, zero], axis=-1)
        higher = spline_basis(length, np.concatenate([knots[:1], knots, knots[-1:]]), d + 1)
        above = np.flip(np.cumsum(np.flip(higher, -1), -1), -1)[..., 1:]
        return above * ((knots[d + 1 :] - knots[:n]) / (d + 1))


def spline_basis(x: Array, knots: Array, degree: int) -> Array:
    """All B-splines (..., N, P) of a degree on clamped knots at x (..., N), by Cox and de Boor's recurrence."""
    count = len(knots) - degree - 1
    span: NDArray[np.intp] = np.clip(np.searchsorted(knots, np.real(x), side="right") - 1, degree, count - 1)
    local = np.zeros((degree + 1, *x.shape), dtype=x.dtype)
    local[0] = 1.0
    for k in range(1, degree + 1):
        saved = np.zeros_like(x)
        for j in range(k):
            right, left = knots[span + j + 1], knots[span + j + 1 - k]
            share = local[j] / (right - left)
            local[j] = saved + (right - x) * share
            saved = (x - left) * share
        local[k] = saved
    found = np.zeros((*x.shape, count), dtype=x.dtype)
    first = np.arange(x.size) * count + (span - degree).ravel()
    flat = found.reshape(-1)
    for j in range(degree + 1):
        flat[first + j] = local[j].ravel()
    return found
