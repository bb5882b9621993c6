"""Families of balancers for one joint: where they sit, what they are made of, how each is judged."""

from equipoise.families.family import Family, Trial
from equipoise.families.hinge import HINGE
from equipoise.families.site import Site, site_of
from equipoise.families.slide import SLIDE

__all__ = ["HINGE", "SLIDE", "Family", "Site", "Trial", "site_of"]
