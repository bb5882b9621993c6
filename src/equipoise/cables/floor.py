"""What no springs on the same reels can beat."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from equipoise.assemble import Balancer
from equipoise.balancers.laws import BSpline
from equipoise.balancers.paths import Reel
from equipoise.balancers.spring import Spring
from equipoise.cables.distribution import reel_of
from equipoise.design import Design
from equipoise.limits import Force, Tension
from equipoise.sweep import Sweep

PIECES = 63
MOST = 12_000
"""Poses of the finer rule: a piece that no pose sees would cost nothing."""


@dataclass(frozen=True)
class SplineFloor:
    """The objective that linear splines of many pieces reach under the same limits on tension, sharing kept."""

    value: float
    unit: str
    pieces: int
    sweep: str


def spline_floor(design: Design, pieces: int = PIECES) -> SplineFloor | None:
    """The least objective over all force laws t(c) on the reels: what a chosen degree or linkage may be held against.

    Springs that share a law go on sharing one; limits on tension and force stay, those that a shape of the law only
    makes worse are left out. Fine splines come within about 0.1 % of the floor of all laws. None where nothing sits
    behind a reel, or no interval of cable lengths is known.
    """
    from equipoise.tasks import settle, task_of

    springs = {b.name: b for b in design.balancers if isinstance(b, Spring) and reel_of(b) is not None}
    ranges = {name: _interval(design, spring) for name, spring in springs.items()}
    if not springs or not all(ranges.values()):
        return None

    def fine(balancer: Balancer) -> Balancer:
        if balancer.name not in springs or not isinstance(balancer, Spring):
            return balancer
        interval = ranges[balancer.like or balancer.name]
        assert interval is not None
        cable = reel_of(balancer)
        assert cable is not None
        return Spring(
            balancer.name, Reel(cable), BSpline(interval, pieces=pieces, piece_degree=1), balancer.mass, balancer.like
        )

    limits: list[Any] = []
    for limit in design.limits:
        if getattr(limit, "spring", None) not in springs:
            limits.append(limit)
        elif isinstance(limit, Force | Tension) and not (isinstance(limit, Force) and _turns(springs[limit.spring])):
            limits.append(Force(limit.spring, limit.max, limit.min, limit.over))
    sweep: Sweep = design.sweep
    while sweep.finer is not None and len(sweep.poses) < MOST:
        sweep = sweep.finer()
    balanced = settle(
        task_of(design.mechanism, [fine(b) for b in design.balancers], sweep, None, design.objective, limits)
    )
    return SplineFloor(balanced.solution.objective, design.certificate.unit, pieces, sweep.label)


def _turns(spring: Spring) -> bool:
    """Whether a limit on the spring's force is no limit on the cable's tension."""
    return not isinstance(spring.path, Reel)


def _interval(design: Design, spring: Spring) -> tuple[float, float] | None:
    """The cable lengths that a spring's law must serve."""
    owner = spring.like or spring.name
    spans = [
        limit.over
        for limit in design.limits
        if isinstance(limit, Force | Tension) and limit.spring == owner and limit.over is not None
    ]
    own = getattr(spring.law, "interval", None)
    if isinstance(spring.path, Reel) and own is not None:
        spans.append(own)
    if not spans:
        return None
    return min(float(low) for low, _ in spans), max(float(high) for _, high in spans)
