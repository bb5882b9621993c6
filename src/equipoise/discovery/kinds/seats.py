"""Where coils lie behind their guides, and how their cables lie on a pulley."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array, Indices
from equipoise.discovery.ground import Group
from equipoise.discovery.kinds.kind import Scene
from equipoise.discovery.kinds.lines import Lines
from equipoise.discovery.lattice import Spots
from equipoise.mechanism import Point

STRAIGHT = 1e-6
LEAST_WRAP, MOST_WRAP = 0.1, 3.0
"""rad: what a pulley with a radius is embraced by at all poses; near half a turn the cable meets its own coil."""
GAP = 1.0
"""How far hooks stay off a pulley's rim, in its radii."""

Way = tuple[Array, Array]
"""Room (C,), m, from guides to the far ends of their coils, and the unit vectors (C, 3) there, in the body's frame."""


@dataclass(frozen=True, eq=False)
class Seated(Lines):
    """Couples of a guide and a hook with the coil behind the guide: room (C,), m, way (C, 3) from guide to far end.

    side (C,) is 1 where the cable turns counter-clockwise at a pulley, about the plane's normal, else -1; ratio (C,) is
    that of the tackle.
    """

    room: Array
    way: Array
    side: Array
    ratio: Array

    @staticmethod
    def seated(lines: Lines, choices: list[tuple[Indices, Way, Array, Array]]) -> Seated:
        """Numbers of couples with the ways, sides and ratios of all couples, one after the other."""
        numbers = [kept for kept, *_ in choices]
        room, way, side, ratio = (
            np.concatenate([values[kept] for values, kept in zip(each, numbers, strict=True)])
            for each in zip(*((room, way, side, ratio) for _, (room, way), side, ratio in choices), strict=True)
        )
        one = lines.take(np.concatenate(numbers))
        return Seated(one.pair, one.form, one.a, one.b, one.shortest, one.longest, room, way, side, ratio)

    def take(self, kept: NDArray[np.bool_] | Indices) -> Self:
        """Some of the couples."""
        one = super().take(kept)
        return replace(one, room=self.room[kept], way=self.way[kept], side=self.side[kept], ratio=self.ratio[kept])


def outwards(group: Group, places: Array, given: float | None) -> Way:
    """From guides along the link's skeleton to its farther end; the room is given, else as far as that is."""
    unit, length = _longest(group)
    if unit is None:
        return np.full(len(places), given or 0.0), np.tile([0.0, 0.0, -1.0], (len(places), 1))
    at = _at(group, places)
    far = length - at >= at
    room = np.where(far, length - at, at) if given is None else np.full(len(places), given)
    return room, np.where(far, 1.0, -1.0)[:, None] * unit


def in_plane(group: Group, places: Array, given: float | None, housed: bool, normal: Array) -> list[Way]:
    """Ways square to the normal: to both ends of the link's skeleton, or all four of a housing's room."""
    count = len(places)
    if housed:
        across = np.eye(3)[np.argsort(np.abs(normal), kind="stable")[:2]]
        across = across - np.outer(across @ normal, normal)
        units = [sign * one / np.linalg.norm(one) for one in across for sign in (1.0, -1.0)]
        return [(np.full(count, given), np.tile(unit, (count, 1))) for unit in units]
    unit, length = _longest(group)
    if unit is None or abs(unit @ normal) > STRAIGHT:
        return []
    at = _at(group, places)
    rooms = [length - at, at] if given is None else [np.full(count, given)] * 2
    return [(room, np.tile(sign * unit, (count, 1))) for room, sign in zip(rooms, (1.0, -1.0), strict=True)]


def _longest(group: Group) -> tuple[Array | None, float]:
    """Direction and length, m, of the longest piece of a skeleton; None where it is a point."""
    pieces = group.skeleton[:, 1] - group.skeleton[:, 0]
    lengths = np.linalg.norm(pieces, axis=1)
    longest = int(lengths.argmax())
    length = float(lengths[longest])
    return (None, 0.0) if length < STRAIGHT else (pieces[longest] / length, length)


def _at(group: Group, places: Array) -> Array:
    """How far along the longest piece of a skeleton places (C, 3) are, m."""
    unit, length = _longest(group)
    start = group.skeleton[np.linalg.norm(group.skeleton[:, 1] - group.skeleton[:, 0], axis=1).argmax(), 0]
    return np.clip((places - start) @ unit, 0.0, length)


@dataclass(frozen=True, eq=False)
class Fan:
    """Hooks as seen from guides: gap (N, C, 3), m, in the frame of the first body of a pair."""

    gap: Array

    @staticmethod
    def of(scene: Scene, pair: tuple[Spots, Spots]) -> Fan:
        """Every hook of the second body from every place on the first."""
        turned = scene.states.rotation(pair[0].body)[0]
        origin = scene.states.point(Point(pair[0].body))[0]
        hooks = np.moveaxis(scene.states.point(Point.many(pair[1].body, pair[1].places))[0], 0, 1) - origin[:, None]
        gap = (hooks @ turned)[:, None] - pair[0].places[:, None]
        return Fan(gap.reshape(len(gap), -1, 3))

    @cached_property
    def distance(self) -> Array:
        """From guide to hook (N, C), m."""
        return np.linalg.norm(self.gap, axis=-1)

    def sides(self, way: Way, radius: float, normal: Array) -> Array:
        """Side (C,) on which a cable from the far end wraps a pulley within bounds at all poses, 0 where on none.

        w = +-(hook - incoming) + asin(r / distance) + asin(r / room)
        """
        room, onwards = way
        ahead = np.einsum("nci,ci->nc", self.gap, -onwards)
        aside = np.einsum("nci,ci->nc", self.gap, np.cross(normal, -onwards))
        turn, lean = np.arctan2(aside, ahead), _lean(radius, self.distance) + _lean(radius, room)
        clear = (self.distance > (1 + GAP) * radius).all(axis=0) & (room > (1 + GAP) * radius)
        side = np.zeros(len(room))
        for sign in (1.0, -1.0):
            wrap = sign * turn + lean
            side[(wrap > LEAST_WRAP).all(axis=0) & (wrap < MOST_WRAP).all(axis=0) & clear] = sign
        return side

    def follows(self, way: Way, radius: float) -> Array:
        """1 (C,) where a swivelling pulley is wrapped within bounds at all poses, else 0.

        w = atan2(p - r, s) + atan2(r, sqrt(s^2 + p^2 - 2 p r)),   s ahead, p aside
        """
        room, onwards = way
        ahead = np.einsum("nci,ci->nc", self.gap, -onwards)
        aside = np.sqrt(np.maximum(self.distance**2 - ahead**2, 0.0))
        run = self.distance**2 - 2 * aside * radius
        wrap = np.arctan2(aside - radius, ahead) + np.arctan2(radius, np.sqrt(np.maximum(run, 0.0)))
        clear = (np.hypot(aside - radius, ahead) > (1 + GAP) * radius).all(axis=0) & (room > 0)
        return np.where((wrap < MOST_WRAP).all(axis=0) & clear, 1.0, 0.0)


def _lean(radius: float, distance: Array) -> Array:
    """How far, rad, a tangent leans from the line to a pulley's centre."""
    return np.arcsin(np.minimum(radius / np.maximum(distance, 1e-300), 1.0))
