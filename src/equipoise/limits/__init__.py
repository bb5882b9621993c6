"""What must hold: limits answer linear rows for the states of a sweep."""

from equipoise.limits.avoid import Avoid
from equipoise.limits.balanced import Balanced
from equipoise.limits.cable import Tension, Transmission, WindUp
from equipoise.limits.curve import Convex, Curvature, OverInterval, Slope
from equipoise.limits.elongation import Elongation, Extension
from equipoise.limits.exact import ExactAt
from equipoise.limits.limit import Limit, Setting
from equipoise.limits.realisable import realisable
from equipoise.limits.spring import Force, Length, MassCap, Slack, Stiffness, Stroke, implied
from equipoise.limits.spring_index import SpringIndex
from equipoise.limits.wrap import Wrap

__all__ = [
    "Avoid",
    "Balanced",
    "Convex",
    "Curvature",
    "Elongation",
    "ExactAt",
    "Extension",
    "Force",
    "Length",
    "Limit",
    "MassCap",
    "OverInterval",
    "Setting",
    "Slack",
    "Slope",
    "SpringIndex",
    "Stiffness",
    "Stroke",
    "Tension",
    "Transmission",
    "WindUp",
    "Wrap",
    "implied",
    "realisable",
]
