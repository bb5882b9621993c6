"""A choice that a discovery considered and left."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Alternative:
    """How many parts, where, the objective's value with them, and why they lost.

    value is over the whole sweep, at the geometry where refinement over few poses left the parts, in the objective's
    unit; the 95 % value of its band where that judges.
    """

    springs: int
    places: tuple[str, ...]
    value: float
    reason: str

    def json(self) -> dict[str, Any]:
        """The choice as design.json holds it."""
        return vars(self) | {"places": list(self.places)}

    @staticmethod
    def read(entry: Mapping[str, Any]) -> Alternative:
        """The choice from what design.json holds; raises TypeError or KeyError for an entry that is none."""
        return Alternative(**{**entry, "places": tuple(entry["places"])})
