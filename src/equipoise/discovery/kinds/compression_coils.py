"""Candidates that push: compression springs between two points."""

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
class CompressionCoils(LineKind):
    """Compression springs between two points, f = k (l - L0) <= 0, on a rod or in a tube that keeps them straight.

        l_max <= L0,   solid L0 <= l_min

    solid is the least length over the free length, without a unit: what its coils, and the clearance between them,
    leave. Each couple is tried with the shortest and the longest free length these admit, between which all others are
    mixtures. force in N is the most that a spring may push, stroke in m the most that it may be squeezed. Raises
    InputError for a solid outside 0..1.
    """

    solid: Number = 0.5
    force: Newtons = 5000.0
    stroke: Length | None = None

    def __post_init__(self) -> None:
        if not 0 < self.solid < 1:
            raise InputError(f"solid is {self.solid:g}, it must lie in 0..1", where="discover", hint="for example 0.5")

    @property
    def words(self) -> str:
        """Compression spring."""
        return "compression spring"

    @property
    def most(self) -> float:
        """The largest force, N."""
        return self.force

    def refuses(self, lines: Lines) -> Mapping[str, NDArray[np.bool_]]:
        """Lines that vary more than the spring can be squeezed, and the stroke."""
        limit = 1 / self.solid
        found = {f"longest over {limit:.3g} times the shortest length": lines.longest > limit * lines.shortest}
        if self.stroke is not None:
            found[f"stroke above {text(self.stroke, 'm')}"] = lines.longest - lines.shortest > self.stroke
        return found

    def laws(self, lines: Lines) -> list[Mapping[str, Array]]:
        """The shortest and the longest free length."""
        return [{"free_length": length} for length in (lines.longest, lines.shortest / self.solid)]

    def open(self, numbers: Mapping[str, Array]) -> Law:
        """f = k (l - L0)."""
        return Coil(free_length=numbers["free_length"])  # type: ignore[arg-type]

    def settled(self, one: Lines) -> Law:  # noqa: ARG002 - the same for all
        """Rate and free length open."""
        return Coil(free_length=None)

    def limits(self, name: str, one: Lines) -> tuple[Limit, ...]:  # noqa: ARG002
        """It pushes, within its force, and is not squeezed solid."""
        found: tuple[Limit, ...] = (
            Force(name, min=-self.force, max=0.0),
            Elongation(name, max=0.0, min=self.solid - 1),
        )
        return found if self.stroke is None else (*found, Stroke(name, max=self.stroke))
