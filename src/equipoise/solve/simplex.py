"""Scalar peak and mean terms: the dual of the linear program, few rows and many columns, by HiGHS' dual simplex."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.solve.answer import Answer, Working
from equipoise.solve.program import Program

KIND = 1 << 40
"""More than any variable's number within its kind."""
ONE = np.zeros(1, dtype=int)
BASIC = 1e-11
"""Value from which a variable counts as basic."""
OPTIONS = {
    "output_flag": False,
    "presolve": "off",
    "solver": "simplex",
    "primal_feasibility_tolerance": 1e-10,
    "dual_feasibility_tolerance": 1e-10,
}


def is_linear(program: Program) -> bool:
    """Whether every term is a peak, or a mean without a cap, of scalar blocks."""
    return (
        bool(program.unknowns)
        and not program.definite
        and all(
            (term.norm == "peak" or (term.norm == "mean" and term.cap is None))
            and all(size == 1 for size in term.sizes)
            for term in program.terms
        )
    )


@dataclass(eq=False)
class _Columns:
    """Dual variables under construction: stationarity (P,), budget rows (K,), objective and bounds of each."""

    slope: list[Array] = field(default_factory=list)
    budget: list[Array] = field(default_factory=list)
    value: list[Array] = field(default_factory=list)
    low: list[Array] = field(default_factory=list)
    high: list[Array] = field(default_factory=list)
    names: list[Indices] = field(default_factory=list)
    count: int = 0

    def add(self, slope: Array, value: Array, budget: Array, low: float, high: float, which: Indices) -> slice:
        """Append one variable per row of slope; budget (K,) is what each takes from the budgets.

        which numbers them within their kind, the same in similar programs.
        """
        count = len(value)
        self.names.append(which + KIND * len(self.names))
        self.slope.append(slope)
        self.value.append(value)
        self.budget.append(np.broadcast_to(budget, (count, len(budget))))
        self.low.append(np.full(count, low))
        self.high.append(np.full(count, high))
        self.count += count
        return slice(self.count - count, self.count)


def solve_linear(program: Program, working: Working, elastic: float | None = None) -> Answer | None:
    """Solve over the working samples and rows; elastic is the price of a common relative excess over all limits.

        max  sum y . b - mu . h - u . nu + l . lam - sum cap kappa
        s.t. sum A' y + G' mu + nu - lam = 0;  peak: sum |y| <= factor or kappa;  mean: |y_n| <= factor w_n

    theta is the price of the stationarity rows, so the vertex that solves the dual is exact in both. None where
    there is no such vertex: the rows conflict, or the simplex gave up.
    """
    P, T, scale, loads = len(program.unknowns), len(program.terms), program.scale, program.loads
    # Multipliers are counted in a unit that makes those of samples about one.
    unit = max(
        term.factor * load * (float(term.weight.mean()) if term.norm == "mean" else 1.0)
        for term, load in zip(program.terms, loads, strict=True)
    )
    columns = _Columns()
    budgets = np.eye(T + 1)  # one per term, the last is the elastic price
    ease = budgets[T] if elastic is not None else np.zeros(T + 1)
    available = np.zeros(T + 1)
    available[T] = elastic / unit if elastic is not None else 0.0

    samples, caps = [], []
    for i, (term, load, flat) in enumerate(zip(program.terms, loads, working.terms, strict=True)):
        state, row = np.divmod(flat, len(term.sizes))
        A, b = term.A[state, row] * (scale / load), term.b[state, row] / load
        allowance = term.factor * load / unit
        if term.norm == "mean":
            share = allowance * term.weight[state]
            samples.append((columns.add(A * share[:, None], b * share, 0 * ease, -1.0, 1.0, flat), share))
            caps.append(None)
            continue
        place = columns.add(np.vstack([A, -A]), np.r_[b, -b], budgets[i], 0.0, np.inf, np.r_[2 * flat, 2 * flat + 1])
        samples.append((place, None))
        if term.cap is None:
            available[i] = allowance
            caps.append(None)
        else:
            price = -budgets[i] + ease * term.cap / load
            caps.append(columns.add(np.zeros((1, P)), np.array([-term.cap / load]), price, 0.0, np.inf, ONE))
    row_places = []
    for rows, chosen in zip(program.rows, working.rows, strict=True):
        G, h = rows.G[chosen] * scale / rows.scale, rows.h[chosen] / rows.scale
        places = [columns.add(G, -h, ease, 0.0, np.inf, chosen)]
        places += [columns.add(-G, h, ease, 0.0, np.inf, chosen)] if rows.equality else []
        row_places.append(places)
    bound_places = []
    for limits, sign in ((program.lower, -1.0), (program.upper, 1.0)):
        which = np.flatnonzero(np.isfinite(limits))
        identity = sign * np.eye(P)[which]
        value = -sign * limits[which] / scale[which]
        bound_places.append((which, columns.add(identity, value, 0 * ease, 0.0, np.inf, which)))

    budget = np.concatenate(columns.budget)
    used = np.flatnonzero((budget != 0).any(axis=0))
    dual, marginal = _highs(
        cost=-np.concatenate(columns.value),
        columns=np.hstack([np.concatenate(columns.slope), budget[:, used]]),
        low=np.concatenate(columns.low),
        high=np.concatenate(columns.high),
        sides=np.append(np.zeros(P), available[used]),
        equal=P,
        names=np.concatenate(columns.names),
        working=working,
    )
    if dual is None:
        return None
    answer = Answer(True, marginal[:P] * scale, lower=np.zeros(P), upper=np.zeros(P))
    if elastic is not None and T in used:
        answer.excess = float(max(0.0, -marginal[P + int(np.searchsorted(used, T))]))
    x = dual * unit
    for (place, share), load, cap in zip(samples, loads, caps, strict=True):
        signed = x[place] * share if share is not None else np.subtract(*np.split(x[place], 2))
        answer.y.append(signed / load)
        answer.level.append(0.0)
        answer.cap.append(float(x[cap][0]) / load if cap is not None else 0.0)
    for rows, places in zip(program.rows, row_places, strict=True):
        price = x[places[0]] - (x[places[1]] if rows.equality else 0.0)
        answer.row.append(price / rows.scale)
    for target, (which, place) in zip((answer.lower, answer.upper), bound_places, strict=True):
        target[which] = x[place] / scale[which]
    return answer


def _highs(
    *,
    cost: Array,
    columns: Array,
    low: Array,
    high: Array,
    sides: Array,
    equal: int,
    names: Indices,
    working: Working,
) -> tuple[Array | None, Array]:
    """Variables (n,) and row prices (m,) of min cost . v, columns' v = sides (the first `equal`) or <= sides.

    columns (n, m). No variables where the program is unbounded, which is what an infeasible primal shows. The simplex
    begins at the basis that the working set brings of a similar program, by the names (n,) of variables, and leaves
    its own there.
    """
    import highspy

    count, rows = columns.shape
    solver = _solver()
    floor = np.full(rows, -np.inf)
    floor[:equal] = sides[:equal]
    start = np.arange(count + 1, dtype=np.int32) * rows
    index = np.tile(np.arange(rows, dtype=np.int32), count)
    integrality = np.zeros(count, dtype=np.int32)
    solver.passModel(
        count, rows, count * rows, 1, 1, 0.0,
        cost, low, high, floor, sides, start, index, columns.ravel(), integrality,
    )  # fmt: skip
    if working.basis is not None:
        solver.setBasis(_basis(names, rows, working.basis))
    solver.run()
    if solver.getModelStatus() != highspy.HighsModelStatus.kOptimal:
        return None, np.zeros(rows)
    solution = solver.getSolution()
    value, slack = np.array(solution.col_value), sides - np.array(solution.row_value)
    working.basis = names[(value > BASIC) & (low == 0.0)], equal + np.flatnonzero(slack[equal:] > BASIC)
    return value, np.array(solution.row_dual)


_own = threading.local()


def _solver() -> Any:
    """This thread's HiGHS: to make one takes longer than to solve with it."""
    if not hasattr(_own, "solver"):
        import highspy

        _own.solver = highspy.Highs()
        for option, value in OPTIONS.items():
            _own.solver.setOptionValue(option, value)
    return _own.solver


def _basis(names: Indices, rows: int, known: tuple[Indices, Indices]) -> Any:
    """The variables and rows that were basic, as HiGHS takes them; what is missing it completes."""
    import highspy

    status = highspy.HighsBasisStatus
    basis = highspy.HighsBasis()
    basis.col_status = [status.kBasic if one else status.kLower for one in np.isin(names, known[0])]
    basis.row_status = [status.kBasic if row in known[1] else status.kUpper for row in range(rows)]
    basis.valid = basis.alien = True
    return basis
