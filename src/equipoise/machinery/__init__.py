"""The machine over a motion: what its motors do and what its bearings carry, with and without what is added."""

from equipoise.machinery.bearings import Bearing, BearingForces, bearing_forces
from equipoise.machinery.drive import Drive, Share
from equipoise.machinery.rubbed import Rubbed
from equipoise.machinery.supply import Supply
from equipoise.machinery.whole import Machine, machine

__all__ = ["Bearing", "BearingForces", "Drive", "Machine", "Rubbed", "Share", "Supply", "bearing_forces", "machine"]
