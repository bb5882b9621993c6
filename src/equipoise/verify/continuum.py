"""Upper bounds of the holding effort between the samples, over the whole box of a sweep and all its payloads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.assemble import Balancer
from equipoise.design import Row
from equipoise.errors import LoopError
from equipoise.mechanism import Mechanism
from equipoise.sweep import Sweep
from equipoise.verify.boxes import Found, search
from equipoise.verify.enclosure import Enclosure
from equipoise.verify.estimate import estimate
from equipoise.verify.field import Field
from equipoise.verify.verification import Bound

RELATIVE = 0.01
OF_LOAD = 1e-3
BUDGET = 60_000
WIDEST = 8
MEMORY = 4_000_000
WORK = 100_000_000

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
    field = Field(mechanism, balancers, values, sweep, _one_turn(mechanism, sweep.box))
    result, left = {}, list(mechanism.driven)
    for index, joint in enumerate(mechanism.driven if _open(mechanism) else ()):
        at = field.coordinates(index)
        enclosure = field.enclosure(index, at) if len(at.joints) <= WIDEST else None
        if enclosure is not None:
            left.remove(joint)
            found = _searched(enclosure, at.box, rows[joint].peak, OF_LOAD * field.loads[index], budget)
            result[joint] = _bound(rows[joint], found, _method(enclosure, found), True)
    result |= _estimates(field, rows, budget, left)
    return {joint: result[joint] for joint in mechanism.driven}


def _searched(enclosure: Enclosure, box: Array, peak: float, absolute: float, budget: int) -> Found:
    most = min(budget, WORK // enclosure.size)
    found = search(enclosure, box, peak, RELATIVE, absolute, most, max(16, MEMORY // enclosure.size))
    return replace(found, upper=found.upper + enclosure.slack)


def _method(enclosure: Enclosure, found: Found) -> str:
    if not np.isfinite(found.upper):
        return "no bound: a spring with preload or free length may shrink to nothing"
    return METHOD + (SPRINGS if len(enclosure.intercepts) else "")


def _estimates(field: Field, rows: Mapping[str, Row], budget: int, joints: list[str]) -> dict[str, Bound]:
    if not joints:
        return {}
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
