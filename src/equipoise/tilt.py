"""A base that leans: gravity as a set of directions, each a case that the design serves."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.units import Angle, Number


@dataclass(frozen=True)
class Tilt:
    """How far the base of a mobile or inclined machine leans: upright, and `directions` leans by `angle`.

        g_i = R(cos a_i e_1 + sin a_i e_2, angle) g,   a_i = 2 pi i / directions

    e_1, e_2 are square to gravity g; angle in rad, between 0 and 90 degrees. With an axis (world) the base leans about
    it alone, to both sides. What motors hold is linear in gravity: no lean within the cone is worse than its rim, and
    n directions miss the worst of the rim by a factor of at most 1 / cos(pi / n). Raises InputError for an angle or a
    number of directions that is none, and an axis along gravity.
    """

    angle: Angle
    directions: int = 8
    axis: tuple[Number, Number, Number] | None = None

    def __post_init__(self) -> None:
        if not 0 < self.angle <= math.pi / 2:
            raise InputError(
                f"the tilt is {math.degrees(self.angle):g} deg, it lies between 0 and 90 deg", where="tilt"
            )
        if self.directions < 3:
            raise InputError(f"{self.directions} directions span no cone", where="tilt", hint="3 or more, or an `axis`")

    def apply(self, mechanism: Mechanism) -> dict[str, Mechanism]:
        """The mechanism upright and in every lean, by label."""
        found = {"upright": mechanism}
        for label, gravity in self.gravities(mechanism.gravity).items():
            spec = mechanism.spec.copy()
            spec.modelfiledir = mechanism.spec.modelfiledir
            spec.option.gravity = gravity.tolist()
            found[label] = mechanism.with_model(spec)
        return found

    def gravities(self, gravity: np.ndarray) -> dict[str, np.ndarray]:
        """Gravity (3,), m/s^2, of every lean."""
        size = float(np.linalg.norm(gravity))
        if not size > 0:
            raise InputError("without gravity a tilt changes nothing", where="tilt")
        down = gravity / size
        first = np.cross(down, np.eye(3)[int(np.abs(down).argmin())])
        first /= np.linalg.norm(first)
        words = f"{math.degrees(self.angle):g} deg"
        if self.axis is None:
            turns = {
                f"tilt {words} about {math.degrees(a):.3g} deg": math.cos(a) * first
                + math.sin(a) * np.cross(down, first)
                for a in 2 * math.pi * np.arange(self.directions) / self.directions
            }
        else:
            axis = np.array(self.axis, dtype=float)
            if not np.linalg.norm(np.cross(axis, down)) > 1e-9:
                raise InputError(
                    "the axis of the tilt lies along gravity", where="tilt", hint="lean about a level axis"
                )
            axis /= np.linalg.norm(axis)
            turns = {f"tilt {words}": axis, f"tilt -{words}": -axis}
        return {label: _turned(gravity, axis, self.angle) for label, axis in turns.items()}


def _turned(vector: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    """A vector turned about a unit axis (Rodrigues)."""
    across = np.cross(axis, vector)
    return vector * math.cos(angle) + across * math.sin(angle) + axis * (axis @ vector) * (1 - math.cos(angle))
