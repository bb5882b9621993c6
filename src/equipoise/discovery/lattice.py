"""Candidate attachment points: a lattice about a link's skeleton, or a user's list."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.discovery.ground import Ground
from equipoise.errors import InputError
from equipoise.units import Length, text

ALIGNED = 1e-6


@dataclass(frozen=True)
class KeepOut:
    """A region of a body in which nothing may be attached: a box in the body's own frame, m."""

    body: str
    low: tuple[Length, Length, Length]
    high: tuple[Length, Length, Length]

    def holds(self, places: Array) -> Array:
        """Whether places (C, 3) lie in it."""
        return np.all((places >= np.array(self.low)) & (places <= np.array(self.high)), axis=-1)


@dataclass(frozen=True, eq=False)
class Spots:
    """Places (C, 3) on a body and the box (3, 2), m, in which they may move later; equal bounds hold one fast."""

    body: str
    places: Array
    box: Array


def lattice(ground: Ground, pair: tuple[str, str], spacing: float, margin: float, aside: float) -> tuple[Spots, Spots]:
    """Points on both bodies of a pair, `spacing` apart within `margin` of their skeletons' boxes.

    Where the two move against each other in one plane, and it stands square to an axis of both frames, the points
    lie in the plane `aside` from the second body's joint: across it a spring gains nothing.
    """
    flat = ground.normal(*pair)
    spots = []
    for index, body in enumerate(pair):
        group = ground.group_of(body)
        box = np.stack([group.low - margin, group.high + margin], axis=1)
        if flat is not None:
            normal = (flat[0], flat[1])[index]
            axis = int(np.abs(normal).argmax())
            if all(1.0 - np.abs(n).max() < ALIGNED for n in flat[:2]):
                at = np.sign(normal[axis]) * (aside + (flat[2] if index == 0 else 0.0))
                box[axis] = at
        ticks = [_ticks(low, high, spacing) for low, high in box]
        grid = np.stack([axis.ravel() for axis in np.meshgrid(*ticks, indexing="ij")], axis=-1)
        spots.append(Spots(body, grid, box))
    return spots[0], spots[1]


def listed(ground: Ground, body: str, points: Sequence[Sequence[float]], margin: float) -> Spots:
    """A user's points on a body; raises InputError for one that lies farther than `margin` from the link."""
    places = np.array(points, dtype=float).reshape(-1, 3)
    group = ground.group_of(body)
    if not len(places):
        raise InputError(f"the list of points on {body} is empty", where=f"discover.points.{body}")
    far = group.distance(ground.in_group(body, places))
    worst = int(far.argmax())
    if far[worst] > margin:
        raise InputError(
            f"point {worst + 1}, ({', '.join(f'{v:g}' for v in places[worst])}) m, lies {text(far[worst], 'm')} from "
            f"the skeleton of {body}, the margin is {text(margin, 'm')}",
            where=f"discover.points.{body}",
            hint="points are in the body's own frame, in m; widen `margin` if a bracket reaches so far",
        )
    return Spots(body, places, np.stack([places.min(axis=0), places.max(axis=0)], axis=1))


def _ticks(low: float, high: float, spacing: float) -> Array:
    """Evenly spaced coordinates from low to high, ends included; one where they coincide."""
    if high - low < 1e-12:
        return np.array([low])
    return np.linspace(low, high, int(np.ceil((high - low) / spacing - 1e-9)) + 1)
