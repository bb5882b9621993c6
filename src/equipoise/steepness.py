"""How large the blocks of a residual are at poses between the samples, and how they change there."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from equipoise.affine import Array, Indices, magnitudes
from equipoise.mechanism import Mechanism
from equipoise.peaks import Probe
from equipoise.states import States
from equipoise.sweep import Sweep

STEP = 1e-5
"""Shares of a joint's range."""

Residual = Callable[[States], Array]


def steepness(
    mechanism: Mechanism,
    sweep: Sweep,
    goal: str,
    residual: Residual,
    *,
    columns: Indices,
    scale: Array,
    sizes: Sequence[int],
) -> Probe:
    """The probe of counted blocks of a goal's residual(states) -> (N, R), worst over the payload scenarios.

    columns and scale (C,) are the residual's counted rows and their factors, sizes those of the blocks.
    """
    if goal == "hold":
        return _conservative(mechanism, sweep, residual, columns, scale)
    return _differenced(mechanism, sweep, lambda states: residual(states)[:, columns] * scale, sizes)


def _conservative(mechanism: Mechanism, sweep: Sweep, residual: Residual, columns: Indices, scale: Array) -> Probe:
    """r = dV/dq, so dr_j/dq_k = dr_k/dq_j: moving joint j alone, to both sides, gives the whole slope of row j."""
    step = STEP * _span(mechanism, sweep)

    def probe(poses: Array, rows: Indices) -> tuple[Array, Array]:
        each, joint = np.arange(len(poses)), columns[rows]
        moved = np.repeat(poses[None], 3, axis=0)
        moved[1, each, joint] -= step[joint]
        moved[2, each, joint] += step[joint]
        here, behind, ahead = np.moveaxis(_everywhere(mechanism, sweep, residual, moved), 1, 0)
        own = here[:, each, joint]
        worst = np.abs(own).argmax(axis=0), each
        slope = (ahead - behind)[worst] / (2 * step[joint])[:, None]
        return np.abs(own)[worst] * scale[rows], (np.sign(own)[worst] * scale[rows])[:, None] * slope

    return probe


def _differenced(mechanism: Mechanism, sweep: Sweep, residual: Residual, sizes: Sequence[int]) -> Probe:
    """Slopes by central differences along every joint."""
    step = STEP * _span(mechanism, sweep)
    shifts = np.concatenate([np.zeros((1, len(step))), np.diag(step), -np.diag(step)])

    def probe(poses: Array, rows: Indices) -> tuple[Array, Array]:
        found = _everywhere(mechanism, sweep, residual, poses + shifts[:, None])
        size = magnitudes(found, sizes)[:, :, np.arange(len(poses)), rows]
        here = size[size[:, 0].argmax(axis=0), :, np.arange(len(poses))]
        ahead, behind = np.split(here[:, 1:], 2, axis=1)
        return here[:, 0], (ahead - behind) / (2 * step)

    return probe


def _everywhere(mechanism: Mechanism, sweep: Sweep, residual: Residual, poses: Array) -> Array:
    """Residuals (S, K, M, R) of all payload scenarios at poses (K, M, nd)."""
    states = mechanism.states(sweep.at_poses(poses.reshape(-1, poses.shape[-1])))
    return residual(states).reshape(len(sweep.scenarios), *poses.shape[:2], -1)


def _span(mechanism: Mechanism, sweep: Sweep) -> Array:
    box = mechanism.box if sweep.box is None else sweep.box
    return np.where(box[:, 1] > box[:, 0], box[:, 1] - box[:, 0], 1.0)
