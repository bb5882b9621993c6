"""Geometry around the convex program: screened starts, then sequential convex programming."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from equipoise.affine import Array, Geometry, Unknown
from equipoise.seeding import generator
from equipoise.solve.answer import Working
from equipoise.solve.exchange import Solution, solve
from equipoise.solve.program import Program, norm_value

STEP = 1e-30
PENALTY = 30.0
MARGIN = 1e-8
BENT = 0.7
LATELY = 3
"""Steps that together must be worth it, where a descent is not to be patient."""
AT_ONCE = 10_000
"""Rows of states times candidates that one program holds, so that its arrays stay in the cache."""

Build = Callable[[Geometry], Program]
Judge = Callable[[Program, int, float], Array]


@dataclass(frozen=True)
class Freedom:
    """One geometry parameter that may move: its name, unit and bounds."""

    name: str
    unit: str
    lower: float
    upper: float


@dataclass(frozen=True, eq=False)
class Local:
    """A local optimum: gamma (G,), the merit N + penalty * excess, what one more step would gain.

    prices (G,) are those of the bounds of gamma, limits {limit: price} those of limits where geometry may move too.
    """

    gamma: Array
    merit: float
    excess: float
    stationarity: float
    solution: Solution
    prices: Array
    limits: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Optima:
    """All starts' results, best first, and the seed that drew them."""

    found: tuple[Local, ...]
    seed: int

    @property
    def best(self) -> Local:
        """The best local optimum."""
        return self.found[0]

    @property
    def distinct(self) -> int:
        """How many different optima the starts ended in."""
        return distinct(self.found)


def distinct(found: Sequence[Local]) -> int:
    """How many different merit values there are, to 0.01 % of the largest."""
    merits = np.array([local.merit for local in found])
    scale = max(float(np.abs(merits).max()), 1e-300)
    return 1 + int((np.diff(np.sort(merits)) > 1e-4 * scale).sum())


@dataclass(frozen=True, eq=False)
class _Point:
    """A visited geometry with its exact inner solution."""

    gamma: Array
    program: Program
    solution: Solution
    merit: float


def screen(
    build: Build, rows: int, freedoms: Sequence[Freedom], count: int, seed: int, load: float, judge: Judge
) -> tuple[Array, Array]:
    """Sobol geometries (K, G) with what a judge makes of them on that many rows of states, best first."""
    gammas = sown(freedoms, count, seed)
    chunks = np.array_split(gammas, -(-len(gammas) * rows // AT_ONCE))
    score = np.concatenate([judge(build(chunk), len(chunk), load) for chunk in chunks])
    order = np.argsort(score, kind="stable")
    return gammas[order], score[order]


def sown(freedoms: Sequence[Freedom], count: int, seed: int) -> Array:
    """At least `count` Sobol geometries (K, G) within the bounds."""
    from scipy.stats import qmc

    low, high = _bounds(freedoms)
    unit = qmc.Sobol(len(freedoms), rng=generator(seed)).random_base2(max(3, int(np.ceil(np.log2(count)))))
    return low + unit * (high - low)


def by_limits(program: Program, count: int, load: float) -> Array:
    """The merit of every candidate with its limits in the program: where nothing but limits asks for anything."""
    solutions = [solve(program.take(index), elastic=load) for index in range(count)]
    return np.array([solution.objective + load * min(solution.excess, 1e3) for solution in solutions])


def by_least_squares(program: Program, count: int, load: float) -> Array:
    """Objective of the batched least-squares solution of every candidate, limits as a penalty."""
    P = len(program.unknowns)
    theta = np.zeros((count, P))
    if P:
        gram, side = np.zeros((count, P, P)), np.zeros((count, P))
        for term in program.terms:
            root = np.sqrt(term.weight)[:, None]
            A = (term.A * root[..., None]).reshape(*term.A.shape[:-3], -1, P)
            b = (term.b * root).reshape(*term.b.shape[:-2], -1)
            gram += np.swapaxes(A, -1, -2) @ A
            side += (np.swapaxes(A, -1, -2) @ b[..., None])[..., 0]
        scale = 1.0 / np.sqrt(np.maximum(np.einsum("cpp->cp", gram), 1e-300))
        scaled = gram * scale[:, :, None] * scale[:, None, :]
        theta = -scale * np.einsum("cpq,cq->cp", np.linalg.pinv(scaled, rcond=1e-10, hermitian=True), side * scale)
        theta = np.clip(theta, program.lower, program.upper)
    score, excess = np.zeros(count), np.zeros(count)
    for term in program.terms:
        if term.cap is None:
            residual = term.b + (term.A @ theta[:, None, :, None])[..., 0]
            score += term.factor * norm_value(term.norm, term.magnitudes(residual), term.weight)
    for rows in program.rows:
        if rows.h.size:
            gap = (rows.G @ theta[:, :, None])[..., 0] - rows.h
            excess = np.maximum(excess, (np.abs(gap) if rows.equality else gap).max(axis=-1) / rows.scale)
    return score + load * np.minimum(excess, 1e3)


def spread_out(gammas: Array, freedoms: Sequence[Freedom], count: int) -> Array:
    """The first `count` of ranked geometries that keep a distance from each other, then simply the next best."""
    low, high = _bounds(freedoms)
    unit = (gammas - low) / np.maximum(high - low, 1e-300)
    chosen: list[int] = []
    for index in range(len(unit)):
        if len(chosen) == count:
            break
        if all(np.abs(unit[index] - unit[other]).max() > 0.15 for other in chosen):
            chosen.append(index)
    rest = [index for index in range(len(unit)) if index not in chosen]
    return gammas[(chosen + rest)[:count]]


def _bounds(freedoms: Sequence[Freedom]) -> tuple[Array, Array]:
    return np.array([f.lower for f in freedoms]), np.array([f.upper for f in freedoms])


def linearise(build: Build, freedoms: Sequence[Freedom], gamma: Array, theta: Array) -> Program:
    """The program over (theta, delta gamma): residuals and limits to first order, by complex step.

    r ~ b + A theta + sum_g (db/dg + dA/dg theta0) delta_g, rows likewise; derivatives exact to rounding.
    """
    steps = gamma + 1j * STEP * np.eye(len(gamma))
    program = build(steps)
    moves = tuple(Unknown(f.name, f.unit) for f in freedoms)
    unknowns = program.unknowns + moves
    terms, rows = [], []
    for term in program.terms:
        b, A = term.b, term.A
        if np.iscomplexobj(b) or np.iscomplexobj(A):
            slope = _derivative(b, 2) + _derivative(A, 3) @ theta
        else:
            slope = np.zeros((1, *b.shape[-2:]))
        slope = np.broadcast_to(slope, (len(gamma), *slope.shape[1:]))
        A0 = np.concatenate([_base(A, 3), np.moveaxis(slope, 0, -1)], axis=-1)
        terms.append(replace(term, b=_base(b, 2), A=A0))
    for row in program.rows:
        slope = _derivative(row.G, 2) @ theta - _derivative(row.h, 1)
        slope = np.broadcast_to(slope, (len(gamma), slope.shape[-1]))
        G0 = np.concatenate([_base(row.G, 2), slope.T], axis=-1)
        rows.append(replace(row, G=G0, h=_base(row.h, 1), unknowns=unknowns))
    definite = tuple(one.expand(unknowns) for one in program.definite)
    return Program(unknowns, tuple(terms), tuple(rows), definite)


def _derivative(array: Array, rank: int) -> Array:
    """Imaginary part over the step, with a candidate axis first (of length one where nothing depends on gamma)."""
    slope = np.imag(array) / STEP
    return slope if array.ndim > rank else slope[None]


def _base(array: Array, rank: int) -> Array:
    return np.real(array[0] if array.ndim > rank else array)


def _within(program: Program, freedoms: Sequence[Freedom], gamma: Array, radius: float) -> Program:
    """The linearised program with its moves kept in the trust region and the bounds."""
    low, high = _bounds(freedoms)
    reach = radius * (high - low)
    lower, upper = np.maximum(low - gamma, -reach), np.minimum(high - gamma, reach)
    fixed = len(program.unknowns) - len(freedoms)
    moves = tuple(
        replace(u, lower=float(lo), upper=float(hi))
        for u, lo, hi in zip(program.unknowns[fixed:], lower, upper, strict=True)
    )
    return program.bounded(program.unknowns[:fixed] + moves)


def descend(
    build: Build,
    freedoms: Sequence[Freedom],
    gamma: Array,
    load: float,
    *,
    penalty: float = PENALTY,
    iterations: int = 60,
    precision: float = 1e-9,
    radius: float = 0.2,
    patience: float = 0.0,
) -> Local:
    """Sequential convex programming from one geometry.

    Every step solves the linearised program in a trust region on the moves and is judged on the true
    residual with theta solved anew. Where curvature spoils a step, the model is shifted by what it missed and
    solved again, so that curved valleys are followed in long steps; limits are elastic at `penalty` times the
    load per unit of relative excess. It ends where a further step may gain less than `precision` times the load, or
    where the last few together gained less than the share `patience` of the merit.
    """
    low, high = _bounds(freedoms)
    span = np.maximum(high - low, 1e-300)
    price = penalty * load

    def inner(at: Array, warm: Working | None) -> _Point:
        program = _tight(build(at[None]).take(0))
        solution = solve(program, elastic=price, warm=warm)
        return _Point(at, program, solution, solution.objective + price * solution.excess)

    here = inner(np.clip(gamma, low, high), None)
    predicted, warm, trial, count = np.inf, None, here.solution, 0
    merits = [here.merit]
    for _ in range(iterations):
        model = _tight(linearise(build, freedoms, here.gamma, here.solution.theta))
        count, moved = len(here.solution.theta), False
        while radius > 1e-9 and not moved:
            trial = solve(_within(model, freedoms, here.gamma, radius), elastic=price, warm=warm)
            warm = trial.working
            predicted = here.merit - (trial.objective + price * trial.excess)
            there = inner(np.clip(here.gamma + trial.theta[count:], low, high), here.solution.working)
            if predicted <= precision * load:
                here = there if here.merit - there.merit > 0.05 * predicted > 1e-13 * load else here
                break
            ratio = (here.merit - there.merit) / predicted
            if ratio < BENT:
                bent = _within(_bend(model, there.program, trial.theta), freedoms, here.gamma, radius)
                again = solve(bent, elastic=price, warm=warm)
                second = inner(np.clip(here.gamma + again.theta[count:], low, high), here.solution.working)
                if second.merit < there.merit:
                    there, ratio = second, (here.merit - second.merit) / predicted
            largest = float(np.abs((there.gamma - here.gamma) / span).max())
            if ratio > 0.05:
                here, moved = there, True
                radius = min(1.0, max(radius, 2 * largest)) if ratio > 0.7 else radius if ratio > 0.3 else largest / 2
            else:
                radius = min(radius, max(largest, 1e-12)) / 4
        merits.append(here.merit)
        if not moved or (len(merits) > LATELY and merits[-1 - LATELY] - here.merit < patience * here.merit):
            break
    gamma = here.gamma
    priced = trial.prices.upper - trial.prices.lower
    prices = priced[count:] if len(priced) == count + len(gamma) else np.zeros(len(gamma))
    at_bound = (np.abs(gamma - low) <= 1e-7 * span) | (np.abs(gamma - high) <= 1e-7 * span)
    excess, stationarity = here.solution.excess, max(predicted, 0.0)
    limits = trial.prices.limits if trial is not here.solution else {}
    return Local(gamma, here.merit, excess, stationarity, here.solution, np.where(at_bound, prices, 0.0), limits)


def _bend(model: Program, there: Program, x: Array) -> Program:
    """The linear model shifted by what it missed at x = (theta, move): a second-order correction of the step."""
    theta = x[: len(there.unknowns)]
    terms = tuple(
        replace(flat, b=flat.b + true.residual(theta) - flat.residual(x))
        for flat, true in zip(model.terms, there.terms, strict=True)
    )
    rows = tuple(
        flat if flat.equality else replace(flat, h=flat.h - (true.G @ theta - true.h) + (flat.G @ x - flat.h))
        for flat, true in zip(model.rows, there.rows, strict=True)
    )
    return Program(model.unknowns, terms, rows, model.definite)


def _tight(program: Program) -> Program:
    """The program with every limit a hair tighter, so that its answer passes the exact limits."""
    rows = tuple(r if r.equality else replace(r, h=r.h - MARGIN * r.scale) for r in program.rows)
    return replace(program, rows=rows)
