"""Many poses from one: a thin set of closed postures grows outwards, every other pose starts from its nearest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.loops.posture import Evaluator
from equipoise.loops.walk import Closed, Loop, Walk, walk

FEW = 100_000  # distances that are computed without a tree
CELL = 0.25  # spacing of the thin set and width of a shell, rad or characteristic lengths
ATTEMPTS = 6  # neighbours a pose is tried from before it counts as out of reach
_CHUNK = 16384


@dataclass(frozen=True, eq=False)
class Blocked:
    """A pose that no walk reached: its number, the last closed posture (one row), how far ahead (k,) the pose is.

    stop (k,) is where the walk met its wall, lowest the least singular value met, others the number of
    further poses not reached.
    """

    index: int
    last: Closed
    ahead: Array
    stop: Array
    lowest: float
    others: int


class Roadmap:
    """Closed postures with their driven positions (M, k), dimensionless; grows as walks arrive."""

    def __init__(self, loop: Loop, evaluate: Evaluator, origin: Closed, here: Array) -> None:
        self._loop, self._evaluate = loop, evaluate
        self.closed, self.driven = origin, here[None]

    def distance(self, targets: Array) -> Array:
        """Distance (T,) of targets to the nearest closed posture."""
        return self._nearest(targets, 1)[0][:, 0]

    def reach(self, targets: Array, attempt: int = 0) -> tuple[Walk, Array]:
        """Walk to targets (T, k) from their nearest posture but `attempt`; with the driven positions at the start."""
        parents = self._nearest(targets, attempt + 1)[1][:, -1]
        begin = self.driven[parents]
        return walk(self._loop, self._evaluate, self.closed.rows(parents), targets - begin), begin

    def add(self, closed: Closed, driven: Array) -> None:
        """Keep more closed postures."""
        if len(driven):
            self.closed = self.closed.join(closed)
            self.driven = np.concatenate([self.driven, driven])

    def _nearest(self, targets: Array, count: int) -> tuple[Array, NDArray[np.int_]]:
        count = min(count, len(self.driven))
        if len(targets) * len(self.driven) <= FEW:  # a tree is not worth its import
            table = np.linalg.norm(targets[:, None] - self.driven, axis=2)
            index = np.argsort(table, axis=1, kind="stable")[:, :count]
            return np.take_along_axis(table, index, axis=1), index
        from scipy.spatial import KDTree

        distance, index = KDTree(self.driven).query(targets, k=count)
        shape = (len(targets), count)
        return np.reshape(distance, shape), np.reshape(index, shape)


def follow(loop: Loop, evaluate: Evaluator, origin: Closed, here: Array, targets: Array) -> Array | Blocked:
    """Postures (T, nq) of driven targets (T, k) on the branch of the origin, or what bars the way.

    here (k,) are the driven positions of the origin; all driven positions are dimensionless.
    """
    road = Roadmap(loop, evaluate, origin, here)
    postures = np.empty((len(targets), origin.q.shape[1]))
    thin = _thin(targets, here)
    blocked = _grow(road, targets, here, thin, postures)
    if blocked is not None:
        return blocked
    rest = np.setdiff1d(np.arange(len(targets)), thin)
    late = []
    for first in range(0, len(rest), _CHUNK):
        part = rest[first : first + _CHUNK]
        done, _ = road.reach(targets[part])
        postures[part[done.arrived]] = done.closed.q[done.arrived]
        late.append(part[~done.arrived])
    blocked = _insist(road, targets, np.concatenate(late), postures) if late else None
    return postures if blocked is None else blocked


def _thin(targets: Array, here: Array) -> NDArray[np.int_]:
    """One target per cell of a grid, or all where cells hardly share."""
    cells = np.round((targets - here) / CELL).astype(np.int64)
    _, first = np.unique(cells, axis=0, return_index=True)
    return first if 2 * len(first) < len(targets) else np.arange(len(targets))


def _grow(road: Roadmap, targets: Array, here: Array, thin: NDArray[np.int_], postures: Array) -> Blocked | None:
    """Close the thin set shell by shell outwards; what fails on the way is tried again from other neighbours."""
    shells = np.floor(np.linalg.norm(targets[thin] - here, axis=1) / CELL).astype(int)
    late: list[NDArray[np.int_]] = []
    for shell in np.unique(shells):
        ring = thin[shells == shell]
        if late:  # beyond a wall only what touches the closed set is worth a walk now
            near = road.distance(targets[ring]) < 3.0 * CELL
            late.append(ring[~near])
            ring = ring[near]
        if not ring.size:
            continue
        ring = _settle(road, targets, ring, road.reach(targets[ring])[0], postures)
        if ring.size:
            late.append(ring)
    return _insist(road, targets, np.concatenate(late), postures) if late else None


def _settle(road: Roadmap, targets: Array, wanted: NDArray[np.int_], done: Walk, postures: Array) -> NDArray[np.int_]:
    """Keep the poses that walks reached; returns those that they did not."""
    keep = np.flatnonzero(done.arrived)
    postures[wanted[keep]] = done.closed.q[keep]
    road.add(done.closed.rows(keep), targets[wanted[keep]])
    return wanted[~done.arrived]


def _insist(road: Roadmap, targets: Array, late: NDArray[np.int_], postures: Array) -> Blocked | None:
    """Try poses again, nearest first, each from several closed neighbours.

    One that cannot be reached condemns the call, so groups are small until they succeed.
    """
    size = 4
    while late.size:
        late = late[np.argsort(road.distance(targets[late]), kind="stable")]
        group, late = late[:size], late[size:]
        tried = group
        first, begin = road.reach(targets[group])
        group = _settle(road, targets, group, first, postures)
        for attempt in range(1, min(ATTEMPTS, len(road.driven))):
            if group.size:
                group = _settle(road, targets, group, road.reach(targets[group], attempt)[0], postures)
        if group.size:
            row = np.flatnonzero(tried == group[0])
            way = (targets[group] - begin[row])[0]
            return Blocked(
                index=int(group[0]),
                last=first.closed.rows(row),
                ahead=(1.0 - first.share[row[0]]) * way,
                stop=begin[row[0]] + first.wall[row[0]] * way,
                lowest=float(first.lowest[row[0]]),
                others=len(group) - 1 + len(late),
            )
        size *= 2
    return None
