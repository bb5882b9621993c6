"""A few of many states whose weights integrate like all of them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.states import States

DEGREES = (14, 11, 8, 6, 4, 3, 2, 1)


@dataclass(frozen=True, eq=False)
class Few:
    """Rows (n,) of states that stand for all, with weights (n,) that sum to those of all."""

    rows: Indices
    weight: Array

    def of(self, states: States) -> States:
        """These states with these weights."""
        return replace(states.take(self.rows), weight=self.weight)

    def joined(self, rows: Indices) -> Few:
        """Further rows, which limits need and the mean does not: they weigh next to nothing."""
        new = np.setdiff1d(rows, self.rows)
        return Few(np.append(self.rows, new), np.append(self.weight, np.full(len(new), 1e-12 * self.weight.sum())))


def thin(states: States, count: int) -> Few:
    """About `count` of the states: an even choice and the ends of every coordinate.

    Their weights are the nearest to equal ones that integrate every polynomial of the coordinates (positions and
    payloads) up to the highest degree that leaves them positive exactly as all states do; an rms over few smooth rows
    is then that over all.
    """
    weight, place = states.weight, np.hstack([states.driven, states.payload_mass])
    if len(states) <= count:
        return Few(np.arange(len(states)), weight)
    even = np.linspace(0, len(states) - 1, count).astype(int)
    ends = [place.argmin(0), place.argmax(0)]
    rows = np.unique(np.concatenate([even, *ends]))
    low, high = place.min(0), place.max(0)
    varies = high > low
    unit = (2 * (place - low) / np.where(varies, high - low, 1.0) - 1)[:, varies]
    plain = np.full(len(rows), weight.sum() / len(rows))
    for degree in DEGREES:
        basis = _polynomials(unit, degree)
        if 3 * basis.shape[1] > 2 * len(rows):
            continue
        few = basis[rows]
        missing = weight @ basis - plain @ few
        found = plain + few @ np.linalg.lstsq(few.T @ few, missing, rcond=None)[0]
        if found.min() > 0.05 * plain[0]:
            return Few(rows, found)
    return Few(rows, plain)


def _polynomials(unit: Array, degree: int) -> Array:
    """Products of Chebyshev polynomials (N, K) of total degree up to `degree`."""
    dims = unit.shape[1]
    columns: list[tuple[tuple[int, ...], Array]] = [((), np.ones(len(unit)))]
    for axis in range(dims):
        ladder = np.polynomial.chebyshev.chebvander(unit[:, axis], degree)
        columns = [
            ((*powers, power), column * ladder[:, power])
            for powers, column in columns
            for power in range(degree + 1 - sum(powers))
        ]
        if len(columns) > len(unit):
            break
    return np.stack([column for _, column in columns], axis=1)
