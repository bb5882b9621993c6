"""Where between the samples springs are shortest, longest, or nearest to bodies, and pulleys wrapped least and most."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.assemble import Balancer, setting_of
from equipoise.balancers.paths import Cable
from equipoise.balancers.spring import Spring
from equipoise.limits import Avoid, Limit
from equipoise.mechanism import Mechanism
from equipoise.peaks import polish
from equipoise.seeding import generator
from equipoise.sweep import Sweep

STARTS = 6
"""Climbs per spring or pulley and side."""
DENSE, NEAREST = 4096, 3
"""Poses among which the nearest to what is avoided are looked for, and how many of these are taken."""
CLOSE = 0.05
"""m: what stays clear by more than this needs no further poses."""


def with_extremes(
    mechanism: Mechanism, balancers: Sequence[Balancer], sweep: Sweep, limits: Sequence[Limit] = ()
) -> Sweep:
    """The sweep with the poses at which springs are shortest and longest, and cables embrace pulleys least and most.

    There working ranges end, and cables lift off. Values x climb from the worst samples over the sweep's box, x and
    x_max - x each. With limits `Avoid` among those given, the poses of a denser sample come along at which springs are
    nearest to what they avoid. A grid or a list of poses is left as it is.
    """
    springs = [balancer for balancer in balancers if isinstance(balancer, Spring)]
    if not springs or not sweep.sampled:
        return sweep
    bare = replace(sweep, payloads=(), scenarios=np.zeros((1, 0)))

    def measured(places: Array) -> tuple[Array, Array]:
        """Lengths and wraps (N, n) and their slopes (N, n, nd)."""
        states = mechanism.states(bare.at(places))
        found = [spring.path.deform(states) for spring in springs]
        for spring in springs:
            if isinstance(spring.path, Cable):
                found += [(wrap, rate) for _, wrap, rate in spring.path.embraces(states)]
        return np.stack([value for value, _ in found], axis=1), np.stack([rate for _, rate in found], axis=1)

    sampled = measured(bare.coordinates)[0]
    above = sampled.max(axis=0) + np.ptp(sampled, axis=0)
    count = sampled.shape[1]

    def probe(places: Array, rows: Indices) -> tuple[Array, Array]:
        value, rate = measured(places)
        each, which = np.arange(len(places)), rows % count
        most = rows < count
        risen = np.where(most, value[each, which], above[which] - value[each, which])
        return risen, np.where(most, 1.0, -1.0)[:, None] * rate[each, which]

    peaks = polish(probe, bare.coordinates, np.hstack([sampled, above - sampled]), bare.domain, STARTS)
    return sweep.extended(np.vstack([peaks.pose, _nearest(mechanism, balancers, bare, limits)]))


def _nearest(mechanism: Mechanism, balancers: Sequence[Balancer], sweep: Sweep, limits: Sequence[Limit]) -> Array:
    """Coordinates (M, n) at which springs are nearest to each thing that they avoid and come close to."""
    avoiding = [limit for limit in limits if isinstance(limit, Avoid)]
    domain = sweep.domain
    if not avoiding or domain is None or sweep.outline is not None:
        return sweep.coordinates[:0]
    places = domain[:, 0] + generator(0).random((DENSE, len(domain))) * np.ptp(domain, axis=1)
    setting = setting_of(mechanism, balancers, sweep, mechanism.states(sweep.at(places)))
    rows = [row for limit in avoiding for row in limit.rows(setting)]
    worst = [np.argsort(row.h, kind="stable")[:NEAREST] for row in rows if row.h.min() < CLOSE]
    return places[np.unique(np.concatenate(worst))] if worst else places[:0]
