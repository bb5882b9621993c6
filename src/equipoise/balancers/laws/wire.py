"""The mass of a coil's wire."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from equipoise.units import Density, Length, Number, Pressure


@dataclass(frozen=True)
class WireMass:
    """The mass of a coil's wire, which grows with the square root of its rate.

    m = pi rho L_w sqrt(D^3 n |k| / (2 G)): the wire diameter follows from d^4 = 8 D^3 n |k| / G.
    diameter D (mean coil) and wire_length L_w in m, coils n, shear_modulus G in Pa, density rho in kg/m^3,
    k in N/m, negative for a spring that pushes. Arakelian & Ghazaryan 2008, Eq. 7 [arakelian_ghazaryan_2008].
    """

    diameter: Length
    coils: Number
    wire_length: Length
    shear_modulus: Pressure = 81e9
    density: Density = 7800.0
    sources: ClassVar[tuple[str, ...]] = ("arakelian_ghazaryan_2008",)

    def of(self, k: Any) -> Any:
        """Mass, kg, of the spring of rate k, N/m."""
        size = np.where(np.real(k) < 0, -1.0, 1.0) * k
        return (
            self.density
            * np.pi
            * self.wire_length
            * np.sqrt(self.diameter**3 * self.coils * size / (2 * self.shear_modulus))
        )

    def thickness(self, k: Any) -> Any:
        """Wire diameter d, m, of the spring of rate k, N/m."""
        return (8 * self.diameter**3 * self.coils * np.abs(k) / self.shear_modulus) ** 0.25
