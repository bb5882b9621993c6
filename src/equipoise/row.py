"""One row of an answer: what a joint, or the base, bears over the sweep."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Row:
    """One joint's effort over the sweep: the polished peak, the sampled one, rms and mean, the motor's limit."""

    peak: float
    sample_peak: float
    rms: float
    mean: float
    unit: str
    limit: float | None = None

    def json(self) -> dict[str, Any]:
        """The row as design.json holds it."""
        return {
            "peak": self.peak,
            "sample_peak": self.sample_peak,
            "rms": self.rms,
            "mean": self.mean,
            "limit": self.limit,
            "unit": self.unit,
        }
