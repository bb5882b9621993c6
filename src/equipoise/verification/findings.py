"""What a verification found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

LOOSE = 1.1
"""Multiple of the largest value met above which an estimate that was cut short says nothing."""


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

    @property
    def vague(self) -> bool:
        """Whether an estimate was cut short so far above what was met that it says nothing."""
        return not self.rigorous and not self.complete and self.upper > LOOSE * self.polished

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
class FreeBase:
    """How far a floating base of a mass (kg) and radius of gyration (m) moves: largest shift (m) and turn (rad).

    before is without the added parts, after with them at the longer and at the shorter time step.
    """

    mass: float
    radius: float
    before: tuple[float, float]
    after: tuple[tuple[float, float], tuple[float, float]]

    def json(self) -> dict[str, Any]:
        """The base as design.json holds it."""
        moved = {
            word: {"shift": {"value": shift, "unit": "m"}, "turn": {"value": turn, "unit": "rad"}}
            for word, (shift, turn) in (("before", self.before), ("coarse", self.after[0]), ("after", self.after[1]))
        }
        return {"mass": self.mass, "radius_of_gyration": self.radius, **moved}


@dataclass(frozen=True)
class MotionCheck:
    """The saved machine in motion.

    errors {row: JointError} of MuJoCo's inverse dynamics at `instants` instants between the samples; differences
    {force, moment: errors of a forward simulation with each of the two time `steps` (s)} fall with the step; base is
    what a floating base does.
    """

    instants: int
    errors: Mapping[str, JointError]
    steps: tuple[float, float]
    differences: Mapping[str, tuple[JointError, JointError]]
    base: FreeBase

    tolerance = 1e-8
    """Of the load, for inverse dynamics."""
    falls = 0.7
    """A fourth of the step must leave at most this share of the difference."""
    settled = 1e-4
    """Of the load: differences that need not fall further."""

    @property
    def faults(self) -> list[str]:
        """What disagrees, in words."""
        found = [
            f"inverse dynamics of the saved model differs by {error.error:.3g} {error.unit} at {name}"
            for name, error in self.errors.items()
            if not error.error <= self.tolerance * max(error.load, 1e-3)
        ]
        for name, (coarse, fine) in self.differences.items():
            if not fine.error <= max(self.falls * coarse.error, self.settled * fine.load, 1e-9):
                found.append(
                    f"the simulated {name} differs by {coarse.error:.3g} {coarse.unit} at a time step of "
                    f"{self.steps[0]:.3g} s and by {fine.error:.3g} {fine.unit} at {self.steps[1]:.3g} s: "
                    "it does not fall"
                )
        return found

    def json(self) -> dict[str, Any]:
        """The check as design.json holds it."""
        return {
            "instants": self.instants,
            "inverse": {name: error.json() for name, error in self.errors.items()},
            "steps": list(self.steps),
            "forward": {name: [error.json() for error in pair] for name, pair in self.differences.items()},
            "free_base": self.base.json(),
            "agrees": not self.faults,
        }


@dataclass(frozen=True)
class Verification:
    """The verdict on a design.

    errors {joint: JointError} over `poses` poses times `scenarios` payloads, chosen as `where` says; worst
    is where they are largest; tolerance is relative to max(load, 1) of a joint's unit; energy {element: largest
    relative difference of its effort and the derivative of its energy}; bounds {joint: Bound}; model is the
    saved file, None where it was only temporary; notes are what else must be known; motion is the check of a motion.
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
    motion: MotionCheck | None = None

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
        moves = self.motion is None or not self.motion.faults
        return same and moves and all(error <= self.energy_tolerance for error in self.energy.values())

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
            "motion": self.motion.json() if self.motion else None,
        }
