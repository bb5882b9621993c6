"""Capsules about the links: fitted to collision shapes where these are found, else drawn joint to joint."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.discovery.ground import Ground, Group
from equipoise.interference.collision import shapes
from equipoise.interference.segments import closest
from equipoise.mechanism import Mechanism, Point
from equipoise.reporting.numbers import quantity
from equipoise.states import States

SHARE = 0.04
"""Radius of a drawn capsule as a share of the mechanism's size."""
INSIDE = 1e-3
"""m: a hook this near to its own link's surface counts as on it."""


@dataclass(frozen=True)
class Capsule:
    """All places within `radius`, m, of the straight piece from start to end (m, frame of `body`)."""

    body: str
    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float
    fitted: bool

    def piece(self, states: States) -> tuple[Array, Array]:
        """Both ends (N, 3) in the world."""
        return states.point(Point(self.body, self.start))[0], states.point(Point(self.body, self.end))[0]

    def holds(self, places: Array) -> NDArray[np.bool_]:
        """Whether places (..., 3) of its own body lie in it or on it."""
        one, other = (np.array(end) for end in (self.start, self.end))
        return closest(places, places, one, other) <= self.radius + INSIDE


@dataclass(frozen=True)
class Shell:
    """The capsules of a mechanism, several per rigid group, each named by the group's body."""

    capsules: tuple[Capsule, ...]

    def foreign(self, a: tuple[str, Array], b: tuple[str, Array]) -> list[tuple[Capsule, Array]]:
        """Capsules that lines between places of two groups may run into, and which lines (C,) they count for.

        A capsule of a line's own body does not count where the hook lies in it or on it.
        """
        found = []
        count = len(a[1])
        for capsule in self.capsules:
            counts = np.ones(count, dtype=bool)
            for body, places in (a, b):
                if capsule.body == body:
                    counts &= ~capsule.holds(np.real(places))
            if counts.any():
                found.append((capsule, counts))
        return found

    @property
    def words(self) -> str:
        """Where the capsules come from."""
        fitted = sorted({capsule.body for capsule in self.capsules if capsule.fitted})
        drawn = [capsule for capsule in self.capsules if not capsule.fitted]
        parts = [f"fitted to collision shapes: {', '.join(fitted)}"] if fitted else []
        if drawn:
            names = ", ".join(sorted({capsule.body for capsule in drawn}))
            parts.append(f"drawn joint to joint with radius {quantity(drawn[0].radius, 'm', 3)}: {names}")
        return "; ".join(parts) or "no capsules"


@functools.lru_cache(maxsize=8)
def shell(mechanism: Mechanism, radius: float | None = None) -> Shell:
    """Capsules of all groups; radius, m, is that of the drawn ones (default: 4 % of the mechanism's size)."""
    ground = Ground(mechanism, np.zeros(len(mechanism.driven)), ())
    drawn = radius if radius is not None else SHARE * ground.mechanism.size
    pieces: dict[str, list[Array]] = {}
    for body, points in shapes(mechanism):
        group = ground.group_of(body)
        pieces.setdefault(group.body, []).append(ground.in_group(body, points))
    found: list[Capsule] = []
    for name, group in ground.groups.items():
        if name in pieces:
            found += [fit(name, points, group) for points in pieces[name]]
        else:
            found += [
                Capsule(name, tuple(start.tolist()), tuple(end.tolist()), drawn, False)
                for start, end in group.skeleton
                if np.linalg.norm(end - start) > 1e-6
            ]
    return Shell(tuple(found))


def fit(body: str, points: Array, group: Group) -> Capsule:
    """The leanest capsule about points (V, 3) whose axis is one of theirs or of the link's."""
    middle = points.mean(axis=0)
    axes = list(np.linalg.svd(points - middle, full_matrices=False)[2])
    axes += [end - start for start, end in group.skeleton if np.linalg.norm(end - start) > 1e-6]
    made = [_about(body, points, axis / np.linalg.norm(axis)) for axis in axes]
    return min(made, key=_volume)


def _about(body: str, points: Array, axis: Array) -> Capsule:
    """The capsule along an axis through the middle of the points' box across it, long enough to hold them all."""
    side = np.cross(axis, np.eye(3)[int(np.abs(axis).argmin())])
    side /= np.linalg.norm(side)
    frame = np.stack([side, np.cross(axis, side)])
    across, along = points @ frame.T, points @ axis
    centre = (across.min(axis=0) + across.max(axis=0)) / 2
    off = np.linalg.norm(across - centre, axis=1)
    radius = float(off.max())
    cap = np.sqrt(np.maximum(radius**2 - off**2, 0.0))
    low, high = float((along + cap).min()), float((along - cap).max())
    if low > high:
        low = high = (low + high) / 2
        radius = float(np.sqrt((off**2 + (along - low) ** 2).max()))
    start, end = (tuple((centre @ frame + at * axis).tolist()) for at in (low, high))
    return Capsule(body, start, end, radius, True)


def _volume(capsule: Capsule) -> float:
    length = float(np.linalg.norm(np.subtract(capsule.end, capsule.start)))
    return np.pi * capsule.radius**2 * (length + 4 / 3 * capsule.radius)
