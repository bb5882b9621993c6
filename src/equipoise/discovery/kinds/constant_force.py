"""Constant-force springs between two bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from equipoise.affine import Array
from equipoise.balancers.laws import Constant, Law
from equipoise.discovery.kinds.lines import Lines
from equipoise.discovery.kinds.pulled import PulledLine
from equipoise.units import Force as Newtons


@dataclass(frozen=True)
class ConstantForce(PulledLine):
    """Constant-force springs (rolled strip, or a weightless cord to one), f = force.

    force in N is the most that a spring may pull, stroke in m the most that it may pay out.
    """

    force: Newtons = 500.0

    @property
    def words(self) -> str:
        """Constant force."""
        return "constant-force spring"

    def open(self, numbers: Mapping[str, Array]) -> Law:  # noqa: ARG002 - it has none
        """f = force."""
        return Constant()

    def settled(self, one: Lines) -> Law:  # noqa: ARG002
        """f = force."""
        return Constant()
