"""What the springs of a design run into."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import Line
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.interference.axes import passed
from equipoise.interference.bulk import coil, half_width, outside, side_by_side
from equipoise.interference.segments import closest
from equipoise.limits.avoid import beside, rooms, runs
from equipoise.mechanism import Mechanism
from equipoise.reporting.numbers import quantity
from equipoise.states import States

AT_MOST = 4096
"""States looked at."""
THIN = 1e-3
"""m: half of what a cable, or a coil of unknown width, counts as thick."""


@dataclass(frozen=True)
class Clash:
    """A spring that runs `depth` m into the capsules about a body or into another spring, or passes a joint's axis.

    depth is 0 for an axis; share is that of the states at which it happens.
    """

    spring: str
    what: str
    depth: float
    share: float


def clashes(design: Design, radius: float | None = None) -> tuple[Clash, ...]:
    """What every straight spring of a design runs into over its states, deepest first.

    Cables count by their runs, and the coils behind them with the width of their bundle; springs against each other by
    the widths of their coils, a run or a coil of unknown width as a line 2 mm thick.
    """
    states = design.states.take(slice(None, None, 1 + len(design.states) // AT_MOST))
    found = []
    for spring in design.balancers:
        room: dict[str, Array] = {}
        passes: dict[str, None] = {}
        for line in runs(spring) if isinstance(spring, Spring) else ():
            for body, clear in rooms(states, line, radius):
                room[body] = np.minimum(room.get(body, clear), clear)
            ends = [np.array([point.at], dtype=float) for point in (line.a, line.b)]
            over = passed(states, (line.a.body, line.b.body), ends[0], ends[1])
            passes |= {joint: None for joint, crossed in over.items() if crossed[0]}
        if isinstance(spring, Spring) and (lying := coil(spring, states.mechanism)) is not None:
            for body, clear in beside(states, lying, radius):
                left: Array = clear - half_width(spring.law)
                name = f"{body} with its coil"
                room[name] = np.minimum(room.get(name, left), left)
        room |= _others(design, states, spring)
        into = [Clash(spring.name, body, float(-r.min()), float((r < 0).mean())) for body, r in room.items()]
        found += sorted((clash for clash in into if clash.depth > 0), key=lambda clash: -clash.depth)
        found += [Clash(spring.name, joint, 0.0, 0.0) for joint in passes]
    return tuple(found)


def _others(design: Design, states: States, spring: object) -> dict[str, Array]:
    """Room (N,), m, between a spring and each that stands behind it in the design."""
    behind = design.balancers[[one is spring for one in design.balancers].index(True) + 1 :]
    own = _pieces(spring, states.mechanism)
    found = {}
    for other in behind:
        rooms = [
            closest(*_ends(states, a), *_ends(states, b)) - wide - broad
            for a, wide in own
            for b, broad in _pieces(other, states.mechanism)
        ]
        if rooms:
            found[other.name] = np.min(rooms, axis=0)
    return found


def _pieces(spring: object, mechanism: Mechanism) -> list[tuple[Line, float]]:
    """The straight pieces of a spring with half their widths, m."""
    if not isinstance(spring, Spring):
        return []
    wide = max(float(half_width(spring.law)), THIN)
    lying = coil(spring, mechanism)
    straight = isinstance(spring.path, Line)
    return [*((line, wide if straight else THIN) for line in runs(spring)), *([(lying, wide)] if lying else [])]


def _ends(states: States, line: Line) -> tuple[Array, Array]:
    return states.point(line.a)[0], states.point(line.b)[0]


def clash_words(found: Sequence[Clash]) -> list[str]:
    """`s1 runs into upper_arm_link (89 mm deep, at 34 % of the poses), ...; it passes the axis of ...`, per spring."""
    words = []
    for spring in dict.fromkeys(clash.spring for clash in found):
        own = [clash for clash in found if clash.spring == spring]
        into = [
            f"{clash.what} ({quantity(clash.depth, 'm', 2)} deep, {_often(clash.share)})"
            for clash in own
            if clash.depth
        ]
        axes = [clash.what for clash in own if not clash.depth]
        told = [f"runs into {', '.join(into)}"] if into else []
        told += [f"passes the ax{'e' if len(axes) > 1 else 'i'}s of {', '.join(axes)}"] if axes else []
        words.append(f"{spring} {'; it '.join(told)}")
    return words


def room_words(design: Design) -> list[str]:
    """`s1: 4 x 60 mm side by side, or a bundle 145 mm thick, by 571 mm along shoulder_link`, per coil of known size."""
    words = []
    for spring in design.balancers:
        if not isinstance(spring, Spring) or (one := outside(spring.law)) is None:
            continue
        count, longest = side_by_side(spring.law), float(spring.path.deform(design.states)[0].max())
        lying = coil(spring, design.mechanism)
        if lying is None and not isinstance(spring.path, Line):
            continue
        sides = quantity(float(one), "m", 3)
        bundle = quantity(2 * float(half_width(spring.law)), "m", 3)
        many = f"{count:g} x {sides} side by side, or a bundle {bundle} thick" if count > 1 else f"{sides} across"
        where = f" along {lying.a.body}" if lying else ""
        words.append(f"{spring.name}: {many}, by {quantity(longest, 'm', 3)}{where}")
    return words


def _often(share: float) -> str:
    return "at all poses" if share == 1 else f"at {quantity(100 * share, '', 2)} % of the poses"
