"""A cylinder whose pressure a regulator keeps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws.charge import STANDARD, Charge, positive
from equipoise.balancers.laws.law import Law, Share
from equipoise.units import Area, Pressure


@dataclass(frozen=True)
class ConstantPressure(Law):
    """A cylinder at a pressure that a regulator keeps, as in air balancers: f = s (P - Pa) A, V = s (P - Pa) A l.

    The gas spring with a reservoir without end. area A in m^2; pressure P in Pa, `absolute` or `gauge` (above ambient
    Pa, Pa), None where it is unknown; s = 1 where it pulls the ends together, -1 where it pushes them apart. Raises
    InputError for an area that is not positive, an absolute pressure that is not, and a negative ambient pressure.
    """

    area: Area
    pressure: Pressure | None = None
    action: Literal["pull", "push"] = "push"
    reading: Literal["absolute", "gauge"] = "gauge"
    ambient: Pressure = STANDARD
    along: ClassVar[tuple[str, ...]] = ("m",)

    @property
    def drag(self) -> float | None:
        """The seals' friction is not stated."""
        return None

    def __post_init__(self) -> None:
        positive(self.area, "area", "law constant_pressure")
        self._charge.check("law constant_pressure")

    @property
    def _charge(self) -> Charge:
        return Charge("pressure", self.pressure, self.reading, self.ambient)

    @property
    def degree(self) -> int:
        """The force does not follow the length."""
        return 0

    @property
    def pushes(self) -> bool:
        """Whether it pushes its ends apart."""
        return self.action == "push"

    @property
    def remarks(self) -> tuple[str, ...]:
        """How it acts and how its pressure is read."""
        return f"{self.action}es" if self.pushes else f"{self.action}s", f"{self.reading} pressure"

    def shares(self, length: Array) -> tuple[Share, ...]:
        """The pressure, affine, and the ambient one, known."""
        push = (-1.0 if self.pushes else 1.0) * self.area * np.ones_like(length)
        gas = Share("gas", "Pa", None, push, push * length, 0.0 * push)
        return self._charge.shares(gas, Share("air", "Pa", None, -push, -push * length, 0.0 * push))

    def details(self, values: Mapping[str, float], length: Array) -> dict[str, tuple[Any, str]]:  # noqa: ARG002
        """The air that a stroke takes from the regulator or gives back, at the pressure kept."""
        return {"volume drawn over the stroke": (float(np.ptp(length) * self.area), "m^3")}
