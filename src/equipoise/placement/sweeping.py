"""What parts and links sweep: segments in every state, what they hit, the areas they cover."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.balancers.spring import Spring
from equipoise.placement.request import Zone
from equipoise.states import States

ALONG = 25
CELLS = 96


@dataclass(frozen=True, eq=False)
class Limb:
    """One kind of part over N states: its name and segments (N, K, 2, 3), m, world axes."""

    name: str
    segments: Array

    @property
    def points(self) -> Array:
        """Points along the segments (N, K, ALONG, 3)."""
        share = np.linspace(0.0, 1.0, ALONG)[:, None]
        start, end = self.segments[:, :, None, 0], self.segments[:, :, None, 1]
        return start + share * (end - start)


@dataclass(frozen=True)
class Hit:
    """Which part reaches how deep, m, into which zone, in which state (row) and where (world, m)."""

    part: str
    zone: str
    depth: float
    row: int
    place: tuple[float, float, float]


def limbs(spring: Spring, states: States) -> tuple[Limb, ...]:
    """Spring, rods and guides of a spring over some states."""
    found: dict[str, list[Array]] = {"spring": [], "rod or crank": [], "cable or guide": []}
    for row in range(len(states)):
        drawn = spring.path.sketch(states, row)
        kinds = (() if drawn.spring is None else (drawn.spring,), drawn.bars, drawn.lines)
        for name, lines in zip(found, kinds, strict=True):
            pairs = [np.stack([line[:-1], line[1:]], axis=1) for line in lines if len(line) > 1]
            found[name].append(np.concatenate(pairs) if pairs else np.zeros((0, 2, 3)))
    return tuple(Limb(name, np.stack(rows)) for name, rows in found.items() if rows and len(rows[0]))


def links(states: States) -> Limb:
    """The moving links over some states, as lines from joint to joint and to their ends."""
    from equipoise.reporting.scene import skeleton

    kin, segments = states.kin, []
    for group, bars in skeleton(states.mechanism).items():
        if group == 0:
            continue
        for first, a, second, b in bars:
            ends = [kin.xpos[:, body] + kin.xmat[:, body] @ at for body, at in ((first, a), (second, b))]
            segments.append(np.stack(ends, axis=1))
    return Limb("link", np.stack(segments, axis=1) if segments else np.zeros((len(states), 0, 2, 3)))


def hits(parts: Sequence[Limb], zones: Sequence[Zone], margin: float) -> list[Hit]:
    """The deepest hit of every part in every zone that it reaches."""
    found = []
    for part in parts:
        points = part.points
        for zone in zones:
            depth = zone.depth(points, margin)
            where = np.unravel_index(int(depth.argmax()), depth.shape)
            if depth[where] > 0:
                x, y, z = points[where].tolist()
                found.append(Hit(part.name, zone.name, float(depth[where]), int(where[0]), (x, y, z)))
    return found


@dataclass(frozen=True, eq=False)
class Raster:
    """A grid over a plane: unit vectors, its corner and the size of its cells, m."""

    plane: tuple[Array, Array]
    corner: Array
    cell: float

    def cover(self, parts: Sequence[Limb], width: float) -> NDArray[np.bool_]:
        """Which cells (CELLS, CELLS) bands of a width along the segments pass over in any state."""
        mask = np.zeros((CELLS, CELLS), dtype=bool)
        centres = self.corner + self.cell * (np.moveaxis(np.indices((CELLS, CELLS)), 0, -1) + 0.5)
        flat = centres.reshape(-1, 2)
        reach = max(0.5 * width, 0.75 * self.cell)
        for part in parts:
            ends = np.stack([part.segments @ axis for axis in self.plane], axis=-1).reshape(-1, 2, 2)
            for start, end in ends:
                low, high = np.minimum(start, end) - reach, np.maximum(start, end) + reach
                near = ~mask.ravel() & ((flat >= low) & (flat <= high)).all(axis=1)
                along = end - start
                share = np.clip(((flat[near] - start) @ along) / max(float(along @ along), 1e-300), 0, 1)
                away = np.linalg.norm(flat[near] - start - share[:, None] * along, axis=1)
                mask.ravel()[np.flatnonzero(near)[away <= reach]] = True
        return mask


def raster(plane: tuple[Array, Array], parts: Sequence[Limb]) -> Raster:
    """A grid that holds all the parts."""
    points = np.concatenate([part.segments.reshape(-1, 3) for part in parts])
    flat = np.stack([points @ axis for axis in plane], axis=1)
    low, high = flat.min(axis=0), flat.max(axis=0)
    size = 1.1 * float((high - low).max()) or 1.0
    return Raster(plane, 0.5 * (low + high) - 0.5 * size, size / CELLS)
