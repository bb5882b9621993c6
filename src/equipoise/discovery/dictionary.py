"""The dictionary: the effort of every candidate per unit of its unknown, over all states, and its compression."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.discovery.kinds.kind import Batch, Proposal

ACCURACY = 1e-4
"""Largest share of a column that compression may lose."""
FIRST = 48
"""Random combinations that the range is first looked for with."""
ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class Compressed:
    """The dictionary in an orthonormal basis of its range: |b + A k|^2 = |load + columns k|^2 + constant.

    columns (r, C) and load (r,) carry the weights of the rows; k counts in units of each candidate's most, so that
    0 <= k <= 1; lost is the largest share of a column outside the basis, constant what no column can change, turn
    (r, rows) takes any other rows there.
    """

    columns: Array
    load: Array
    constant: float
    lost: float
    turn: Array

    @property
    def rank(self) -> int:
        """How many directions the candidates span."""
        return len(self.load)


@dataclass(frozen=True, eq=False)
class Dictionary:
    """All candidates as batches of columns, and the loads (S, rows) of S payload scenarios that they work against.

    weight (rows,) sums to one over the states; blocks is the number of counted rows per state.
    """

    batches: tuple[Batch, ...]
    loads: Array
    weight: Array
    blocks: int

    def __len__(self) -> int:
        return sum(map(len, self.batches))

    @cached_property
    def starts(self) -> NDArray[np.intp]:
        """Number of the first candidate of each batch."""
        return np.cumsum([0, *map(len, self.batches)])[:-1]

    @cached_property
    def upper(self) -> Array:
        """The most of each unknown (C,)."""
        return np.concatenate([batch.upper for batch in self.batches])

    @cached_property
    def spots(self) -> NDArray[np.intp]:
        """A number (C,) per place, shared by its variants."""
        found, first = [], 0
        for batch in self.batches:
            found.append(batch.spot + first)
            first += int(batch.spot.max(initial=-1)) + 1
        return np.concatenate(found)

    def find(self, index: int) -> tuple[int, int]:
        """Batch and place within it of a candidate."""
        batch = int(np.searchsorted(self.starts, index, side="right")) - 1
        return batch, index - int(self.starts[batch])

    def propose(self, index: int, number: int) -> Proposal:
        """A candidate as the number-th balancer of a design."""
        batch, within = self.find(index)
        return self.batches[batch].propose(within, f"{self.batches[batch].letter}{number}")

    def places(self, subset: tuple[int, ...]) -> tuple[str, ...]:
        """Where the members of a subset sit, sorted."""
        return tuple(sorted(self.batches[self.find(index)[0]].place for index in subset))

    def columns(self, subset: tuple[int, ...]) -> Array:
        """Columns (rows, n) of a subset, per unit of k."""
        found = []
        for index in subset:
            batch, within = self.find(index)
            found.append(self.batches[batch].column(within) * self.upper[index])
        return np.stack(found, axis=1)

    @cached_property
    def compressed(self) -> Compressed:
        """Rank compression under the rows' weights: the range is found from random combinations of columns.

        As many are taken as it needs.
        """
        mean = self.loads.mean(axis=0)
        spread = float((self.weight * (self.loads - mean) ** 2).sum()) / len(self.loads)
        root = np.sqrt(self.weight)
        target = root * mean
        norms = np.concatenate([self._norms(batch, root) for batch in self.batches]) * self.upper
        basis, columns, lost = self._range(root, norms)
        load = basis.T @ target
        constant = spread + max(float(target @ target - load @ load), 0.0)
        return Compressed(columns, load, constant, lost, basis.T * root)

    def _range(self, root: Array, norms: Array) -> tuple[Array, Array, float]:
        """An orthonormal basis (rows, r) of all columns, the columns (r, C) in it, and the largest share outside."""
        rng, size = np.random.default_rng(0), np.maximum(norms, 1e-300)
        most = min(len(self), len(root))
        basis, columns = np.zeros((len(root), 0)), np.zeros((0, len(self)))
        largest, lost = 0.0, 1.0
        for count in _doubling(FIRST, most):
            fresh = self._mixed(root, size, None if count == most else rng.standard_normal, count - basis.shape[1])
            for _ in range(2):  # once leaves rounding errors of what is taken out
                fresh -= basis @ (basis.T @ fresh)
            left, values, _ = np.linalg.svd(fresh, full_matrices=False)
            largest = max(largest, values.max(initial=0.0))
            left = left[:, values > ROUNDING * largest]
            turned = (left * root[:, None]).T
            basis = np.hstack([basis, left])
            columns = np.vstack([columns, np.hstack([batch.under(turned) for batch in self.batches]) * self.upper])
            kept = np.einsum("rc,rc->c", columns / size, columns / size)
            lost = float(np.sqrt(np.maximum(1.0 - kept, 0.0))[norms > 0].max(initial=0.0))
            if lost <= ACCURACY:
                break
        return basis, columns, lost

    def _mixed(self, root: Array, size: Array, draw: Callable[..., Array] | None, count: int) -> Array:
        """So many random combinations (rows, count) of columns of equal size; all columns where none are drawn."""
        found = []
        for first, batch in zip(self.starts, self.batches, strict=True):
            scale = (self.upper / size)[first : first + len(batch), None]
            found.append(batch.times(np.diagflat(scale) if draw is None else scale * draw((len(batch), count))))
        return root[:, None] * (np.hstack(found) if draw is None else np.sum(found, axis=0))

    @staticmethod
    def _norms(batch: Batch, root: Array) -> Array:
        weighted = batch.generators * root[:, None]
        if batch.coefficients is None:
            return np.sqrt(np.einsum("rc,rc->c", weighted, weighted))
        small = np.linalg.qr(weighted, mode="r") @ batch.coefficients
        return np.sqrt(np.einsum("rc,rc->c", small, small))


def _doubling(first: int, last: int) -> Iterator[int]:
    """first, twice as many, and so on; the last is all there is."""
    while first < last:
        yield first
        first *= 2
    yield last
