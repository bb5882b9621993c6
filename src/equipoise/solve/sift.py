"""Which of many geometries suits each of many parts best: least squares in closed form, from Gram matrices alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.seeding import generator
from equipoise.solve.program import Program


@dataclass(frozen=True, eq=False)
class Sifted:
    """Geometries gamma (S, G) of a path: Gram matrices (S, 4, 4) of what a part scales, and its range of length (S,).

    The residual is load + mass sag + tension-at-zero pull + rate stretch, with every other unknown already at its
    best: |r|^2 = c' M c for c = (1, mass, tension at zero length, rate). excess (S,) is that of limits on geometry.
    """

    gamma: Array
    gram: Array
    shortest: Array
    longest: Array
    excess: Array

    def scores(self, coefficients: Array, low: Array, high: Array, slack: Array, load: float, price: float) -> Array:
        """Objective of each part (C, 4) at each geometry (C, S), with a price on leaving its range low..high (C,).

        slack (C,) is what the range is measured by, load what the objective is.
        """
        left, right = np.triu_indices(4)
        twice = np.where(left == right, 1.0, 2.0)
        squares = (coefficients[:, left] * coefficients[:, right]) @ (self.gram[:, left, right] * twice).T
        beyond = np.maximum(low[:, None] - self.shortest, self.longest - high[:, None])
        out = np.maximum(beyond, 0.0) / slack[:, None] + np.maximum(self.excess, 0.0)
        return np.sqrt(np.maximum(squares, 0.0)) + price * load * np.minimum(out, 1e3)


def sift(program: Program, part: Indices, sag: Array, length: Array, gamma: Array, lead: Array) -> Sifted:
    """Gram matrices of a program over geometries gamma (S, G), whose unknowns `part` are the spring's (preload, rate).

    sag (S, N, R) is what one kilogram of the spring adds to the residual of the first term, length (S, N); lead (S,) of
    it is a leader's.
    """
    count = len(length)
    others = np.setdiff1d(np.arange(len(program.unknowns)), part)
    gram = np.zeros((count, 4 + len(others), 4 + len(others)))
    first = True
    for term in program.terms:
        if term.cap is not None:
            continue
        root = term.factor * np.sqrt(term.weight)[:, None, None]
        b = np.broadcast_to(term.b, (count, *term.b.shape[-2:]))
        A = np.broadcast_to(term.A, (count, *term.A.shape[-3:]))
        own = sag if first else np.zeros_like(b)
        pull, stretch = A[..., part[:1]], A[..., part[1:]] - lead[:, None, None, None] * A[..., part[:1]]
        columns = np.concatenate([b[..., None], own[..., None], pull, stretch, A[..., others]], axis=-1) * root
        flat = columns.reshape(count, -1, columns.shape[-1])
        gram += np.swapaxes(flat, 1, 2) @ flat
        first = False
    excess = np.zeros(count)
    for rows in program.rows:
        if not np.any(rows.G) and rows.h.shape[-1]:
            excess = np.maximum(excess, (-rows.h / rows.scale).max(axis=-1))
    return Sifted(gamma, _reduced(gram), length.min(-1) - lead, length.max(-1) - lead, excess)


def _reduced(gram: Array) -> Array:
    """The Gram matrix (S, 4, 4) that is left when all further columns are at their best."""
    known, other = gram[:, :4, :4], gram[:, 4:, 4:]
    if not other.shape[-1]:
        return known
    size = np.sqrt(np.maximum(np.einsum("sii->si", other), 1e-300))
    inverse = np.linalg.pinv(other / (size[:, :, None] * size[:, None, :]), rcond=1e-10, hermitian=True)
    mixed = gram[:, 4:, :4] / size[:, :, None]
    return known - np.swapaxes(mixed, 1, 2) @ inverse @ mixed


def evenly(count: int, dims: int, seed: int) -> Array:
    """Points (count, dims) of the unit cube, evenly spread: an additive recurrence on the roots of x^(d+1) = x + 1."""
    root = 2.0
    for _ in range(64):
        root = (1 + root) ** (1 / (dims + 1))
    steps = (1 / root) ** np.arange(1, dims + 1)
    offset = generator(seed).random(dims)
    return (offset + np.arange(1, count + 1)[:, None] * steps) % 1.0
