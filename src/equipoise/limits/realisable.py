"""What mass parameters a body can have."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from equipoise import units
from equipoise.balancers.counterweight import MOMENTS, Counterweight
from equipoise.solve.program import Definite, Rows


def realisable(balancers: Iterable[Any]) -> tuple[Definite, ...]:
    """[[S, m r], [m r', m]] positive semidefinite for every free distribution, in kg over the reach.

    A Plate has S = J times the identity of its plane, which is m J >= |m r|^2.
    """
    found = []
    for weight in balancers:
        if not isinstance(weight, Counterweight) or not weight.second:
            continue
        assert weight.reach is not None
        axes = [*weight.directions, 3]
        size = len(axes)
        basis = [np.zeros((size, size)) for _ in weight.unknowns]
        names = [unknown.name for unknown in weight.unknowns]
        known = np.zeros((size, size))
        heavy = known if weight.mass is not None else basis[0]
        heavy[-1, -1] = 1.0 if weight.mass is None else weight.mass
        for place, i in enumerate(weight.directions):
            moment = basis[names.index(f"{weight.owner}.{MOMENTS[i]}")]
            moment[place, -1] = moment[-1, place] = 1.0 / weight.reach
        for name, spread in weight.second:
            part = np.eye(size - 1) if name == "J" else spread[np.ix_(axes[:-1], axes[:-1])]
            basis[names.index(f"{weight.owner}.{name}")][:-1, :-1] = part / weight.reach**2
        found.append(Definite(f"mass parameters of {weight.name}", np.array(basis), known, weight.unknowns))
    return tuple(found)


def room(weight: Counterweight) -> list[Rows]:
    """tr S <= m reach^2: all mass lies within the reach."""
    assert weight.reach is not None
    traces = {name: float(np.trace(spread)) for name, spread in weight.second}
    G = np.array([[traces.get(unknown.name.rpartition(".")[2], 0.0) for unknown in weight.unknowns]])
    square = weight.reach**2
    limit = f"reach of {weight.name} ({units.text(weight.reach, 'm')})"
    if weight.mass is not None:
        return [Rows(limit, "kg m^2", G, np.array([weight.mass * square]), weight.unknowns, scale=square)]
    G[0, 0] = -square
    return [Rows(limit, "kg m^2", G, np.zeros(1), weight.unknowns, scale=square)]
