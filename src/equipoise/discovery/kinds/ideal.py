"""Ideal springs of zero free length, whose effort is bilinear in the attachment points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws import Law, ZeroFreeLength
from equipoise.discovery.kinds.cable_springs import CableSprings
from equipoise.discovery.kinds.kind import Batch, Kind, Proposal, Scene
from equipoise.discovery.kinds.lines import Lines
from equipoise.discovery.kinds.pulled import PulledLine
from equipoise.parts.makeable import Makeable
from equipoise.units import Force as Newtons


@dataclass(frozen=True)
class Ideal(PulledLine):
    """Springs of zero free length, f = k l: what a cable over a guide makes of a coil.

        dV/dq = k sum_ij a_i b_j E_ij(q),   a = (1, a_x, a_y, a_z), b likewise

    so per pair of bodies 16 generators E span all couples of points. force in N is the most that a spring may pull,
    stroke in m the most that it may stretch.
    """

    force: Newtons = 5000.0

    @property
    def words(self) -> str:
        """Zero free length."""
        return "zero free length"

    def made(self, make: Makeable) -> Kind:
        """What acts like it and can be wound: a coil along a link behind a cable."""
        return CableSprings(force=self.force, make=make)

    def batch(self, scene: Scene, lines: Lines) -> Batch:  # noqa: ARG002 - no column is spelled out
        """The pair's generators and the products of the places; no column is spelled out."""

        def propose(index: int, name: str) -> Proposal:
            return self.proposal(lines, index, name)

        upper = self.force / lines.longest
        return Batch(lines.place, lines.form.pull, lines.products(), upper, np.arange(len(lines)), propose)

    def open(self, numbers: Mapping[str, Array]) -> Law:  # noqa: ARG002 - an ideal spring has none
        """f = k l."""
        return ZeroFreeLength()

    def settled(self, one: Lines) -> Law:  # noqa: ARG002
        """f = k l."""
        return ZeroFreeLength()
