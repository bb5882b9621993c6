"""What a sweep is made of: joints by name, intervals, boxes and ticks."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.posefile import held
from equipoise.units import Joint, to_si

MAX_POSES = 5_000_000


def pose_vector(mechanism: Mechanism, pose: Mapping[str, float]) -> Array:
    """Driven positions (nd,) of a pose {joint: value}; joints left out stay at the reference posture."""
    vector = held(mechanism)
    for joint, value in pose.items():
        vector[driven_index(mechanism, joint, "pose")] = to_si(value, "", f"pose, joint {joint}")
    return vector


def driven_index(mechanism: Mechanism, joint: str, where: str) -> int:
    """The place of a driven joint; raises InputError for any other."""
    if joint not in mechanism.driven:
        mechanism.joint_id(joint)
        raise InputError(
            f"joint {joint!r} is not driven: loops, the file or you hold it",
            where=where,
            hint="driven joints: " + ", ".join(mechanism.driven),
        )
    return mechanism.driven.index(joint)


def few_enough(rows: int) -> None:
    """Raise InputError for more rows than a sweep may have."""
    if rows > MAX_POSES:
        raise InputError(
            f"the sweep has {rows} rows, the limit is {MAX_POSES}",
            where="sweep",
            hint="use fewer poses, points per joint or payloads",
        )


def points_each_way(points: int) -> int:
    """The number of points in each direction of a rule; raises InputError for one that is none."""
    if not 1 <= points <= 200:
        raise InputError(f"{points} points in each direction", where="sweep.points", hint="use 4 to 40")
    return points


def anchors(mechanism: Mechanism, names: Sequence[str]) -> Array:
    """Where cables of a point platform have no length, in the plane of two slides (S, 2)."""
    platform, model = mechanism.platform, mechanism.model
    if platform is None or len(platform.rows) != 2:
        return np.zeros((0, 2))
    axes = [int(np.argmax(np.abs(model.jnt_axis[mechanism.joint_id(name)]))) for name in names]
    return np.array([[mechanism.cable(cable)[0].at[axis] for axis in axes] for cable in platform.cables])


def crossed(points: Array, others: Array, indices: Sequence[int]) -> Array:
    """Every point (M, j) of some joints, by their indices, with every pose (K, nd) of the others (M K, nd)."""
    poses = np.tile(others, (len(points), 1))
    poses[:, indices] = np.repeat(points, len(others), axis=0)
    return poses


def finite(values: Sequence[float], count: int, where: str) -> list[float]:
    """That many finite numbers; raises InputError for others."""
    if len(values) != count:
        raise InputError(f"expected {count} numbers, got {len(values)}", where=where)
    numbers = [float(value) for value in values]
    if not all(map(math.isfinite, numbers)):
        raise InputError(f"{numbers} is not finite", where=where)
    return numbers


def interval(values: Sequence[float], count: int, where: str) -> list[float]:
    """That many finite numbers, the first two in order; raises InputError for others."""
    numbers = finite(values, count, where)
    if numbers[0] > numbers[1]:
        raise InputError(
            f"the limits are reversed: {numbers[0]:g} > {numbers[1]:g}", where=where, hint="write the lower limit first"
        )
    return numbers


def box_of(mechanism: Mechanism, ranges: Mapping[str, Sequence[float]]) -> Array:
    """Joint limits (nd, 2) with other ranges where given; raises InputError for a slide without limits."""
    box = mechanism.box
    for joint, limits in ranges.items():
        where = f"sweep.ranges.{joint}"
        box[driven_index(mechanism, joint, where)] = interval(limits, 2, where)
    unlimited = [name for name, row in zip(mechanism.driven, box, strict=True) if np.isnan(row).any()]
    if unlimited:
        raise InputError(
            f"slide {unlimited[0]!r} has no limits",
            where="sweep",
            hint=f"give its range: ranges: {{{unlimited[0]}: [0, 0.5]}}",
        )
    return box


def ticks_of(mechanism: Mechanism, axes: Mapping[str, Sequence[Joint]], rule: Any) -> tuple[list[Any], Array]:
    """Ticks and weights of every joint by a rule, held joints at the reference, and the box (nd, 2) they span."""
    if not axes:
        raise InputError("the sweep names no joint", where="sweep", hint=f"joints: {', '.join(mechanism.driven)}")
    start = held(mechanism)
    ticks: list[Any] = [(np.array([value]), np.ones(1)) for value in start]
    box = np.stack([start, start], axis=1)
    for joint, values in axes.items():
        where = f"sweep, joint {joint}"
        index = driven_index(mechanism, joint, where)
        low, high, count = interval(values, 3, where)
        if count < 1 or count != int(count) or count > MAX_POSES:
            raise InputError(f"{count:g} is not a number of points", where=where, hint="write [low, high, points]")
        if math.prod(len(tick[0]) for tick in ticks) * count > MAX_POSES:
            raise InputError(f"the grid has more than {MAX_POSES} poses", where=where, hint="use fewer points or sobol")
        ticks[index] = rule(low, high, int(count))
        box[index] = low, high
    return ticks, box


def tensor(ticks: list[Any]) -> tuple[Array, Array]:
    """Poses (N, nd) and weights (N,) of the product of ticks."""
    mesh = np.meshgrid(*[tick[0] for tick in ticks], indexing="ij")
    weights = np.meshgrid(*[tick[1] for tick in ticks], indexing="ij")
    poses = np.stack([axis.ravel() for axis in mesh], axis=1)
    return poses, np.prod([axis.ravel() for axis in weights], axis=0)
