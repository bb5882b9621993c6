"""What a verification found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np


@dataclass(frozen=True)
class JointError:
    """Largest |MuJoCo - design| of one driven joint, the load it is judged against, both in the joint's unit."""

    error: float
    load: float
    unit: str

    @property
    def relative(self) -> float:
        """Error over load."""
        return self.error / self.load if self.load > 0 else 0.0

    def json(self) -> dict[str, Any]:
        """The error as design.json holds it."""
        return {"error": self.error, "relative": self.relative, "load": self.load, "unit": self.unit}


@dataclass(frozen=True)
class Disagreement:
    """The pose at which design and MuJoCo differ most: {joint: position}, payload {body: kg}, both efforts."""

    joint: str
    pose: Mapping[str, float]
    payload: Mapping[str, float]
    design: float
    simulated: float
    unit: str

    def __str__(self) -> str:
        where = ", ".join(f"{joint} = {value:.4g}" for joint, value in self.pose.items())
        carried = "".join(f", {mass:g} kg at {body}" for body, mass in self.payload.items())
        return (
            f"{self.joint} at {where}{carried}: the design says {self.design:.9g} {self.unit}, "
            f"MuJoCo {self.simulated:.9g} {self.unit}"
        )


@dataclass(frozen=True)
class Bound:
    """How large one joint's effort can be between the samples.

    sample <= polished <= true peak over the box <= upper, in `unit`; method says how upper was found and
    `rigorous` whether it is a bound or an estimate; cells boxes were judged, complete tells whether the
    wanted gap was reached within the budget (upper holds either way). upper is infinite where there is no
    bound; method then says why.
    """

    sample: float
    polished: float
    upper: float
    unit: str
    method: str
    rigorous: bool
    cells: int
    complete: bool

    @property
    def gap(self) -> float:
        """upper - polished."""
        return self.upper - self.polished

    def json(self) -> dict[str, Any]:
        """The bound as design.json holds it; an upper value that is not there is null."""
        there = bool(np.isfinite(self.upper))
        return {
            "sample": self.sample,
            "polished": self.polished,
            "upper": self.upper if there else None,
            "gap": self.gap if there else None,
            "unit": self.unit,
            "method": self.method,
            "rigorous": self.rigorous,
            "cells": self.cells,
            "complete": self.complete,
        }


@dataclass(frozen=True)
class Verification:
    """The verdict on a design.

    errors {joint: JointError} over `poses` poses times `scenarios` payloads, chosen as `where` says; worst
    is where they are largest; tolerance is relative to max(load, 1) of a joint's unit; energy {element: largest
    relative difference of its effort and the derivative of its energy}; bounds {joint: Bound}; model is the
    saved file, None where it was only temporary; notes are what else must be known.
    """

    engine: str
    poses: int
    seed: int
    where: str
    scenarios: int
    errors: Mapping[str, JointError]
    worst: Disagreement | None
    tolerance: float
    energy: Mapping[str, float]
    energy_tolerance: float
    bounds: Mapping[str, Bound]
    model: Path | None = None
    notes: tuple[str, ...] = field(default=())

    @property
    def max_abs_error(self) -> float:
        """The largest error over all driven joints, in `unit`."""
        return self._largest.error

    @property
    def unit(self) -> str:
        """The unit of the joint with the largest error."""
        return self._largest.unit

    @property
    def relative(self) -> float:
        """The largest error relative to its load."""
        return max(error.relative for error in self.errors.values())

    @property
    def agrees(self) -> bool:
        """Whether MuJoCo gives the same efforts and every effort is the derivative of its energy."""
        same = all(self.within(error) for error in self.errors.values())
        return same and all(error <= self.energy_tolerance for error in self.energy.values())

    def within(self, error: JointError) -> bool:
        """Whether one joint's error is within the tolerance; an error that is not a number is not."""
        return bool(error.error <= self.tolerance * max(error.load, 1.0))

    @property
    def _largest(self) -> JointError:
        return max(self.errors.values(), key=lambda error: np.nan_to_num(error.error, nan=np.inf))

    def json(self) -> dict[str, Any]:
        """The verification as design.json holds it."""
        return {
            "engine": self.engine,
            "poses": self.poses,
            "max_abs_error": self.max_abs_error,
            "unit": self.unit,
            "relative": self.relative,
            "agrees": self.agrees,
            "tolerance": self.tolerance,
            "seed": self.seed,
            "where": self.where,
            "scenarios": self.scenarios,
            "errors": {joint: error.json() for joint, error in self.errors.items()},
            "energy": dict(self.energy),
            "energy_tolerance": self.energy_tolerance,
            "bounds": {joint: bound.json() for joint, bound in self.bounds.items()},
            "model": self.model.name if self.model else None,
            "notes": list(self.notes),
        }
