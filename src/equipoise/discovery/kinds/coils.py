"""Coil springs hooked straight on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.balancers.laws import Coil, Law
from equipoise.discovery.kinds.kind import Kind
from equipoise.discovery.kinds.lines import LineKind, Lines
from equipoise.errors import InputError
from equipoise.limits import Elongation, Force, Limit, Stroke
from equipoise.parts.makeable import Makeable
from equipoise.units import Force as Newtons
from equipoise.units import Length, Number, text

STRETCH = 2.0
WOUND = (1.0, 0.5, 0.2)
"""Rest lengths that are tried of springs that can be wound, as shares of the way from the shortest to the longest."""


@dataclass(frozen=True)
class Coils(LineKind):
    """Extension springs between two hooks, f = k (l - L0), never slack.

        L0 <= rest l_min,   l_max <= stretch L0

    rest is the largest rest length over the shortest length and stretch the largest length over the rest length,
    neither with a unit. Each couple is tried with the longest and the shortest rest length these admit, between
    which all others are mixtures. force in N is the most that a spring may pull, stroke in m the most that it may
    stretch. With make, what can be wound decides (a `WindableSpring` each), and stretch only where it is said; without,
    it is 2 by default. Raises InputError for a rest outside 0..1 or a stretch that leaves no room.
    """

    rest: Number = 0.95
    stretch: Number | None = None
    force: Newtons = 5000.0
    stroke: Length | None = None
    make: Makeable | None = None

    def __post_init__(self) -> None:
        if not 0 < self.rest <= 1:
            raise InputError(f"rest is {self.rest:g}, it must lie in 0..1", where="discover", hint="for example 0.95")
        if self.stretch is not None and not self.stretch * self.rest > 1:
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

    @property
    def gap(self) -> float:
        """Half of what it may be wide, m."""
        return 0.0 if self.make is None else self.make.width / 2

    @property
    def most_stretch(self) -> float:
        """The largest length over the rest length."""
        return STRETCH if self.stretch is None else self.stretch

    def made(self, make: Makeable) -> Kind:
        """The same with springs that can be wound."""
        return replace(self, make=make)

    def refuses(self, lines: Lines) -> Mapping[str, NDArray[np.bool_]]:
        """Lines that vary more than the spring can stretch, and the stroke."""
        found = {}
        if self.make is None or self.stretch is not None:
            limit = self.most_stretch * self.rest
            found[f"longest over {limit:.3g} times the shortest length"] = lines.longest > limit * lines.shortest
        if self.make is not None:
            found["stretched further than can be wound"] = ~(self._least(lines) < self.rest * lines.shortest)
        if self.stroke is not None:
            found[f"stroke above {text(self.stroke, 'm')}"] = lines.longest - lines.shortest > self.stroke
        return found

    def _least(self, lines: Lines) -> Array:
        """The shortest rest length (C,)."""
        least = lines.longest / self.most_stretch if self.stretch is not None or self.make is None else 0.0
        if self.make is None:
            return np.asarray(least)
        return np.maximum(self.make.least_free(lines.shortest, lines.longest), least)

    def laws(self, lines: Lines) -> list[Mapping[str, Array]]:
        """The longest and the shortest rest length; of springs that can be wound also some between."""
        longest, least = self.rest * lines.shortest, self._least(lines)
        shares = (1.0, 0.0) if self.make is None else WOUND
        return [{"free_length": least + share * (longest - least)} for share in shares]

    def allowed(self, lines: Lines, law: Mapping[str, Array], most: Array) -> Array:
        """Rates (C,), N/m, under the force limit and of what can be wound."""
        if self.make is None:
            return most
        return np.minimum(most, self.make.most_straight(lines.shortest, lines.longest, law["free_length"])[0])

    def masses(self, lines: Lines, law: Mapping[str, Array], most: Array) -> Array:
        """Own mass (C,), kg, of what can be wound."""
        if self.make is None:
            return super().masses(lines, law, most)
        rate, option = self.make.most_straight(lines.shortest, lines.longest, law["free_length"])
        return self.make.mass_at(option, rate) * most / np.maximum(rate, 1e-300)

    def open(self, numbers: Mapping[str, Array]) -> Law:
        """f = k (l - L0)."""
        return Coil(free_length=numbers["free_length"])  # type: ignore[arg-type]

    def settled(self, one: Lines) -> Law:
        """Rate and rest length open; of what can be wound the wire that allows most at a middling rest length."""
        if self.make is None:
            return Coil(free_length=None)
        return self.make.start(self.make.most_straight(one.shortest, one.longest, self.laws(one)[1]["free_length"])[1])

    def freed(self, name: str) -> Mapping[str, tuple[float, float]]:
        """Wire and index of what is to be wound."""
        return {} if self.make is None else self.make.freed(name)

    def limits(self, name: str, one: Lines) -> tuple[Limit, ...]:  # noqa: ARG002
        """Force, elongation, stroke."""
        found: tuple[Limit, ...] = (Force(name, max=self.force),)
        if self.make is None or self.stretch is not None:
            found = (*found, Elongation(name, max=self.most_stretch - 1, min=1 / self.rest - 1))
        return found if self.stroke is None else (*found, Stroke(name, max=self.stroke))
