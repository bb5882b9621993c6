"""conditions: what mass parameters must keep so that force, or force and moment, vanish in all motions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, cast

import numpy as np

from equipoise.affine import Array
from equipoise.completion import Completion, completion
from equipoise.errors import InputError, nearest
from equipoise.mechanism import Mechanism
from equipoise.regressor import Frame, frame, free_states, row_space
from equipoise.units import Length

Vanishing = Literal["force", "moment", "both"]
VANISHING: tuple[Vanishing, ...] = ("force", "moment", "both")
CHOSEN = 1e-6
"""Share of a column that others may leave of it, below which it cannot be solved for."""
CLEAN = 1e-9
POWER = {"kg": 0.0, "kg m": 1.0, "kg m^2": 2.0}


@dataclass(frozen=True, eq=False)
class Conditions:
    """C pi = 0: independent linear conditions on the mass parameters pi of the bodies, for all motions.

    rows C (rank, P) in reduced form over names (P,): each condition is solved for the parameter of `solved`, in the
    unit of that parameter; null (P - rank, P) spans the changes of mass parameters that no motion shows at the base;
    own (P,) are the mechanism's parameters; gap is how far the last kept singular value stands above the first that
    is dropped. completion says whether added mass alone can meet them, and why not.
    """

    mechanism: Mechanism
    goal: Vanishing
    names: tuple[str, ...]
    units: tuple[str, ...]
    rows: Array
    solved: tuple[int, ...]
    null: Array
    own: Array
    gap: float
    completion: Completion

    @property
    def rank(self) -> int:
        """How many conditions there are."""
        return len(self.rows)

    @property
    def missing(self) -> Array:
        """What each solved parameter lacks (rank,): C pi = -missing of the mechanism as it is."""
        return -self.rows @ self.own

    def json(self) -> dict[str, Any]:
        """The conditions as `conditions --json` prints them."""
        return {
            "mechanism": self.mechanism.name,
            "goal": self.goal,
            "rank": self.rank,
            "parameters": [
                {"name": name, "unit": unit, "value": value}
                for name, unit, value in zip(self.names, self.units, self.own.tolist(), strict=True)
            ],
            "conditions": [
                {
                    "solved": self.names[index],
                    "coefficients": {
                        name: value for name, value in zip(self.names, row.tolist(), strict=True) if value
                    },
                    "missing": missing,
                    "unit": self.units[index],
                }
                for index, row, missing in zip(self.solved, self.rows, self.missing.tolist(), strict=True)
            ],
            "null_space": self.null.tolist(),
            "gap": self.gap,
            "added_mass_alone": self.completion.json(),
        }

    def __str__(self) -> str:
        from equipoise.reporting.balance import conditions_text

        return conditions_text(self)


def conditions(
    mechanism: Mechanism,
    goal: Vanishing = "force",
    *,
    solve_for: Sequence[str] = (),
    on: Sequence[str] | None = None,
    reach: Length | None = None,
    seed: int = 0,
) -> Conditions:
    """The conditions on mass parameters under which force, moment or both vanish for all motions.

        (p; L) = Y(q, qdot) pi = const for all motions  <=>  C pi = 0,   C spanning the row space of Y

    Y is the regressor of momentum over random admissible states (poses that the loops reach, any velocity); its rank
    is the number of conditions. They are solved for first moments of the innermost bodies first, unless `solve_for`
    names parameters (`rocker.mx`) or bodies to be tried before. `on` names the bodies that may carry added mass
    (default: all that move) within `reach`, m, of their frames (default: anywhere): whether that alone can meet the
    conditions is answered with the least mass, or with the reason.
    Goal `moment` counts L about the world origin; with `both` the pole does not matter.

    Raises InputError for another goal, and for names that are not there.
    """
    if goal not in VANISHING:
        raise InputError(
            f"there is no goal {goal!r} for all motions", where="conditions", hint=nearest(goal, VANISHING)
        )
    if reach is not None and not reach > 0:
        raise InputError(f"the reach is {reach:g} m, it must be positive", where="conditions.reach")
    whole = frame(mechanism)
    if not whole.parameters:
        raise InputError("no joint moves anything", where=mechanism.name, hint="load a mechanism with joints")
    bodies = tuple(dict.fromkeys(p.body for p in whole.parameters))
    names = tuple(p.name for p in whole.parameters)
    order = _order(whole, solve_for, (*names, *bodies))
    for body in on or ():
        if body not in bodies:
            raise InputError(f"{body!r} is no moving body", where="conditions.on", hint=nearest(body, bodies))
    Y = whole.rows(free_states(mechanism, None, max(48, 2 * len(names)), seed), goal)
    scale = _scales(whole, Y)
    basis, null, gap = row_space(Y * scale)
    solved = _pivots(basis, order)
    reduced = np.linalg.solve(basis[:, solved], basis) if solved else basis
    rows = reduced / scale * scale[solved][:, None]
    rows[np.abs(reduced) < CLEAN] = 0.0
    found = completion(whole, rows, bodies if on is None else tuple(on), scale, reach)
    return Conditions(
        mechanism, cast("Vanishing", goal), names, tuple(p.unit for p in whole.parameters), rows, tuple(solved),
        null * scale, whole.own, gap, found,
    )  # fmt: skip


def _scales(whole: Frame, Y: Array) -> Array:
    """Units (P,) of the parameters per kg: powers of the length by which masses outdo first moments."""
    size, units = np.linalg.norm(Y, axis=0), [p.unit for p in whole.parameters]
    mass, first = (max(s for s, unit in zip(size, units, strict=True) if unit == kind) for kind in ("kg", "kg m"))
    length = float(mass / first) if mass > 0 and first > 0 else 1.0
    return length ** np.array([POWER[unit] for unit in units])


def _order(whole: Frame, solve_for: Sequence[str], known: tuple[str, ...]) -> list[int]:
    """Columns in the order in which they are solved for."""
    for name in solve_for:
        if name not in known:
            hint = nearest(name, known)
            raise InputError(f"{name!r} is neither a body nor a parameter", where="conditions.solve_for", hint=hint)

    def rank(index: int) -> tuple[int, int, int]:
        parameter = whole.parameters[index]
        kind = {"kg m": 0, "kg m^2": 1, "kg": 2}[parameter.unit]
        for place, name in enumerate(solve_for):
            if name in (parameter.name, parameter.body):
                return place, kind, index
        return len(solve_for), kind, index

    return sorted(range(len(whole.parameters)), key=rank)


def _pivots(basis: Array, order: Sequence[int]) -> list[int]:
    """The first columns of an order that are independent."""
    found: list[int] = []
    left = basis.copy()
    for column in order:
        vector = left[:, column]
        size = float(np.linalg.norm(vector))
        if len(found) == len(basis):
            break
        if size > CHOSEN * max(1e-3, float(np.linalg.norm(basis[:, column]))):
            found.append(column)
            unit = vector / size
            left = left - np.outer(unit, unit @ left)
    return found
