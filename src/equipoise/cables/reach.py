"""Where cables can hold a platform: wrench closure, feasibility under weight, and the tension that limits sag."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.cables.wrench import wrench_matrix
from equipoise.errors import InputError
from equipoise.states import States

RANK = 1e-9


@dataclass(frozen=True, eq=False)
class Reach:
    """Per pose a margin (N,), positive where the cables hold the platform, and the states it was asked at."""

    margin: Array
    states: States

    @property
    def outside(self) -> list[dict[str, float]]:
        """Poses {joint: value} at which the cables cannot hold the platform."""
        driven = self.states.mechanism.driven
        rows = self.states.driven[self.margin <= 0]
        return [dict(zip(driven, row.tolist(), strict=True)) for row in rows]

    @property
    def share(self) -> float:
        """Share of the poses at which the cables hold."""
        return float((self.margin > 0).mean())


def closure(states: States) -> Reach:
    """Wrench closure: any load can be held with enough tension.

        rank W = n and there is t > 0 with W t = 0   (so m >= n + 1)

    The margin is the least tension of the most even such t, as a share of the largest: 1 is as even as can be,
    0 or less is outside. Gravity does not matter.
    """
    W, _, _ = wrench_matrix(states)
    singular = np.linalg.svd(W, compute_uv=False)
    full = singular[:, -1] > RANK * singular[:, 0] if W.shape[2] >= W.shape[1] else np.zeros(len(W), dtype=bool)
    count = W.shape[2]
    margin = np.array([_even(matrix, np.zeros(len(matrix)), 0.0, 1.0, count) for matrix in W])
    return Reach(np.where(full & (margin > RANK), margin, np.minimum(margin, 0.0)), states)


def feasible(states: States, t_min: float, t_max: float) -> Reach:
    """Whether tensions between t_min and t_max, N, hold weight and payload: W t + w = 0.

    The margin, N, is how far from both limits all tensions can stay; below 0 the limits cannot be kept, minus
    infinity where no tensions at all hold the platform. Raises InputError for limits that are reversed.
    """
    if not t_min <= t_max:
        raise InputError(f"t_min {t_min:g} N is above t_max {t_max:g} N", where="tension limits")
    W, w, _ = wrench_matrix(states)
    count = W.shape[2]
    margin = np.array([_even(matrix, load, t_min, t_max, count) for matrix, load in zip(W, w, strict=True)])
    # On the limit itself the platform is still held.
    return Reach(np.where(np.abs(margin) < RANK * max(t_max, 1.0), RANK, margin), states)


def _even(W: Array, w: Array, low: float, high: float, count: int) -> float:
    """max s with low + s <= t_i <= high (for closure) or high - s, W t + w = 0; -inf where there is none."""
    closing = low == 0.0 and high == 1.0 and not w.any()
    upper = np.hstack([np.eye(count), np.zeros((count, 1)) if closing else np.ones((count, 1))])
    lower = np.hstack([-np.eye(count), np.ones((count, 1))])
    from scipy.optimize import linprog

    found = linprog(
        np.append(np.zeros(count), -1.0),
        A_ub=np.vstack([upper, lower]),
        b_ub=np.concatenate([np.full(count, high), np.full(count, -low)]),
        A_eq=np.hstack([W, np.zeros((len(W), 1))]),
        b_eq=-w,
        bounds=[(None, None)] * (count + 1),
        method="highs",
    )
    return float(-found.fun) if found.status == 0 else -np.inf


def sag_tension(mass_per_metre: float, span: float, sag: float, gravity: float = 9.81) -> float:
    """Tension t, N, that keeps a taut rope's sag below a bound: t = mu g L^2 / (8 s), the flat parabola.

    mu in kg/m, horizontal span L and sag s in m; good to 1 % for s < L / 20. Raises InputError for numbers that
    are not positive or a sag beyond that.
    """
    for name, value in (("mass_per_metre", mass_per_metre), ("span", span), ("sag", sag)):
        if not value > 0:
            raise InputError(f"{name} is {value:g}, it must be positive", where="sag")
    if sag > span / 20:
        raise InputError(f"a sag of {sag:g} m over {span:g} m is not flat", where="sag", hint="ask for less than L/20")
    return mass_per_metre * gravity * span**2 / (8 * sag)
