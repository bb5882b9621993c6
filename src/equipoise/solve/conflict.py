"""Which limits cannot be kept together: the smallest conflicting set, found by leaving limits out one by one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from equipoise.solve.answer import Working
from equipoise.solve.convex import solve_restricted
from equipoise.solve.program import Program, Term

FEASIBLE = 1e-8


def explain(program: Program) -> str:
    """Name a smallest set of limits and caps that conflict, with the excess that is left when all are wanted."""
    groups = sorted({rows.limit for rows in program.rows if rows.h.size})
    groups += sorted({definite.limit for definite in program.definite})
    bounded = [u.name for u in program.unknowns if np.isfinite(u.lower) or np.isfinite(u.upper)]
    kept = [*groups, *[f"bounds of {name}" for name in bounded], *[cap_words(t) for t in program.terms if t.cap]]
    for group in list(kept):
        fewer = [name for name in kept if name != group]
        if excess(program, fewer) > FEASIBLE:
            kept = fewer
    share = excess(program, kept)
    if alone := [term.cap for term in program.terms if term.cap and kept == [cap_words(term)]]:
        return f"{kept[0]} cannot be kept: the least possible is {alone[0] * (1 + share):.4g}"
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
    terms = tuple(term for term in program.terms if term.cap and cap_words(term) in groups)
    every = [np.arange(len(term.b) * len(term.sizes)) for term in terms]
    working = Working(every, [np.arange(len(r.h)) for r in rows])
    definite = tuple(one for one in program.definite if one.limit in groups)
    answer = solve_restricted(Program(unknowns, terms, rows, definite), working, elastic=1.0)
    return answer.excess if answer.feasible else np.inf


def cap_words(term: Term) -> str:
    """The cap of an aim in words."""
    return f"the cap of {term.name} ({term.norm} <= {term.cap:g})"


def _amount(program: Program, limit: str, share: float) -> str:
    for rows in program.rows:
        if rows.limit == limit:
            return f"{share * rows.scale:.3g} {rows.unit}"
    return f"{100 * share:.3g} %"
