"""A local optimum held between the samples too."""

from __future__ import annotations

from typing import Any

from equipoise.solve.shape import Local, descend
from equipoise.tasks.search import Search
from equipoise.tasks.settle import attempt
from equipoise.tasks.task import Balanced

REFINED = 4
"""How often poses between the samples are added and the descent goes on."""
MENDED = 12
"""How often at most, as long as a limit breaks at such poses."""
BRIEF = 25
"""Steps of a descent from a geometry that is nearly optimal."""


def refine(search: Search, best: Local, load: float, **options: Any) -> tuple[Search, Local, Balanced]:
    """Add the poses between the samples that exceed the peak, and descend again, until none does."""
    balanced = attempt(search.at(best.gamma))
    for turn in range(MENDED):
        if not balanced.refined or (turn >= REFINED and balanced.broken is None):
            break
        search = search.over(balanced.task.sweep)
        best = descend(search.builder(balanced.states), search.freedoms, best.gamma, load, radius=0.02, **options)
        balanced = attempt(search.at(best.gamma))
    if balanced.broken is not None:
        raise balanced.broken
    return search.over(balanced.task.sweep), best, balanced
