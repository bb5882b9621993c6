"""One rms term: least distance programming, exact to rounding, by non-negative least squares."""

from __future__ import annotations

import numpy as np

from equipoise.affine import Array
from equipoise.solve.answer import Answer, Working
from equipoise.solve.program import Program

RANK = 1e-9


def is_least_squares(program: Program) -> bool:
    """Whether the objective is one rms norm, without a cap, whose columns are independent."""
    if len(program.terms) != 1 or not program.unknowns or program.definite:
        return False
    term = program.terms[0]
    if term.norm != "rms" or term.cap is not None:
        return False
    singular = np.linalg.svd(term.triangle[:, :-1] * program.scale, compute_uv=False)
    return bool(singular[-1] > RANK * singular[0])


def solve_least_distance(program: Program, working: Working) -> Answer | None:
    """min |R theta + c| subject to the working rows and the bounds; None where the rows leave no theta.

    Equality rows are eliminated; with z = R theta + c what is left is min |z|, H z >= g, whose multipliers solve
    min |[H'; g'] u - e_last|, u >= 0 (Lawson and Hanson, unsourced).
    """
    from scipy.optimize import nnls

    (term,) = program.terms
    P = len(program.unknowns)
    scale, (load,) = program.scale, program.loads
    factor, c = term.triangle[:, :-1] * scale / load, term.triangle[:, -1] / load
    G, h, places = _inequalities(program, working)
    E, f = _equalities(program, working)
    base, free = np.zeros(P), np.eye(P)
    if len(f):
        base = np.linalg.lstsq(E, f, rcond=1e-12)[0]
        if np.abs(E @ base - f).max() > 1e-9 * max(1.0, np.abs(f).max()):
            return None
        _, singular, vectors = np.linalg.svd(E)
        free = vectors[int((singular > 1e-12 * singular[0]).sum()) :].T
    Q, R = np.linalg.qr(factor @ free)
    known = c + factor @ base
    along = Q.T @ known
    H = -np.linalg.solve(R.T, (G @ free).T).T if free.shape[1] else np.zeros((len(G), 0))
    g = H @ along - (h - G @ base)
    u = np.zeros(len(g))
    z = np.zeros(free.shape[1])
    if len(g) and (g > 0).any():
        target = np.append(np.zeros(free.shape[1]), 1.0)
        u, distance = nnls(np.vstack([H.T, g]), target)
        rest = target - np.vstack([H.T, g]) @ u
        if distance < 1e-9 or rest[-1] <= 0:
            return None
        z, u = -rest[:-1] / rest[-1], u / rest[-1]
    x = base + free @ (np.linalg.solve(R, z - along) if free.shape[1] else z)
    r = factor @ x + c
    norm = float(np.linalg.norm(r))
    price = u / max(norm, 1e-300) * load * term.factor
    slope = factor.T @ r / max(norm, 1e-300) * load * term.factor + G.T @ price
    answer = Answer(True, x * scale, lower=np.zeros(P), upper=np.zeros(P), level=[term.factor if norm > 0 else 0.0])
    answer.y, answer.cap = [np.zeros(0)], [0.0]
    level = -np.linalg.pinv(E.T, rcond=1e-12) @ slope
    done = 0
    for k, rows in enumerate(program.rows):
        if rows.equality:
            count = len(working.rows[k])
            answer.row.append(level[done : done + count] / rows.scale)
            done += count
        else:
            answer.row.append(price[places[k]] / rows.scale)
    for target, (which, place) in zip((answer.lower, answer.upper), places[len(program.rows) :], strict=True):
        target[which] = price[place] / scale[which]
    return answer


def _inequalities(program: Program, working: Working) -> tuple[Array, Array, list]:
    """Rows (m, P) and sides of inequality limits, then of lower and upper bounds, and where each lies."""
    P, scale = len(program.unknowns), program.scale
    matrices, sides, places, count = [np.zeros((0, P))], [np.zeros(0)], [], 0
    for rows, chosen in zip(program.rows, working.rows, strict=True):
        if rows.equality:
            places.append(slice(0, 0))
            continue
        matrices.append(rows.G[chosen] * scale / rows.scale)
        sides.append(rows.h[chosen] / rows.scale)
        places.append(slice(count, count + len(chosen)))
        count += len(chosen)
    for limits, sign in ((program.lower, -1.0), (program.upper, 1.0)):
        which = np.flatnonzero(np.isfinite(limits))
        matrices.append(sign * np.eye(P)[which])
        sides.append(sign * limits[which] / scale[which])
        places.append((which, slice(count, count + len(which))))
        count += len(which)
    return np.vstack(matrices), np.concatenate(sides), places


def _equalities(program: Program, working: Working) -> tuple[Array, Array]:
    """Equality rows (m, P) in scaled unknowns and their sides."""
    P = len(program.unknowns)
    kept = [(r, w) for r, w in zip(program.rows, working.rows, strict=True) if r.equality]
    matrices = [np.zeros((0, P))] + [rows.G[chosen] * program.scale / rows.scale for rows, chosen in kept]
    sides = [np.zeros(0)] + [rows.h[chosen] / rows.scale for rows, chosen in kept]
    return np.vstack(matrices), np.concatenate(sides)
