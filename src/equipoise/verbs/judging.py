"""Candidates judged over all states: every norm, and the worst limit with the state where it is passed."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.parts.ranking import Line
from equipoise.solve.program import NORMS, Program, norm_value

KEPT = 1e-6
"""Relative excess of a limit over all states up to which it is kept."""
TOGETHER = 60_000
"""States times candidates that are judged at once, so that arrays stay small."""

Rows = NDArray[np.intp]
Many = Callable[[Rows, Array], Program]


@dataclass(frozen=True, eq=False)
class Judged:
    """Candidates over all states: the norms (K, 3), the objective (K,), and the worst limit with its state (K,).

    size (K,) is what a least squares fit makes small: the root of all terms' squares.
    """

    norms: Array
    value: Array
    size: Array
    excess: Array
    limit: NDArray[np.object_]
    worst: Rows

    @classmethod
    def over(cls, many: Many, states: int, gamma: Array, theta: Array) -> Judged:
        """Judge candidates gamma (K, G), theta (K, P) over that many states."""
        size = max(1, TOGETHER // states)
        parts = [np.arange(start, min(start + size, len(gamma))) for start in range(0, len(gamma), size)]
        found = [_judged(many(part, gamma[part]), theta[part]) for part in parts]
        return cls(*(np.concatenate([getattr(one, what) for one in found]) for what in cls.__dataclass_fields__))

    @property
    def amiss(self) -> Array:
        """The excess (K,) of what is refused, zero for what is kept."""
        return np.where(self.excess > KEPT, self.excess, 0.0)

    def take(self, at: Rows) -> Judged:
        """Some of the candidates."""
        return Judged(*(getattr(self, what)[at] for what in self.__dataclass_fields__))

    def updated(self, at: Rows, other: Judged) -> Judged:
        """These candidates with some judged anew."""
        whole = {what: getattr(self, what).copy() for what in self.__dataclass_fields__}
        for what, values in whole.items():
            values[at] = getattr(other, what)
        return replace(self, **whole)

    def line(self, k: int, part: str, number: float, gamma: Array) -> Line:
        """The line of one candidate."""
        value, (peak, rms, mean), excess = float(self.value[k]), self.norms[k].tolist(), float(self.excess[k])
        refused = _reason(self.limit[k], part) if excess > KEPT else ""
        return Line(part, int(number), value, peak, rms, mean, tuple(gamma[k].tolist()), refused, excess)


@dataclass(frozen=True, eq=False)
class Best:
    """Where each of a chunk's parts is best so far: gamma (K, G), theta (K, P), and how that is judged."""

    gamma: Array
    theta: Array
    judged: Judged

    @classmethod
    def of(cls, count: int, which: Rows, gamma: Array, theta: Array, judged: Judged) -> Best:
        """The best of each of `count` parts among ends, `which` (E,) tells whose; a part without any has no value."""
        order = np.lexsort((judged.value, judged.amiss, which))
        place = np.searchsorted(which[order], np.arange(count))
        there = np.minimum(place, len(order) - 1)
        first = order[there]
        found = judged.take(first)
        none = which[first] != np.arange(count)
        found.value[none], found.excess[none] = np.inf, np.inf
        return cls(gamma[first], theta[first], found)

    def better_of(self, other: Best) -> Best:
        """Of each part the better one."""
        ours = (
            np.lexsort(
                (
                    np.stack([self.judged.value, other.judged.value]),
                    np.stack([self.judged.amiss, other.judged.amiss]),
                ),
                axis=0,
            )[0]
            == 0
        )
        at = np.flatnonzero(ours)
        gamma, theta = other.gamma.copy(), other.theta.copy()
        gamma[at], theta[at] = self.gamma[at], self.theta[at]
        return Best(gamma, theta, other.judged.updated(at, self.judged.take(at)))


def _judged(program: Program, theta: Array) -> Judged:
    """Norms and limits of a program with a leading axis of candidates at their unknowns theta (K, P)."""
    count = len(theta)
    terms = [term for term in program.terms if term.cap is None]
    value, square, norms = np.zeros(count), np.zeros(count), np.zeros((count, 3))
    for term in reversed(terms):
        sizes = np.broadcast_to(term.magnitudes(_at(term.b, term.A, theta)), (count, len(term.weight), len(term.sizes)))
        each = {norm: norm_value(norm, sizes, term.weight) for norm in NORMS}
        norms = np.stack([each["peak"], each["rms"], each["mean"]], axis=1)
        value = value + term.factor * each[term.norm]
        square = square + (term.factor * each["rms"]) ** 2
    excess, limit, worst = np.zeros(count), np.full(count, "", dtype=object), np.full(count, -1)
    for rows in program.rows:
        if not rows.h.shape[-1]:
            continue
        gap = -np.broadcast_to(rows.h, (count, rows.h.shape[-1])) / rows.scale
        gap = gap if rows.fixed else gap + (rows.G @ theta[..., None])[..., 0] / rows.scale
        gap = np.abs(gap) if rows.equality else gap
        row = gap.argmax(axis=1)
        most = gap[np.arange(count), row]
        worse = most > excess
        excess = np.where(worse, most, excess)
        limit[worse] = rows.limit
        worst = np.where(worse, -1 if rows.state is None else rows.state[row], worst)
    return Judged(norms, value, np.sqrt(square), excess, limit, worst)


def _at(b: Array, A: Array, theta: Array) -> Array:
    """b + A theta (K, N, R)."""
    return b + (A @ theta[:, None, :, None])[..., 0] if theta.shape[1] else b


def _reason(limit: str, part: str) -> str:
    """A limit in words that do not name the part's own numbers, so that reasons can be counted."""
    return re.split(r" \(| <= | >= ", limit, maxsplit=1)[0].replace(part, "").strip()
