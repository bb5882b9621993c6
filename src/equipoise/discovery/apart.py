"""Springs of planar pairs slid along the axes of their joints, where one is in another's way."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import Cable, Line
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.discovery.ground import Ground
from equipoise.discovery.lattice import KeepOut
from equipoise.discovery.refine import again
from equipoise.errors import EquipoiseError
from equipoise.interference.findings import Clash, clashes

STEPS = (1.0, -1.0, 2.0, -2.0, 3.0, -3.0)
"""Slides that are tried, in depths by which two springs meet."""
PLAY = 1.1
"""What is left between springs set apart, as a multiple of what they need."""
EDGE = 1e-9
"""m: what rounding leaves."""
SAME = 1e-9
"""Share of the load by which a slide may change what is left."""


@dataclass(frozen=True, eq=False)
class Leeway:
    """Where guides and hooks may sit: within `margin`, m, of their links, out of zones; radius of drawn capsules, m."""

    ground: Ground
    margin: float
    keep_out: tuple[KeepOut, ...] = ()
    radius: float | None = None

    def allows(self, place: Any, normal: Array) -> bool:
        """Whether a place is within the margin of its link along the normal, and in no zone."""
        group = self.ground.group_of(place.body)
        at = self.ground.in_group(place.body, np.array([place.at], dtype=float))[0]
        axis = int(np.abs(normal).argmax())
        near = group.low[axis] - self.margin - EDGE <= at[axis] <= group.high[axis] + self.margin + EDGE
        held = any(
            bool(zone.holds(np.array(place.at, dtype=float))) for zone in self.keep_out if zone.body == place.body
        )
        return bool(near) and not held


def set_apart(design: Design, leeway: Leeway) -> Design:
    """The design with springs slid until none meets another, as far as margin, zones and links leave room.

        |p_a + s n - (p_b + s n)| = |p_a - p_b|,   n the common axis of the joints between a and b

    So a slide s, m, changes neither a length nor the torque of a weight about those joints; one that changes what is
    left all the same is not taken. What still meets is told as before.
    """
    names = {balancer.name for balancer in design.balancers}
    for _ in names:
        known = clashes(design, leeway.radius)
        meets = [clash for clash in known if clash.what in names]
        slid = next((one for clash in meets for one in _slid(design, leeway, known, clash)), None)
        if slid is None:
            return design
        design = slid
    return design


def _slid(design: Design, leeway: Leeway, known: Sequence[Clash], clash: Clash) -> Iterator[Design]:
    """Designs in which two springs that met do so no more, and nothing is worse than before."""
    names = [balancer.name for balancer in design.balancers]
    before, load = design.residual(design.states, "hold"), np.abs(design.states.holding).max()
    for steps in STEPS:
        for name in (clash.what, clash.spring):
            index = names.index(name)
            spring = _moved(design.balancers[index], leeway, steps * PLAY * clash.depth)
            if spring is None:
                continue
            balancers = (*design.balancers[:index], spring, *design.balancers[index + 1 :])
            trial = replace(design, balancers=balancers)
            same = np.abs(trial.residual(design.states, "hold") - before).max() <= SAME * load
            if same and not _worse(known, clashes(trial, leeway.radius), clash):
                try:
                    yield again(design, balancers, design.limits)
                except EquipoiseError:
                    continue


def _worse(known: Sequence[Clash], found: Sequence[Clash], clash: Clash) -> bool:
    """Whether two springs still meet, or anything goes deeper than before."""
    depth = {(one.spring, one.what): one.depth for one in known} | {(clash.spring, clash.what): 0.0}
    return any(one.depth > depth.get((one.spring, one.what), 0.0) + EDGE for one in found)


def _moved(spring: Any, leeway: Leeway, slide: float) -> Spring | None:
    """The spring slid along the axis of its pair; None where it has none, or its guide or hook would sit elsewhere."""
    if not isinstance(spring, Spring) or not isinstance(spring.path, Line | Cable):
        return None
    path = spring.path
    places: list[Any] = [path.a, path.b] if isinstance(path, Line) else list(path.through)
    ends = (places[0].body, places[-1].body)
    flat = leeway.ground.normal(*ends)
    if flat is None or not {place.body for place in places} <= set(ends):
        return None
    normals = dict(zip(ends, flat[:2], strict=True))
    moved = [replace(place, at=tuple((np.array(place.at) + slide * normals[place.body]).tolist())) for place in places]
    seats = moved if isinstance(path, Line) else moved[1:]
    if not all(leeway.allows(place, normals[place.body]) for place in seats):
        return None
    slid = Line(*moved) if isinstance(path, Line) else replace(path, through=tuple(moved))
    return replace(spring, path=slid)
