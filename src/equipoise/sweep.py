"""The weighted poses and payloads that matter: grid, Sobol sample, quadrature, or a file of poses."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from equipoise import workspace
from equipoise.affine import Array, Indices
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.motion.drivers import Driver
from equipoise.motion.motion import Motion, of_drivers, read_motion
from equipoise.motion.moves import Moves, Timed, take
from equipoise.payload import Payload, scenarios_of
from equipoise.posefile import held, read_columns
from equipoise.ranges import (
    MAX_POSES,
    anchors,
    box_of,
    few_enough,
    finite,
    interval,
    points_each_way,
    pose_vector,
    tensor,
    ticks_of,
)
from equipoise.regions import Workspace, gauss_ticks
from equipoise.seeding import generator
from equipoise.units import Joint, Length, Number, Time

INSTANTS = 721
FINER = 2
"""Gauss points per axis that the finer rule has more."""


@dataclass(frozen=True, eq=False)
class Sweep:
    """Weighted poses of the driven joints, crossed with payload scenarios.

    poses (N, nd) rad or m; weight (N,) non-negative, a pose of weight 0 counts for peaks only; box (nd, 2)
    the region that the poses stand for, or None for a bare list; payloads K points and scenarios (S, K) kg;
    label says in words what was swept; sampled poses may be refined between the samples; finer makes the same
    region with a finer quadrature, whose difference is the error of this one; outline is the polygon
    (joint numbers, corners (V, 2)) that two joints stay in; moves gives the states velocities and accelerations
    (then poses are its rows), None leaves them at rest; beside is the motion from whose way the poses are reached,
    None where they are reached from the reference.
    """

    poses: Array
    weight: Array
    label: str
    box: Array | None = None
    sampled: bool = False
    payloads: tuple[Payload, ...] = ()
    scenarios: Array = field(default_factory=lambda: np.zeros((1, 0)))
    moves: Moves | None = None
    finer: Callable[[], Sweep] | None = None
    outline: tuple[tuple[int, int], Array] | None = None
    beside: Motion | None = None

    def __post_init__(self) -> None:
        if len(self.poses) == 0:
            raise InputError("the sweep has no poses", where="sweep", hint="give at least one pose")
        few_enough(len(self.poses) * len(self.scenarios))

    @staticmethod
    def sobol(
        mechanism: Mechanism,
        n: int = 2048,
        *,
        seed: int = 0,
        ranges: Mapping[str, Sequence[Joint]] | None = None,
        payload: Sequence[Payload] = (),
    ) -> Sweep:
        """n scrambled Sobol poses over the joint limits, or over `ranges` {joint: (low, high)} where given."""
        from scipy.stats import qmc

        if n < 1:
            raise InputError(f"a Sobol sweep needs at least one pose, got {n}", where="sweep.sobol")
        few_enough(n * max(1, len(payload)))
        box = box_of(mechanism, ranges or {})
        sampler = qmc.Sobol(len(mechanism.driven), scramble=True, rng=generator(seed))
        unit = sampler.random_base2(max(0, math.ceil(math.log2(n))))[:n]
        poses = box[:, 0] + unit * (box[:, 1] - box[:, 0])
        label = f"{n} poses (Sobol, seed {seed})"
        return Sweep(poses, np.ones(n), label, box, sampled=True)._carrying(mechanism, payload)

    @staticmethod
    def grid(
        mechanism: Mechanism,
        axes: Mapping[str, Sequence[Joint]],
        *,
        payload: Sequence[Payload] = (),
    ) -> Sweep:
        """The full grid of {joint: (low, high, points)}, ends included, equal weights; other joints are held."""
        ticks, box = ticks_of(mechanism, axes, lambda lo, hi, n: (np.linspace(lo, hi, n), np.ones(n)))
        poses, weight = tensor(ticks)
        counts = " x ".join(f"{name} {len(ticks[mechanism.driven.index(name)][0])}" for name in axes)
        return Sweep(poses, weight, f"{len(poses)} poses (grid {counts})", box)._carrying(mechanism, payload)

    @staticmethod
    def quadrature(
        mechanism: Mechanism,
        axes: Mapping[str, Sequence[Joint]],
        *,
        payload: Sequence[Payload] = (),
    ) -> Sweep:
        """Gauss-Legendre points of {joint: (low, high, points)}; the weights sum to the measure of the box."""

        def finer() -> Sweep:
            more = {joint: (low, high, int(count) + FINER) for joint, (low, high, count) in axes.items()}
            return Sweep.quadrature(mechanism, more, payload=payload)

        ticks, box = ticks_of(mechanism, axes, gauss_ticks)
        poses, weight = tensor(ticks)
        label = f"{len(poses)} Gauss-Legendre points"
        return Sweep(poses, weight, label, box, finer=finer)._carrying(mechanism, payload)

    @staticmethod
    def polygon(
        mechanism: Mechanism,
        corners: Sequence[tuple[Length, Length]],
        *,
        points: int = 12,
        joints: tuple[str, str] | None = None,
        axes: Mapping[str, Sequence[Joint]] | None = None,
        payload: Sequence[Payload] = (),
    ) -> Sweep:
        """A polygon (corners in order, m) of two slides, by Gauss points collapsed onto corners and anchors.

        joints default to the first two driven ones; axes {joint: (low, high, points)} are Gauss-Legendre points
        of further joints. Weights sum to the area times the measure of the axes; poses on the edges and close to
        the corners have weight 0 and count for peaks. Raises InputError for a polygon that crosses itself, has no
        area, or leaves the joints' limits.
        """
        names = mechanism.driven[:2] if joints is None else joints
        vertices = np.array([finite(corner, 2, "sweep.polygon") for corner in corners])
        rule = workspace.polygon_rule(vertices, anchors(mechanism, names), points_each_way(points))
        space = Workspace(tuple(names), vertices, rule, workspace.rim(vertices, points))
        poses, weight = space.poses(mechanism, axes or {})

        def finer() -> Sweep:
            more = points + 4
            return Sweep.polygon(mechanism, corners, points=more, joints=joints, axes=axes, payload=payload)

        what = f"polygon of {len(vertices)} corners over {' and '.join(names)}"
        label = f"{np.count_nonzero(weight)} Gauss points of a {what}"
        first, second = (mechanism.driven.index(name) for name in names)
        sweep = Sweep(poses, weight, label, finer=finer, outline=((first, second), vertices))
        return sweep._carrying(mechanism, payload)

    @staticmethod
    def triangle(
        mechanism: Mechanism,
        corners: tuple[tuple[Length, Length], tuple[Length, Length], tuple[Length, Length]],
        *,
        points: int = 12,
        joints: tuple[str, str] | None = None,
        axes: Mapping[str, Sequence[Joint]] | None = None,
        payload: Sequence[Payload] = (),
    ) -> Sweep:
        """A triangle of two slides: the polygon of three corners, 6 points^2 poses."""
        return Sweep.polygon(mechanism, corners, points=points, joints=joints, axes=axes, payload=payload)

    @staticmethod
    def region(
        mechanism: Mechanism,
        ranges: Mapping[str, tuple[Joint, Joint]],
        *,
        points: int = 8,
        axes: Mapping[str, Sequence[Joint]] | None = None,
        payload: Sequence[Payload] = (),
    ) -> Sweep:
        """A box {joint: (low, high)} by Gauss points collapsed onto its corners, where anchors may be.

        d 2^d points^d poses for d joints; axes {joint: (low, high, points)} are plain Gauss-Legendre points of
        further joints. Weights sum to the measure. Raises InputError for ranges beyond the joints' limits.
        """
        names = tuple(ranges)
        pairs = np.array([interval(pair, 2, f"sweep.box.{name}") for name, pair in ranges.items()]).reshape(-1, 2)
        if not 1 <= len(names) <= 3 or (pairs[:, 0] >= pairs[:, 1]).any():
            raise InputError(
                "a box needs one to three joints with low < high", where="sweep.box", hint="use quadrature"
            )
        corners = np.array(list(itertools.product(*pairs)))
        rule = workspace.box_rule(pairs[:, 0], pairs[:, 1], points_each_way(points))
        poses, weight = Workspace(names, corners, rule, corners).poses(mechanism, axes or {})

        def finer() -> Sweep:
            return Sweep.region(mechanism, ranges, points=points + 2, axes=axes, payload=payload)

        label = f"{np.count_nonzero(weight)} Gauss points of a box over {', '.join(names)}"
        box = np.stack([poses.min(axis=0), poses.max(axis=0)], axis=1)
        return Sweep(poses, weight, label, box, finer=finer)._carrying(mechanism, payload)

    @staticmethod
    def of_poses(
        mechanism: Mechanism,
        poses: Sequence[Mapping[str, Joint]] | str | Path,
        *,
        weight: Sequence[Number] | None = None,
        payload: Sequence[Payload] = (),
    ) -> Sweep:
        """A list of poses {joint: value} (joints left out are held) or a CSV file with a column per joint.

        A CSV column is headed `joint` (rad or m) or `joint [deg]`; a column `weight` weighs the poses; columns
        headed `before ...`, `after ...` and `payload ...`, as reports write them, are results and left out.
        """
        if isinstance(poses, str | Path):
            columns = read_columns(mechanism, Path(poses), {"weight": ""})
            weights = columns.get("weight", np.ones(len(next(iter(columns.values()), ()))))
            table = np.tile(held(mechanism), (len(weights), 1))
            for index, joint in enumerate(mechanism.driven):
                table[:, index] = columns.get(joint, table[:, index])
            label = f"{len(table)} poses ({Path(poses).name})"
        else:
            table = np.array([pose_vector(mechanism, pose) for pose in poses]).reshape(-1, len(mechanism.driven))
            weights = np.ones(len(table)) if weight is None else np.asarray(weight, dtype=float)
            label = f"{len(table)} poses (list)"
        if len(weights) != len(table) or (weights < 0).any() or (len(table) and not weights.sum() > 0):
            raise InputError("pose weights must be non-negative, one per pose, and not all zero", where="sweep.poses")
        return Sweep(table, weights, label)._carrying(mechanism, payload)

    def holds(self, poses: Array) -> NDArray[np.bool_]:
        """Which poses (M, nd) lie in the region: the sweep's outline and the box of its poses, rims included."""
        low, high = self.poses.min(axis=0), self.poses.max(axis=0)
        slack = 1e-9 * np.maximum(1.0, high - low)
        if self.outline is None:
            return ((poses >= low - slack) & (poses <= high + slack)).all(axis=1)
        joints, corners = self.outline
        others = [index for index in range(poses.shape[1]) if index not in joints]
        fine = ((poses >= low - slack) & (poses <= high + slack))[:, others].all(axis=1)
        return fine & workspace.contains(corners, poses[:, list(joints)])

    @staticmethod
    def motion(
        mechanism: Mechanism,
        motion: Mapping[str, Driver | Any] | str | Path,
        *,
        duration: Time | None = None,
        start: Time = 0.0,
        samples: int | None = None,
        payload: Sequence[Payload] = (),
    ) -> Sweep:
        """Driven joints over time: {joint: driver}, or a CSV file with a column `time` and one per moving joint.

        A driver is text in t and T (the duration), a Cycloidal, Polynomial or Spline, or a number; joints left
        out stand still. The motion runs from `start` to `duration`, s, sampled at `samples` instants (default
        721), ends included; a file brings its own times and instants. Weights follow the trapezoid rule, so rms
        and mean are averages over time.
        """
        if isinstance(motion, str | Path):
            if duration is not None or start:
                raise InputError("a recorded motion brings its own times", where="sweep.motion", hint="leave them out")
            moving, times = read_motion(mechanism, Path(motion))
            label = Path(motion).name
        else:
            moving, times = of_drivers(mechanism, motion, duration, start), np.zeros(0)
            label = "motion"
        count = samples or (len(times) or INSTANTS)
        if not 2 <= count <= MAX_POSES:
            raise InputError(f"{count} instants are not a motion", where="sweep.motion", hint="samples: 721")
        timed = Timed(moving, times if samples is None and len(times) else np.linspace(moving.start, moving.end, count))
        label = f"{len(timed.time)} instants of {moving.end - moving.start:g} s ({label})"
        sweep = Sweep(timed.rows[0], timed.weight, label, sampled=True, moves=timed)
        return sweep._carrying(mechanism, payload)

    @staticmethod
    def reactionless(
        mechanism: Mechanism,
        path: Mapping[str, Driver | Any],
        *,
        duration: Time,
        start: Mapping[str, Joint] | None = None,
        samples: int = INSTANTS,
        balancers: Sequence[Any] = (),
    ) -> Sweep:
        """The motion of a force-balanced mechanism along a path that leaves no moment at the base.

        path {joint: driver} prescribes as many joints, driven or not (`platform_x`), as zero angular momentum leaves;
        what is left open, such as the platform's orientation, follows: see `reactionless_motion`. It begins at the
        reference, or at `start` {driven joint: position}. The masses of balancers count, and must be known; a problem
        file hands over its own.
        """
        from equipoise.verbs.reactionless import reactionless_motion

        found = reactionless_motion(mechanism, path, duration=duration, start=start, balancers=balancers)
        return found.sweep(samples)

    @staticmethod
    def any_motion(
        mechanism: Mechanism,
        n: int = 256,
        *,
        seed: int = 0,
        ranges: Mapping[str, Sequence[Joint]] | None = None,
        payload: Sequence[Payload] = (),
    ) -> Sweep:
        """n random states that the mechanism admits: poses in the joint limits (or `ranges`), moving in any way.

        What vanishes on them vanishes for all motions, as everything here is analytic in the pose. Velocities and
        accelerations are drawn from -1..1 (rad/s, rad/s^2 or m/s, m/s^2). Where loops do not reach all poses, these
        are drawn closer to the reference, until the loops do.
        """
        from equipoise.motion.anyhow import any_states

        if n < 1:
            raise InputError(f"{n} states are no sample", where="sweep.any_motion")
        few_enough(n * max(1, len(payload)))
        free = any_states(mechanism, box_of(mechanism, ranges or {}), n, generator(seed))
        sweep = Sweep(free.rows[0], np.ones(n), f"{n} random states (seed {seed})", moves=free)
        return sweep._carrying(mechanism, payload)

    @property
    def coordinates(self) -> Array:
        """What finds a state (N, c): its pose, or the instant of a motion."""
        return self.poses if self.moves is None else self.moves.coordinates

    @property
    def domain(self) -> Array | None:
        """Bounds (c, 2) that the coordinates stand for, or None for a bare list."""
        return self.box if self.moves is None else self.moves.region

    @property
    def instants(self) -> Timed | None:
        """The motion in time that is swept, or None."""
        return self.moves if isinstance(self.moves, Timed) else None

    def at(self, coordinates: Array) -> Sweep:
        """The same payload scenarios at other coordinates, equal weights."""
        if self.moves is None:
            return self.at_poses(coordinates)
        moves = self.moves.at(coordinates)
        return replace(self, poses=moves.rows[0], weight=np.ones(len(coordinates)), finer=None, moves=moves)

    def extended(self, coordinates: Array) -> Sweep:
        """The sweep with further states that count for peaks only."""
        weight = np.concatenate([self.weight, np.zeros(len(coordinates))])
        more = self.at(np.vstack([self.coordinates, coordinates]))
        return replace(more, weight=weight, box=self.box, finer=self.finer, outline=self.outline)

    def thinned(self, rows: Indices) -> Sweep:
        """Some of the states, each with a weight above zero."""
        moves = None if self.moves is None else take(self.moves, rows)
        return replace(self, poses=self.poses[rows], weight=np.maximum(self.weight[rows], 1e-300), moves=moves)

    def at_poses(self, poses: Array) -> Sweep:
        """The same payload scenarios at rest at other poses, equal weights."""
        beside = self.beside if self.instants is None else self.instants.motion
        there = replace(self, poses=poses, weight=np.ones(len(poses)), moves=None, beside=beside)
        return replace(there, box=None, finer=None, outline=None)

    def rows(self) -> tuple[Array, Array, Array]:
        """Driven positions (S N, nd), weights (S N,) and payload masses (S N, K), scenario by scenario."""
        count = len(self.scenarios)
        masses = np.repeat(self.scenarios, len(self.poses), axis=0)
        return np.tile(self.poses, (count, 1)), np.tile(self.weight, count), masses

    def describe(self) -> str:
        """One line: what was swept, with which payload."""
        if not self.payloads:
            return f"{self.label}, payload 0 kg"
        lists = [sorted(set(column)) for column in self.scenarios.T]
        carried = "; ".join(
            f"{' / '.join(f'{mass:g}' for mass in masses)} kg at {payload.body}"
            for payload, masses in zip(self.payloads, lists, strict=True)
        )
        return f"{self.label}, payload {carried}"

    def _carrying(self, mechanism: Mechanism, payload: Sequence[Payload]) -> Sweep:
        places, masses = scenarios_of(mechanism, payload)
        return replace(self, payloads=places, scenarios=masses)
