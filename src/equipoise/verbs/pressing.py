"""Norms other than the rms by least squares: weights of each candidate's residuals that follow the residuals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.solve.program import Program, Term

LEAST = 0.02
"""Share of the largest residual that counts at least: a weight that has vanished would never come back."""

Rows = NDArray[np.intp]
Pressure = list[Array]


def pressed(program: Program, theta: Array, before: Pressure | None) -> Pressure:
    """Factors (K, N, R) of the residuals of every term of candidates at theta (K, P).

    Of a peak the weights so far times the residuals, of a mean their inverse, of an rms one; on average one each.
    before may be of fewer states, which come first.
    """
    found = []
    for index, term in enumerate(program.terms):
        size = term.magnitudes(_residual(term, theta))
        size = np.broadcast_to(size, (len(theta), len(term.weight), size.shape[-1]))
        share = np.maximum(size / np.maximum(size.max(axis=(1, 2), keepdims=True), 1e-300), LEAST)
        weight = {"peak": share, "mean": 1 / share, "rms": np.ones_like(share)}[term.norm]
        if before is not None and term.norm == "peak":
            old = before[index][:, :, np.cumsum((0, *term.sizes[:-1]))] ** 2
            weight[:, : old.shape[1]] *= old
        weight = weight / weight.mean(axis=(1, 2), keepdims=True)
        found.append(np.sqrt(np.repeat(weight, term.sizes, axis=2)))
    return found


def weighted(many: Callable[[Rows, Array], Program], pressure: Pressure, which: Rows, gamma: Array) -> Program:
    """The program of candidates with the residuals of its terms times their factors."""
    program = many(which, gamma)
    terms = [
        replace(term, b=term.b * factor[which], A=term.A * factor[which][..., None])
        for term, factor in zip(program.terms, pressure, strict=True)
    ]
    return replace(program, terms=tuple(terms))


def _residual(term: Term, theta: Array) -> Array:
    """b + A theta (K, N, R)."""
    return term.b + (term.A @ theta[:, None, :, None])[..., 0] if theta.shape[1] else term.b
