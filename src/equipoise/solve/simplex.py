"""Scalar peak and mean terms: the dual of the linear program, few rows and many columns, by HiGHS' dual simplex."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from equipoise.affine import Array
from equipoise.solve.answer import Answer, Working
from equipoise.solve.program import Program

TOLERANCE = 1e-10


def is_linear(program: Program) -> bool:
    """Whether every term is a peak, or a mean without a cap, of scalar blocks."""
    return bool(program.unknowns) and all(
        (term.norm == "peak" or (term.norm == "mean" and term.cap is None)) and all(size == 1 for size in term.sizes)
        for term in program.terms
    )


@dataclass(eq=False)
class _Columns:
    """Dual variables under construction: stationarity (P,), budget rows (K,), objective and bounds of each."""

    slope: list[Array] = field(default_factory=list)
    budget: list[Array] = field(default_factory=list)
    value: list[Array] = field(default_factory=list)
    low: list[Array] = field(default_factory=list)
    high: list[Array] = field(default_factory=list)
    count: int = 0

    def add(self, slope: Array, value: Array, budget: Array, low: float, high: float) -> slice:
        """Append one variable per row of slope; budget (K,) is what each takes from the budgets."""
        count = len(value)
        self.slope.append(slope)
        self.value.append(value)
        self.budget.append(np.broadcast_to(budget, (count, len(budget))))
        self.low.append(np.full(count, low))
        self.high.append(np.full(count, high))
        self.count += count
        return slice(self.count - count, self.count)


def solve_linear(program: Program, working: Working, elastic: float | None = None) -> Answer:
    """Solve over the working samples and rows; elastic is the price of a common relative excess over all limits.

        max  sum y . b - mu . h - u . nu + l . lam - sum cap kappa
        s.t. sum A' y + G' mu + nu - lam = 0;  peak: sum |y| <= factor or kappa;  mean: |y_n| <= factor w_n

    theta is the price of the stationarity rows, so the vertex that solves the dual is exact in both.
    """
    from scipy.optimize import linprog

    P, T = len(program.unknowns), len(program.terms)
    scale, loads = program.scale, program.loads
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
        A, b = term.A.reshape(-1, P)[flat] * scale / load, term.b.ravel()[flat] / load
        allowance = term.factor * load / unit
        if term.norm == "mean":
            share = allowance * term.weight[flat // len(term.sizes)]
            samples.append((columns.add(A * share[:, None], b * share, 0 * ease, -1.0, 1.0), share))
            caps.append(None)
            continue
        place = columns.add(np.vstack([A, -A]), np.r_[b, -b], budgets[i], 0.0, np.inf)
        samples.append((place, None))
        if term.cap is None:
            available[i] = allowance
            caps.append(None)
        else:
            price = -budgets[i] + ease * term.cap / load
            caps.append(columns.add(np.zeros((1, P)), np.array([-term.cap / load]), price, 0.0, np.inf))
    row_places = []
    for rows, chosen in zip(program.rows, working.rows, strict=True):
        G, h = rows.G[chosen] * scale / rows.scale, rows.h[chosen] / rows.scale
        places = [columns.add(G, -h, ease, 0.0, np.inf)]
        places += [columns.add(-G, h, ease, 0.0, np.inf)] if rows.equality else []
        row_places.append(places)
    bound_places = []
    for limits, sign in ((program.lower, -1.0), (program.upper, 1.0)):
        which = np.flatnonzero(np.isfinite(limits))
        identity = sign * np.eye(P)[which]
        value = -sign * limits[which] / scale[which]
        bound_places.append((which, columns.add(identity, value, 0 * ease, 0.0, np.inf)))

    budget = np.concatenate(columns.budget)
    used = np.flatnonzero((budget != 0).any(axis=0))
    solution = linprog(
        -np.concatenate(columns.value),
        A_ub=budget[:, used].T,
        b_ub=available[used],
        A_eq=np.concatenate(columns.slope).T,
        b_eq=np.zeros(P),
        bounds=np.column_stack([np.concatenate(columns.low), np.concatenate(columns.high)]),
        method="highs-ds",
        options={"primal_feasibility_tolerance": TOLERANCE, "dual_feasibility_tolerance": TOLERANCE},
    )
    if solution.x is None:
        return Answer(False, np.zeros(P))
    x = solution.x * unit
    answer = Answer(True, solution.eqlin.marginals * scale)
    for (place, share), load, cap in zip(samples, loads, caps, strict=True):
        signed = x[place] * share if share is not None else np.subtract(*np.split(x[place], 2))
        answer.y.append(signed / load)
        answer.level.append(0.0)
        answer.cap.append(float(x[cap][0]) / load if cap is not None else 0.0)
    for rows, places in zip(program.rows, row_places, strict=True):
        price = x[places[0]] - (x[places[1]] if rows.equality else 0.0)
        answer.row.append(price / rows.scale)
    answer.lower, answer.upper = np.zeros(P), np.zeros(P)
    for target, (which, place) in zip((answer.lower, answer.upper), bound_places, strict=True):
        target[which] = x[place] / scale[which]
    if elastic is not None and T in used:
        answer.excess = float(max(0.0, -solution.ineqlin.marginals[list(used).index(T)]))
    return answer
