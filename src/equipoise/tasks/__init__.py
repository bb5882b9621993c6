"""Tasks: one balancing question at one geometry, solved, certified and put into a design.

Verbs pose tasks: `balance` one, `shape` one for every geometry it tries, `adjust` one for every case. A search frees
geometry: `search` says what is free, `starts` descends from many places, `refine` holds the optimum between the
samples, `lean` picks what stores least energy among equals, `optimum` tells the result; `family` joins cases.
"""

from equipoise.tasks.between import between
from equipoise.tasks.certificate import active_limits, certify, is_exact
from equipoise.tasks.finish import finish
from equipoise.tasks.settle import attempt, settle, tightened
from equipoise.tasks.task import Balanced, Task, task_of, unit_of

__all__ = [
    "Balanced",
    "Task",
    "active_limits",
    "attempt",
    "between",
    "certify",
    "finish",
    "is_exact",
    "settle",
    "task_of",
    "tightened",
    "unit_of",
]
