"""Sums over many states, a few thousand at a time: what an rms objective needs is small, the states are not.

A spring's effort is an outer product, rate (n, R) times basis (n, P), so the Gram matrix of all columns needs no
dense A:  G_ij = B_i' diag(w (rate_i . rate_j)) B_j.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from equipoise import platform
from equipoise.affine import Affine, Array, Unknown, merge_unknowns
from equipoise.balancers.spring import Spring
from equipoise.mechanism import Mechanism
from equipoise.objective import Aim
from equipoise.solve.program import Term
from equipoise.states import States

CHUNK = 4096
BIG = 20_000_000
"""Numbers in a dense A, 160 MB, from which on an rms term is summed in chunks."""
NOISE = 1e-14
"""Share of the largest eigenvalue of a scaled Gram matrix below which a direction is rounding."""

Balancers = Sequence[Any]


@dataclass(frozen=True, eq=False)
class Product:
    """Columns of a residual as an outer product: rows (n, R) times basis (n, P), at some columns (P,)."""

    rows: Array
    basis: Array
    columns: NDArray[np.int_]


def is_big(balancers: Balancers, states: States, unknowns: int) -> bool:
    """Whether a residual is better summed than spelled out; candidates and complex steps are for few states."""
    if len(states) * states.driven.shape[1] * unknowns <= BIG:
        return False
    probe = states.take(slice(0, 1))
    lengths = [balancer.path.deform(probe)[0] for balancer in balancers if isinstance(balancer, Spring)]
    return all(np.ndim(length) == 1 and np.isrealobj(length) for length in lengths)


def rms_term(mechanism: Mechanism, balancers: Balancers, states: States, aim: Aim) -> Term:
    """The rms term over all states as one of P + 1 rows: |R [theta; 1]|^2 = sum_n w_n |b_n + A_n theta|^2.

    R is the root of the Gram matrix of the columns, scaled to unit length; it keeps half the digits of A, so a
    residual below 1e-7 of its load is rounding.
    """
    unknowns = merge_unknowns([balancer.unknowns for balancer in balancers])
    count = len(unknowns) + 1
    gram, total = np.zeros((count, count)), float(states.weight.sum())
    for part in _parts(states):
        products = _products(mechanism, balancers, unknowns, part, aim)
        weight = part.weight / total
        for i, one in enumerate(products):
            for other in products[: i + 1]:
                shared = weight * np.einsum("nr,nr->n", one.rows, other.rows)
                block = one.basis.T @ (other.basis * shared[:, None])
                gram[np.ix_(one.columns, other.columns)] += block
                if other is not one:
                    gram[np.ix_(other.columns, one.columns)] += block.T
    size = np.sqrt(np.where(np.diag(gram) > 0, np.diag(gram), 1.0))
    values, vectors = np.linalg.eigh(gram / np.outer(size, size))
    root = np.where(values > NOISE * values[-1], np.sqrt(np.maximum(values, 0.0)), 0.0)[:, None] * vectors.T * size
    factor = np.linalg.qr(root).R
    return Term(
        aim.goal, "rms", factor[None, :, -1], factor[None, :, :-1], np.ones(1), (1,) * count, aim.weight, aim.cap
    )


def residual(mechanism: Mechanism, balancers: Balancers, states: States, goal: str, theta: Array) -> Array:
    """A goal's b + A theta (N, R) of all states, without ever holding the whole A."""
    unknowns = merge_unknowns([balancer.unknowns for balancer in balancers])
    augmented = np.append(theta, 1.0)
    found = []
    for part in _parts(states):
        products = _products(mechanism, balancers, unknowns, part, Aim(goal=goal))
        found.append(sum(p.rows * (p.basis @ augmented[p.columns])[:, None] for p in products))
    return np.concatenate(found)


def _parts(states: States) -> Iterator[States]:
    for start in range(0, len(states), CHUNK):
        yield states.take(slice(start, start + CHUNK))


def _products(
    mechanism: Mechanism, balancers: Balancers, unknowns: Sequence[Unknown], states: States, aim: Aim
) -> list[Product]:
    """Every column of the residual over a slice, and last, at column P, its constant."""
    turn = _turn(mechanism, states, aim)
    place = {unknown.name: index for index, unknown in enumerate(unknowns)}
    one = np.ones((len(states), 1))
    constant, products = mechanism.effort(states, "hold").b, []
    for balancer in balancers:
        columns = np.array([place[unknown.name] for unknown in balancer.unknowns], dtype=int)
        if isinstance(balancer, Spring):
            rate, basis, known = balancer.factors(states)
            constant = constant + known
            if len(columns):
                products.append(Product(turn(rate), basis, columns))
        else:
            part: Affine = balancer.effort(states, "hold")
            constant = constant + part.b
            products += [Product(turn(part.A[..., p]), one, columns[[p]]) for p in range(len(columns))]
    return [*products, Product(turn(constant), one, np.array([len(unknowns)]))]


def _turn(mechanism: Mechanism, states: States, aim: Aim) -> Callable[[Array], Array]:
    """From holding efforts (n, nd) to the counted, scaled rows (n, R) of a goal."""
    columns, scale = aim.columns(mechanism)
    if aim.goal == "wrench":
        transform = platform.transform(states)
        return lambda tau: transform(tau)[:, columns] * scale
    return lambda tau: tau[:, columns] * scale
