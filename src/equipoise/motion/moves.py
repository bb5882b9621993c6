"""How the states of a sweep move: along a motion in time, or in any way the mechanism admits."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.motion.motion import Motion


class Moves(Protocol):
    """Poses with velocities and accelerations (N, nd), found by coordinates (N, c) within region (c, 2)."""

    @property
    def coordinates(self) -> Array: ...  # noqa: D102
    @property
    def region(self) -> Array: ...  # noqa: D102
    @property
    def rows(self) -> tuple[Array, Array, Array]:
        """Positions, velocities and accelerations (N, nd)."""
        ...

    def at(self, coordinates: Array) -> Moves:
        """The same kind of movement at other coordinates."""
        ...


@dataclass(frozen=True, eq=False)
class Timed:
    """Instants (N,), s, of a motion."""

    motion: Motion
    time: Array

    @property
    def coordinates(self) -> Array:
        """Time is the only coordinate."""
        return self.time[:, None]

    @property
    def region(self) -> Array:
        """From start to end."""
        return np.array([[self.motion.start, self.motion.end]])

    @property
    def rows(self) -> tuple[Array, Array, Array]:
        """The motion at the instants."""
        return self._rows

    @cached_property
    def _rows(self) -> tuple[Array, Array, Array]:
        return self.motion.at(self.time)

    def at(self, coordinates: Array) -> Timed:
        """Other instants."""
        return replace(self, time=coordinates[:, 0])

    @property
    def weight(self) -> Array:
        """Share of each instant in a time average: the trapezoid rule, so ends count half."""
        gaps = np.diff(self.time)
        return (np.r_[gaps, 0.0] + np.r_[0.0, gaps]) / (2.0 * gaps.sum()) * len(self.time)


@dataclass(frozen=True, eq=False)
class Free:
    """States with poses, velocities and accelerations of their own (N, 3 nd), each within the region."""

    coordinates: Array
    region: Array

    @property
    def rows(self) -> tuple[Array, Array, Array]:
        """The three thirds of the coordinates."""
        position, velocity, acceleration = np.split(self.coordinates, 3, axis=1)
        return position, velocity, acceleration

    def at(self, coordinates: Array) -> Free:
        """Other states."""
        return replace(self, coordinates=coordinates)


def take(moves: Moves, rows: Indices) -> Moves:
    """Some of the states."""
    return moves.at(moves.coordinates[rows])
