"""The limit that keeps a straight spring clear of the links."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

import numpy as np

from equipoise import units
from equipoise.affine import Array
from equipoise.balancers.paths import Cable, Line
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError
from equipoise.interference import closest, shell
from equipoise.interference.axes import ways
from equipoise.interference.bulk import coil, half_width
from equipoise.limits.limit import Setting
from equipoise.mechanism import Mechanism, Point
from equipoise.solve.program import Rows
from equipoise.states import States

if TYPE_CHECKING:
    from equipoise.discovery.ground import Ground


@dataclass(frozen=True)
class Avoid:
    """A spring's line stays at least `gap`, m, outside of the capsules about the links, at every state.

        |p(q, s) - c(q, t)| >= radius + gap

    p on the spring, c on a capsule's axis, at the places of least distance. Of a cable every run between bodies that
    move against each other counts, by the centres of its pulleys, and the coil behind it keeps half the width of its
    bundle, too, from the links that it does not lie on. Capsules are fitted to the robot's collision STL or
    OBJ where the files are found, else drawn joint to joint with `radius`, m (default: 4 % of the mechanism's size). A
    hook's own link does not count where the hook lies in its capsule. what says what is kept clear of: `bodies`, the
    `axes` of the hinges between the ends (the line, seen along an axis, does not meet it), or `both`. The geometry
    alone decides. Raises InputError for a spring that is neither a straight line nor a cable.
    """

    spring: str
    radius: units.Length | None = None
    gap: units.Length = 0.0
    what: Literal["bodies", "axes", "both"] = "bodies"

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """radius + gap - distance <= 0, one row per state and capsule or axis."""
        spring = setting.find(self.spring, Spring, "avoid")
        if not isinstance(spring.path, Line | Cable):
            raise InputError(f"spring {self.spring} is neither a straight line nor a cable", where="limit avoid")
        found: list[Rows] = []
        for line in runs(spring):
            clear = rooms(setting.states, line, self.radius) if self.what != "axes" else []
            if self.what != "bodies":
                clear += [(f"the axis of {joint}", room) for joint, room in ways(setting.states, line).items()]
            found += self._rows(clear)
        lying = coil(spring, setting.states.mechanism)
        if lying is not None and self.what != "axes":
            wide = half_width(spring.law)
            clear = beside(setting.states, lying, self.radius)
            found += self._rows([(f"{body} (its coil)", room - wide) for body, room in clear])
        return tuple(found)

    def _rows(self, clear: list[tuple[str, Array]]) -> list[Rows]:
        """One row per state of what is left (..., N), m, to things by name."""
        found = []
        for name, room in clear:
            left = room - self.gap
            none = np.zeros((*left.shape, 0), dtype=left.dtype)
            state = np.arange(left.shape[-1])
            found.append(Rows(f"clearance of {self.spring} from {name}", "m", none, left, (), state, scale=0.1))
        return found


def runs(spring: Spring) -> tuple[Line, ...]:
    """The straight runs of a spring or its cable between bodies that differ; pulleys count by their centres."""
    if isinstance(spring.path, Line):
        return (spring.path,)
    if not isinstance(spring.path, Cable):
        return ()
    points = spring.path.points
    return tuple(Line(a, b) for a, b in pairwise(points) if a.body != b.body)


def rooms(states: States, line: Line, radius: float | None) -> list[tuple[str, Array]]:
    """How far, m, a line (or candidates of one) stays outside of each capsule that counts (..., N), by its body."""
    mechanism = states.mechanism
    a, b = (states.point(point)[0] for point in (line.a, line.b))
    one, other = ((_group(mechanism, point), _local(mechanism, point)) for point in (line.a, line.b))
    found = []
    for capsule, counts in shell(mechanism, radius).foreign(one, other):
        start, end = capsule.piece(states)
        room = closest(a, b, start, end) - capsule.radius
        if not counts.all():
            room = np.where(counts.reshape(-1, 1) if room.ndim > 1 else counts[0], room, 1.0)
        found.append((capsule.body, room))
    return found


def beside(states: States, line: Line, radius: float | None) -> list[tuple[str, Array]]:
    """How far, m, a line on one body (or candidates of one) stays outside of the others' capsules (..., N)."""
    own = _group(states.mechanism, line.a)
    a, b = (states.point(point)[0] for point in (line.a, line.b))
    foreign = [capsule for capsule in shell(states.mechanism, radius).capsules if capsule.body != own]
    return [(capsule.body, closest(a, b, *capsule.piece(states)) - capsule.radius) for capsule in foreign]


def _group(mechanism: Mechanism, point: Point) -> str:
    return str(mechanism.model.body(int(mechanism.model.body_weldid[mechanism.body_id(point.body)])).name)


def _local(mechanism: Mechanism, point: Point) -> Array:
    """Places (C, 3) of a point in the frame of its rigid group."""
    numbers = np.broadcast_arrays(*(np.atleast_1d(np.real(v)) for v in point.at))
    places = np.stack([part.reshape(len(part), -1)[:, 0] for part in numbers], axis=-1)
    return _ground(mechanism).in_group(point.body, places)


@functools.lru_cache(maxsize=8)
def _ground(mechanism: Mechanism) -> Ground:
    from equipoise.discovery.ground import Ground

    return Ground(mechanism, np.zeros(len(mechanism.driven)), ())
