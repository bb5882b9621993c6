"""Upper bounds of the holding effort between the samples, over the whole box of a sweep and all its payloads."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.assemble import Balancer, effort
from equipoise.balancers.spring import Spring
from equipoise.design import Row
from equipoise.errors import LoopError
from equipoise.mechanism import Mechanism
from equipoise.states import States
from equipoise.sweep import Sweep
from equipoise.verify.boxes import Found, search
from equipoise.verify.enclosure import Enclosure
from equipoise.verify.estimate import estimate
from equipoise.verify.verification import Bound
from equipoise.verify.waves import Axes

RELATIVE = 0.01
OF_LOAD = 1e-3
BUDGET = 60_000
WIDEST = 8
MEMORY = 4_000_000
PROBES = 24
NEGLIGIBLE = 1e-12

METHOD = (
    "branch and bound; the effort is affine in (cos q, sin q) of every hinge, so its largest value over a cell is "
    "at the corners of triangles around the arcs"
)
SPRINGS = "; of springs with a free length the remainder of second order is bounded"
ESTIMATE = "estimated, not rigorous: local slopes, and second derivatives sampled and taken 1.5 times"


def bounds(
    mechanism: Mechanism,
    balancers: Sequence[Balancer],
    values: Mapping[str, float],
    sweep: Sweep,
    rows: Mapping[str, Row],
    *,
    budget: int = BUDGET,
) -> dict[str, Bound]:
    """An upper bound of |r_j| over the sweep's box and payloads, beside the values of `rows` {joint: Row}.

        r_j = P_j(q) + sum_m c_m ds_m/dq_j / (2 sqrt(s_m)),   f_m = c_m + k_m l,  s_m = l^2

    P_j (gravity, point masses, zero-free-length shares of all springs), s_m and ds_m/dq_j of an open chain are
    affine in (cos q, sin q) of each hinge and quadratic in each slide: three values per joint determine
    them, and triangles around the arcs enclose them. Cells are split until the bound exceeds the largest value
    met by less than 1 % or 0.1 % of the joint's load, or `budget` cells of that joint are used; it is valid
    either way, up to rounding. Closed loops, tendon springs of the file, and efforts that depend on more than
    eight joints get an estimate, which says so. A sweep without a box has no bounds.
    """
    if sweep.box is None:
        return {}
    field = _Field(mechanism, tuple(balancers), dict(values), _extremes(sweep), _one_turn(mechanism, sweep.box))
    if not _open(mechanism):
        return _estimates(field, rows, budget, list(mechanism.driven))
    result, left = {}, []
    dependence = field.dependence()
    for index, joint in enumerate(mechanism.driven):
        moving = np.flatnonzero(dependence[index])
        enclosure = None if len(moving) > WIDEST else field.enclosure(index, moving)
        if enclosure is None:
            left.append(joint)
        else:
            result[joint] = _bound(rows[joint], *_searched(field, enclosure, rows[joint], index, moving, budget))
    return result | (_estimates(field, rows, budget, left) if left else {})


def _searched(
    field: _Field, enclosure: Enclosure, row: Row, index: int, moving: NDArray[np.int_], budget: int
) -> tuple[Found, str, bool]:
    chunk = max(16, MEMORY // enclosure.size)
    absolute = OF_LOAD * field.loads[index]
    found = search(enclosure, field.box[moving], row.peak, RELATIVE, absolute, budget, chunk)
    if not np.isfinite(found.upper):
        return found, "no bound: a spring with preload or free length may shrink to nothing", True
    method = METHOD + (SPRINGS if enclosure.springs else "")
    return replace(found, upper=found.upper + enclosure.slack), method, True


def _estimates(field: _Field, rows: Mapping[str, Row], budget: int, joints: list[str]) -> dict[str, Bound]:
    result = {}
    columns = [field.mechanism.driven.index(joint) for joint in joints]
    try:
        found = estimate(field.residual, field.box, columns, [rows[j].peak for j in joints], RELATIVE, OF_LOAD, budget)
    except LoopError as error:
        found = [Found(np.inf, rows[joint].peak, 0, False) for joint in joints]
        method = f"no bound: the loops do not close everywhere in the box ({error.message})"
        return {joint: _bound(rows[joint], item, method, False) for joint, item in zip(joints, found, strict=True)}
    for joint, item in zip(joints, found, strict=True):
        result[joint] = _bound(rows[joint], item, ESTIMATE, False)
    return result


def _bound(row: Row, found: Found, method: str, rigorous: bool) -> Bound:
    polished = max(row.peak, found.met)
    return Bound(row.sample_peak, polished, found.upper, row.unit, method, rigorous, found.cells, found.complete)


@dataclass(eq=False)
class _Field:
    """The efforts of a design over a box: `residual(q)` (S, N, nd) in all extreme payloads."""

    mechanism: Mechanism
    balancers: tuple[Balancer, ...]
    values: dict[str, float]
    sweep: Sweep
    box: Array

    def __post_init__(self) -> None:
        rng = np.random.default_rng(0)
        self.probes = self.box[:, 0] + rng.random((PROBES, len(self.box))) * np.ptp(self.box, axis=1)
        bare, _ = self._efforts(self.probes)
        self.loads = np.abs(bare).max(axis=(0, 1))
        self.springs = [b for b in self.balancers if isinstance(b, Spring) and self._intercept(b) != 0.0]

    def residual(self, q: Array) -> Array:
        """Efforts (S, N, nd) with the balancers at positions (N, nd)."""
        return self._efforts(q)[1]

    def dependence(self) -> NDArray[np.bool_]:
        """Which joint's position changes which joint's effort (nd, nd), seen at random positions."""
        joints = len(self.box)
        probes = self.probes[:6]
        moved = np.repeat(probes[None], joints, axis=0)
        moved[np.arange(joints), :, np.arange(joints)] = np.roll(probes, 1, axis=0).T
        here = self.residual(probes)[:, None]
        there = self.residual(moved.reshape(-1, joints)).reshape(len(here), joints, len(probes), joints)
        change = np.abs(there - here).max(axis=(0, 2)).T
        return change > NEGLIGIBLE * max(float(np.abs(here).max()), float(self.loads.max()), 1e-300)

    def enclosure(self, row: int, moving: NDArray[np.int_]) -> Enclosure | None:
        """The effort of one joint as waves of the joints that move it; None where it proves to be no such thing."""
        model = self.mechanism.model
        slide = model.jnt_type[self.mechanism.driven_ids[moving]] == mujoco.mjtJoint.mjJNT_SLIDE
        axes = Axes(~slide, self.box[moving])
        nodes = np.tile(self.box.mean(axis=1), (3 ** len(moving), 1))
        nodes[:, moving] = axes.nodes()
        joint = int(self.mechanism.driven_ids[row])
        stiffness = float(model.jnt_stiffness[joint])
        rest = float(model.qpos_spring[model.jnt_qposadr[joint]])
        own = int(np.flatnonzero(moving == row)[0]) if row in moving else -1
        enclosure = Enclosure(
            axes=axes,
            waves=axes.fit(self._waves(nodes, row, stiffness, rest)),
            scenarios=len(self.sweep.scenarios),
            intercepts=np.array([self._intercept(spring) for spring in self.springs]),
            spring=(stiffness, rest, own),
        )
        return enclosure.confirmed(self._waves(self.probes, row, stiffness, rest), self.probes[:, moving])

    def _waves(self, q: Array, row: int, stiffness: float, rest: float) -> Array:
        """P per payload, then s and ds/dq_row of every spring with an intercept: (F, N)."""
        states, total = self._states(q), self._total(q)
        smooth = total.reshape(-1, *q.shape)[..., row] - stiffness * (q[:, row] - rest)
        shared = []
        for spring in self.springs:
            length, rate = spring.path.deform(states)
            length, rate = length[: len(q)], rate[: len(q), row]
            smooth = smooth - self._intercept(spring) * rate
            shared += [length * length, 2 * length * rate]
        return np.concatenate([smooth, np.array(shared).reshape(-1, len(q))])

    def _intercept(self, spring: Spring) -> float:
        """The force at length zero of the spring's line, N."""
        own = {u.name.removeprefix(f"{spring.owner}."): self.values[u.name] for u in spring.unknowns}
        return spring.law.affine_force(own)[0]

    def _efforts(self, q: Array) -> tuple[Array, Array]:
        states = self._states(q)
        shape = (len(self.sweep.scenarios), *q.shape)
        return states.holding.reshape(shape), self._total(q, states).reshape(shape)

    def _total(self, q: Array, states: States | None = None) -> Array:
        total = effort(self.mechanism, self.balancers, states or self._states(q))
        return total.at(np.array([self.values[unknown.name] for unknown in total.unknowns]))

    def _states(self, q: Array) -> States:
        return self.mechanism.states(self.sweep.at_poses(q))


def _open(mechanism: Mechanism) -> bool:
    """Whether the mechanism is an open tree whose own springs, if any, are linear ones at joints."""
    model = mechanism.model
    plain = not (model.jnt_stiffnesspoly.any() or model.jnt_springyield.any())
    return bool(plain and not model.eq_active0.any() and not model.tendon_stiffness.any()
                and not model.tendon_stiffnesspoly.any())  # fmt: skip


def _one_turn(mechanism: Mechanism, box: Array) -> Array:
    """The box with hinges cut to one turn, unless a spring at the joint remembers how often it turned."""
    model, joints = mechanism.model, mechanism.driven_ids
    turns = (model.jnt_type[joints] == mujoco.mjtJoint.mjJNT_HINGE) & (model.jnt_stiffness[joints] == 0)
    high = np.where(turns & _open(mechanism), np.minimum(box[:, 1], box[:, 0] + 2 * np.pi), box[:, 1])
    return np.stack([box[:, 0], high], axis=1)


def _extremes(sweep: Sweep) -> Sweep:
    """The least and the largest mass of every payload: |r| is convex in the masses."""
    low, high = sweep.scenarios.min(axis=0), sweep.scenarios.max(axis=0)
    corners = [dict.fromkeys(pair) for pair in zip(low.tolist(), high.tolist(), strict=True)]
    return replace(sweep, scenarios=np.array(list(itertools.product(*corners))).reshape(-1, len(low)))
