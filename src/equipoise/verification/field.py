"""The efforts of a design over a box, and how few numbers each of them depends on."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.assemble import Balancer, effort
from equipoise.balancers.paths import Line
from equipoise.balancers.paths.path import Place
from equipoise.balancers.spring import Spring
from equipoise.errors import EquipoiseError
from equipoise.mechanism import Mechanism, Point
from equipoise.states import States
from equipoise.sweep import Sweep
from equipoise.verification.enclosure import Enclosure
from equipoise.verification.waves import Axes

PROBES = 24
FEW = 6
WIDTH = 1_000_000
NEGLIGIBLE = 1e-12


@dataclass(frozen=True, eq=False)
class Coordinates:
    """y = middle + lead (q - mid): the n numbers that an effort depends on, hinges or slides, within box (n, 2).

    joints (n,) are the joints that y are moved by while the others stay in the middle of their range.
    """

    joints: NDArray[np.int_]
    lead: Array
    box: Array


class Field:
    """Holding efforts over a sweep's box in its extreme payloads: |r| is convex in the masses.

    loads (nd,) are the largest efforts without balancers and scale that of all terms, at random positions.
    """

    def __init__(
        self, mechanism: Mechanism, balancers: Sequence[Balancer], values: Mapping[str, float], sweep: Sweep
    ) -> None:
        box = np.array(sweep.box)
        self.mechanism, self.balancers, self.values, self.box = mechanism, balancers, values, box
        self.sweep = _extremes(sweep)
        self.middle = box.mean(axis=1)
        self.probes = box[:, 0] + np.random.default_rng(0).random((PROBES, len(box))) * np.ptp(box, axis=1)
        states = self._at_probes
        springs = [balancer for balancer in balancers if isinstance(balancer, Spring)]
        self._runs = {spring.name: spring.path.run(states) for spring in springs}
        self._lines = {spring.name: spring.law.line(spring.own(values)) for spring in springs}
        self._copied = (np.abs(states.D) > 0).any(axis=0).sum(axis=0) > 1
        bare, total = states.holding, self._total(states)
        self.loads = np.abs(bare).max(axis=0)
        self.scale = float(np.maximum(np.abs(bare), np.abs(total - bare)).max())
        self.springs = [spring for spring in springs if self._intercept(spring) != 0.0 or _riding(spring)]

    @property
    def straight(self) -> bool:
        """Whether all springs follow one straight distance each, with forces affine in it."""
        return None not in (*self._lines.values(), *self._runs.values())

    def residual(self, q: Array) -> Array:
        """Efforts (S, N, nd) with the balancers at positions (N, nd)."""
        bodies = self.mechanism.model.nbody
        most = max(1, WIDTH // (bodies * len(self.sweep.scenarios)))
        parts = [q[start : start + most] for start in range(0, len(q), most)]
        return np.concatenate([self._total(self._states(part)).reshape(-1, *part.shape) for part in parts], axis=1)

    def coordinates(self, row: int) -> Coordinates:
        """What the effort of a joint depends on: joints that do not matter are left out, sums of angles count once.

        Parallel hinges often move an effort by the sum of their angles only.
        """
        model, ids = self.mechanism.model, self.mechanism.driven_ids
        hinge = model.jnt_type[ids] == mujoco.mjtJoint.mjJNT_HINGE
        # Hinges whose effort does not repeat every turn: a spring is wound there, or other joints copy the angle.
        apart = ~hinge | ~self._repeats[row] | self._copied
        kept: list[int] = []
        lead = np.zeros((len(ids), len(ids)))
        for joint in np.flatnonzero(self._dependence[row]):
            twin = [(other, sign) for other, sign in itertools.product(kept, (1, -1))
                    if not apart[[joint, other]].any() and self._twins[row, other, joint, (1 - sign) // 2]]  # fmt: skip
            target, sign = twin[0] if twin else (joint, 1)
            lead[target, joint] = sign
            kept += [] if twin else [int(joint)]
        lead = lead[kept]
        reach = np.abs(lead) @ np.ptp(self.box, axis=1) / 2
        reach = np.where(~apart[kept], np.minimum(reach, np.pi), reach)
        box = self.middle[kept, None] + reach[:, None] * np.array([-1.0, 1.0])
        return Coordinates(np.array(kept, dtype=int), lead, box)

    @property
    def everything(self) -> Coordinates:
        """All joints as they are."""
        count = len(self.box)
        return Coordinates(np.arange(count), np.eye(count), self.box)

    def positions(self, places: Array, at: Coordinates) -> Array:
        """Positions (N, nd) of coordinates (N, n), the other joints in the middle of their range."""
        q = np.tile(self.middle, (len(places), 1))
        q[:, at.joints] = places
        return q

    def enclosure(self, row: int, at: Coordinates) -> Enclosure | None:
        """The effort of one joint as waves of its coordinates; None where it proves to be no such thing."""
        model, ids = self.mechanism.model, self.mechanism.driven_ids
        axes = Axes(model.jnt_type[ids[at.joints]] == mujoco.mjtJoint.mjJNT_HINGE, at.box)
        nodes = self.positions(axes.nodes(), at)
        stiffness = float(model.jnt_stiffness[ids[row]])
        rest = float(model.qpos_spring[model.jnt_qposadr[ids[row]]])
        springs = [spring for spring in self.springs if self._matters(spring, row)]
        enclosure = Enclosure(
            axes=axes,
            waves=axes.fit(self._waves(nodes, row, springs, stiffness, rest)),
            scenarios=len(self.sweep.scenarios),
            intercepts=np.array([self._intercept(spring) for spring in springs]),
            riders=tuple(number for number, spring in enumerate(springs) if _riding(spring)),
            spring=(stiffness, rest, int(np.flatnonzero(at.joints == row)[0]) if stiffness else -1),
        )
        reduced = self.middle[at.joints] + (self.probes - self.middle) @ at.lead.T
        values = self._waves(self.probes, row, springs, stiffness, rest)
        return enclosure.confirmed(values, reduced, NEGLIGIBLE * self.scale)

    def _waves(self, q: Array, row: int, springs: Sequence[Spring], stiffness: float, rest: float) -> Array:
        """P per payload, s and ds/dq_row of every spring with an intercept, then V and W of those that ride: (F, N)."""
        states = self._states(q)
        smooth = self._total(states).reshape(-1, *q.shape)[..., row] - stiffness * (q[:, row] - rest)
        shared, riders = [], []
        for spring in springs:
            length, rate = self._distance(spring, states)
            length, rate = length[: len(q)], rate[: len(q), row]
            smooth = smooth - self._intercept(spring) * rate
            shared += [length * length, 2 * length * rate]
            if _riding(spring):
                across, along = (wave[: len(q)] for wave in self._rider(spring, states, row))
                smooth = smooth - across * length - along * rate
                riders += [across, along]
        return np.concatenate([smooth, np.array(shared + riders).reshape(-1, len(q))])

    def _matters(self, spring: Spring, row: int) -> bool:
        length, rate = self._distance(spring, self._at_probes)
        pull = self._intercept(spring) * rate[:, row]
        if _riding(spring):
            across, along = self._rider(spring, self._at_probes, row)
            pull = np.abs(pull) + np.abs(across * length) + np.abs(along * rate[:, row])
        return bool(np.abs(pull).max() > NEGLIGIBLE * self.scale)

    def _intercept(self, spring: Spring) -> float:
        """The pull along the spring's distance, N, where that is zero."""
        line, run = self._lines[spring.name], self._runs[spring.name]
        return 0.0 if line is None or run is None else run.ratio * (line[0] + line[1] * run.offset)

    def _rider(self, spring: Spring, states: States, row: int) -> tuple[Array, Array]:
        """V and W (N,) of the weight d V + W dd/dq that parts at l = ratio d + offset along a body's own line add.

        The energy of such a part is affine in l: its slope and the slope's own derivative follow from two offsets.
        """
        run, path = self._runs[spring.name], spring.path
        assert run is not None
        there = replace(spring, path=replace(path, offset=path.offset + 1.0))  # type: ignore[call-arg, attr-defined]
        across, along = 0.0, 0.0
        for one, sign in ((there, 1.0), (spring, -1.0)):
            for place, mass in _riding(one):
                across = across + sign * states.weight_effort(place, mass)[:, row]
                along = along + sign * states.weight_energy(place, mass)
        return run.ratio * np.asarray(across), run.ratio * np.asarray(along)

    @cached_property
    def _at_probes(self) -> States:
        return self._states(self.probes)

    def _distance(self, spring: Spring, states: States) -> tuple[Array, Array]:
        run = self._runs[spring.name]
        assert run is not None
        return Line(run.a, run.b).deform(states)

    @cached_property
    def _dependence(self) -> NDArray[np.bool_]:
        """Which joint's position changes which joint's effort (row, joint), seen at random positions."""
        probes = self.probes[:FEW]
        joints = np.arange(len(self.box))
        moved = np.repeat(probes[None], len(joints), axis=0)
        moved[joints, :, joints] = np.roll(probes, 1, axis=0).T
        change = self._changes(moved)
        return (change > NEGLIGIBLE * self.scale).T

    @cached_property
    def _repeats(self) -> NDArray[np.bool_]:
        """Whether a whole turn of a joint leaves an effort (row, joint), seen at random positions."""
        same = np.zeros((len(self.box), len(self.box)), dtype=bool)
        for joint in range(len(self.box)):
            turned = self.probes[None, :FEW].copy()
            turned[0, :, joint] += 2 * np.pi
            try:
                same[:, joint] = self._changes(turned)[0] <= NEGLIGIBLE * self.scale
            except EquipoiseError:
                # What does not hold a turn further on is no function of the turned angle alone.
                continue
        return same

    @cached_property
    def _twins(self) -> NDArray[np.bool_]:
        """Whether turning two joints by opposite (0) or equal (1) angles leaves an effort (row, joint, joint, 2)."""
        joints = len(self.box)
        table = np.zeros((joints, joints, joints, 2), dtype=bool)
        together = self._dependence.T.astype(int) @ self._dependence > 0
        pairs = [pair for pair in itertools.combinations(range(joints), 2) if together[pair]]
        turn = np.random.default_rng(2).uniform(0.3, 1.0, FEW)
        for side, sign in enumerate((-1.0, 1.0)):
            moved = np.repeat(self.probes[None, :FEW], len(pairs), axis=0)
            for number, (first, second) in enumerate(pairs):
                moved[number, :, first] += turn
                moved[number, :, second] += sign * turn
            same = self._changes(moved) <= NEGLIGIBLE * self.scale
            for (first, second), rows in zip(pairs, same, strict=True):
                table[:, first, second, side] = table[:, second, first, side] = rows
        return table

    def _changes(self, moved: Array) -> Array:
        """Largest change (K, nd) of the efforts from the first probes to their moved copies (K, FEW, nd)."""
        here = self.residual(self.probes[:FEW])[:, None]
        there = self.residual(moved.reshape(-1, len(self.box))).reshape(len(here), *moved.shape)
        return np.abs(there - here).max(axis=(0, 2), initial=0.0)

    def _total(self, states: States) -> Array:
        total = effort(self.mechanism, self.balancers, states)
        return total.at(np.array([self.values[unknown.name] for unknown in total.unknowns]))

    def _states(self, q: Array) -> States:
        return self.mechanism.states(self.sweep.at_poses(q))


def _riding(spring: Spring) -> list[tuple[Place, Any]]:
    """The spring's parts that move within a body, as the end of a coil behind a cable does, with their masses."""
    return [(place, mass) for place, mass in spring.masses if not isinstance(place, Point)]


def _extremes(sweep: Sweep) -> Sweep:
    """The least and the largest mass of every payload."""
    low, high = sweep.scenarios.min(axis=0), sweep.scenarios.max(axis=0)
    corners = [dict.fromkeys(pair) for pair in zip(low.tolist(), high.tolist(), strict=True)]
    return replace(sweep, scenarios=np.array(list(itertools.product(*corners))))
