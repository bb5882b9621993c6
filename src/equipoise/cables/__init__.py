"""What cable platforms can do: wrench closure, feasibility, tensions, clearance, stiffness, equilibria."""

from equipoise.cables.behaviour import Behaviour, Motors, behaviour
from equipoise.cables.clearance import Clearance, clearance
from equipoise.cables.distribution import Distribution, distribute
from equipoise.cables.equilibria import Equilibrium, equilibria
from equipoise.cables.floor import SplineFloor, spline_floor
from equipoise.cables.reach import Reach, closure, feasible
from equipoise.cables.stiffness import held_stiffness, stiffness
from equipoise.cables.survey import Survey, survey
from equipoise.cables.wrench import wrench_matrix
from equipoise.sag import Sag, sag_tension

__all__ = [
    "Behaviour",
    "Clearance",
    "Distribution",
    "Equilibrium",
    "Motors",
    "Reach",
    "Sag",
    "SplineFloor",
    "Survey",
    "behaviour",
    "clearance",
    "closure",
    "distribute",
    "equilibria",
    "feasible",
    "held_stiffness",
    "sag_tension",
    "spline_floor",
    "stiffness",
    "survey",
    "wrench_matrix",
]
