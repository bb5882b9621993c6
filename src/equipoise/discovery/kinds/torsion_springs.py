"""Torsion springs at joints."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from equipoise.balancers.laws import Torsion
from equipoise.balancers.paths import Angle
from equipoise.balancers.spring import Spring
from equipoise.discovery.kinds.kind import Batch, Kind, Proposal, Scene
from equipoise.limits import Extension, Force
from equipoise.units import Number, Torque

RESTS = 9
"""Rest angles that are tried, from one span below to one span above the joint's range."""


@dataclass(frozen=True)
class TorsionSprings(Kind):
    """Torsion springs about hinges, T = k (q - rest), tried at rest angles within and beyond the joint's range.

    torque in N m is the most that a spring may exert, turns how far it may be wound from its rest: a soft spring wound
    without end would be a constant torque, which no coil gives.
    """

    torque: Torque = 200.0
    turns: Number = 3.0

    @property
    def words(self) -> str:
        """Torsion spring."""
        return "torsion spring at the joint"

    def batches(self, scene: Scene) -> list[Batch]:
        """One batch per joint: two generators, q dq/dq_driven and dq/dq_driven."""
        found = []
        for joint in scene.joints:
            angle, rate = scene.states.angle(joint)
            low, high = float(angle.min()), float(angle.max())
            rests = np.linspace(2 * low - high, 2 * high - low, RESTS)
            generators = np.stack([scene.counted(angle[:, None] * rate), scene.counted(-rate)], axis=1)
            turn = np.maximum(np.abs(low - rests), np.abs(high - rests))

            def propose(index: int, name: str, joint: str = joint) -> Proposal:  # noqa: ARG001 - the rest is found
                limits = (Force(name, min=-self.torque, max=self.torque), Extension(name, 2 * math.pi * self.turns))
                return Proposal(Spring(name, Angle(joint), Torsion(rest=None)), limits)

            coefficients = np.stack([np.ones(RESTS), rests])
            found.append(
                Batch(
                    f"about {joint}", generators, coefficients, self.torque / turn, np.zeros(RESTS, dtype=int), propose
                )
            )
        return found
