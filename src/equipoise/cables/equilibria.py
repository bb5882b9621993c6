"""Where a platform with springs rests when the motors are off: equilibria, their kind and stiffness."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.assemble import effort
from equipoise.balancers.paths import Reel
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.mechanism import Mechanism

STEP = 1e-5
STEPS = 60
SETTLED = 1e-10
SAME = 1e-5
STARTS = 600
LEVEL = 1e-7


@dataclass(frozen=True)
class Equilibrium:
    """A pose without resultant: kind minimum, saddle, maximum or corner sink; stiffness are dV/dq's eigenvalues.

    In a corner sink a point platform rests on an anchor: its own cable pulls harder than all others together.
    """

    pose: Mapping[str, float]
    kind: str
    stiffness: tuple[float, ...]


def stiffness(design: Design, poses: Array) -> Array:
    """K (N, nd, nd) = d2V/dq2 at poses (N, nd): springs, weight and payload; N/m, N or N m/rad.

    Central differences of the holding effort, extrapolated (Richardson).
    """
    nd = poses.shape[1]

    def slope(h: float) -> Array:
        moves = h * np.concatenate([np.eye(nd), -np.eye(nd)])
        there = _hold(design, (poses[:, None] + moves).reshape(-1, nd)).reshape(len(poses), 2, nd, nd)
        return np.swapaxes((there[:, 0] - there[:, 1]) / (2 * h), 1, 2)

    K = (4 * slope(STEP / 2) - slope(STEP)) / 3
    return (K + np.swapaxes(K, 1, 2)) / 2


def equilibria(design: Design) -> tuple[Equilibrium, ...]:
    """All equilibria that Newton's method finds from the poses of the sweep, inside its region, stable ones first.

    Few starts may miss one; for a planar point among forces that point inwards on the edges, minima - saddles +
    maxima + corner sinks = 1 (Poincare and Hopf).
    """
    sweep = design.sweep
    weighed = sweep.poses[sweep.weight > 0]
    x = weighed[np.linspace(0, len(weighed) - 1, min(STARTS, len(weighed))).astype(int)]
    x = np.vstack([x, weighed.mean(axis=0), np.average(weighed, axis=0, weights=sweep.weight[sweep.weight > 0])])
    size = np.ptp(sweep.poses, axis=0)
    free = size > 0
    scale = max(float(np.abs(_hold(design, x)).max()), 1e-12)
    for _ in range(STEPS):
        force = _hold(design, x)
        K = stiffness(design, x)[:, free][:, :, free]
        step = np.zeros_like(x)
        step[:, free] = -np.linalg.solve(K + 1e-12 * scale * np.eye(free.sum()), force[:, free, None])[..., 0]
        length = np.linalg.norm(step / np.where(free, size, 1.0), axis=1, keepdims=True)
        x = x + step * np.minimum(1.0, 0.1 / np.maximum(length, 1e-300))
        x = np.clip(x, sweep.poses.min(0) - 0.05 * size, sweep.poses.max(0) + 0.05 * size)
        if length[sweep.holds(x), 0].max(initial=0.0) < SETTLED:
            break
    x = x[(np.abs(_hold(design, x)[:, free]).max(axis=1) < 1e-9 * scale) & sweep.holds(x)]
    distinct: list[Array] = []
    for pose in x:
        if not any((np.abs(pose - other) <= SAME * np.where(free, size, 1.0)).all() for other in distinct):
            distinct.append(pose)
    found = [_kind(design, pose, free) for pose in distinct] + _sinks(design)
    order = ["minimum", "corner sink", "saddle", "maximum", "flat"]
    return tuple(sorted(found, key=lambda e: (order.index(e.kind), *e.pose.values())))


def _hold(design: Design, poses: Array) -> Array:
    """Holding effort (N, nd), of the first payload."""
    states = design.mechanism.states(design.sweep.at_poses(poses))
    return design.residual(states)[: len(poses)]


def _kind(design: Design, pose: Array, free: Array) -> Equilibrium:
    eigenvalues = np.linalg.eigvalsh(stiffness(design, pose[None])[0][free][:, free])
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
