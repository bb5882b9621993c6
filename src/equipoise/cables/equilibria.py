"""Where a platform with springs rests when the motors are off: equilibria, their kind and stiffness."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array, Mask
from equipoise.assemble import effort
from equipoise.balancers.paths import Reel
from equipoise.balancers.spring import Spring
from equipoise.cables.stiffness import hold, principal, slopes, stiffness
from equipoise.design import Design
from equipoise.mechanism import Mechanism

STEPS = 60
SETTLED = 1e-10
SAME = 1e-5
STARTS = 600
SPATIAL_STARTS = 100
"""Starts on platforms with more than two coordinates, whose steps cost more."""
STUCK = 12
"""Steps in a row outside the region after which a start is given up."""
LEVEL = 1e-7


@dataclass(frozen=True)
class Equilibrium:
    """A pose without resultant: kind minimum, saddle, maximum or corner sink; stiffness is principal, N/m.

    In a corner sink a point platform rests on an anchor: its own cable pulls harder than all others together.
    """

    pose: Mapping[str, float]
    kind: str
    stiffness: tuple[float, ...]


def equilibria(design: Design) -> tuple[Equilibrium, ...]:
    """All equilibria that Newton's method finds from the poses of the sweep, inside its region, stable ones first.

    Few starts may miss one; for a planar point among forces that point inwards on the edges, minima - saddles +
    maxima + corner sinks = 1 (Poincare and Hopf).
    """
    sweep = design.sweep
    weighed = sweep.poses[sweep.weight > 0]
    size = np.ptp(sweep.poses, axis=0)
    free = size > 0
    most = STARTS if free.sum() <= 2 else SPATIAL_STARTS
    x = weighed[np.linspace(0, len(weighed) - 1, min(most, len(weighed))).astype(int)]
    x = np.vstack([x, weighed.mean(axis=0), np.average(weighed, axis=0, weights=sweep.weight[sweep.weight > 0])])
    scale = max(float(np.abs(hold(design, x)).max()), 1e-12)
    x = _newton(design, x, size, scale)
    x = x[(np.abs(hold(design, x)[:, free]).max(axis=1, initial=0.0) < 1e-9 * scale) & sweep.holds(x)]
    distinct: list[Array] = []
    for pose in x:
        if not any((np.abs(pose - other) <= SAME * np.where(free, size, 1.0)).all() for other in distinct):
            distinct.append(pose)
    found = [_kind(design, pose, free) for pose in distinct] + _sinks(design)
    order = ["minimum", "corner sink", "saddle", "maximum", "flat"]
    return tuple(sorted(found, key=lambda e: (order.index(e.kind), *e.pose.values())))


def _newton(design: Design, x: Array, size: Array, scale: float) -> Array:
    """Damped Newton steps on the holding effort from many poses; those that stay outside the region are left behind."""
    sweep, free = design.sweep, size > 0
    low, high = sweep.poses.min(0) - 0.05 * size, sweep.poses.max(0) + 0.05 * size
    active, stuck = np.ones(len(x), dtype=bool), np.zeros(len(x), dtype=int)
    for _ in range(STEPS):
        here = x[active]
        K = slopes(lambda poses: hold(design, poses), here)[:, free][:, :, free]
        step = np.zeros_like(here)
        force = hold(design, here)[:, free, None]
        step[:, free] = -np.linalg.solve(K + 1e-12 * scale * np.eye(free.sum()), force)[..., 0]
        length = np.linalg.norm(step / np.where(free, size, 1.0), axis=1, keepdims=True)
        x[active] = np.clip(here + step * np.minimum(1.0, 0.1 / np.maximum(length, 1e-300)), low, high)
        stuck[active] = np.where(sweep.holds(x[active]), 0, stuck[active] + 1)
        active[np.flatnonzero(active)[length[:, 0] < SETTLED]] = False
        active &= stuck < STUCK
        if not active.any():
            break
    return x


def _kind(design: Design, pose: Array, free: Mask) -> Equilibrium:
    eigenvalues = principal(design.mechanism, stiffness(design, pose[None]), free)[0]
    level = LEVEL * max(float(np.abs(eigenvalues).max()), 1e-12)
    low, high = eigenvalues[0], eigenvalues[-1]
    if np.abs(eigenvalues).min() < level:
        kind = "flat"
    else:
        kind = "minimum" if low > 0 else "maximum" if high < 0 else "saddle"
    names = dict(zip(design.mechanism.driven, pose.tolist(), strict=True))
    return Equilibrium(names, kind, tuple(eigenvalues.tolist()))


def _sinks(design: Design) -> list[Equilibrium]:
    """Anchors of a point platform at which its own cable's pull exceeds that of all others together."""
    mechanism: Mechanism = design.mechanism
    platform = mechanism.platform
    if platform is None or any(any(mechanism.cable(cable)[1].at) for cable in platform.cables):
        return []
    found = []
    for cable in platform.cables:
        anchor = mechanism.cable(cable)[0].at
        axes = [int(np.argmax(np.abs(mechanism.model.jnt_axis[joint]))) for joint in mechanism.driven_ids]
        pose = np.array([[anchor[axis] for axis in axes]])
        if not design.sweep.holds(pose)[0]:
            continue
        states = mechanism.states(design.sweep.at_poses(pose))
        own = [
            b for b in design.balancers if isinstance(b, Spring) and isinstance(b.path, Reel) and b.path.cable == cable
        ]
        others = [balancer for balancer in design.balancers if balancer not in own]
        rest = effort(mechanism, others, states)
        pull = sum(float(spring.force(states, design.values)[1][0]) for spring in own)
        away = rest.at(np.array([design.values[u.name] for u in rest.unknowns]))[0]
        if pull > np.linalg.norm(away):
            found.append(Equilibrium(dict(zip(mechanism.driven, pose[0].tolist(), strict=True)), "corner sink", ()))
    return found
