"""How large the blocks of a residual are between the samples of a sweep, and how they change there."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from equipoise.affine import Array, Block, Indices, magnitudes
from equipoise.mechanism import Mechanism
from equipoise.peaks import Probe
from equipoise.states import States
from equipoise.sweep import Sweep

STEP = 1e-5
"""Share of a coordinate's range."""

Account = Callable[[States], tuple[Sequence[Block], Array]]
"""states -> blocks and their residual (N, R)."""


def steepness(mechanism: Mechanism, sweep: Sweep, blocks: Sequence[Block], account: Account) -> Probe:
    """The probe of an account's blocks at coordinates of the sweep, worst over the payload scenarios.

    Holding efforts are r = dV/dq, so dr_j/dq_k = dr_k/dq_j: moving joint j alone, to both sides, gives the whole
    slope of row j. Other blocks are differenced along every coordinate.
    """
    sizes = [block.size for block in blocks]
    names = [block.name for block in blocks]
    domain = sweep.domain
    if domain is None:
        domain = np.tile([-np.inf, np.inf], (sweep.coordinates.shape[1], 1))
    low, high = domain.T
    step = STEP * np.where(np.isfinite(high - low) & (high > low), high - low, 1.0)
    low, high = np.where(high > low, low, -np.inf), np.where(high > low, high, np.inf)
    place = np.full(len(blocks), -1)
    if sweep.moves is None and all(joint in names for joint in mechanism.driven):
        for number, joint in enumerate(mechanism.driven):
            place[names.index(joint)] = number
    columns = np.cumsum([0, *sizes[:-1]])[[names.index(joint) for joint in mechanism.driven if joint in names]]

    def everywhere(places: Array) -> Array:
        """Residuals (S, K, M, R) of all payload scenarios at coordinates (K, M, c)."""
        _, residual = account(mechanism.states(sweep.at(places.reshape(-1, places.shape[-1]))))
        return residual.reshape(len(sweep.scenarios), *places.shape[:2], -1)

    def conservative(places: Array, rows: Indices) -> tuple[Array, Array]:
        each, joint = np.arange(len(places)), place[rows]
        moved = np.repeat(places[None], 3, axis=0)
        moved[1, each, joint] = np.maximum(places[each, joint] - step[joint], low[joint])
        moved[2, each, joint] = np.minimum(places[each, joint] + step[joint], high[joint])
        here, behind, ahead = np.moveaxis(everywhere(moved)[..., columns], 1, 0)
        own = here[:, each, joint]
        worst = np.abs(own).argmax(axis=0), each
        width = moved[2, each, joint] - moved[1, each, joint]
        slope = (ahead - behind)[worst] / width[:, None]
        return np.abs(own)[worst], np.sign(own)[worst][:, None] * slope

    def differenced(places: Array, rows: Indices) -> tuple[Array, Array]:
        shifts = np.concatenate([np.zeros((1, len(step))), np.diag(step), -np.diag(step)])
        moved = np.clip(places + shifts[:, None], low, high)
        each = np.arange(len(places))
        size = magnitudes(everywhere(moved), sizes)[:, :, each, rows]
        here = size[size[:, 0].argmax(axis=0), :, each]
        ahead, behind = np.split(here[:, 1:], 2, axis=1)
        n = len(step)
        width = np.diagonal(moved[1 : n + 1] - moved[n + 1 :], axis1=0, axis2=2)
        return here[:, 0], (ahead - behind) / width

    def probe(places: Array, rows: Indices) -> tuple[Array, Array]:
        value, slope = np.empty(len(places)), np.empty(places.shape)
        plain = place[rows] >= 0
        for which, answer in ((plain, conservative), (~plain, differenced)):
            if which.any():
                value[which], slope[which] = answer(places[which], rows[which])
        return value, slope

    return probe
