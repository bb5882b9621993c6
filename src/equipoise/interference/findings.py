"""What the springs of a design run into."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.interference.axes import passed
from equipoise.limits.avoid import rooms, runs
from equipoise.units import text

AT_MOST = 4096
"""States looked at."""


@dataclass(frozen=True)
class Clash:
    """A spring that runs `depth` m into the capsule about a body, or passes the axis of a joint (depth 0)."""

    spring: str
    what: str
    depth: float
    share: float

    @property
    def words(self) -> str:
        """The clash in words; share is that of the states at which it happens."""
        if not self.depth:
            return f"{self.spring} passes the axis of {self.what}"
        poses = f"at {100 * self.share:.2g} % of the poses"
        return f"{self.spring} runs {text(self.depth, 'm', 2)} into {self.what} {poses}"


def clashes(design: Design, radius: float | None = None) -> tuple[Clash, ...]:
    """What every straight spring of a design runs into over its states; cables by their runs."""
    states = design.states.take(slice(None, None, 1 + len(design.states) // AT_MOST))
    found = []
    for spring in design.balancers:
        for line in runs(spring) if isinstance(spring, Spring) else ():
            for body, room in rooms(states, line, radius):
                if room.min() < 0:
                    found.append(Clash(spring.name, body, float(-room.min()), float((room < 0).mean())))
            ends = [np.array([point.at], dtype=float) for point in (line.a, line.b)]
            over = passed(states, (line.a.body, line.b.body), ends[0], ends[1])
            found += [Clash(spring.name, joint, 0.0, 0.0) for joint, crossed in over.items() if crossed[0]]
    return tuple(found)
