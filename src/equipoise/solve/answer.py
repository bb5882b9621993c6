"""What the solvers are given and what they answer: working samples and rows, multipliers of each."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from equipoise.affine import Array, Indices


@dataclass(eq=False)
class Working:
    """Which samples are spelled out: per term the flat (state, block) numbers, per limit the row numbers.

    basis is what the simplex found of a similar program: (columns that are basic, rows that are), by number.
    """

    terms: list[Indices]
    rows: list[Indices]
    basis: tuple[Indices, Indices] | None = None

    def copied(self) -> Working:
        """The same, to be grown by itself."""
        return Working([one.copy() for one in self.terms], [one.copy() for one in self.rows], self.basis)


@dataclass(eq=False)
class Answer:
    """What a solver says: theta and a multiplier for every working sample, row, bound and cap.

    y[i] stacks the rows of term i's working samples, of an rms term those of its triangle (or none, where
    level[i] along the residual says all); level[i] is the multiplier of an rms term's cone; excess
    is the common relative excess of an elastic program, definite[k] (k, k) the multiplier of a definite matrix.
    """

    feasible: bool
    theta: Array
    y: list[Array] = field(default_factory=list)
    level: list[float] = field(default_factory=list)
    row: list[Array] = field(default_factory=list)
    cap: list[float] = field(default_factory=list)
    definite: list[Array] = field(default_factory=list)
    lower: Array = field(default_factory=lambda: np.zeros(0))
    upper: Array = field(default_factory=lambda: np.zeros(0))
    excess: float = 0.0


def spread(sizes: tuple[int, ...], flat: Indices) -> tuple[Indices, Indices, Indices]:
    """Rows behind flat (state, block) numbers: sample index, state and row, one entry per row."""
    starts, counts = np.cumsum((0, *sizes[:-1])), np.array(sizes)
    state, block = np.divmod(flat, len(sizes))
    sample = np.repeat(np.arange(len(flat)), counts[block])
    inside = np.arange(len(sample)) - np.repeat(np.cumsum(counts[block]) - counts[block], counts[block])
    return sample, state[sample], starts[block][sample] + inside
