"""A local optimum over geometry as a design: certificate, prices of bounds, floors, flat directions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from equipoise.certificate import Active
from equipoise.design import Design
from equipoise.floors import floors
from equipoise.objective import leading
from equipoise.solve.program import Program
from equipoise.solve.shape import Local, Optima, linearise
from equipoise.tasks.certificate import certify
from equipoise.tasks.finish import finish
from equipoise.tasks.search import Search
from equipoise.tasks.task import Balanced
from equipoise.units import enumerated, text


def finish_optimum(search: Search, optima: Optima, balanced: Balanced) -> Design:
    """The design at the best of all optima: certified for its geometry, `local` over geometry unless exact."""
    task, best = balanced.task, optima.best
    aim = leading(task.objective)
    unit = aim.unit(task.mechanism)
    inner = certify(balanced)
    theta = balanced.solution.theta
    wide = linearise(search.builder(balanced.states), search.freedoms, best.gamma, theta)
    sizes = np.concatenate([np.abs(theta), [f.upper - f.lower for f in search.freedoms]])
    bound = [
        Active(
            f"{f.name} {'<=' if price > 0 else '>='} {text(f.upper if price > 0 else f.lower, f.unit)}",
            float(abs(price)),
            f"{unit} per {f.unit}" if f.unit else unit,
        )
        for f, price in zip(search.freedoms, best.prices, strict=True)
        if abs(price) * (f.upper - f.lower) > 1e-6 * max(balanced.solution.objective, 1e-300)
    ]
    named = {active.limit for active in inner.active}
    sizes_of = {rows.limit: (float(rows.scale), rows.unit) for rows in balanced.program.rows}
    shaped = [
        Active(limit, price, f"{unit} per {sizes_of[limit][1]}")
        for limit, price in best.limits.items()
        if limit in sizes_of
        and limit not in named
        and price * sizes_of[limit][0] > 1e-6 * max(balanced.solution.objective, 1e-300)
    ]
    merits = [local.merit for local in optima.found]
    certificate = replace(
        inner,
        kind="exact" if inner.kind == "exact" else "local",
        starts=len(optima.found),
        optima=optima.distinct,
        spread=float(max(merits) - min(merits)),
        stationarity=best.stationarity,
        active=(*bound, *shaped, *inner.active),
        floors=floors(
            wide,
            np.append(theta, np.zeros(len(search.freedoms))),
            sizes,
            aim.counted(task.mechanism),
            len(task.sweep.scenarios),
        ),
        flat=inner.flat + _flat(search, wide, balanced, best),
    )
    geometry = {f.name: float(value) for f, value in zip(search.freedoms, best.gamma, strict=True)}
    bounds = {f.name: (f.lower, f.upper) for f in search.freedoms}
    return finish(balanced, certificate, geometry, bounds, {f.name: f.unit for f in search.freedoms}, optima.seed)


def _flat(search: Search, program: Program, balanced: Balanced, best: Local) -> tuple[str, ...]:
    """Directions of geometry and unknowns along which the optimum does not change to first order."""
    term = next(term for term in program.terms if term.cap is None)
    low = np.array([f.lower for f in search.freedoms])
    high = np.array([f.upper for f in search.freedoms])
    inside = (best.gamma - low > 1e-6 * (high - low)) & (high - best.gamma > 1e-6 * (high - low))
    theta = balanced.solution.theta
    free = np.concatenate([np.ones(len(theta), dtype=bool), inside])
    scale = np.concatenate([np.maximum(np.abs(theta), 1e-12), high - low])
    magnitude = term.magnitudes(term.residual(np.concatenate([theta, np.zeros(len(low))])))
    if term.norm == "peak":
        state, block = np.nonzero(magnitude >= magnitude.max() * (1 - 1e-5))
        slopes = term.A[state, block]
    else:
        slopes = term.triangle[:, :-1]
    slopes = (slopes * scale)[:, free]
    names = np.array([u.name for u in program.unknowns])[free]
    _, singular, vectors = np.linalg.svd(slopes)
    rank = int((singular > 1e-6 * max(program.loads)).sum())
    if rank >= len(names):
        return ()
    loose = np.sqrt((vectors[rank:] ** 2).sum(axis=0))
    words = [str(name) for name, size in zip(names, loose, strict=True) if size > 0.1]
    return (enumerated(words) + (" trade freely; settled by least stored energy" if len(words) > 1 else " is free"),)
