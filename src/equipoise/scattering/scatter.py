"""How far things may be off."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from equipoise.errors import InputError
from equipoise.units import Angle, Length, Number, Temperature, text, unit_marks

HALF_A_DEGREE = math.radians(0.5)


@dataclass(frozen=True)
class Scatter:
    """Tolerances: two standard deviations of independent normal errors. The defaults are unsourced.

    rate: share of a spring's force at a given length, of a counterweight's mass; rest_length: of every spring, on an
    angle rest_angle; anchor: every coordinate of a point and every other length of a path; angle: every angle of a
    path; mass: share of every moving body of the robot; payload: share of its mass; tilt: of the base about each of
    two level axes; temperature: what the surroundings differ by, the same for all springs.
    Raises InputError for a negative tolerance, or a temperature or tilt beyond what a linear answer holds for.
    """

    rate: Number = 0.05
    rest_length: Length = 1e-3
    rest_angle: Angle = HALF_A_DEGREE
    anchor: Length = 1e-3
    angle: Angle = HALF_A_DEGREE
    mass: Number = 0.02
    payload: Number = 0.02
    tilt: Angle = HALF_A_DEGREE
    temperature: Temperature = 15.0

    def __post_init__(self) -> None:
        units = unit_marks(type(self))
        most = {"rate": 0.5, "mass": 0.5, "payload": 0.5, "tilt": math.radians(10), "temperature": 100.0}
        for field in fields(self):
            value, unit = getattr(self, field.name), units[field.name]
            where = f"tolerances.{field.name}"
            if not value >= 0:
                raise InputError(f"the tolerance is {text(value, unit)}", where=where, hint="0 leaves it out")
            if value > most.get(field.name, math.inf):
                limit = text(most[field.name], unit)
                raise InputError(
                    f"{text(value, unit)} is no tolerance any more, at most {limit}",
                    where=where,
                    hint="a difference in K, such as 15 K" if field.name == "temperature" else "use payload or cases",
                )
