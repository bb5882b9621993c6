"""Closed loops: dependent joints and transmission of many poses at once."""

from equipoise.loops.choices import assemblies, on_branch
from equipoise.loops.close import close_loops, loop_report, reachable, tighten_loops
from equipoise.loops.multipliers import LoopJacobian, constraint_jacobian
from equipoise.loops.posture import ancestors
from equipoise.loops.rates import accelerations
from equipoise.loops.track import close_beside, close_motion

__all__ = [
    "LoopJacobian",
    "accelerations",
    "ancestors",
    "assemblies",
    "close_beside",
    "close_loops",
    "close_motion",
    "constraint_jacobian",
    "loop_report",
    "on_branch",
    "reachable",
    "tighten_loops",
]
