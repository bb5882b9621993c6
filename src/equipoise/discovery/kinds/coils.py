"""Coil springs hooked straight on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.balancers.laws import Coil, Law
from equipoise.discovery.kinds.lines import LineKind, Lines
from equipoise.errors import InputError
from equipoise.limits import Elongation, Force, Limit, Stroke
from equipoise.units import Force as Newtons
from equipoise.units import Length, Number, text


@dataclass(frozen=True)
class Coils(LineKind):
    """Extension springs between two hooks, f = k (l - L0), never slack.

        L0 <= rest l_min,   l_max <= stretch L0

    rest is the largest rest length over the shortest length and stretch the largest length over the rest length,
    neither with a unit. Each couple is tried with the longest and the shortest rest length these admit, between
    which all others are mixtures. force in N is the most that a spring may pull, stroke in m the most that it may
    stretch. Raises InputError for a rest outside 0..1 or a stretch that leaves no room.
    """

    rest: Number = 0.95
    stretch: Number = 2.0
    force: Newtons = 5000.0
    stroke: Length | None = None
    variants = 2

    def __post_init__(self) -> None:
        if not 0 < self.rest <= 1:
            raise InputError(f"rest is {self.rest:g}, it must lie in 0..1", where="discover", hint="for example 0.95")
        if not self.stretch * self.rest > 1:
            raise InputError(
                f"a stretch of {self.stretch:g} from a rest of {self.rest:g} of the shortest length reaches no length",
                where="discover",
                hint=f"give a stretch above {1 / self.rest:.3g}",
            )

    @property
    def words(self) -> str:
        """Coils."""
        return "coil hooked straight on"

    @property
    def most(self) -> float:
        """The largest force, N."""
        return self.force

    def refuses(self, lines: Lines) -> Mapping[str, NDArray[np.bool_]]:
        """Lines that vary more than the spring can stretch, and the stroke."""
        limit = self.stretch * self.rest
        found = {f"longest over {limit:.3g} times the shortest length": lines.longest > limit * lines.shortest}
        if self.stroke is not None:
            found[f"stroke above {text(self.stroke, 'm')}"] = lines.longest - lines.shortest > self.stroke
        return found

    def laws(self, lines: Lines) -> list[Mapping[str, Array]]:
        """The longest and the shortest rest length."""
        return [{"free_length": self.rest * lines.shortest}, {"free_length": lines.longest / self.stretch}]

    def open(self, numbers: Mapping[str, Array]) -> Law:
        """f = k (l - L0)."""
        return Coil(free_length=numbers["free_length"])  # type: ignore[arg-type]

    def settled(self, one: Lines) -> Law:  # noqa: ARG002
        """Rate and rest length open."""
        return Coil(free_length=None)

    def limits(self, name: str, one: Lines) -> tuple[Limit, ...]:  # noqa: ARG002
        """Force, elongation, stroke."""
        found: tuple[Limit, ...] = (
            Force(name, max=self.force),
            Elongation(name, max=self.stretch - 1, min=1 / self.rest - 1),
        )
        return found if self.stroke is None else (*found, Stroke(name, max=self.stroke))
