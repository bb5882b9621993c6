"""Counterweights on moving bodies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equipoise.balancers.counterweight import Counterweight
from equipoise.discovery.kinds.kind import Batch, Kind, Proposal, Scene
from equipoise.discovery.lattice import Spots
from equipoise.limits import MassCap
from equipoise.mechanism import Point
from equipoise.units import Mass


@dataclass(frozen=True)
class Counterweights(Kind):
    """Point masses on moving bodies, whose effort is affine in their place: four generators per body.

    mass in kg is the most that one may weigh.
    """

    mass: Mass = 5.0

    @property
    def words(self) -> str:
        """Counterweight."""
        return "counterweight"

    def batches(self, scene: Scene) -> list[Batch]:
        """One batch per moving body."""
        found = []
        for spots in scene.bodies:
            kept = scene.sift(len(spots.places), scene.keep((spots.body, spots.body), spots.places, spots.places))
            places = spots.places[kept]
            if len(places):
                found.append(self._batch(scene, spots, places))
        return found

    def _batch(self, scene: Scene, spots: Spots, places: np.ndarray) -> Batch:
        corners = np.vstack([np.zeros(3), np.eye(3)])
        point = Point.many(spots.body, corners)
        values = scene.counted(scene.states.weight_effort(point, 1.0)).T
        generators = np.hstack([values[:, 1:] - values[:, :1], values[:, :1]])
        coefficients = np.vstack([places.T, np.ones(len(places))])

        def propose(index: int, name: str) -> Proposal:
            weight = Counterweight(name, Point.of(spots.body, places[index].tolist()))
            free = {
                f"{name}.at.{axis}": (float(lo), float(hi)) for axis, (lo, hi) in zip("xyz", spots.box, strict=True)
            }
            return Proposal(weight, (MassCap(name, self.mass),), free)

        upper = np.full(len(places), self.mass)
        return Batch(
            f"weight on {spots.body}", generators, coefficients, upper, np.arange(len(places)), propose, letter="w"
        )
