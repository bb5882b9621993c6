"""What a limit sees and answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol, TypeVar

from equipoise.affine import Affine, Array
from equipoise.balancers.counterweight import Counterweight
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError, nearest
from equipoise.solve.program import Rows
from equipoise.states import States

Kind = TypeVar("Kind", Spring, Counterweight)


@dataclass(frozen=True, eq=False)
class Setting:
    """The balancers by name, the states they work in, and what else may be asked of mechanism and balancers.

    hold_at is the whole hold effort at any other poses (N, nd); momentum the whole linear (`force`) or angular
    (`moment`) momentum over random admissible states.
    """

    balancers: Mapping[str, object]
    states: States
    hold_at: Callable[[Array], Affine]
    momentum: Callable[[str], Affine] | None = None

    def find(self, name: str, kind: type[Kind], limit: str) -> Kind:
        """The balancer of a kind that a limit names; raises InputError where there is none."""
        balancer = self.balancers.get(name)
        if isinstance(balancer, kind):
            return balancer
        known = [label for label, other in self.balancers.items() if isinstance(other, kind)]
        raise InputError(
            f"there is no {kind.__name__.lower()} called {name!r}", where=f"limit {limit}", hint=nearest(name, known)
        )


class Limit(Protocol):
    """Answers rows G theta <= h over the states of a setting."""

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """The rows to keep."""
        ...
