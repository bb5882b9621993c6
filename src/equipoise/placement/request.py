"""What must stay free, and how wide parts are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.units import Length, Number

FAR = 1e3


@dataclass(frozen=True)
class Zone:
    """A box in world axes that springs, rods and guides must keep out of: two corners (3,), m, and its name."""

    name: str
    low: tuple[Length, Length, Length]
    high: tuple[Length, Length, Length]

    def __post_init__(self) -> None:
        if not np.isfinite([*self.low, *self.high]).all() or not all(
            a < b for a, b in zip(self.low, self.high, strict=True)
        ):
            raise InputError(
                f"zone {self.name} has no room: {list(self.low)} to {list(self.high)}",
                where=f"placement.zones.{self.name}",
                hint="write the lower corner first",
            )

    def depth(self, points: Array, margin: float) -> Array:
        """How deep points (..., 3) lie within the box grown by a margin, m; negative outside."""
        inner = np.minimum(points - (np.array(self.low) - margin), np.array(self.high) + margin - points)
        return inner.min(axis=-1)


@dataclass(frozen=True)
class Placing:
    """Which of the equal places of a spring to take: out of zones and, as far as it goes, of the links' own sweep.

    width, m, is that of springs and rods; link_width that of the links; step, rad, how finely turns are tried; springs
    those that may be moved (default: all that can be).
    """

    zones: tuple[Zone, ...] = ()
    width: Length = 0.02
    link_width: Length = 0.04
    step: Number = np.pi / 36
    springs: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not (self.width >= 0 and self.link_width >= 0 and 1e-3 <= self.step <= np.pi):
            raise InputError("widths cannot be negative, a step lies between 0.001 and pi", where="placement")
        names = [zone.name for zone in self.zones]
        if len(set(names)) < len(names):
            raise InputError(f"two zones are called alike: {', '.join(names)}", where="placement.zones")
