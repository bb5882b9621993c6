"""Closed loops: dependent joints and transmission of many poses at once."""

from equipoise.loops.close import close_loops, loop_report, tighten_loops
from equipoise.loops.posture import ancestors

__all__ = ["ancestors", "close_loops", "loop_report", "tighten_loops"]
