"""The best subsets of a compressed dictionary: pairs exhaustively in closed form, more by a beam with exchange."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array, Indices
from equipoise.discovery.dictionary import Compressed

BLOCK = 192
"""Candidates whose partners are judged at once."""
SWAPS = 12
"""Rounds of exchange at most."""

Subset = tuple[int, ...]
Ranked = list[tuple[float, Subset]]


@dataclass(frozen=True, eq=False)
class Search:
    """min over 0 <= k <= 1 of |load + columns k|^2 over subsets of columns of different spots."""

    columns: Array
    load: Array
    spots: NDArray[np.intp]

    @staticmethod
    def of(compressed: Compressed, spots: NDArray[np.intp]) -> Search:
        """The search in a compressed dictionary."""
        return Search(compressed.columns, compressed.load, spots)

    @property
    def _square(self) -> Array:
        return np.maximum(np.einsum("rc,rc->c", self.columns, self.columns), 1e-300)

    def singles(self) -> Array:
        """|load + c k|^2 (C,) at the best 0 <= k <= 1 of every candidate alone."""
        slope, square = self.load @ self.columns, self._square
        k = np.clip(-slope / square, 0.0, 1.0)
        return self.load @ self.load + k * (2 * slope + k * square)

    def pairs(self, keep: int) -> Ranked:
        """The best `keep` of all pairs, each solved in closed form: inside the box, or on one of its edges."""
        slope, square, alone = self.load @ self.columns, self._square, self.singles()
        base, count = float(self.load @ self.load), self.columns.shape[1]
        best = np.zeros(0), np.zeros((0, 2), dtype=int)
        for start in range(0, count - 1, BLOCK):
            one = np.arange(start, min(start + BLOCK, count))
            two = np.arange(start, count)
            cross = self.columns[:, one].T @ self.columns[:, two]
            value = base + _box_pairs(square[one, None], square[two], cross, slope[one, None], slope[two])
            value = np.minimum(value, np.minimum(alone[one, None], alone[two]))
            value[(two <= one[:, None]) | (self.spots[one, None] == self.spots[two])] = np.inf
            flat = np.argpartition(value, min(keep, value.size - 1), axis=None)[:keep]
            row, column = np.unravel_index(flat, value.shape)
            found = np.stack([one[row], two[column]], axis=1)
            values = np.concatenate([best[0], value[row, column]])
            order = np.argsort(values, kind="stable")[:keep]
            best = values[order], np.vstack([best[1], found])[order]
        return [(float(v), (int(i), int(j))) for v, (i, j) in zip(*best, strict=True) if np.isfinite(v)]

    def extended(self, subset: Subset) -> Array:
        """|load + columns k|^2 (C,) of the subset with every candidate added; infinite where that is no subset.

        Every choice of members that stay above zero is solved with the newcomer by a bordered system; a newcomer
        that asks for more than it may stays at its most. Members at their most are left to `solve`.
        """
        members = np.array(subset, dtype=int)
        slope, square = self.load @ self.columns, self._square
        value = np.minimum(self.solve(subset)[0], self.singles())
        for size in range(1, len(members) + 1):
            for chosen in combinations(members, size):
                value = np.minimum(value, self._bordered(np.array(chosen), slope, square))
        value[np.isin(self.spots, self.spots[members])] = np.inf
        return value

    def _bordered(self, chosen: Indices, slope: Array, square: Array) -> Array:
        own = self.columns[:, chosen]
        gram = own.T @ own
        try:
            inverse = np.linalg.inv(gram)
        except np.linalg.LinAlgError:
            return np.full(len(square), np.inf)
        across = own.T @ self.columns
        back = inverse @ across
        still = -inverse @ slope[chosen]
        rest = square - np.einsum("sc,sc->c", across, back)
        pull = slope + across.T @ still
        sound = rest > 1e-9 * square
        k = np.clip(np.where(sound, -pull / np.where(sound, rest, 1.0), 0.0), 0.0, 1.0)
        others = still[:, None] - back * k
        value = self.load @ self.load + slope[chosen] @ still + k * (2 * pull + k * rest)
        inside = sound & ((others >= -1e-12) & (others <= 1.0 + 1e-12)).all(axis=0)
        return np.where(inside, value, np.inf)

    def solve(self, subset: Subset) -> tuple[float, Array]:
        """The value of a subset and its k (n,)."""
        from scipy.optimize import lsq_linear

        own = self.columns[:, list(subset)]
        scale = np.maximum(np.linalg.norm(own, axis=0), 1e-300)
        found = lsq_linear(own / scale, -self.load, bounds=(0.0, scale), method="bvls", tol=1e-12)
        k = np.clip(found.x / scale, 0.0, 1.0)
        left = self.load + own @ k
        return float(left @ left), k

    def grown(self, beam: Iterable[Subset], keep: int, each: int = 8) -> Ranked:
        """The best `keep` subsets with one member more than those of a beam, `each` of one root at most."""
        found: dict[Subset, float] = {}
        for subset in beam:
            value = self.extended(subset)
            for index in np.argpartition(value, min(each, len(value) - 1))[:each]:
                if np.isfinite(value[index]):
                    found[tuple(sorted((*subset, int(index))))] = float(value[index])
        return sorted(((value, subset) for subset, value in found.items()))[:keep]

    def exchanged(self, subset: Subset) -> tuple[float, Subset]:
        """The subset after swapping single members as long as that helps."""
        best, _ = self.solve(subset)
        for _ in range(SWAPS):
            moved = False
            for member in subset:
                rest = tuple(other for other in subset if other != member)
                value = self.extended(rest) if rest else self.singles()
                index = int(value.argmin())
                if value[index] < best * (1 - 1e-9) and index != member:
                    best, subset, moved = float(value[index]), tuple(sorted((*rest, index))), True
                    break
            if not moved:
                return best, subset
        return best, subset

    def best(self, most: int, keep: int = 64, progress: Callable[[int], None] | None = None) -> dict[int, Ranked]:
        """Ranked subsets of 1, 2, ... `most` members, best first."""
        alone = self.singles()
        order = np.argsort(alone, kind="stable")[:keep]
        found: dict[int, Ranked] = {1: [(float(alone[i]), (int(i),)) for i in order]}
        for size in range(2, most + 1):
            if progress:
                progress(size)
            if size == 2:
                ranked = self.pairs(keep)
            else:
                ranked = self.grown([subset for _, subset in found[size - 1]], keep)
                swapped = {subset: value for value, subset in (self.exchanged(s) for _, s in ranked[:3])}
                swapped |= {subset: value for value, subset in ranked}
                ranked = sorted((value, subset) for subset, value in swapped.items())[:keep]
            if not ranked:
                break
            found[size] = ranked
        return found


def _box_pairs(a: Array, b: Array, c: Array, f: Array, g: Array) -> Array:
    """min over the unit square of a x^2 + 2 c x y + b y^2 + 2 f x + 2 g y, edges x = 0 and y = 0 left out."""
    det = a * b - c * c
    sound = det > 1e-12 * a * b
    det = np.where(sound, det, 1.0)
    x, y = (g * c - f * b) / det, (f * c - g * a) / det
    inside = sound & (x >= 0) & (x <= 1) & (y >= 0) & (y <= 1)
    value = np.where(inside, f * x + g * y, np.inf)
    y = np.clip(-(g + c) / b, 0.0, 1.0)
    value = np.minimum(value, a + 2 * f + y * (2 * (g + c) + b * y))
    x = np.clip(-(f + c) / a, 0.0, 1.0)
    return np.minimum(value, b + 2 * g + x * (2 * (f + c) + a * x))
