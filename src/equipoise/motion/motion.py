"""A motion: a driver for every driven joint over an interval of time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError, nearest
from equipoise.mechanism import Mechanism
from equipoise.motion.drivers import Driver, Samples, TimePolynomial, as_driver, increasing
from equipoise.posefile import held, read_columns

REGULAR, GAP = 8, 4.0
"""Rows from which on a recording has a usual step, and how many of these one may be."""


@dataclass(frozen=True, eq=False)
class Motion:
    """Drivers of all driven joints from `start` to `end`, s; the duration T = end - 0 is what drivers scale with.

    joints are named in error messages; limits (nd, 2) of the joints must be kept.
    """

    joints: tuple[str, ...]
    drivers: tuple[Driver, ...]
    start: float
    end: float
    duration: float

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """Positions, velocities and accelerations (N, nd) at instants t (N,), s."""
        jets = [
            driver.at(t, self.duration, f"motion, joint {joint}")
            for joint, driver in zip(self.joints, self.drivers, strict=True)
        ]
        parts = [[jet.value for jet in jets], [jet.rate for jet in jets], [jet.bend for jet in jets]]
        position, velocity, acceleration = (np.stack(part, axis=-1) for part in parts)
        return position, velocity, acceleration


def of_drivers(mechanism: Mechanism, drivers: Mapping[str, Any], duration: float | None, start: float) -> Motion:
    """A motion from {joint: driver}; joints left out stand still at the reference posture."""
    if duration is None:
        raise InputError("the motion has no duration", where="sweep.motion", hint="add for example `duration: 0.5 s`")
    if not duration > 0 or not start < duration:
        raise InputError(
            f"the motion runs from {start:g} s to {duration:g} s", where="sweep.motion", hint="end after the start"
        )
    if not drivers:
        raise InputError("the motion drives no joint", where="sweep.motion", hint=", ".join(mechanism.driven))
    found = {joint: as_driver(driver) for joint, driver in drivers.items()}
    for joint, driver in found.items():
        if joint not in mechanism.driven:
            mechanism.joint_id(joint)
            hint = nearest(joint, mechanism.driven)
            raise InputError(f"joint {joint!r} is not driven", where="sweep.motion", hint=hint)
        driver.check(f"motion, joint {joint}")
    still = held(mechanism)
    every = tuple(
        found.get(joint, TimePolynomial((float(place),))) for joint, place in zip(mechanism.driven, still, strict=True)
    )
    return Motion(mechanism.driven, every, float(start), float(duration), float(duration))


def _insist_on_no_gap(times: Array, path: Path) -> None:
    """A recording that misses instants would be bridged by a spline that nobody measured."""
    steps = np.diff(times)
    usual = float(np.median(steps))
    if len(times) >= REGULAR and steps.max() > GAP * usual:
        row = int(steps.argmax())
        raise InputError(
            f"the recording has a gap: {times[row]:g} s is followed by {times[row + 1]:g} s, the usual step is "
            f"{usual:.4g} s",
            where=f"{path}, line {row + 3}",
            hint="fill the gap, or record the motion anew",
        )


def read_motion(mechanism: Mechanism, path: Path) -> tuple[Motion, Array]:
    """A recorded motion and its times (N,), s: a CSV file with a column `time` and one per moving joint.

    Columns are headed `time`, `time [ms]`, `joint`, `joint [deg]`. Raises InputError for times that do not
    increase, naming the row.
    """
    columns = read_columns(mechanism, path, {"time": "s"})
    if "time" not in columns:
        raise InputError(
            "the motion has no column `time`", where=f"{path}, line 1", hint="head it `time` or `time [ms]`"
        )
    times = columns["time"]
    if len(times) < 2:
        raise InputError("a motion needs two rows at least", where=str(path))
    increasing(times, str(path))
    _insist_on_no_gap(times, path)
    still = held(mechanism)
    drivers = tuple(
        Samples(times, columns[joint]) if joint in columns else TimePolynomial((float(place),))
        for joint, place in zip(mechanism.driven, still, strict=True)
    )
    span = float(times[-1])
    return Motion(mechanism.driven, drivers, float(times[0]), span, span), times
