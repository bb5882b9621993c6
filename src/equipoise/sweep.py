"""The weighted poses and payloads that matter: grid, Sobol sample, quadrature, or a file of poses."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from equipoise import workspace
from equipoise.affine import Array, Indices
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism, Point
from equipoise.motion.drivers import Driver
from equipoise.motion.motion import Motion, of_drivers, read_motion
from equipoise.motion.moves import Free, Moves, Timed, take
from equipoise.posefile import held, read_columns
from equipoise.ranges import (
    MAX_POSES,
    anchors,
    box_of,
    crossed,
    driven_index,
    few_enough,
    interval,
    points_each_way,
    pose_vector,
    tensor,
    ticks_of,
)
from equipoise.seeding import generator
from equipoise.units import Joint, Length, Mass, Number, Time

INSTANTS = 721
FINER = 2
"""Gauss points per axis that the finer rule has more."""
PROBE = 12
"""How many random poses must be in reach before more are tried."""


@dataclass(frozen=True)
class Payload:
    """A known point mass carried at `at` (m, link frame) of `body`; several masses are scenarios.

    mass in kg, one number or several; masses given for the same point are alternatives, masses at
    different points are combined.
    """

    body: str
    mass: Mass | tuple[Mass, ...]
    at: tuple[Length, Length, Length] = (0.0, 0.0, 0.0)

    @property
    def point(self) -> Point:
        """Where the payload sits."""
        return Point(self.body, self.at)

    @property
    def masses(self) -> tuple[float, ...]:
        """All scenarios of this payload, kg."""
        return tuple(self.mass) if isinstance(self.mass, tuple | list) else (self.mass,)


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
    scenarios: Array = None  # type: ignore[assignment]
    moves: Moves | None = None
    finer: Callable[[], Sweep] | None = None
    outline: tuple[tuple[int, int], Array] | None = None
    beside: Motion | None = None

    def __post_init__(self) -> None:
        if self.scenarios is None:
            object.__setattr__(self, "scenarios", np.zeros((1, 0)))
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
        return _with_payload(mechanism, Sweep(poses, np.ones(n), label, box, sampled=True), payload)

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
        return _with_payload(mechanism, Sweep(poses, weight, f"{len(poses)} poses (grid {counts})", box), payload)

    @staticmethod
    def quadrature(
        mechanism: Mechanism,
        axes: Mapping[str, Sequence[Joint]],
        *,
        payload: Sequence[Payload] = (),
    ) -> Sweep:
        """Gauss-Legendre points of {joint: (low, high, points)}; the weights sum to the measure of the box."""

        def gauss(lo: float, hi: float, n: int) -> tuple[Array, Array]:
            x, w = np.polynomial.legendre.leggauss(n)
            return (lo + hi) / 2 + x * (hi - lo) / 2, w * (hi - lo) / 2

        def finer() -> Sweep:
            more = {joint: (low, high, int(count) + FINER) for joint, (low, high, count) in axes.items()}
            return Sweep.quadrature(mechanism, more, payload=payload)

        ticks, box = ticks_of(mechanism, axes, gauss)
        poses, weight = tensor(ticks)
        label = f"{len(poses)} Gauss-Legendre points"
        return _with_payload(mechanism, Sweep(poses, weight, label, box, finer=finer), payload)

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
        vertices = np.array([interval(corner, 2, "sweep.polygon", ordered=False) for corner in corners])
        rule = workspace.polygon_rule(vertices, anchors(mechanism, names), points_each_way(points))
        edge = workspace.rim(vertices, points)
        label = f"polygon of {len(vertices)} corners over {' and '.join(names)}"

        def finer() -> Sweep:
            more = points + 4
            return Sweep.polygon(mechanism, corners, points=more, joints=joints, axes=axes, payload=payload)

        sweep = _region(
            mechanism, names, vertices, rule=rule, edge=edge, axes=axes or {}, payload=payload, label=label, finer=finer
        )
        first, second = (mechanism.driven.index(name) for name in names)
        return replace(sweep, outline=((first, second), vertices))

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
        rule = workspace.box_rule(pairs[:, 0], pairs[:, 1], points_each_way(points))
        corners = np.array(list(itertools.product(*pairs)))

        def finer() -> Sweep:
            return Sweep.region(mechanism, ranges, points=points + 2, axes=axes, payload=payload)

        sweep = _region(
            mechanism,
            names,
            corners,
            rule=rule,
            edge=corners,
            axes=axes or {},
            payload=payload,
            label=f"box over {', '.join(names)}",
            finer=finer,
        )
        box = sweep.poses.min(0), sweep.poses.max(0)
        return replace(sweep, box=np.stack(box, axis=1))

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
        return _with_payload(mechanism, Sweep(table, weights, label), payload)

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
        return _with_payload(mechanism, sweep, payload)

    @staticmethod
    def reactionless(
        mechanism: Mechanism,
        path: Mapping[str, Driver | Any],
        *,
        duration: Time,
        start: Mapping[str, Joint] | None = None,
        samples: int = INSTANTS,
    ) -> Sweep:
        """The motion of a force-balanced mechanism along a path that leaves no moment at the base.

        path {joint: driver} prescribes as many joints, driven or not (`platform_x`), as zero angular momentum leaves;
        what is left open, such as the platform's orientation, follows: see `reactionless_motion`. It begins at the
        reference, or at `start` {driven joint: position}.
        """
        from equipoise.verbs.reactionless import reactionless_motion

        return reactionless_motion(mechanism, path, duration=duration, start=start).sweep(samples)

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
        from equipoise.loops import reachable

        if n < 1:
            raise InputError(f"{n} states are no sample", where="sweep.any_motion")
        few_enough(n * max(1, len(payload)))
        box, rng = box_of(mechanism, ranges or {}), generator(seed)
        centre, kept = held(mechanism), np.zeros((0, len(box)))
        for shrink in (1.0, 0.4, 0.15, 0.05, 0.02):
            near = centre + shrink * (box - centre[:, None]).T
            poses = near[0] + rng.random((2 * n, len(box))) * (near[1] - near[0])
            some = poses[:PROBE][reachable(mechanism, poses[:PROBE])]
            reached = poses[reachable(mechanism, poses)] if len(some) == len(poses[:PROBE]) else some
            if len(reached) == len(poses):  # a room without walls: its poses also reach each other
                kept = reached
                break
            kept = np.vstack([kept, reached])
        if len(kept) < n:
            raise InputError(
                f"only {len(kept)} of {n} random poses can be reached by the loops",
                where="sweep.any_motion",
                hint="narrow the `ranges` of the driven joints",
            )
        kept = kept[-n:]
        unit = np.repeat([[-1.0, 1.0]], 2 * len(box), axis=0)
        rates = rng.uniform(-1.0, 1.0, (n, 2 * len(box)))
        free = Free(np.hstack([kept, rates]), np.vstack([np.stack([kept.min(0), kept.max(0)], 1), unit]))
        sweep = Sweep(kept, np.ones(n), f"{n} random states (seed {seed})", moves=free)
        return _with_payload(mechanism, sweep, payload)

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


def _region(
    mechanism: Mechanism,
    names: Sequence[str],
    corners: Array,
    *,
    rule: tuple[Array, Array],
    edge: Array,
    axes: Mapping[str, Sequence[Joint]],
    payload: Sequence[Payload],
    label: str,
    finer: Callable[[], Sweep],
) -> Sweep:
    """The product of a rule over some joints and Gauss points of others; edge poses weigh nothing."""
    indices = [driven_index(mechanism, name, "sweep") for name in names]
    limits = mechanism.box[indices]
    for corner in corners:
        for name, value, (low, high) in zip(names, corner, limits, strict=True):
            if value < low - 1e-9 or value > high + 1e-9:
                raise InputError(
                    f"the workspace reaches {name} = {value:g}, the platform only {low:g} to {high:g}",
                    where="sweep",
                    hint="keep it within the anchors, or widen the platform's `limits`",
                )
    if set(names) & set(axes):
        raise InputError("a joint is in the region and in the axes", where="sweep.axes", hint="name it once")
    start = held(mechanism)
    others, weight = start[None], np.ones(1)
    ends = start[None]
    if axes:
        inner = Sweep.quadrature(mechanism, axes)
        others, weight = inner.poses, inner.weight
        assert inner.box is not None
        ends = np.array(list(itertools.product(*inner.box)))
    points, w = rule
    poses = np.concatenate([crossed(points, others, indices), crossed(edge, np.unique(ends, axis=0), indices)])
    weights = np.concatenate([np.outer(w, weight).ravel(), np.zeros(len(poses) - len(w) * len(weight))])
    what = f"{len(w) * len(weight)} Gauss points of a {label}"
    return _with_payload(mechanism, Sweep(poses, weights, what, finer=finer), payload)


def _with_payload(mechanism: Mechanism, sweep: Sweep, payload: Sequence[Payload]) -> Sweep:
    points: dict[tuple[str, tuple[float, ...]], list[float]] = {}
    for item in payload:
        mechanism.body_id(item.body)
        for mass in item.masses:
            if not (math.isfinite(mass) and mass >= 0):
                raise InputError(f"a payload of {mass:g} kg is not a mass", where=f"payload at {item.body}")
            points.setdefault((item.body, tuple(item.at)), []).append(float(mass))
    if not points:
        return sweep
    places = tuple(Payload(body, 0.0, at) for body, at in points)  # type: ignore[arg-type]
    return replace(sweep, payloads=places, scenarios=np.array(list(itertools.product(*points.values()))))
