"""Known masses that a mechanism carries, and the scenarios that several of them make."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism, Point
from equipoise.units import Length, Mass


@dataclass(frozen=True)
class Payload:
    """A known point mass carried at `at` (m, link frame) of `body`; several masses are scenarios.

    mass in kg, one number or several; masses given for the same point are alternatives, masses at
    different points are combined.
    """

    body: str
    mass: Mass | tuple[Mass, ...]
    at: tuple[Length, Length, Length] = (0.0, 0.0, 0.0)

    @property
    def point(self) -> Point:
        """Where the payload sits."""
        return Point(self.body, self.at)

    @property
    def masses(self) -> tuple[float, ...]:
        """All scenarios of this payload, kg."""
        return tuple(self.mass) if isinstance(self.mass, tuple | list) else (self.mass,)


def scenarios_of(mechanism: Mechanism, payload: Sequence[Payload]) -> tuple[tuple[Payload, ...], Array]:
    """Places that carry something, K payloads of no mass, and what each carries in every scenario (S, K), kg.

    Raises InputError for a body that the mechanism does not have, or a mass that is none.
    """
    carried: dict[tuple[str, tuple[Length, Length, Length]], list[float]] = {}
    for item in payload:
        mechanism.body_id(item.body)
        for mass in item.masses:
            if not (math.isfinite(mass) and mass >= 0):
                raise InputError(f"a payload of {mass:g} kg is not a mass", where=f"payload at {item.body}")
            x, y, z = item.at
            carried.setdefault((item.body, (x, y, z)), []).append(float(mass))
    places = tuple(Payload(body, 0.0, at) for body, at in carried)
    return places, np.array(list(itertools.product(*carried.values())))
