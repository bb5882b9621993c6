"""A body's mass as point masses: the same momentum in every motion from masses at given points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import mujoco
import numpy as np

from equipoise.affine import Array, Unknown
from equipoise.balancers.counterweight import moves_in_plane
from equipoise.errors import InfeasibleError, InputError
from equipoise.loops import ancestors
from equipoise.mechanism import Mechanism
from equipoise.momentum import body_inertia
from equipoise.reporting.numbers import place, plain, quantity
from equipoise.solve.exchange import solve
from equipoise.solve.program import Program, Rows, Term

Kind = Literal["static", "dynamic"]
CLOSE = 1e-9
ROUNDED = 1e-4
"""Relative difference of polar moments that rounded coordinates explain; it is told as what is left."""


@dataclass(frozen=True, eq=False)
class PointMasses:
    """Masses (n,), kg, at points (n, d), m, of a body's frame; left is the inertia about its centre that they lack.

    left is a polar moment (planar) or second moments (3, 3), kg m^2: zero for a dynamic substitution, else what still
    has to be turned against (positive) or taken off (negative).
    """

    points: Array
    masses: Array
    left: Any
    sources: ClassVar[tuple[str, ...]] = ("arakelian_smith_2008",)

    def json(self) -> dict[str, Any]:
        """Plain data."""
        return {"points": self.points.tolist(), "masses": self.masses.tolist(), "left": np.asarray(self.left).tolist()}

    def __str__(self) -> str:
        lines = [f"{plain(m)} kg at {place(p.tolist())}" for m, p in zip(self.masses, self.points, strict=True)]
        left = np.asarray(self.left)
        size = float(left) if left.ndim == 0 else float(np.abs(left).max())
        return "\n".join([*lines, f"inertia that they lack: {plain(size if abs(size) > CLOSE else 0.0)} kg m^2"])


def point_masses(
    mass: float,
    points: Array | Sequence[Sequence[float]],
    *,
    com: Any = None,
    inertia: Any = 0.0,
    kind: Kind = "dynamic",
) -> PointMasses:
    """Point masses at given points that move like a body: n of them, as even as the conditions allow.

        sum m_i = m,   sum m_i r_i = m c,   and dynamic: sum m_i |r_i - c|^2 = J  (planar)
                                                         sum m_i (r_i - c)(r_i - c)' = S  (spatial)

    mass m in kg; points r_i (n, 2) in the plane or (n, 3), m; com c, m (default: the origin); inertia about com: the
    polar J, or the inertia tensor (3, 3), from which S = tr/2 - I, kg m^2. Masses are not negative. Arakelian & Smith
    2008, Eqs. 1-4, are n = 3 in the plane [arakelian_smith_2008].

    Raises InfeasibleError where no such masses exist: the message says how far the centre lies outside the points, or
    which radius or which ring would mend it; InputError for numbers that no body has.
    """
    r = np.atleast_2d(np.asarray(points, dtype=float))
    if r.ndim != 2 or r.shape[1] not in (2, 3) or not np.isfinite(r).all():
        raise InputError("points are (n, 2) or (n, 3)", where="point_masses")
    c = np.zeros(r.shape[1]) if com is None else np.asarray(com, dtype=float)
    J = np.asarray(inertia, dtype=float)
    if not mass > 0 or c.shape != r.shape[1:] or (J.shape != (() if r.shape[1] == 2 else (3, 3)) and J.any()):
        hint = "mass above zero, com with as many numbers as a point, inertia one number in the plane, else (3, 3)"
        raise InputError("mass, com and inertia do not fit the points", where="point_masses", hint=hint)
    if np.any(J.diagonal() < 0 if J.ndim else J < 0):
        raise InputError("the inertia is negative", where="point_masses")
    arm = r - c
    wanted = _second(J, r.shape[1])
    spread = _spread(arm)
    static = (np.vstack([np.ones(len(r)), arm.T]), np.r_[mass, np.zeros(r.shape[1])])
    found = _even(*static, mass)
    if found is None:
        raise InfeasibleError(_outside(arm, mass), where="point_masses", hint="put points around the centre of mass")
    if kind == "dynamic":
        nearest = _nearest(arm, wanted, static)
        found = _even(np.vstack([static[0], spread]), np.r_[static[1], nearest], mass)
        if found is None:
            raise _mended(arm, mass, wanted, static)
    left = wanted - spread @ found
    return PointMasses(r, found, float(left[0]) if len(left) == 1 else _matrix(left))


def substitute(mechanism: Mechanism, body: str, kind: Kind = "dynamic", points: Any = None) -> PointMasses:
    """Point masses for a body of a mechanism, at `points` of its frame or (default) where pins and joints hold it.

    A body that moves in a plane across one of its axes is substituted in that plane, with coordinates in the other two
    axes. Raises what `point_masses` raises, and InputError for a body that is not there or that nothing holds.
    """
    model, index = mechanism.model, mechanism.body_id(body)
    J = body_inertia(model, index)
    mass = float(J[3, 3])
    across = [axis for axis in range(3) if ancestors(model, index) and moves_in_plane(mechanism, index, axis)]
    axes = [i for i in range(3) if i != across[0]] if across else [0, 1, 2]
    r = np.asarray(points, dtype=float) if points is not None else held_at(mechanism, body)
    if r.ndim == 2 and r.shape[1] == 3 and across:
        r = r[:, axes]
    c = J[:3, 3] / max(mass, 1e-300)
    S = J[:3, :3] - mass * np.outer(c, c)
    own = np.trace(S[np.ix_(axes, axes)]) if across else np.trace(S) * np.eye(3) - S
    return point_masses(mass, r, com=c[axes], inertia=np.where(np.abs(own) < 1e-15, 0.0, own), kind=kind)


def held_at(mechanism: Mechanism, body: str) -> Array:
    """Points (n, 3) of a body's frame, m, where pins of loops and hinges hold it or others on it."""
    model, index = mechanism.model, mechanism.body_id(body)
    found = []
    for equality in range(model.neq):
        if (
            model.eq_type[equality] == mujoco.mjtEq.mjEQ_CONNECT
            and model.eq_objtype[equality] == mujoco.mjtObj.mjOBJ_SITE
        ):
            sites = (model.eq_obj1id[equality], model.eq_obj2id[equality])
            found += [model.site_pos[site] for site in sites if model.site_bodyid[site] == index]
    if model.body_jntnum[index] == 1:
        found.append(model.jnt_pos[model.body_jntadr[index]])
    for child in range(1, model.nbody):
        if model.body_parentid[child] == index and model.body_jntnum[child]:
            turn = np.empty(9)
            mujoco.mju_quat2Mat(turn, model.body_quat[child])
            found.append(model.body_pos[child] + turn.reshape(3, 3) @ model.jnt_pos[model.body_jntadr[child]])
    if not found:
        raise InputError(f"no pin and no joint holds {body}", where="substitute", hint="give the points")
    return np.array(found)


def _second(J: Array, d: int) -> Array:
    """What sum m (r - c)(r - c)' must be: one number in the plane, six in space."""
    if d == 2:
        return np.array([float(J)])
    tensor = J if J.ndim else np.zeros((3, 3))
    S = 0.5 * np.trace(tensor) * np.eye(3) - tensor
    return S[np.triu_indices(3)]


def _spread(arm: Array) -> Array:
    """Second moments (k, n) of one kg at each point."""
    if arm.shape[1] == 2:
        return (arm**2).sum(axis=1)[None]
    return np.array([arm[:, i] * arm[:, j] for i, j in zip(*np.triu_indices(3), strict=True)])


def _matrix(values: Array) -> Array:
    found = np.zeros((3, 3))
    found[np.triu_indices(3)] = values
    return found + np.triu(found, 1).T


def _even(A: Array, b: Array, mass: float) -> Array | None:
    """Masses (n,) >= 0 with A m = b, nearest to equal ones; None where there are none."""
    n = A.shape[1]
    names = tuple(Unknown(f"m{i + 1}", "kg", lower=0.0) for i in range(n))
    scale = np.maximum(np.abs(A).max(axis=1) * mass, np.abs(b))
    scale = np.where(scale > 0, scale, 1.0)
    rows = Rows("substitution", "", A / scale[:, None], b / scale, names, equality=True)
    term = Term("unevenness", "rms", np.full((1, n), -mass / n), np.eye(n)[None], np.ones(1), (1,) * n)
    try:
        found = solve(Program(names, (term,), (rows,))).theta
    except InfeasibleError:
        return None
    return found if np.abs(rows.G @ found - rows.h).max() < CLOSE else None


def _extreme(static: tuple[Array, Array], cost: Array) -> float:
    """The least of cost . m over masses that keep the static conditions."""
    from scipy.optimize import linprog

    return float(linprog(cost, A_eq=static[0], b_eq=static[1], method="highs").fun)


def _nearest(arm: Array, wanted: Array, static: tuple[Array, Array]) -> Array:
    """The polar moment that the points can have, where the body's is off by no more than rounded coordinates."""
    if arm.shape[1] != 2:
        return wanted
    radii = (arm**2).sum(axis=1)
    inside = np.clip(wanted, _extreme(static, radii), -_extreme(static, -radii))
    return inside if abs(float(inside[0] - wanted[0])) <= ROUNDED * float(inside[0]) else wanted


def _outside(arm: Array, mass: float) -> str:
    """How far the centre of mass lies from what the points enclose."""
    names = tuple(Unknown(f"m{i}", "", lower=0.0) for i in range(len(arm)))
    whole = Rows("sum", "", np.ones((1, len(arm))), np.ones(1), names, equality=True)
    term = Term("distance", "peak", np.zeros((1, arm.shape[1])), arm.T[None], np.ones(1), (arm.shape[1],))
    away = solve(Program(names, (term,), (whole,))).objective
    return f"the centre of mass of {plain(mass)} kg lies {quantity(away, 'm')} outside the points that shall carry it"


def _mended(arm: Array, mass: float, wanted: Array, static: tuple[Array, Array]) -> InfeasibleError:
    """Which radius, or which ring, makes the dynamic conditions possible."""
    radii = (arm**2).sum(axis=1)
    total = float(wanted.sum()) if arm.shape[1] == 2 else float(wanted[[0, 3, 5]].sum())
    least, most = _extreme(static, radii), -_extreme(static, -radii)
    radius = float(np.sqrt(radii.mean()))
    what = "polar moment" if arm.shape[1] == 2 else "trace of the second moments"
    if least * (1 - CLOSE) <= total <= most * (1 + CLOSE):
        return InfeasibleError(
            f"masses at these {len(arm)} points have the {what} of the body but not its directions",
            where="point_masses",
            hint="add points out of line with the others, or substitute statically and balance what is left",
        )
    bound = most if total > most else least
    factor = float(np.sqrt(total / bound)) if bound > 0 else float("inf")
    held = f"{plain(bound)} kg m^2 at {'most' if total > most else 'least'}"
    message = f"{plain(mass)} kg at these points hold a {what} of {held}, the body has {plain(total)}"
    aside = (
        f"move the points to {plain(factor)} times their distance from the centre ({quantity(radius * factor, 'm')})"
    )
    if total > most:
        rest = f"or let a counter-rotor or flywheel turn against the remaining {plain(total - most)} kg m^2"
    else:
        rest = f"or add a ring of {plain(least - total)} kg m^2 to the body"
    return InfeasibleError(message, where="point_masses", hint=f"{aside}, {rest}")
