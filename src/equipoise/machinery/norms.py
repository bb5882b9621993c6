"""Norms over the states of a motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from equipoise.affine import Array, Block
from equipoise.instants import Magnitudes, between
from equipoise.mechanism import Mechanism
from equipoise.row import Row
from equipoise.states import States
from equipoise.sweep import Sweep


def rows_of(
    mechanism: Mechanism, sweep: Sweep, states: States, size: Array, blocks: Sequence[Block], account: Magnitudes
) -> dict[str, Row]:
    """A row per block: rms and mean over the sweep's weights, the worst payload's sampled and polished peaks.

    size (N, R) are the blocks' magnitudes at the states of the sweep, account answers them at others.
    """
    weight = states.weight / states.weight.sum()
    sampled = size.reshape(len(sweep.scenarios), -1, len(blocks)).max(axis=0)
    peaks = between(mechanism, sweep, sampled, account)
    return {
        block.name: Row(
            peak=float(peaks[i]),
            sample_peak=float(sampled[:, i].max()),
            rms=float(np.sqrt(weight @ size[:, i] ** 2)),
            mean=float(weight @ size[:, i]),
            unit=block.unit,
        )
        for i, block in enumerate(blocks)
    }
