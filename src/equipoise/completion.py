"""Whether added mass alone can meet linear conditions on mass parameters: the least mass, or a proof that it cannot.

    find pi_added in K with C (pi_own + pi_added) = 0,   K = {pseudo-inertia of every body positive semidefinite}
    or y with W = C'y, W_b positive semidefinite for every body of K, and W . pi_own > 0

The second excludes the first: the conditions then contain a form, W . pi = 0, that every body makes positive.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from equipoise.affine import Array, Unknown
from equipoise.errors import InfeasibleError
from equipoise.regressor import Frame
from equipoise.solve.exchange import solve
from equipoise.solve.program import Definite, Program, Rows, Term

SLIGHT = 1e-7


@dataclass(frozen=True, eq=False)
class Share:
    """What one body gives to the form that cannot vanish: second int |r - centre|^2 dm + first int dm, both >= 0."""

    body: str
    second: float
    first: float
    centre: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Completion:
    """The answer: possible with `mass` kg added as `added` {parameter: value}, or impossible for the reason in `form`.

    form lists per body what the conditions force to vanish although no body has it negative; own is the
    mechanism's part of it, kg m^2 in a scale where the form's largest coefficient is one.
    """

    possible: bool
    mass: float | None = None
    added: Mapping[str, float] = field(default_factory=dict)
    form: tuple[Share, ...] = ()
    own: float = 0.0

    def json(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "possible": self.possible,
            "mass": self.mass,
            "added": dict(self.added),
            "form": [vars(share) for share in self.form],
        }


def completion(frame: Frame, rows: Array, on: tuple[str, ...], scale: Array, reach: float | None = None) -> Completion:
    """The least mass on the bodies `on` that meets rows (rank, P), or the form that forbids it.

    scale (P,) turns kg into the units of the parameters (1, a length, its square). All mass stays within `reach`, m,
    of each body's frame; without it mass plus inertia over that length's square is made small, as far weights need
    hardly any mass.
    """
    columns = [i for i, p in enumerate(frame.parameters) if p.body in on]
    used = rows * scale
    used = used / np.maximum(np.linalg.norm(used, axis=1), 1e-300)[:, None]
    unknowns = tuple(Unknown(frame.parameters[i].name, "") for i in columns)
    wanted = -used @ (frame.own / scale)
    masses = np.array([float(frame.parameters[i].unit == "kg") for i in columns])
    spread = np.array([float(frame.parameters[i].diagonal) for i in columns])
    bound = max(float(np.abs(wanted).max(initial=0.0)), 1e-300)
    if bound <= 1e-10 * max(float(np.abs(frame.own / scale).max(initial=0.0)), 1e-300):
        return Completion(True, 0.0)
    equal = Rows("balance", "", used[:, columns] / bound, wanted / bound, unknowns, equality=True)
    cost = masses if reach is not None else masses + spread
    term = Term("mass", "peak", np.zeros((1, 1)), cost[None, None, :], np.ones(1), (1,))
    limits = [equal]
    if reach is not None:
        square = float(scale[columns][spread > 0].max()) / reach**2
        inside = [[float(frame.parameters[i].body == body) for i in columns] for body in on]
        limits.append(Rows("reach", "kg", np.array(inside) * (spread * square - masses), np.zeros(len(on)), unknowns))
    try:
        found = solve(Program(unknowns, (term,), tuple(limits), _bodies(frame, columns, unknowns)))
    except InfeasibleError:
        return _forbidden(frame, used, columns, scale)
    left = float(np.abs(equal.G @ found.theta - equal.h).max())
    if left > SLIGHT:
        return _forbidden(frame, used, columns, scale)
    values = found.theta * scale[columns]
    return Completion(
        True, float(masses @ found.theta), {u.name: float(v) for u, v in zip(unknowns, values, strict=True)}
    )


def _bodies(frame: Frame, columns: list[int], unknowns: tuple[Unknown, ...]) -> tuple[Definite, ...]:
    """Positive semidefinite pseudo-inertias of the added masses; of a planar one J counts along both axes."""
    found = []
    for body in dict.fromkeys(frame.parameters[i].body for i in columns):
        S = np.zeros((len(columns), *_matrix(frame, body, None).shape))
        for place, i in enumerate(columns):
            if frame.parameters[i].body == body:
                S[place] = _matrix(frame, body, i)
        found.append(Definite(f"mass parameters of {body}", S, np.zeros(S.shape[1:]), unknowns))
    return tuple(found)


def _matrix(frame: Frame, body: str, index: int | None, dual: bool = False) -> Array:
    """The matrix that one unit of a parameter adds to a body's; of the dual cone for coefficients of a form."""
    own = [p for p in frame.parameters if p.body == body]
    axes = sorted({int(i) for p in own for i in np.argwhere(p.part).ravel()})
    if index is None:
        return np.zeros((len(axes), len(axes)))
    part = frame.parameters[index].part[np.ix_(axes, axes)]
    if frame.parameters[index].name.endswith(".J"):
        return np.diag([1.0] * (len(axes) - 1) + [0.0])
    return np.where(np.eye(len(axes)) > 0, part, 0.5 * part) if dual else part


def _forbidden(frame: Frame, used: Array, columns: list[int], scale: Array) -> Completion:
    """y with C'y positive semidefinite on every body that may be added to, and positive on what is there."""
    names = tuple(Unknown(f"y{k}", "") for k in range(len(used)))
    own = used @ (frame.own / scale)
    bodies = tuple(dict.fromkeys(frame.parameters[i].body for i in columns))
    definite = []
    for body in bodies:
        S = np.array([_form(frame, body, columns, row) for row in used])
        definite.append(Definite(f"form of {body}", S, np.zeros(S.shape[1:]), names))
    for row, what in zip(used, own, strict=True):  # often one condition says it alone
        for sign in (1.0, -1.0):
            if sign * what > 0 and all(_least(sign * _form(frame, body, columns, row)) >= 0 for body in bodies):
                return _excluded(frame, sign * row / scale)
    size = float(np.abs(own).max())
    positive = Rows("form", "", own[None] / size, np.ones(1), names, equality=True)
    # the sum of sizes leaves few of the conditions in the combination
    term = Term("size", "mean", np.zeros((1, len(used))), np.eye(len(used))[None], np.ones(1), (1,) * len(used))
    try:
        y = solve(Program(names, (term,), (positive,), tuple(definite))).theta
    except InfeasibleError:
        return Completion(False)
    return _excluded(frame, (y @ used) / scale)


def _form(frame: Frame, body: str, columns: list[int], row: Array) -> Array:
    """The matrix of a body's part of a form: positive semidefinite where no body has it negative."""
    own = [i for i in columns if frame.parameters[i].body == body]
    return sum((row[i] * _matrix(frame, body, i, dual=True) for i in own), _matrix(frame, body, None))


def _least(matrix: Array) -> float:
    """The least eigenvalue, rounding taken for zero."""
    values = np.linalg.eigvalsh(matrix)
    return float(values[0]) if values[0] < -SLIGHT * max(values[-1], 1e-300) else 0.0


def _excluded(frame: Frame, form: Array) -> Completion:
    """The answer for a form (P,) that cannot vanish."""
    second = max(abs(form[i]) for i, p in enumerate(frame.parameters) if p.unit == "kg m^2")
    form = form / (second or 1.0)
    shares = [_share(frame, body, form) for body in dict.fromkeys(p.body for p in frame.parameters)]
    kept = tuple(share for share in shares if share.second or share.first)
    return Completion(False, form=kept, own=float(form @ frame.own))


def _share(frame: Frame, body: str, form: Array) -> Share:
    """A body's part of a form, written about the point where it is least."""
    first = 0.0
    slope: list[float] = []
    second = 0.0
    for coefficient, p in zip(form, frame.parameters, strict=True):
        if p.body == body:
            if p.unit == "kg":
                first = float(coefficient)
            elif p.unit == "kg m":
                slope.append(float(coefficient))
            elif p.diagonal:
                second = max(second, float(coefficient))
    if second <= SLIGHT:
        return Share(body, 0.0, _clean(first), tuple(0.0 for _ in slope))
    centre = tuple(_clean(-0.5 * value / second) for value in slope)
    return Share(body, second, _clean(first - second * sum(value**2 for value in centre)), centre)


def _clean(value: float) -> float:
    """Without rounding errors of the solver."""
    return value if abs(value) > SLIGHT else 0.0
