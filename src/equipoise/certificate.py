"""How good an answer is, and what holds it back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from equipoise.floors import Floor


@dataclass(frozen=True)
class Active:
    """A limit or bound that holds the optimum: its price is the objective gained per unit of relaxing it."""

    limit: str
    price: float
    unit: str


@dataclass(frozen=True)
class Certificate:
    """How good the answer is, recomputed from the problem's data.

    kind `exact` (residual at rounding level, also off the grid), `convex` (primal, dual and gap) or `local`
    (starts, how many different optima, the spread of their values, what one more step would gain), `bracketed` where
    dual bounds all geometry within the bounds, after so many boxes of branch and bound. quadrature is how much the
    objective changes, relatively, on a finer rule over the same region.
    """

    kind: str
    primal: float
    dual: float
    unit: str
    violation: float
    starts: int = 0
    optima: int = 0
    spread: float = 0.0
    stationarity: float = 0.0
    active: tuple[Active, ...] = ()
    floors: tuple[Floor, ...] = ()
    flat: tuple[str, ...] = ()
    quadrature: float | None = None
    boxes: int = 0

    @property
    def gap(self) -> float:
        """primal - dual."""
        return self.primal - self.dual

    def json(self) -> dict[str, Any]:
        """The certificate as design.json holds it."""
        return {
            "kind": self.kind,
            "primal": self.primal,
            "dual": self.dual,
            "gap": self.gap,
            "unit": self.unit,
            "violation": self.violation,
            "starts": self.starts,
            "optima": self.optima,
            "spread": self.spread,
            "stationarity": self.stationarity,
            "active": [vars(active) for active in self.active],
            "floors": [vars(floor) for floor in self.floors],
            "flat": self.flat,
            "quadrature": self.quadrature,
            "boxes": self.boxes,
        }
