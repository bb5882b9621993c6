"""Where equal balancers sit: what may be turned or swapped without any change, what is in the way, what it costs."""

from equipoise.placement.equals import turned
from equipoise.placement.request import Placing, Zone
from equipoise.placement.sweeping import Hit, Limb, limbs, links

__all__ = ["Hit", "Limb", "Placing", "Zone", "limbs", "links", "turned"]
