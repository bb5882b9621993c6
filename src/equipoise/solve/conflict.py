"""Which limits cannot be kept together: the smallest conflicting set, found by leaving limits out one by one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from equipoise.solve.answer import Working
from equipoise.solve.convex import solve_restricted
from equipoise.solve.program import Program, Term

FEASIBLE = 1e-8


def explain(program: Program, working: Working) -> str:
    """Name a smallest set of limits and caps that conflict, with the excess that is left when all are wanted.

    working holds the samples at which the caps were found not to be kept.
    """
    # A row that no unknown moves either holds or is refused where it is made.
    groups = sorted({rows.limit for rows in program.rows if rows.h.size and (rows.G.any() or (rows.h < 0).any())})
    groups += sorted({_cap(term) for term in program.terms if term.cap is not None})
    groups += sorted({definite.limit for definite in program.definite})
    bounded = [u.name for u in program.unknowns if np.isfinite(u.lower) or np.isfinite(u.upper)]
    kept = list(groups) + [f"bounds of {name}" for name in bounded]
    for group in list(kept):
        fewer = [name for name in kept if name != group]
        if excess(program, working, fewer) > FEASIBLE:
            kept = fewer
    share = excess(program, working, kept)
    if len(kept) == 1:
        return f"{kept[0]} cannot be kept: the best possible still exceeds it by {_amount(program, kept[0], share)}"
    named = " and ".join(kept) if len(kept) < 3 else ", ".join(kept[:-1]) + " and " + kept[-1]
    least = "at least " if set(kept) & {_cap(term) for term in program.terms if term.cap is not None} else ""
    return f"{named} conflict: no values of the unknowns keep them together (excess {least}{100 * share:.3g} % of them)"


def excess(program: Program, samples: Working, groups: list[str]) -> float:
    """The smallest common relative excess with which the named limits can be kept."""
    rows = tuple(rows for rows in program.rows if rows.limit in groups and rows.h.size)
    unknowns = tuple(
        u if f"bounds of {u.name}" in groups else replace(u, lower=-np.inf, upper=np.inf) for u in program.unknowns
    )
    capped = [i for i, term in enumerate(program.terms) if term.cap is not None and _cap(term) in groups]
    terms = tuple(program.terms[i] for i in capped)
    working = Working([samples.terms[i] for i in capped], [np.arange(len(r.h)) for r in rows])
    definite = tuple(one for one in program.definite if one.limit in groups)
    answer = solve_restricted(Program(unknowns, terms, rows, definite), working, elastic=1.0)
    return answer.excess if answer.feasible else np.inf


def _cap(term: Term) -> str:
    what = "resultant" if term.name == "wrench" else term.name
    return f"{term.norm} of {what} <= {term.cap:g}"


def _amount(program: Program, limit: str, share: float) -> str:
    for rows in program.rows:
        if rows.limit == limit:
            return f"{share * rows.scale:.3g} {rows.unit}"
    return f"{100 * share:.3g} %"
