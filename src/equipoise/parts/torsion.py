"""The torsion spring of round wire, on a path that is an angle."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from equipoise.affine import Array
from equipoise.parts import coil
from equipoise.parts.helical import Helical
from equipoise.parts.part import Clause
from equipoise.parts.wire import UNSOURCED
from equipoise.units import Angle, Number

BENDING = 0.70
"""Allowed share of Rm of the uncorrected bending stress; unsourced."""
FRICTIONLESS = 64 / (2 * np.pi)


def torsion_rate(wire: Any, diameter: Any, coils: Any, young: Any, factor: float = FRICTIONLESS) -> Any:
    """k = E d^4 / (2 pi factor D n), N m/rad.

    factor 64 / (2 pi) = 10.19 is that of bending alone [fossee_bhandari, Ex. 10.21]; American makers count 10.8 for
    the coils' rubbing [acxess_torsion].
    """
    return young * wire**4 / (2 * np.pi * factor * diameter * coils)


def bending_stress(torque: Any, wire: Any) -> Any:
    """sigma = 32 M / (pi d^3), Pa, without correction for curvature."""
    return 32 * torque / (np.pi * wire**3)


@dataclass(frozen=True)
class TorsionSpring(Helical):
    """A torsion spring: T = N k (theta - rest), k = E d^4 / (64 D n), wound up by the angle theta.

    wire d, diameter D (mean), m, coils n, grade of the wire; rest in rad; number N act side by side; winds says
    whether growing (`up`) or falling (`down`) angles wind it up, the only way in which it may be loaded; the working
    range ends at .7 Rm of bending (unsourced). Legs are taken as stiff. Raises InputError for a wire outside its
    grade, an index outside 4..20 and fewer than 2 coils [fossee_bhandari, acxess_torsion].
    """

    rest: Angle = 0.0  # pyright: ignore[reportIncompatibleMethodOverride]
    number: Number = 1.0
    winds: Literal["up", "down"] = "up"
    along: ClassVar[tuple[str, ...]] = ("rad",)
    kind: ClassVar[str] = "torsion spring"
    standard: ClassVar[str] = "EN 13906-3"
    corrections: ClassVar[Mapping[str, Callable[[Any], Any]]] = {"curvature": coil.bending_correction}
    sources: ClassVar[tuple[str, ...]] = ("fossee_bhandari", "acxess_torsion")

    @property
    def k(self) -> Any:
        """Rate, N m/rad, of all the springs side by side."""
        return self.number * torsion_rate(self.wire, self.diameter, self.coils, self.material.young)

    @property
    def largest_torque(self) -> Any:
        """The largest static torque, N m, of all the springs side by side."""
        return self.number * BENDING * self.strength / bending_stress(1.0, self.wire)

    @property
    def span(self) -> tuple[Any, Any]:
        """From rest to the angle at the largest torque."""
        reach = self.largest_torque / self.k
        return (self.rest, self.rest + reach) if self.winds == "up" else (self.rest - reach, self.rest)

    def plain_stress(self, length: Array) -> Array:
        """sigma of the wire."""
        return bending_stress(np.abs(self.k * (length - self.rest)) / self.number, self.wire)

    def clauses(self, length: Array) -> Iterator[Clause]:
        """Bending at the angle (N,) farthest from rest."""
        stress = float(self.plain_stress(length).max())
        yield Clause("bending", stress, BENDING * float(self.strength), "Pa", UNSOURCED)

    @property
    def unsourced(self) -> tuple[str, ...]:
        """The share of Rm in bending, and the grade where it is."""
        return (*super().unsourced, "the allowed bending stress")

    def order_line(self) -> str:
        """`EN 13906-3, wire EN 10270-1 SH 2, D 20, n 5, R ... N mm/deg`."""
        return f"{self.head()}, R {self.k / self.number * 1e3 * np.pi / 180:.4g} N mm/deg"
