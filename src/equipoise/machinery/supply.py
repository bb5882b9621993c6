"""Energy that motors supply and take back over a motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.mechanism import Mechanism
from equipoise.sweep import Sweep

HALVINGS = 40


@dataclass(frozen=True)
class Supply:
    """Energy over the motion, J: `positive` is supplied where nothing is regenerated, `braking` is taken back.

    With perfect regeneration the motor draws `net` = positive - braking.
    """

    positive: float
    braking: float

    @property
    def net(self) -> float:
        """positive - braking, J."""
        return self.positive - self.braking

    def json(self) -> dict[str, float]:
        """The supply as design.json holds it."""
        return {
            "without_regeneration": self.positive,
            "with_regeneration": self.net,
            "braking": self.braking,
        }


def supplies(mechanism: Mechanism, sweep: Sweep, power: Array) -> dict[str, Supply]:
    """Energy that each motor supplies and takes back over a motion in time, and `all` of them on one supply.

    The integral of the positive part of quintic splines through the powers (N, nd), W, between their roots; of several
    payloads the one that asks for most.
    """
    instants = sweep.instants
    if instants is None or len(instants.time) < 4:
        return {}
    order = np.argsort(instants.time, kind="stable")
    power = np.concatenate([power, power.sum(axis=1, keepdims=True)], axis=1)
    scenarios = power.reshape(len(sweep.scenarios), len(order), -1)[:, order]
    runs = [_split(instants.time[order], run) for run in scenarios]
    names = (*mechanism.driven, "all")
    return {name: max(column, key=_positive) for name, column in zip(names, zip(*runs, strict=True), strict=True)}


def _positive(supply: Supply) -> float:
    return supply.positive


def _split(time: Array, power: Array) -> list[Supply]:
    """The integrals of the positive and the negative parts of quintic splines through powers (N, k), W, at times, s."""
    from scipy.interpolate import make_interp_spline

    law = make_interp_spline(time, power, k=min(5, (len(time) - 2) // 2 * 2 + 1))
    turns, column = np.nonzero(np.sign(power[1:]) * np.sign(power[:-1]) < 0)
    low, high, each = time[turns], time[turns + 1], np.arange(len(turns))
    ahead = power[turns, column]
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        same = law(middle)[each, column] * ahead > 0
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    store = law.antiderivative()
    whole, roots = store(time), store(low)[each, column]
    found = []
    for k in range(power.shape[1]):
        here = column == k
        places = np.concatenate([time, low[here]])
        pieces = np.diff(np.concatenate([whole[:, k], roots[here]])[np.argsort(places, kind="stable")])
        found.append(Supply(float(pieces[pieces > 0].sum()), float(-pieces[pieces < 0].sum())))
    return found
