"""How good an answer is, recomputed from the problem's own data: primal, dual, gap."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from equipoise.affine import Array
from equipoise.solve.answer import Answer, Working, spread
from equipoise.solve.program import Program, Term


@dataclass(frozen=True, eq=False)
class Multipliers:
    """Prices at the optimum: per limit the sum over its rows, per unknown's bound."""

    limits: dict[str, float] = field(default_factory=dict)
    lower: Array = field(default_factory=lambda: np.zeros(0))
    upper: Array = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True)
class Gap:
    """primal >= optimum >= dual; stationarity is what is left of the dual's equality, as a norm share."""

    primal: float
    dual: float
    violation: float

    @property
    def gap(self) -> float:
        """primal - dual, in the unit of the objective."""
        return self.primal - self.dual


@dataclass(eq=False)
class _Columns:
    """Multipliers with what each adds to the stationarity (P,) and to the dual value."""

    slope: list[Array] = field(default_factory=list)
    value: list[Array] = field(default_factory=list)
    size: list[Array] = field(default_factory=list)

    def add(self, slope: Array, value: Array | float, size: Array | float) -> int:
        self.slope.append(np.atleast_2d(slope))
        self.value.append(np.atleast_1d(value))
        self.size.append(np.atleast_1d(np.asarray(size, dtype=float)))
        return len(self.slope) - 1


def certify(program: Program, working: Working, answer: Answer) -> tuple[Gap, Multipliers]:
    """Recompute primal and dual values from b, A, G, h and the multipliers.

    dual = sum y . b - lambda . h - nu . f + bounds, with sum A' y + G' lambda + E' nu + bounds = 0 and the dual
    norm of y at most each term's factor. The solver's multipliers are first moved onto that equality
    (smallest relative change), then scaled into the dual norm's ball; signs are enforced.
    """
    theta = answer.theta
    primal = program.objective(theta)
    if not theta.size:
        return Gap(primal, primal, program.violation(theta)), Multipliers()
    columns = _Columns()
    for i, term in enumerate(program.terms):
        _term_columns(columns, term, working, answer, i)
    rows_at = []
    for rows, chosen, multiplier in zip(program.rows, working.rows, answer.row, strict=True):
        price = multiplier if rows.equality else np.maximum(multiplier, 0.0)
        rows_at.append(columns.add(rows.G[chosen], -rows.h[chosen], price))
    P = len(theta)
    definite_at = [
        columns.add(-one.S.reshape(P, -1).T, -one.S0.ravel(), Z.ravel())
        for one, Z in zip(program.definite, answer.definite, strict=True)
    ]
    lower = columns.add(
        -np.eye(P), np.where(np.isfinite(program.lower), program.lower, 0.0), np.maximum(answer.lower, 0)
    )
    upper = columns.add(
        np.eye(P), np.where(np.isfinite(program.upper), -program.upper, 0.0), np.maximum(answer.upper, 0)
    )
    slope = np.concatenate([part.reshape(-1, P) for part in columns.slope])
    value = np.concatenate(columns.value)
    cuts = np.cumsum([len(part) for part in columns.size])[:-1]
    size = np.concatenate(columns.size)
    smooth = next((i for i, term in enumerate(program.terms) if term.norm == "rms" and answer.level[i] > 0), None)
    if smooth is None:
        size = _onto_stationarity(slope, size)
    parts = np.split(size, cuts)
    one_sided = [k for k, rows in zip(rows_at, program.rows, strict=True) if not rows.equality] + [lower, upper]
    for k in one_sided:
        parts[k] = np.maximum(parts[k], 0.0)
    for k in definite_at:
        parts[k] = _semidefinite(parts[k])
    size = np.concatenate(parts)
    leftover, gain = size @ slope, 0.0
    norms = [_dual_norm(t, working, parts[i], i) for i, t in enumerate(program.terms)]
    if smooth is not None:
        leftover, gain, norms[smooth] = _through_rms(program, parts[smooth], smooth, leftover)
    # A cap's own price may be any that covers its multipliers: their dual norm is the cheapest.
    excess = max([1.0, *(norm / t.factor for t, norm in zip(program.terms, norms, strict=True) if t.cap is None)])
    caps = sum(norm * term.cap for term, norm in zip(program.terms, norms, strict=True) if term.cap is not None)
    dual = (float(size @ value) + gain - caps - float(np.abs(leftover) @ np.abs(theta))) / excess
    prices: dict[str, float] = {}
    for k, rows in zip(rows_at, program.rows, strict=True):
        prices[rows.limit] = prices.get(rows.limit, 0.0) + float(np.abs(parts[k]).sum() / excess)
    for k, one in zip(definite_at, program.definite, strict=True):
        prices[one.limit] = prices.get(one.limit, 0.0) + float(np.abs(parts[k]).sum() / excess)
    multipliers = Multipliers(prices, parts[lower] / excess, parts[upper] / excess)
    # Zero residual bounds every norm from below.
    return Gap(primal, max(dual, 0.0), program.violation(theta)), multipliers


def _semidefinite(flat: Array) -> Array:
    """The nearest positive semidefinite matrix, flat as it came."""
    k = round(len(flat) ** 0.5)
    values, vectors = np.linalg.eigh(flat.reshape(k, k))
    return ((vectors * np.maximum(values, 0.0)) @ vectors.T).ravel()


def _term_columns(columns: _Columns, term: Term, working: Working, answer: Answer, i: int) -> None:
    """One column group per term: its working samples, or the rows of its triangle."""
    if term.norm == "rms":
        direction = term.triangle @ np.append(answer.theta, 1.0)
        along = answer.level[i] * direction / max(float(np.linalg.norm(direction)), 1e-300)
        columns.add(term.triangle[:, :-1], term.triangle[:, -1], answer.y[i] if answer.y[i].size else along)
    else:
        _, state, row = spread(term.sizes, working.terms[i])
        columns.add(term.A[state, row], term.b[state, row], answer.y[i])


def _onto_stationarity(slope: Array, size: Array) -> Array:
    """Move multipliers onto slope' size = 0 by the smallest change relative to their own size."""
    for _ in range(3):
        residual = size @ slope
        weighted = slope * (np.abs(size) ** 2)[:, None]
        gram = slope.T @ weighted
        size = size - np.abs(size) ** 2 * (slope @ (np.linalg.pinv(gram, rcond=1e-13, hermitian=True) @ residual))
    return size


def _through_rms(program: Program, y: Array, i: int, residual: Array) -> tuple[Array, float, float]:
    """Take a stationarity residual up with y + R z of an rms term of triangle R, whose multipliers are dense.

    Returns what is left of the residual, the change of the dual value and the new dual norm.
    """
    factor = program.terms[i].triangle
    slope, known = factor[:, :-1] * program.scale, factor[:, -1]
    step = slope @ np.linalg.lstsq(slope.T @ slope, -residual * program.scale, rcond=1e-14)[0]
    return residual + factor[:, :-1].T @ step, float(step @ known), float(np.linalg.norm(y + step))


def _dual_norm(term: Term, working: Working, y: Array, i: int) -> float:
    """Dual norm of a term's multipliers."""
    if term.norm == "rms":
        return float(np.linalg.norm(y))
    sample = spread(term.sizes, working.terms[i])[0]
    magnitude = np.sqrt(np.bincount(sample, weights=y * y, minlength=len(working.terms[i])))
    if term.norm == "peak":
        return float(magnitude.sum())
    weight = np.maximum(term.weight[working.terms[i] // len(term.sizes)], 1e-300)
    return float((magnitude / weight).max(initial=0.0))
