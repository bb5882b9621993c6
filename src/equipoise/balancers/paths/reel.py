"""Reels: springs on what the cables of a platform wind on."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths.line import Line
from equipoise.balancers.paths.path import Path, Place, Sketch
from equipoise.balancers.paths.rub import Rub, after
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.states import States

UPRIGHT = np.array([0.0, -1.0, 0.0])
"""The axis about which a reel is drawn: across the plane of planar platforms."""


@dataclass(frozen=True)
class Reel(Path):
    """The reel of a platform's cable, named by the cable: a spring on it pulls with its force at the cable's length.

    l = |a - p - R b|, dl/dq; l in m. What the spring is made of, such as a cam or a drum, is `make`'s concern.
    """

    cable: str

    def deform(self, states: States) -> tuple[Array, Array]:
        """Length l (N,) and its derivative dl/dq_driven (N, nd); zero where the cable has no length."""
        return Line(*states.mechanism.cable(self.cable)).deform(states)

    def along(self, length: Array) -> tuple[Array, Array]:
        """The cable's own length."""
        return length, np.ones_like(length)

    def rubs(self, states: States) -> tuple[Rub, ...]:
        """The cable on its reel."""
        return after("rope", self.deform(states)[1])

    def ends(self) -> tuple[tuple[Place, float], ...]:
        """A spring on a reel loads the platform with none of its own mass."""
        return ()

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for a cable that is not there or that no motion changes."""
        Line(*mechanism.cable(self.cable)).check(mechanism, name)

    def install(self, spec: mujoco.MjSpec, name: str, states: States) -> mujoco.MjsTendon:  # noqa: ARG002
        """Add a tendon along the cable to a model."""
        found = spec.tendon(self.cable)
        if found is None:
            raise InputError(f"there is no cable {self.cable!r} in the model", where=f"spring {name}")
        tendon = spec.add_tendon(name=name)
        for wrap in found.path:
            tendon.wrap_site(wrap.target.name)
        return tendon

    def sketch(self, states: States, row: int) -> Sketch:
        """The cable from its anchor to the platform, and the spring wound up at the anchor."""
        ends = states.mechanism.cable(self.cable)
        line = np.stack([states.point(point)[0][row] for point in ends])
        return Sketch(lines=(line,), spirals=((line[0], UPRIGHT),), anchors=ends)
