"""Cables as paths: the length of a tendon that the mechanism already has."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import mujoco

from equipoise.affine import Array
from equipoise.balancers.paths import Line
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism, Point
from equipoise.states import States


@dataclass(frozen=True)
class Cable:
    """A cable of a platform, by name: a spring on its reel pulls with the spring's force at the cable's length.

    l = |a - p - R b|, dl/dq; l in m. The reel's own spring turns the force into a torque; see `make`.
    """

    cable: str
    unit: ClassVar[str] = "m"

    def deform(self, states: States) -> tuple[Array, Array]:
        """Length l (N,) and its derivative dl/dq_driven (N, nd); zero where the cable has no length."""
        return Line(*states.mechanism.cable(self.cable)).deform(states)

    def span(self, mechanism: Mechanism) -> tuple[Point, Point]:
        """The points that the cable runs between."""
        return mechanism.cable(self.cable)

    def ends(self) -> tuple[tuple[Point, float], ...]:
        """A spring on a reel loads the platform with none of its own mass."""
        return ()

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for a cable that is not there or that no motion changes."""
        Line(*mechanism.cable(self.cable)).check(mechanism, name)

    def install(self, spec: mujoco.MjSpec, name: str) -> mujoco.MjsTendon:
        """Add a tendon along the cable to a model."""
        found = spec.tendon(self.cable)
        if found is None:
            raise InputError(f"there is no cable {self.cable!r} in the model", where=f"spring {name}")
        tendon = spec.add_tendon(name=name)
        for wrap in found.path:
            tendon.wrap_site(wrap.target.name)
        return tendon
