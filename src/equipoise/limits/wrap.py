"""The limit that keeps a cable on its pulleys, on their own side."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from equipoise import units
from equipoise.balancers.paths import Cable
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError
from equipoise.limits.limit import Setting
from equipoise.limits.sides import sides
from equipoise.solve.program import Rows


@dataclass(frozen=True)
class Wrap:
    """min <= w <= max of the angle w, rad, by which a cable embraces each of its pulleys, at every state.

    w is signed: that of a cable which bears on every pulley of positive radius, on the pulley's own side, and runs
    smoothly below zero where it would lift off. With min 0 or more the cable stays on its pulleys. What it leads to,
    a hook say, stays at least gap, m, off the rims. The geometry alone decides. Raises InputError for a spring without
    a cable, or whose cable has no pulley of positive radius.
    """

    spring: str
    min: units.Angle | None = 0.0
    max: units.Angle | None = None
    gap: units.Length = 0.0

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """Rows without unknowns, one per state, pulley and side, and per neighbour of a pulley."""
        spring = setting.find(self.spring, Spring, "wrap")
        path = spring.path
        found = path.embraces(setting.states) if isinstance(path, Cable) else []
        if not isinstance(path, Cable) or not found:
            raise InputError(
                f"the path of spring {self.spring} has no pulley that a cable could embrace",
                where="limit wrap",
                hint="it belongs to path cable with a pulley of positive radius",
            )
        rows: list[Rows] = []
        for number, wrap, _ in found:
            place = f" on pulley {number + 1}" if len(found) > 1 else ""
            none = np.zeros((*wrap.shape, 0), dtype=wrap.dtype)
            made = sides(f"wrap of {self.spring}{place}", "rad", none, wrap, (), self.min, self.max)
            rows += [replace(row, scale=1.0) for row in made]
        for room, _ in path.clearances(setting.states) if self.gap > 0 else ():
            none = np.zeros((*room.shape, 0), dtype=room.dtype)
            what = f"gap of {self.spring} to its pulleys >= {units.text(self.gap, 'm')}"
            rows.append(Rows(what, "m", none, room - self.gap, (), np.arange(room.shape[-1]), scale=0.1))
        return tuple(rows)
