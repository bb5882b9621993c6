"""What cable platforms can do: wrench closure, feasibility, tensions, clearance, stiffness, equilibria."""

from equipoise.cables.clearance import Clearance, clearance
from equipoise.cables.distribution import Distribution, distribute
from equipoise.cables.equilibria import Equilibrium, equilibria, stiffness
from equipoise.cables.reach import Reach, closure, feasible, sag_tension
from equipoise.cables.wrench import wrench_matrix

__all__ = [
    "Clearance",
    "Distribution",
    "Equilibrium",
    "Reach",
    "clearance",
    "closure",
    "distribute",
    "equilibria",
    "feasible",
    "sag_tension",
    "stiffness",
    "wrench_matrix",
]
