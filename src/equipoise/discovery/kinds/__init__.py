"""Kinds of candidates."""

from equipoise.discovery.kinds.cable_springs import CableSprings
from equipoise.discovery.kinds.coils import Coils
from equipoise.discovery.kinds.compression_coils import CompressionCoils
from equipoise.discovery.kinds.constant_force import ConstantForce
from equipoise.discovery.kinds.counterweights import Counterweights
from equipoise.discovery.kinds.gas_struts import GasStruts
from equipoise.discovery.kinds.ideal import Ideal
from equipoise.discovery.kinds.kind import Batch, Kind, Proposal, Scene
from equipoise.discovery.kinds.torsion_springs import TorsionSprings

__all__ = [
    "Batch",
    "CableSprings",
    "Coils",
    "CompressionCoils",
    "ConstantForce",
    "Counterweights",
    "GasStruts",
    "Ideal",
    "Kind",
    "Proposal",
    "Scene",
    "TorsionSprings",
]
