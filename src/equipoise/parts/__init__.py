"""Real parts: wire, springs by their formulas, data sheets and catalogues; rows are arrays throughout."""

from equipoise.parts.compression import CompressionSpring
from equipoise.parts.extension import ExtensionSpring
from equipoise.parts.gas import GasSpring
from equipoise.parts.part import Clause, Fault, Part
from equipoise.parts.stock import StockSpring
from equipoise.parts.strip import ConstantForceSpring
from equipoise.parts.torsion import TorsionSpring
from equipoise.parts.windable import WindableSpring
from equipoise.parts.wire import Grade, grade, grades, preferred_sizes

PARTS: dict[str, type[Part]] = {
    "extension_spring": ExtensionSpring,
    "compression_spring": CompressionSpring,
    "torsion_spring": TorsionSpring,
    "gas_spring": GasSpring,
    "constant_force_spring": ConstantForceSpring,
    "stock_spring": StockSpring,
}
"""Laws that are parts, by their tag in a problem file."""

__all__ = [
    "PARTS",
    "Clause",
    "CompressionSpring",
    "ConstantForceSpring",
    "ExtensionSpring",
    "Fault",
    "GasSpring",
    "Grade",
    "Part",
    "StockSpring",
    "TorsionSpring",
    "WindableSpring",
    "grade",
    "grades",
    "preferred_sizes",
]
