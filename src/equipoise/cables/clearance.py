"""How near cables come to each other and to the platform."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.states import States


@dataclass(frozen=True, eq=False)
class Clearance:
    """Least distances (N,) per pose, m: between cables by pair, and of each cable to the platform's outline."""

    pairs: dict[tuple[str, str], Array]
    platform: dict[str, Array]

    @property
    def closest(self) -> tuple[tuple[str, str], float]:
        """The pair of cables that come nearest, and how near, m."""
        pair = min(self.pairs, key=lambda key: float(self.pairs[key].min()))
        return pair, float(self.pairs[pair].min())


def clearance(states: States) -> Clearance:
    """Distances between straight cables, and of each cable to the edges between the other cables' ends.

    Two cables that share an end on the platform count from there on: their distance is 0 there by design, and
    they are left out, as are a cable and the edges at its own end.
    """
    mechanism = states.mechanism
    if mechanism.platform is None:
        raise InputError(f"{mechanism.name} has no platform", where="clearance")
    ends = {cable: mechanism.cable(cable) for cable in mechanism.platform.cables}
    lines = {cable: tuple(states.point(point)[0] for point in pair) for cable, pair in ends.items()}
    pairs = {}
    for one, other in itertools.combinations(ends, 2):
        if ends[one][1] != ends[other][1] and ends[one][0] != ends[other][0]:
            pairs[one, other] = segments(lines[one][0], lines[one][1], lines[other][0], lines[other][1])
    hull = list(dict.fromkeys(pair[1] for pair in ends.values()))
    to_platform = {}
    for cable, pair in ends.items():
        edges = [edge for edge in itertools.combinations(hull, 2) if pair[1] not in edge]
        if edges:
            places = [(states.point(a)[0], states.point(b)[0]) for a, b in edges]
            to_platform[cable] = np.min([segments(lines[cable][0], lines[cable][1], a, b) for a, b in places], axis=0)
    return Clearance(pairs, to_platform)


def segments(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Least distance (N,) between segments a-b and c-d, each end (N, 3)."""
    u, v, w = b - a, d - c, a - c
    uu, uv, vv = ((x * y).sum(-1) for x, y in ((u, u), (u, v), (v, v)))
    uw, vw = (u * w).sum(-1), (v * w).sum(-1)
    det = uu * vv - uv * uv
    with np.errstate(divide="ignore", invalid="ignore"):
        s = np.where(det > 1e-14 * uu * vv, np.clip((uv * vw - vv * uw) / det, 0, 1), 0.0)
        t = np.where(vv > 0, (uv * s + vw) / vv, 0.0)
        t = np.clip(t, 0, 1)
        s = np.where(uu > 0, np.clip((uv * t - uw) / uu, 0, 1), 0.0)
    return np.linalg.norm(w + s[:, None] * u - t[:, None] * v, axis=-1)
