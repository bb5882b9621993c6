"""Shafts: angles that can drive a mechanism of cranks, cams and sliders."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

import mujoco

from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.path import Path
from equipoise.states import States


class Shaft(Path):
    """An angle that follows the mechanism and that other paths may take as their input."""

    @abstractmethod
    def shaft(self, model: mujoco.MjModel) -> Mount:
        """Where the angle can be seen: the shaft, where it points at angle zero, and its axis."""

    @abstractmethod
    def crank(self, spec: mujoco.MjSpec, frame: Any, name: str, states: States, phase: Any, length: float) -> Any:
        """Add a crank of a length, m, to a frame of a model: its hinge `name` reads the angle plus a phase, rad."""
