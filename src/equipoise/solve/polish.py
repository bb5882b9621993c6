"""From a solver's ten digits to rounding: solve the optimum's own active equations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from equipoise.affine import Array
from equipoise.solve.answer import Answer, Working, spread
from equipoise.solve.program import Program

ACTIVE = 1e-6
VANISHED = 1e-6


def polish(program: Program, working: Working, answer: Answer) -> Answer:
    """Refine theta on the active samples, rows and bounds; the answer is kept as it was where that does not help.

    One rms term: the equality-constrained least-squares problem on the active rows. One peak term of scalar
    blocks: the level and theta that all active samples share. Other objectives are left to the solver.
    """
    answer = _vanished(program, answer)
    if len(program.terms) != 1 or program.terms[0].cap is not None or not program.unknowns:
        return answer
    term = program.terms[0]
    scale = program.scale
    rows, rhs = _active_rows(program, working, answer)
    if term.norm == "rms":
        candidate = _least_squares(term.triangle * np.append(scale, 1.0), rows * scale, rhs) * scale
    elif term.norm == "peak" and all(size == 1 for size in term.sizes):
        candidate = _level(program, working, answer, rows, rhs, scale)
    else:
        return answer
    before = program.objective(answer.theta)
    slack = max(program.violation(answer.theta), 1e-12)
    if program.violation(candidate) <= slack and program.objective(candidate) <= before * (1 + 1e-8) + 1e-300:
        return replace(answer, theta=candidate)
    return answer


def _vanished(program: Program, answer: Answer) -> Answer:
    """Where nearly nothing is left, the nearest theta that leaves nothing, if limits allow it."""
    theta, load = answer.theta, sum(program.loads)
    if not theta.size or not 0 < program.objective(theta) <= VANISHED * load:
        return answer
    scale = program.scale
    factor = np.vstack([term.triangle for term in program.terms if term.cap is None])
    step = np.linalg.lstsq(factor[:, :-1] * scale, -factor @ np.append(theta, 1.0), rcond=1e-12)[0]
    candidate = theta + scale * step
    allowed = max(program.violation(theta), 1e-12)
    better = program.objective(candidate) < program.objective(theta) and program.violation(candidate) <= allowed
    return replace(answer, theta=candidate) if better else answer


def _active_rows(program: Program, working: Working, answer: Answer) -> tuple[Array, Array]:
    """Rows (m, P) and right sides of limits and bounds that carry a price."""
    P = len(program.unknowns)
    matrices, sides = [np.zeros((0, P))], [np.zeros(0)]
    largest = max(
        [float(np.abs(m).max(initial=0.0) * r.scale) for m, r in zip(answer.row, program.rows, strict=True)] + [1e-300]
    )
    for rows, chosen, price in zip(program.rows, working.rows, answer.row, strict=True):
        active = chosen if rows.equality else chosen[price * rows.scale > ACTIVE * largest]
        matrices.append(rows.G[active])
        sides.append(rows.h[active])
    scale = program.scale
    for limits, price in ((program.lower, answer.lower), (program.upper, answer.upper)):
        weight = price * scale
        active = np.flatnonzero(np.isfinite(limits) & (weight > ACTIVE * max(weight.max(initial=0.0), largest)))
        matrices.append(np.eye(P)[active])
        sides.append(limits[active])
    return np.vstack(matrices), np.concatenate(sides)


def _least_squares(factor: Array, rows: Array, rhs: Array) -> Array:
    """min |R [x; 1]| subject to rows x = rhs, minimum-norm where that leaves freedom."""
    P = factor.shape[1] - 1
    fixed, free = np.zeros(P), np.eye(P)
    if len(rhs):
        fixed = np.linalg.lstsq(rows, rhs, rcond=1e-12)[0]
        _, singular, vectors = np.linalg.svd(rows)
        free = vectors[int((singular > 1e-12 * singular.max()).sum()) :].T
    step = np.linalg.lstsq(factor[:, :P] @ free, -factor[:, P] - factor[:, :P] @ fixed, rcond=1e-12)[0]
    return fixed + free @ step


def _level(program: Program, working: Working, answer: Answer, rows: Array, rhs: Array, scale: Array) -> Array:
    """theta and the common level t of the active samples, by the smallest move from the solver's answer."""
    term = program.terms[0]
    flat, y = working.terms[0], answer.y[0]
    chosen = np.abs(y) > ACTIVE * max(np.abs(y).max(initial=0.0), 1e-300)
    _, state, row = spread(term.sizes, flat[chosen])
    sign = np.sign(y[chosen])
    load = program.loads[0]
    A = np.hstack([sign[:, None] * term.A[state, row] * scale, -np.full((len(state), 1), load)])
    b = -sign * term.b[state, row]
    full = np.vstack([A, np.hstack([rows * scale, np.zeros((len(rhs), 1))])])
    here = np.append(answer.theta / scale, term.value(answer.theta) / load)
    move = np.linalg.lstsq(full, np.concatenate([b, rhs]) - full @ here, rcond=1e-11)[0]
    return (here + move)[:-1] * scale
