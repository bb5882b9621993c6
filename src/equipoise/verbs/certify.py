"""certify: how much better than a design any other geometry within its bounds could be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from equipoise.design import Design
from equipoise.errors import InputError
from equipoise.objective import minimised
from equipoise.parameters import write
from equipoise.solve.bracket import Bracket, bracket
from equipoise.verbs.enclosures import Enclosing

MOST = 4
SHARE = 0.01


def certify(
    design: Design,
    *,
    share: float = SHARE,
    most: int = 200_000,
    progress: Callable[[int, float, float], None] | None = None,
) -> tuple[Design, Bracket]:
    """Bracket the best value over all geometry within the bounds of a shaped design, by branch and bound.

    share is how close, relatively, the lower bound shall come to the design's value; most is the number of boxes after
    which the search ends. Limits on lengths are kept; others are left out, which only lowers the bound. The design
    answers with certificate `bracketed`, dual the bound; one that is `exact` is kept. Raises InputError for more than
    four free parameters, several aims, a goal that is not `hold`, and parts without a bound in closed form.
    """
    names = tuple(design.geometry)
    if not 1 <= len(names) <= MOST:
        raise InputError(
            f"{len(names)} geometry parameters are free, a bound over all of them is for one to {MOST}",
            where="shape --certify",
            hint="fix some of them",
        )
    aims = minimised(design.objective)
    if len(design.objective) > 1 or aims[0].goal != "hold" or aims[0].divisor == "before":
        raise InputError("a bound is for one aim on `hold`", where="shape --certify", hint="use a single objective")
    aim = aims[0]
    if design.certificate.kind == "exact":
        return design, Bracket(0.0, 0.0, 0)
    states = design.states
    kept = states.take(np.flatnonzero(states.weight > 0)) if aim.norm != "peak" else states
    columns, scale = aim.columns(design.mechanism)
    opened = write(design.balancers, dict(design.geometry))
    enclosing = Enclosing(opened, names, kept, columns.astype(np.intp), scale, design.limits)
    weight = np.tile(kept.weight / kept.weight.sum(), len(columns))
    bounds = np.array([design.bounds[name] for name in names])
    theta = np.array([[u.lower, u.upper] for u in enclosing.unknowns]).reshape(-1, 2)
    found = bracket(
        enclosing,
        bounds,
        design.certificate.primal / aim.weight,
        norm=aim.norm,
        weight=weight,
        theta=theta,
        share=share,
        most=most,
        progress=progress,
    )
    certificate = replace(
        design.certificate, kind="bracketed", dual=min(found.low * aim.weight, design.certificate.primal)
    )
    return replace(design, certificate=replace(certificate, boxes=found.boxes)), found
