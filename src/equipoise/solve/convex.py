"""One restricted cone program: the working samples of a Program, handed to Clarabel, multipliers mapped back."""

from __future__ import annotations

from typing import Any

import clarabel
import numpy as np
from scipy import sparse

from equipoise.affine import Array
from equipoise.solve.answer import Answer, Working, spread
from equipoise.solve.program import Program

TINY = 1e-300


class _Cone:
    """Rows of one cone kind under construction, as triplets: A z + s = rhs, s in the cone."""

    def __init__(self) -> None:
        self.count = 0
        self.rhs: list[Array] = []
        self.row: list[Array] = []
        self.col: list[Array] = []
        self.val: list[Array] = []

    def add(self, rhs: Any, *parts: tuple[Any, Any, Any]) -> slice:
        """Append len(rhs) rows whose entries are (row, column, value) triplets; return their place."""
        rhs = np.atleast_1d(np.asarray(rhs, dtype=float))
        for row, col, val in parts:
            row, col, val = np.broadcast_arrays(row, col, val)
            self.row.append(row.ravel() + self.count)
            self.col.append(col.ravel())
            self.val.append(val.ravel())
        self.rhs.append(rhs)
        place = slice(self.count, self.count + len(rhs))
        self.count = place.stop
        return place

    def dense(self, matrix: Array, first_row: int = 0) -> tuple[Array, Array, Array]:
        """Triplets of a dense (m, P) matrix over theta."""
        rows, cols = np.indices(matrix.shape)
        return rows + first_row, cols, matrix


def solve_restricted(program: Program, working: Working, elastic: float | None = None) -> Answer:
    """Solve over the working samples; elastic is the price of a common relative excess over all limits.

    Columns are theta, one level per term, one magnitude per working sample of a mean term, and last the excess. Residuals are scaled by each term's load, unknowns by the program's scale.
    """
    P, T = len(program.unknowns), len(program.terms)
    scale = program.scale
    loads = program.loads
    extra = [len(w) if t.norm == "mean" else 0 for t, w in zip(program.terms, working.terms, strict=True)]
    first = P + T + np.cumsum((0, *extra))
    excess, width = int(first[-1]), int(first[-1]) + (elastic is not None)
    equal, linear, second = _Cone(), _Cone(), _Cone()
    sizes: list[int] = []
    cost = np.zeros(width)

    def soft(rows: int) -> list[tuple[Any, Any, Any]]:
        return [(np.arange(rows), excess, -1.0)] if elastic is not None else []

    row_places = []
    for rows, chosen in zip(program.rows, working.rows, strict=True):
        G, h = rows.G[chosen] * scale / rows.scale, rows.h[chosen] / rows.scale
        if not rows.equality:
            row_places.append((linear, linear.add(h, linear.dense(G), *soft(len(h)))))
        elif elastic is None:
            row_places.append((equal, equal.add(h, equal.dense(G))))
        else:
            both = np.vstack([G, -G])
            row_places.append((linear, linear.add(np.r_[h, -h], linear.dense(both), *soft(2 * len(h)))))
    bound_places = []
    for limits, sign in ((program.lower, -1.0), (program.upper, 1.0)):
        which = np.flatnonzero(np.isfinite(limits))
        place = linear.add(sign * limits[which] / scale[which], (np.arange(len(which)), which, sign))
        bound_places.append((which, place))
    if elastic is not None:
        cost[excess] = elastic
        linear.add([0.0], (0, excess, -1.0))

    term_places, cap_places = [], []
    for i, (term, load) in enumerate(zip(program.terms, loads, strict=True)):
        level = P + i
        if term.cap is None:
            cost[level] = term.factor * load
            cap_places.append(None)
        else:
            ease = [(0, excess, -term.cap / load)] if elastic is not None else []
            cap_places.append(linear.add([term.cap / load], (0, level, 1.0), *ease))
        if term.norm == "rms":
            factor = term.triangle
            rhs = np.r_[0.0, factor[:, P] / load]
            place = second.add(rhs, (0, level, -1.0), second.dense(-factor[:, :P] * scale / load, 1))
            sizes.append(P + 2)
        else:
            flat = working.terms[i]
            sample, state, row = spread(term.sizes, flat)
            counts = np.bincount(sample, minlength=len(flat)) + 1
            head = np.cumsum(counts) - counts
            at = np.arange(len(sample)) + sample + 1
            rhs = np.zeros(int(counts.sum()))
            rhs[at] = term.b[state, row] / load
            top = level if term.norm == "peak" else first[i] + np.arange(len(flat))
            body = (at[:, None], np.arange(P)[None, :], -term.A[state, row] * scale / load)
            place = second.add(rhs, (head, top, -1.0), body)
            sizes += counts.tolist()
        if term.norm == "mean":
            weights = term.weight[working.terms[i] // len(term.sizes)]
            linear.add([0.0], (0, level, -1.0), (0, first[i] + np.arange(len(weights)), weights))
        term_places.append(place)

    solution = _clarabel(cost, (equal, linear, second), sizes, width)
    if "Infeasible" in str(solution.status):
        return Answer(False, np.zeros(P))
    x, z = np.array(solution.x), np.array(solution.z) * max(np.abs(cost).max(), TINY)
    begin = {equal: 0, linear: equal.count, second: equal.count + linear.count}

    def dual(cone: _Cone, place: slice) -> Array:
        return z[begin[cone] + place.start : begin[cone] + place.stop]

    answer = Answer(True, x[:P] * scale)
    for (cone, place), rows in zip(row_places, program.rows, strict=True):
        multiplier = dual(cone, place)
        if rows.equality and elastic is not None:
            multiplier = np.subtract(*np.split(multiplier, 2))
        answer.row.append(multiplier / rows.scale)
    answer.lower, answer.upper = np.zeros(P), np.zeros(P)
    for target, (which, place) in zip((answer.lower, answer.upper), bound_places, strict=True):
        target[which] = dual(linear, place) / scale[which]
    for term, load, place, cap, flat in zip(program.terms, loads, term_places, cap_places, working.terms, strict=True):
        multiplier = dual(second, place) / load
        sample = spread(term.sizes, flat)[0]
        answer.level.append(float(multiplier[0]) if term.norm == "rms" else 0.0)
        answer.y.append(np.zeros(0) if term.norm == "rms" else -multiplier[np.arange(len(sample)) + sample + 1])
        answer.cap.append(float(dual(linear, cap)[0]) / load if cap is not None else 0.0)
    answer.excess = float(max(0.0, x[excess])) if elastic is not None else 0.0
    return answer


def _clarabel(cost: Array, cones: tuple[_Cone, _Cone, _Cone], sizes: list[int], width: int) -> Any:
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
    base = np.cumsum((0, *[cone.count for cone in cones]))
    row = np.concatenate([part + base[k] for k, cone in enumerate(cones) for part in cone.row])
    col = np.concatenate([part for cone in cones for part in cone.col])
    val = np.concatenate([part for cone in cones for part in cone.val])
    keep = val != 0
    A = sparse.csc_matrix((val[keep], (row[keep], col[keep])), shape=(int(base[-1]), width))
    b = np.concatenate([part for cone in cones for part in cone.rhs])
    kinds: list[Any] = [clarabel.ZeroConeT(cones[0].count)] if cones[0].count else []
    kinds += [clarabel.NonnegativeConeT(cones[1].count)] if cones[1].count else []
    kinds += [clarabel.SecondOrderConeT(size) for size in sizes]
    price = cost / max(np.abs(cost).max(), TINY)
    return clarabel.DefaultSolver(sparse.csc_matrix((width, width)), price, A, b, kinds, settings).solve()
