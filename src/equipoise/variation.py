"""The mean of |effort| without a grid: the total variation of the energy."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from equipoise.affine import Array
from equipoise.assemble import effort
from equipoise.design import Design
from equipoise.errors import InputError, nearest
from equipoise.ranges import pose_vector
from equipoise.sweep import Sweep

SAMPLES = 2001
HALVINGS = 24
"""The energy is stationary at a root, so half of all digits of the root give all of the energy's."""


def exact_mean(design: Design, joint: str | None = None, at: Mapping[str, Any] | None = None) -> float:
    """The mean of |r| of a driven joint over its range in the sweep's box, N m or N, exact to rounding.

        mean |r| = sum_i |V(x_{i+1}) - V(x_i)| / (high - low),   r = dV/dx

    x_i are the ends of the range and all roots of r between them, V the energy of weights and balancers: where r does
    not change its sign its integral is a difference of V, so no grid enters but the one that brackets the roots.
    joint defaults to the only driven one; the others stand at `at` {joint: value}, in the middle of their range where
    it says nothing. Payload scenarios are averaged. Raises InputError where the joint is not named or has no range.
    """
    mechanism, sweep = design.mechanism, design.sweep
    if joint is None and len(mechanism.driven) > 1:
        raise InputError("several joints are driven", where="exact_mean", hint="name one of them as `joint`")
    if joint is not None and joint not in mechanism.driven:
        raise InputError(f"joint {joint!r} is not driven", where="exact_mean", hint=nearest(joint, mechanism.driven))
    index = 0 if joint is None else mechanism.driven.index(joint)
    if sweep.box is None:
        raise InputError("the sweep is a bare list of poses, it has no range", where="exact_mean", hint="use a grid")
    middle = {name: float(value) for name, value in zip(mechanism.driven, sweep.box.mean(axis=1), strict=True)}
    rest = pose_vector(mechanism, middle | dict(at or {}))
    low, high = (float(end) for end in sweep.box[index])
    means = []
    for scenario in sweep.scenarios:
        carried = replace(sweep, scenarios=scenario[None])

        def along(positions: Array, goal: str, carried: Sweep = carried) -> Array:
            poses = np.tile(rest, (len(positions), 1))
            poses[:, index] = positions
            total = effort(mechanism, design.balancers, mechanism.states(carried.at_poses(poses)), goal)
            values = total.at(np.array([design.values[unknown.name] for unknown in total.unknowns]))
            return values[:, index if goal == "hold" else 0]

        means.append(total_variation(along, low, high) / (high - low))
    return float(np.mean(means))


def total_variation(along: Callable[[Array, str], Array], low: float, high: float, samples: int = SAMPLES) -> float:
    """Integral of |r| over [low, high] from along(x, `hold`) = r and along(x, `energy`) = V, (N,) both.

    Roots of r are bracketed on `samples` points and halved; pairs of roots closer than the samples
    are taken as none, which costs no more than the energy between them.
    """
    x = np.linspace(low, high, samples)
    r = along(x, "hold")
    turns = np.flatnonzero(np.sign(r[:-1]) * np.sign(r[1:]) < 0)
    left, right, sign = x[turns], x[turns + 1], np.sign(r[turns])
    for _ in range(HALVINGS if len(turns) else 0):
        middle = (left + right) / 2
        same = np.sign(along(middle, "hold")) == sign
        left, right = np.where(same, middle, left), np.where(same, right, middle)
    ends = np.sort(np.concatenate([[low], x[r == 0.0], left, [high]]))
    return float(np.abs(np.diff(along(ends, "energy"))).sum())
