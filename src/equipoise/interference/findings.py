"""What the springs of a design run into."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.interference.axes import passed
from equipoise.limits.avoid import rooms, runs
from equipoise.reporting.numbers import quantity

AT_MOST = 4096
"""States looked at."""


@dataclass(frozen=True)
class Clash:
    """A spring that runs `depth` m into the capsules about a body, or passes the axis of a joint (depth 0).

    share is that of the states at which it happens.
    """

    spring: str
    what: str
    depth: float
    share: float


def clashes(design: Design, radius: float | None = None) -> tuple[Clash, ...]:
    """What every straight spring of a design runs into over its states, deepest first; cables by their runs."""
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
        into = [Clash(spring.name, body, float(-r.min()), float((r < 0).mean())) for body, r in room.items()]
        found += sorted((clash for clash in into if clash.depth > 0), key=lambda clash: -clash.depth)
        found += [Clash(spring.name, joint, 0.0, 0.0) for joint in passes]
    return tuple(found)


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


def _often(share: float) -> str:
    return "at all poses" if share == 1 else f"at {quantity(100 * share, '', 2)} % of the poses"
