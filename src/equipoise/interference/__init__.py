"""Interference: what springs may run into."""

from equipoise.interference.capsules import Capsule, Shell, shell
from equipoise.interference.segments import closest

__all__ = ["Capsule", "Shell", "closest", "shell"]
