"""Constant-force springs between two bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.balancers.laws import Constant, Law
from equipoise.discovery.kinds.lines import LineKind, Lines
from equipoise.limits import Force, Limit, Stroke
from equipoise.units import Force as Newtons
from equipoise.units import Length, text


@dataclass(frozen=True)
class ConstantForce(LineKind):
    """Constant-force springs (rolled strip, or a weightless cord to one), f = force.

    force in N is the most that a spring may pull, stroke in m the most that it may pay out.
    """

    force: Newtons = 500.0
    stroke: Length | None = None

    @property
    def words(self) -> str:
        """Constant force."""
        return "constant-force spring"

    @property
    def most(self) -> float:
        """The largest force, N."""
        return self.force

    def refuses(self, lines: Lines) -> Mapping[str, NDArray[np.bool_]]:
        """The stroke."""
        if self.stroke is None:
            return {}
        return {f"stroke above {text(self.stroke, 'm')}": lines.longest - lines.shortest > self.stroke}

    def open(self, numbers: Mapping[str, Array]) -> Law:  # noqa: ARG002 - it has none
        """f = force."""
        return Constant()

    def settled(self, one: Lines) -> Law:  # noqa: ARG002
        """f = force."""
        return Constant()

    def limits(self, name: str, one: Lines) -> tuple[Limit, ...]:  # noqa: ARG002
        """Force and stroke."""
        found: tuple[Limit, ...] = (Force(name, max=self.force),)
        return found if self.stroke is None else (*found, Stroke(name, max=self.stroke))
