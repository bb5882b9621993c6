"""Which limits cannot be kept together: the smallest conflicting set, found by leaving limits out one by one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from equipoise.solve.answer import Working
from equipoise.solve.convex import solve_restricted
from equipoise.solve.program import Program

FEASIBLE = 1e-8


def explain(program: Program) -> str:
    """Name a smallest set of limits that conflict, with the excess that is left when all are wanted."""
    groups = sorted({rows.limit for rows in program.rows if rows.h.size})
    groups += sorted({definite.limit for definite in program.definite})
    bounded = [u.name for u in program.unknowns if np.isfinite(u.lower) or np.isfinite(u.upper)]
    kept = list(groups) + [f"bounds of {name}" for name in bounded]
    for group in list(kept):
        fewer = [name for name in kept if name != group]
        if excess(program, fewer) > FEASIBLE:
            kept = fewer
    share = excess(program, kept)
    if len(kept) == 1:
        return f"{kept[0]} cannot be kept: the best possible still exceeds it by {_amount(program, kept[0], share)}"
    named = " and ".join(kept) if len(kept) < 3 else ", ".join(kept[:-1]) + " and " + kept[-1]
    return f"{named} conflict: no values of the unknowns keep them together (excess {100 * share:.3g} % of the limits)"


def excess(program: Program, groups: list[str]) -> float:
    """The smallest common relative excess with which the named limits can be kept."""
    rows = tuple(rows for rows in program.rows if rows.limit in groups and rows.h.size)
    unknowns = tuple(
        u if f"bounds of {u.name}" in groups else replace(u, lower=-np.inf, upper=np.inf) for u in program.unknowns
    )
    working = Working([], [np.arange(len(r.h)) for r in rows])
    definite = tuple(one for one in program.definite if one.limit in groups)
    answer = solve_restricted(Program(unknowns, (), rows, definite), working, elastic=1.0)
    return answer.excess if answer.feasible else np.inf


def _amount(program: Program, limit: str, share: float) -> str:
    for rows in program.rows:
        if rows.limit == limit:
            return f"{share * rows.scale:.3g} {rows.unit}"
    return f"{100 * share:.3g} %"
