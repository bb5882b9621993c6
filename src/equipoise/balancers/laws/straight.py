"""Straight force lines: zero free length, preload and rate, constant force."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws.law import FORCE, RATE, Law, Share
from equipoise.units import Pull, Rate


@dataclass(frozen=True)
class ZeroFreeLength(Law):
    """The ideal spring of static balancing: f = k l, V = k l^2 / 2; k in N/m, None where it is unknown."""

    k: Rate | None = None
    along: ClassVar[tuple[str, ...]] = ("m", "rad")

    def shares(self, length: Array) -> tuple[Share, ...]:
        """One share: the rate."""
        return (Share("k", RATE, self.k, length, length * length / 2, np.ones_like(length), lower=0.0),)


@dataclass(frozen=True)
class Linear(Law):
    """A straight force line: f = preload + k l; k in N/m, preload in N, each None where it is unknown."""

    k: Rate | None = None
    preload: Pull | None = None
    along: ClassVar[tuple[str, ...]] = ("m", "rad")

    def shares(self, length: Array) -> tuple[Share, ...]:
        """Two shares: the rate and the preload at zero length."""
        one = np.ones_like(length)
        return (
            Share("k", RATE, self.k, length, length * length / 2, one, lower=0.0),
            Share("preload", FORCE, self.preload, one, length, 0.0 * one),
        )


@dataclass(frozen=True)
class Constant(Law):
    """A constant-force spring: f = force, V = force l; force in N, None where it is unknown."""

    force: Pull | None = None
    along: ClassVar[tuple[str, ...]] = ("m", "rad")

    @property
    def degree(self) -> int:
        """The force does not follow the length."""
        return 0

    def shares(self, length: Array) -> tuple[Share, ...]:
        """One share: the force."""
        one = np.ones_like(length)
        return (Share("force", FORCE, self.force, one, length, 0.0 * one, lower=0.0),)
