"""One restricted cone program: the working samples of a Program, handed to Clarabel, multipliers mapped back."""

from __future__ import annotations

from typing import Any

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.solve.answer import Answer, Working, spread
from equipoise.solve.program import Definite, Program, Rows

TINY = 1e-300


class _Cone:
    """Rows of one cone kind under construction, as triplets: A z + s = rhs, s in the cone."""

    def __init__(self) -> None:
        self.count = 0
        self.rhs: list[Array] = []
        self.row: list[Indices] = []
        self.col: list[Indices] = []
        self.val: list[Array] = []

    def add(self, rhs: Any, *parts: tuple[Any, Any, Any]) -> slice:
        """Append len(rhs) rows whose entries are (row, column, value) triplets; return their place."""
        rhs = np.atleast_1d(np.asarray(rhs, dtype=float))
        for part in parts:
            row, col, val = (entry.ravel() for entry in np.broadcast_arrays(*part))
            self.row.append(row + self.count)
            self.col.append(col)
            self.val.append(val)
        self.rhs.append(rhs)
        place = slice(self.count, self.count + len(rhs))
        self.count = place.stop
        return place

    def dense(self, matrix: Array, first_row: int = 0) -> tuple[Indices, Indices, Array]:
        """Triplets of a dense (m, P) matrix over theta."""
        row, col = (np.arange(count) for count in matrix.shape)
        return row[:, None] + first_row, col, matrix


class _Draft:
    """The cone program of some working samples, under construction.

    Columns are theta, one level per term, one magnitude per working sample of a mean term, and last the common
    relative excess where `elastic` prices one. Residuals are scaled by each term's load, unknowns by the program's
    scale. What is added answers its place: the rows whose multipliers it will read.
    """

    def __init__(self, program: Program, working: Working, elastic: float | None) -> None:
        self.program, self.working, self.elastic = program, working, elastic
        self.equal, self.linear, self.second, self.spectral = _Cone(), _Cone(), _Cone(), _Cone()
        self.sizes: list[int] = []
        self.orders: list[int] = []
        extra = [len(w) if t.norm == "mean" else 0 for t, w in zip(program.terms, working.terms, strict=True)]
        self.first = len(program.unknowns) + len(program.terms) + np.cumsum((0, *extra))
        self.excess = int(self.first[-1])
        self.cost = np.zeros(self.excess + (elastic is not None))
        if elastic is not None:
            self.cost[self.excess] = elastic
            self.linear.add([0.0], (0, self.excess, -1.0))

    @property
    def cones(self) -> tuple[_Cone, _Cone, _Cone, _Cone]:
        """Equalities, inequalities, second-order and semidefinite cones, in the order of the multipliers."""
        return self.equal, self.linear, self.second, self.spectral

    def limit(self, rows: Rows, chosen: Indices) -> tuple[_Cone, slice]:
        """G theta <= h, or = h, softened by the excess where there is one."""
        G, h = rows.G[chosen] * self.program.scale / rows.scale, rows.h[chosen] / rows.scale
        if rows.equality and self.elastic is None:
            return self.equal, self.equal.add(h, self.equal.dense(G))
        if rows.equality:
            G, h = np.vstack([G, -G]), np.r_[h, -h]
        return self.linear, self.linear.add(h, self.linear.dense(G), *self._ease(np.ones(len(h))))

    def bound(self, limits: Array, sign: float) -> tuple[Indices, slice]:
        """sign theta <= sign limits where these are finite."""
        which = np.flatnonzero(np.isfinite(limits))
        rhs = sign * limits[which] / self.program.scale[which]
        return which, self.linear.add(rhs, (np.arange(len(which)), which, sign))

    def price(self, i: int) -> slice | None:
        """What a term's level costs, or the cap it must keep (then its place)."""
        term, load = self.program.terms[i], self.program.loads[i]
        level = len(self.program.unknowns) + i
        if term.cap is None:
            self.cost[level] = term.factor * load
            return None
        return self.linear.add([term.cap / load], (0, level, 1.0), *self._ease(np.array([term.cap / load])))

    def term(self, i: int) -> slice:
        """The cones that keep a term's norm below its level."""
        program, flat = self.program, self.working.terms[i]
        term, load, P = program.terms[i], program.loads[i], len(program.unknowns)
        level = P + i
        if term.norm == "rms":
            factor = term.triangle
            self.sizes.append(P + 2)
            body = self.second.dense(-factor[:, :P] * program.scale / load, 1)
            return self.second.add(np.r_[0.0, factor[:, P] / load], (0, level, -1.0), body)
        sample, state, row = spread(term.sizes, flat)
        counts = np.bincount(sample, minlength=len(flat)) + 1
        head, at = np.cumsum(counts) - counts, _below_heads(sample)
        rhs = np.zeros(int(counts.sum()))
        rhs[at] = term.b[state, row] / load
        top = level if term.norm == "peak" else self.first[i] + np.arange(len(flat))
        body = (at[:, None], np.arange(P)[None, :], -term.A[state, row] * program.scale / load)
        self.sizes += counts.tolist()
        if term.norm == "mean":
            weights = term.weight[flat // len(term.sizes)]
            self.linear.add([0.0], (0, level, -1.0), (0, top, weights))
        return self.second.add(rhs, (head, top, -1.0), body)

    def definite(self, one: Definite) -> slice:
        """S0 + sum theta S positive semidefinite."""
        self.orders.append(len(one.S0))
        slope = -triangle(one.S).T * self.program.scale
        return self.spectral.add(triangle(one.S0), self.spectral.dense(slope))

    def _ease(self, size: Array) -> list[tuple[Any, Any, Any]]:
        """What the excess gives to rows, in units of their size."""
        return [(np.arange(len(size)), self.excess, -size)] if self.elastic is not None else []


def solve_restricted(program: Program, working: Working, elastic: float | None = None) -> Answer:
    """Solve over the working samples; elastic is the price of a common relative excess over all limits."""
    P, loads, draft = len(program.unknowns), program.loads, _Draft(program, working, elastic)
    limits = [draft.limit(rows, chosen) for rows, chosen in zip(program.rows, working.rows, strict=True)]
    bounds = [draft.bound(program.lower, -1.0), draft.bound(program.upper, 1.0)]
    caps = [draft.price(i) for i in range(len(loads))]
    terms = [draft.term(i) for i in range(len(loads))]
    spectral = [draft.definite(one) for one in program.definite]
    solution = _clarabel(draft.cost, draft.cones, draft.sizes, draft.orders)
    if "Infeasible" in str(solution.status):
        return Answer(False, np.zeros(P))
    x, z = np.array(solution.x), np.array(solution.z) * max(np.abs(draft.cost).max(), TINY)
    begin = dict(zip(draft.cones, np.cumsum((0, *[cone.count for cone in draft.cones[:-1]])).tolist(), strict=True))

    def dual(cone: _Cone, place: slice) -> Array:
        return z[begin[cone] + place.start : begin[cone] + place.stop]

    answer = Answer(True, x[:P] * program.scale)
    for (cone, place), rows in zip(limits, program.rows, strict=True):
        multiplier = dual(cone, place)
        if rows.equality and elastic is not None:
            multiplier = np.subtract(*np.split(multiplier, 2))
        answer.row.append(multiplier / rows.scale)
    answer.lower, answer.upper = np.zeros(P), np.zeros(P)
    for target, (which, place) in zip((answer.lower, answer.upper), bounds, strict=True):
        target[which] = dual(draft.linear, place) / program.scale[which]
    for term, load, place, cap, flat in zip(program.terms, loads, terms, caps, working.terms, strict=True):
        multiplier = dual(draft.second, place) / load
        smooth = term.norm == "rms"
        answer.level.append(float(multiplier[0]) if smooth else 0.0)
        answer.y.append(-multiplier[1:] if smooth else -multiplier[_below_heads(spread(term.sizes, flat)[0])])
        answer.cap.append(float(dual(draft.linear, cap)[0]) / load if cap is not None else 0.0)
    answer.definite = [square(dual(draft.spectral, at), k) for at, k in zip(spectral, draft.orders, strict=True)]
    answer.excess = float(max(0.0, x[draft.excess])) if elastic is not None else 0.0
    return answer


def _below_heads(sample: Indices) -> Indices:
    """Rows of samples among cones that each begin with a row of their own."""
    return np.arange(len(sample)) + sample + 1


def triangle(matrix: Array) -> Array:
    """Upper triangle (..., k (k + 1) / 2) of symmetric matrices, column by column, with its scalar product kept."""
    i, j = _upper(matrix.shape[-1])
    return matrix[..., i, j] * np.where(i == j, 1.0, np.sqrt(2.0))


def square(values: Array, k: int) -> Array:
    """The symmetric matrix (k, k) behind a triangle."""
    i, j = _upper(k)
    matrix = np.zeros((k, k))
    matrix[i, j] = matrix[j, i] = values / np.where(i == j, 1.0, np.sqrt(2.0))
    return matrix


def _upper(k: int) -> tuple[Indices, Indices]:
    j, i = np.tril_indices(k)
    return i, j


def _clarabel(cost: Array, cones: tuple[_Cone, ...], sizes: list[int], orders: list[int]) -> Any:
    import clarabel
    from scipy import sparse

    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
    width, base = len(cost), np.cumsum((0, *[cone.count for cone in cones]))
    row = np.concatenate([part + base[k] for k, cone in enumerate(cones) for part in cone.row])
    col = np.concatenate([part for cone in cones for part in cone.col])
    val = np.concatenate([part for cone in cones for part in cone.val])
    keep = val != 0
    A = sparse.csc_matrix((val[keep], (row[keep], col[keep])), shape=(int(base[-1]), width))
    b = np.concatenate([part for cone in cones for part in cone.rhs])
    kinds: list[Any] = [clarabel.ZeroConeT(cones[0].count)] if cones[0].count else []
    kinds += [clarabel.NonnegativeConeT(cones[1].count)] if cones[1].count else []
    kinds += [clarabel.SecondOrderConeT(size) for size in sizes]
    kinds += [clarabel.PSDTriangleConeT(order) for order in orders]
    price = cost / max(np.abs(cost).max(), TINY)
    return clarabel.DefaultSolver(sparse.csc_matrix((width, width)), price, A, b, kinds, settings).solve()
