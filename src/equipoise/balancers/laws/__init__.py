"""Laws: forces affine in their unknowns, f = B(l) theta + f0, with their integral E(l); one idea per file."""

from equipoise.balancers.laws.bspline import BSpline
from equipoise.balancers.laws.coil import Coil
from equipoise.balancers.laws.constant_pressure import ConstantPressure
from equipoise.balancers.laws.cylinder import gas_cylinder
from equipoise.balancers.laws.gas import Gas
from equipoise.balancers.laws.hydro_pneumatic import HydroPneumatic
from equipoise.balancers.laws.law import Law, Share
from equipoise.balancers.laws.nitrogen import Nitrogen
from equipoise.balancers.laws.polynomial import Polynomial
from equipoise.balancers.laws.stored import Stored
from equipoise.balancers.laws.straight import Constant, Linear, ZeroFreeLength
from equipoise.balancers.laws.torsion import Torsion
from equipoise.balancers.laws.weight import Weight
from equipoise.balancers.laws.wire import WireMass

__all__ = [
    "BSpline",
    "Coil",
    "Constant",
    "ConstantPressure",
    "Gas",
    "HydroPneumatic",
    "Law",
    "Linear",
    "Nitrogen",
    "Polynomial",
    "Share",
    "Stored",
    "Torsion",
    "Weight",
    "WireMass",
    "ZeroFreeLength",
    "gas_cylinder",
]
