"""Where springs are shortest and longest between the samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.assemble import Balancer
from equipoise.balancers.spring import Spring
from equipoise.mechanism import Mechanism
from equipoise.peaks import polish
from equipoise.sweep import Sweep

STARTS = 6
"""Climbs per spring and side."""


def with_extremes(mechanism: Mechanism, balancers: Sequence[Balancer], sweep: Sweep) -> Sweep:
    """The sweep with the poses at which springs are shortest and longest: there working ranges end.

    Lengths climb from the worst samples over the sweep's box, |l| and l_max - l per spring; a grid or a list of poses
    is left as it is.
    """
    springs = [balancer for balancer in balancers if isinstance(balancer, Spring)]
    if not springs or not sweep.sampled:
        return sweep
    bare = replace(sweep, payloads=(), scenarios=np.zeros((1, 0)))

    def lengths(places: Array) -> tuple[Array, Array]:
        """Lengths (N, n) and their slopes (N, n, nd)."""
        states = mechanism.states(bare.at(places))
        found = [spring.path.deform(states) for spring in springs]
        return np.stack([length for length, _ in found], axis=1), np.stack([rate for _, rate in found], axis=1)

    sampled = lengths(bare.coordinates)[0]
    above = sampled.max(axis=0) + np.ptp(sampled, axis=0)
    count = len(springs)

    def probe(places: Array, rows: Indices) -> tuple[Array, Array]:
        length, rate = lengths(places)
        each, spring = np.arange(len(places)), rows % count
        long = rows < count
        value = np.where(long, length[each, spring], above[spring] - length[each, spring])
        return value, np.where(long, 1.0, -1.0)[:, None] * rate[each, spring]

    peaks = polish(probe, bare.coordinates, np.hstack([sampled, above - sampled]), bare.domain, STARTS)
    return sweep.extended(peaks.pose)
