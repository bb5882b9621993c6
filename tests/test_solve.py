"""The convex core against SciPy's solvers, and certificates that cannot be fooled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares, linprog, lsq_linear, nnls

from equipoise.affine import Unknown
from equipoise.errors import InfeasibleError
from equipoise.solve.certificate import certify
from equipoise.solve.exchange import solve
from equipoise.solve.program import NORMS, Program, Rows, Term
from equipoise.solve.shape import Freedom, Local
from equipoise.solve.sharpen import sharpen


def problem(norm, *, seed=0, n=300, rows=3, p=4, sizes=None, bounded=False, limited=False):
    rng = np.random.default_rng(seed)
    scale = np.logspace(-2, 3, p)
    A = rng.normal(size=(n, rows, p)) * scale
    b = rng.normal(size=(n, rows)) * 20 - A @ (rng.normal(size=p) / scale * 30)
    weight = rng.random(n)
    unknowns = tuple(Unknown(f"x{i}", "N", 0.0 if bounded else -np.inf) for i in range(p))
    limits = ()
    if limited:
        limits = (Rows("limit", "N", rng.normal(size=(n, p)) * scale, np.full(n, 40.0), unknowns, scale=40.0),)
    return Program(unknowns, (Term("hold", norm, b, A, weight / weight.sum(), sizes or (1,) * rows),), limits)


def least_distance(A, b, G, h):
    """min |A x + b| subject to G x <= h, by Lawson and Hanson's way through non-negative least squares."""
    Q, R = np.linalg.qr(A)
    c = Q.T @ b
    rows, sides = G @ np.linalg.inv(R), h + G @ np.linalg.solve(R, c)
    _, distance = nnls(np.vstack([-rows.T, -sides]), np.append(np.zeros(len(c)), 1.0))
    return float(np.sqrt(1 / distance**2 - 1 + b @ b - c @ c))


def reference(program):
    """The optimum by HiGHS for scalar peak and mean, by bounded least squares or least distance for rms."""
    (term,) = program.terms
    n, r, p = term.A.shape
    A, b = term.A.reshape(-1, p) * program.scale, term.b.ravel()
    G = np.vstack([rows.G for rows in program.rows]) * program.scale if program.rows else np.zeros((0, p))
    h = np.concatenate([rows.h for rows in program.rows]) if program.rows else np.zeros(0)
    bounds = [(lower, None) if np.isfinite(lower) else (None, None) for lower in program.lower]
    if term.norm == "rms":
        w = np.sqrt(np.repeat(term.weight, r))
        if not len(h):
            low = np.array([-np.inf if lo is None else lo for lo, _ in bounds])
            found = lsq_linear(A * w[:, None], -b * w, (low, np.inf), tol=1e-15, max_iter=2000)
            return float(np.sqrt(2 * found.cost))
        return least_distance(A * w[:, None], b * w, np.vstack([G, -np.eye(p)]), np.append(h, np.zeros(p)))
    wide = n * r if term.norm == "mean" else 1
    e = np.eye(n * r) if term.norm == "mean" else np.ones((n * r, 1))
    upper = np.vstack([np.hstack([A, -e]), np.hstack([-A, -e]), np.hstack([G, np.zeros((len(G), wide))])])
    cost = np.concatenate([np.zeros(p), np.repeat(term.weight, r) if term.norm == "mean" else [1.0]])
    found = linprog(cost, upper, np.concatenate([-b, b, h]), bounds=bounds + [(0, None)] * wide)
    return float(found.fun)


@pytest.mark.parametrize("norm", NORMS)
@pytest.mark.parametrize(("bounded", "limited"), [(False, False), (True, False), (True, True)])
def test_scalar_norms_against_scipy(norm, bounded, limited):
    program = problem(norm, bounded=bounded, limited=limited, seed=3, n=120)
    found = solve(program)
    assert found.objective == pytest.approx(reference(program), rel=2e-7)
    assert found.gap.gap + 1e-9 * found.objective >= 0
    assert found.gap.gap <= 1e-6 * found.objective
    assert found.gap.violation <= 1e-7


@pytest.mark.parametrize("norm", NORMS)
def test_vector_blocks_reach_a_closed_gap(norm):
    found = solve(problem(norm, rows=6, sizes=(3, 2, 1), n=80, bounded=True, limited=True))
    assert -1e-9 <= found.gap.gap / found.objective <= 1e-6


@pytest.mark.parametrize("norm", NORMS)
def test_a_worse_theta_shows_in_the_gap(norm):
    found = solve(problem(norm))
    spoilt = replace(found.answer, theta=found.theta * 1.05)
    gap, _ = certify(found.program, found.working, spoilt)
    assert gap.primal > found.objective * (1 + 1e-6)
    assert gap.gap >= gap.primal - found.objective - 1e-6 * found.objective


def test_wrong_multipliers_never_prove_too_much():
    """Whatever the solver says, the dual stays below the optimum."""
    rng = np.random.default_rng(1)
    found = solve(problem("peak", bounded=True, limited=True))
    for _ in range(20):
        lie = replace(
            found.answer,
            y=[y * rng.uniform(0, 3, y.shape) for y in found.answer.y],
            row=[row * rng.uniform(-1, 3, row.shape) for row in found.answer.row],
        )
        gap, _ = certify(found.program, found.working, lie)
        assert gap.dual <= found.objective * (1 + 1e-9)


def test_prices_are_derivatives_of_the_optimum():
    program = problem("peak", bounded=True, limited=True)
    found = solve(program)
    price = found.prices.limits["limit"]
    assert price > 0
    h = 1e-4
    values = [solve(replace(program, rows=(replace(r, h=r.h + s),))).objective for r in program.rows for s in (h, -h)]
    assert price == pytest.approx((values[1] - values[0]) / (2 * h), rel=1e-3)


def test_conflicting_limits_are_named():
    program = problem("rms")
    G = np.eye(4)[:1]
    rows = (
        Rows("force of s1 <= 3 N", "N", G, np.array([3.0]), program.unknowns, scale=3.0),
        Rows("force of s1 >= 5 N", "N", -G, np.array([-5.0]), program.unknowns, scale=5.0),
        Rows("mass <= 9 kg", "kg", np.eye(4)[1:2], np.array([9.0]), program.unknowns, scale=9.0),
    )
    with pytest.raises(InfeasibleError) as caught:
        solve(replace(program, rows=rows))
    assert "force of s1 <= 3 N and force of s1 >= 5 N conflict" in str(caught.value)
    assert "mass" not in str(caught.value)


def test_a_weighted_list_of_norms_and_a_cap():
    base = problem("rms", n=100)
    (term,) = base.terms
    peak = replace(term, norm="peak", factor=0.5)
    both = solve(Program(base.unknowns, (term, peak)))
    assert both.gap.gap <= 1e-6 * both.objective
    alone = solve(Program(base.unknowns, (replace(peak, factor=1.0),)))
    cap = 1.02 * alone.objective
    kept = solve(Program(base.unknowns, (term, replace(peak, cap=cap))))
    assert peak.value(kept.theta) <= cap * (1 + 1e-7)
    assert kept.objective >= solve(base).objective
    assert kept.gap.gap <= 1e-6 * kept.objective


def test_unknowns_that_trade_freely_are_found_and_settled():
    base = problem("rms", p=3)
    (term,) = base.terms
    twin = replace(term, A=np.concatenate([term.A, term.A[..., :1]], axis=-1))
    found = solve(Program((*base.unknowns, Unknown("twin", "N")), (twin,)))
    assert len(found.flat) == 1
    assert np.abs(found.flat[0] * [0, 1, 1, 0]).max() < 1e-8 * np.abs(found.flat[0]).max()
    assert found.objective == pytest.approx(solve(base).objective, rel=1e-12)
    assert found.theta[0] == pytest.approx(found.theta[3], rel=1e-6)


def test_columns_of_very_different_size_are_scaled():
    program = problem("peak", p=5, seed=7)
    squeeze = np.array([1e6, 1e-6, 1.0, 1e3, 1e-3])
    (term,) = program.terms
    skewed = replace(program, terms=(replace(term, A=term.A * squeeze),))
    assert solve(skewed).objective == pytest.approx(solve(program).objective, rel=1e-8)


def test_a_cap_binds_a_program_that_has_nothing_to_find():
    """Thrift caps the objective of a fixed geometry; an elastic program without unknowns must say by how much."""
    saving = Term("energy", "peak", np.array([[2.0]]), np.zeros((1, 1, 0)), np.ones(1), (1,))
    kept = Term("residual", "peak", np.array([[3.0]]), np.zeros((1, 1, 0)), np.ones(1), (1,), cap=2.0)
    found = solve(Program((), (saving, kept)), elastic=10.0)
    assert found.excess == pytest.approx(0.5, rel=1e-6)
    with pytest.raises(InfeasibleError):
        solve(Program((), (saving, kept)))


def test_the_least_rms_of_a_curved_family_has_all_its_digits():
    """Frequency and phase of a sine with noise: SciPy's least squares to 1e-9, from a start 1e-3 away."""
    x = np.linspace(0, 3, 40)
    y = np.sin(1.7 * x + 0.3) + 0.3 * np.cos(9 * x)

    def build(gamma):
        b = np.sin(gamma[:, :1] * x + gamma[:, 1:]) - y
        term = Term("fit", "rms", b[..., None], np.zeros((1, 40, 1, 0)), np.full(40, 1 / 40), (1,))
        return Program((), (term,))

    def residual(gamma):
        return np.sin(gamma[0] * x + gamma[1]) - y

    best = least_squares(residual, (1.7, 0.3), xtol=1e-15, ftol=1e-15, gtol=1e-15)
    freedoms = (Freedom("a", "", 1.0, 3.0), Freedom("b", "", -1.0, 1.0))
    start = best.x + 1e-3
    near = Local(start, 0.0, 0.0, 1.0, solve(build(start[None]).take(0)), np.zeros(2))
    found = sharpen(build, freedoms, near)
    assert found.gamma == pytest.approx(best.x, abs=1e-8)
    assert found.merit == pytest.approx(np.sqrt(2 * best.cost / 40), rel=1e-13)
    # A bound in the way holds its parameter.
    held = sharpen(build, (Freedom("a", "", 1.0, float(start[0])), freedoms[1]), near)
    assert held.gamma[0] == start[0]
