"""The resultant on a platform: the wrench that everything but the motors exerts on it, as an affine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from equipoise.affine import Affine, Array, Block
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism, Platform
from equipoise.states import States

RESULTANT = "resultant"
SINGULAR = 1e-6
ROUNDING = 1e-14


def platform_of(mechanism: Mechanism) -> Platform:
    """The platform of a mechanism; raises InputError where it has none."""
    if mechanism.platform is None:
        raise InputError(
            f"{mechanism.name} has no platform that a wrench could act on",
            where="objective",
            hint="use goal hold, or the builder cable_platform",
        )
    return mechanism.platform


def blocks(mechanism: Mechanism) -> tuple[Block, ...]:
    """One block: the resultant (F, M / l), N."""
    return (Block(RESULTANT, "N", len(platform_of(mechanism).rows)),)


def jacobian(states: States) -> Array:
    """J (N, n, nd) with [v; omega / 1] = J dq of the platform's point, in the rows of its wrench; m and rad."""
    platform = platform_of(states.mechanism)
    _, linear = states.point(platform.point)
    _, angular = states.rotation(platform.point.body)
    return np.array(platform.rows) @ np.concatenate(np.broadcast_arrays(linear, angular), axis=1)


def weights(platform: Platform) -> Array:
    """What each row of the wrench is multiplied with in the resultant (n,): 1 for forces, 1 / l for moments."""
    turns = np.abs(np.array(platform.rows)[:, 3:]).max(axis=1, initial=0.0) > 0
    return np.where(turns, 1.0 / platform.length, 1.0)


def resultant(states: States, hold: Affine) -> Affine:
    """The resultant of a holding effort: w = -J^-T (b + A theta), moments over the platform's length.

    hold is dV/dq per driven joint; w (N, n) acts on the platform at its point, world axes. Raises InputError where
    the platform's coordinates are singular (pitch at 90 deg).
    """
    turn = transform(states)
    A = np.moveaxis(turn(np.moveaxis(hold.A, -1, 0)), 0, -1)
    return replace(hold, blocks=blocks(states.mechanism), b=turn(hold.b), A=A)


def transform(states: States) -> Callable[[Array], Array]:
    """tau (..., N, nd) -> w (..., N, n), the resultant of a holding effort."""
    platform = platform_of(states.mechanism)
    J = jacobian(states)
    scale = weights(platform)
    if J.shape[1] != J.shape[2]:
        raise InputError(f"{J.shape[1]} rows of a wrench for {J.shape[2]} driven joints", where="platform")
    if _identity(J):
        return lambda tau: -tau * scale
    if np.abs(np.linalg.det(J)).min() < SINGULAR:
        raise InputError("the platform's angles are singular", where="sweep", hint="keep pitch within +-80 deg")
    turn = -np.linalg.inv(J) * scale
    return lambda tau: (tau[..., None, :] @ turn)[..., 0, :]


def _identity(J: Array) -> bool:
    return float(np.abs(J - np.eye(J.shape[1])).max()) < ROUNDING
