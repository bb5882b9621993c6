"""Solve a Program on its worst samples, add what is violated, certify on all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.errors import EquipoiseError, InfeasibleError
from equipoise.solve.answer import Answer, Working
from equipoise.solve.certificate import Gap, Multipliers, certify
from equipoise.solve.convex import solve_restricted
from equipoise.solve.least_distance import is_least_squares, solve_least_distance
from equipoise.solve.polish import polish
from equipoise.solve.program import Program, Term
from equipoise.solve.simplex import is_linear, solve_linear

TOLERANCE = 1e-9
ROUNDS = 60
BATCH = 6


@dataclass(frozen=True, eq=False)
class Solution:
    """theta (P,) with the program it solves; certificate, prices and flat directions are worked out when asked for."""

    theta: Array
    program: Program
    working: Working
    answer: Answer

    @cached_property
    def objective(self) -> float:
        """The weighted sum of norms at theta."""
        return self.program.objective(self.theta)

    @property
    def excess(self) -> float:
        """The common relative excess over the limits that an elastic program needed."""
        return self.answer.excess

    @cached_property
    def _certified(self) -> tuple[Gap, Multipliers]:
        return certify(self.program, self.working, self.answer)

    @property
    def gap(self) -> Gap:
        """Primal, dual and violation, recomputed from the program's data."""
        return self._certified[0]

    @property
    def prices(self) -> Multipliers:
        """Prices of limits and bounds at the optimum."""
        return self._certified[1]

    @cached_property
    def flat(self) -> Array:
        """Directions of theta (count, P) that change no residual: unknowns that trade freely."""
        if not self.program.unknowns:
            return np.zeros((0, 0))
        scale = self.program.scale
        parts = [term.triangle[:, :-1] for term in self.program.terms]
        # what a body can have binds before a residual does: such directions are not free
        parts += [one.S.reshape(len(scale), -1).T for one in self.program.definite]
        parts += [rows.G / rows.scale for rows in self.program.rows if rows.equality]
        factor = np.vstack(parts) * scale
        _, singular, vectors = np.linalg.svd(factor)
        rank = int((singular > 1e-10 * max(singular.max(initial=0.0), 1e-300)).sum())
        return vectors[rank:] * scale


def solve(program: Program, *, elastic: float | None = None, warm: Working | None = None) -> Solution:
    """Minimise the program's norms exactly, working on few samples and certifying on all of them.

    elastic prices a common relative excess over all limits instead of refusing; warm starts from the
    working set of a similar program. Raises InfeasibleError naming the limits that conflict.
    """
    if warm is not None and all(term.norm == "peak" for term in program.terms) and program.unknowns:
        working = warm.copied()
        answer = _exchange(program, working, elastic)
        return Solution(answer.theta, program, working, answer)
    start = least_squares(program)
    if _plain(program, start):
        empty = np.zeros(0, dtype=int)
        working = Working([empty for _ in program.terms], [empty for _ in program.rows])
        answer = _plain_answer(program, start)
    else:
        working = _initial(program, start) if warm is None else _refresh(program, warm, start)
        answer = _exchange(program, working, elastic)
    return Solution(answer.theta, program, working, answer)


def least_squares(program: Program) -> Array:
    """Minimum-norm theta of the weighted squares of all terms, limits left out; the start of every norm."""
    if not program.unknowns:
        return np.zeros(0)
    scale = program.scale
    factor = np.vstack([term.triangle for term in program.terms])
    return scale * np.linalg.lstsq(factor[:, :-1] * scale, -factor[:, -1], rcond=1e-12)[0]


def _plain(program: Program, theta: Array) -> bool:
    """Whether least squares is already the answer: a single rms, or no residual at all, and no limit violated."""
    if not theta.size and not program.rows and all(term.cap is None for term in program.terms):
        return True
    load = sum(program.loads)
    single = len(program.terms) == 1 and program.terms[0].norm == "rms" and program.terms[0].cap is None
    return (single or program.objective(theta) <= 1e-13 * load) and program.violation(theta) <= 1e-12


def _plain_answer(program: Program, theta: Array) -> Answer:
    answer = Answer(True, theta, lower=np.zeros_like(theta), upper=np.zeros_like(theta))
    empty = np.zeros(0)
    for term in program.terms:
        answer.y.append(empty)
        answer.cap.append(0.0)
        answer.level.append(term.factor if term.value(theta) > 0 else 0.0)
    answer.row = [np.zeros(0) for _ in program.rows]
    answer.definite = [np.zeros_like(one.S0) for one in program.definite]
    return answer


def _exchange(program: Program, working: Working, elastic: float | None) -> Answer:
    restricted = _method(program, elastic)
    for _ in range(ROUNDS):
        answer = restricted(working)
        if not answer.feasible:
            from equipoise.solve.conflict import explain

            raise InfeasibleError(
                explain(program, working), where="limits", hint="relax one of them, or free more geometry"
            )
        if elastic is None:
            answer = _aligned(program, polish(program, working, answer))
        if not _grow(program, working, answer):
            return answer
    raise EquipoiseError(
        f"the exchange did not settle in {ROUNDS} rounds", where="solve", hint="use norm rms, or fewer poses"
    )


def _aligned(program: Program, answer: Answer) -> Answer:
    """Equalities kept to rounding, by the smallest move within bounds, where no other limit minds."""
    equal = [rows for rows in program.rows if rows.equality and rows.h.size]
    if not equal or not program.unknowns:
        return answer
    G = np.vstack([rows.G / rows.scale for rows in equal]) * program.scale
    h = np.concatenate([rows.h / rows.scale for rows in equal])
    theta = answer.theta
    for _ in range(3):
        theta = np.clip(theta, program.lower, program.upper)
        free = (theta > program.lower) & (theta < program.upper)
        step = np.linalg.lstsq(G[:, free], h - G @ (theta / program.scale), rcond=1e-12)[0]
        theta = theta.copy()
        theta[free] += program.scale[free] * step
    better = program.violation(theta) <= max(program.violation(answer.theta), 1e-9)
    return replace(answer, theta=theta) if better else answer


def _method(program: Program, elastic: float | None) -> Callable[[Working], Answer]:
    """What solves the restricted program: least distance or the dual simplex, and the cone solver where they cannot."""
    linear, squares = is_linear(program), elastic is None and is_least_squares(program)

    def restricted(working: Working) -> Answer:
        answer = None
        if linear:
            answer = solve_linear(program, working, elastic)
        elif squares:
            answer = solve_least_distance(program, working)
        return answer or solve_restricted(program, working, elastic)

    return restricted


def _initial(program: Program, theta: Array) -> Working:
    """The worst samples at zero and at least squares, and all that a mean term has."""
    terms: list[Indices] = []
    for term in program.terms:
        if term.norm == "rms":
            chosen = np.zeros(0, dtype=int)
        elif term.norm == "peak":
            chosen = np.union1d(_worst(term, term.residual(theta)), _worst(term, term.b))
        else:
            chosen = np.arange(term.b.shape[0] * len(term.sizes))
        terms.append(chosen)
    rows = [np.arange(len(rows.h)) if rows.equality else _tightest(rows.excess(theta)) for rows in program.rows]
    return Working(terms, rows)


def _refresh(program: Program, warm: Working, theta: Array) -> Working:
    """A known working set for a program of the same shape, with its own worst samples added."""
    fresh = _initial(program, theta)
    terms = [np.union1d(old, new) for old, new in zip(warm.terms, fresh.terms, strict=True)]
    rows = [
        np.union1d(old[old < len(spec.h)], new).astype(int)
        for spec, old, new in zip(program.rows, warm.rows, fresh.rows, strict=True)
    ]
    return Working(terms, rows, warm.basis)


def _worst(term: Term, r: Array, count: int = BATCH) -> Indices:
    """Flat numbers of the worst few samples of every block, both signs of scalar ones."""
    magnitude = term.magnitudes(r)
    faces = [magnitude] if any(size > 1 for size in term.sizes) else [r, -r]
    blocks = np.arange(len(term.sizes))
    found = []
    for face in faces:
        top = np.argpartition(-face, min(count, len(face) - 1), axis=0)[:count]
        found.append((top * len(term.sizes) + blocks).ravel())
    return np.unique(np.concatenate(found))


def _tightest(excess: Array) -> Indices:
    """The few rows that are kept by least, or violated by most."""
    return np.sort(np.argsort(-excess)[:BATCH])


def _grow(program: Program, working: Working, answer: Answer) -> bool:
    """Add violated samples and rows to the working set; say whether there were any."""
    grew = False
    for i, term in enumerate(program.terms):
        if term.norm != "peak":
            continue
        r = term.residual(answer.theta)
        magnitude = term.magnitudes(r)
        level = magnitude.ravel()[working.terms[i]].max(initial=0.0)
        if magnitude.max() > level * (1 + TOLERANCE) + 1e-13 * program.loads[i]:
            worst = _worst(term, r)
            worst = worst[magnitude.ravel()[worst] > level]
            grown = np.union1d(working.terms[i], worst)
            grew |= len(grown) > len(working.terms[i])
            working.terms[i] = grown
    for k, rows in enumerate(program.rows):
        if rows.equality or not len(rows.h):
            continue
        excess = rows.excess(answer.theta) / rows.scale - answer.excess
        if excess.max() > TOLERANCE:
            worst = _tightest(excess)
            grown = np.union1d(working.rows[k], worst[excess[worst] > 0]).astype(int)
            grew |= len(grown) > len(working.rows[k])
            working.rows[k] = grown
    return grew
