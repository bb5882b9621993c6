"""Upper bounds of the holding effort between the samples, over the whole box of a sweep and all its payloads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import mujoco
import numpy as np

from equipoise.assemble import Balancer
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.row import Row
from equipoise.sweep import Sweep
from equipoise.verification.boxes import Found, search
from equipoise.verification.estimate import estimate
from equipoise.verification.field import Coordinates, Field
from equipoise.verification.findings import Bound

RELATIVE = 0.002
OF_LOAD = 1e-4
BUDGET = 60_000
WIDEST = 8
MEMORY = 4_000_000
WORK = 300_000_000
LEAST = 6_000_000

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
    met by less than 0.2 % or 0.01 % of the joint's load, or `budget` cells of that joint are used; it is valid
    either way, up to rounding. A spring behind a cable through eyes follows one distance as well; the weight of its end
    adds products of waves with s_m^(1/2). Mechanisms with closed loops or tendon springs of their own, springs that are
    bent or follow more than one distance, and efforts that are no such waves (joints that copy others) get an estimate,
    efforts that depend on more than eight joints no bound; both say so. A sweep without a box has no bounds.
    """
    if sweep.box is None:
        return {}
    joints = mechanism.driven
    try:
        field = Field(mechanism, balancers, values, sweep)
        return {joint: _row(field, index, rows[joint], budget) for index, joint in enumerate(joints)}
    except InputError as error:
        method = f"no bound: the loops or paths do not close everywhere in the box ({error.message})"
        none = {joint: Found(np.inf, rows[joint].peak, 0, False) for joint in joints}
        return {joint: _bound(rows[joint], none[joint], method, False) for joint in joints}


def _row(field: Field, index: int, row: Row, budget: int) -> Bound:
    """The bound of one joint, an estimate where its effort is no wave of the hinges of an open chain."""
    if not _open(field.mechanism):
        return _rough(field, index, row, field.everything, budget)
    at = field.coordinates(index)
    joints = len(at.joints)
    if joints > WIDEST:
        method = f"no bound: the effort depends on {joints} joints, no more than {WIDEST} can be searched"
        return _bound(row, Found(np.inf, row.peak, 0, False), method, False)
    enclosure = field.enclosure(index, at) if field.straight else None
    if enclosure is None:
        return _rough(field, index, row, at, budget)
    work = max(LEAST, WORK // len(field.box))
    found = search(
        enclosure,
        at.box,
        row.peak,
        relative=RELATIVE,
        absolute=OF_LOAD * field.loads[index],
        budget=min(budget, work // enclosure.size),
        chunk=max(16, MEMORY // enclosure.size),
    )
    if not np.isfinite(found.upper):
        return _bound(row, found, "no bound: a spring with preload or free length may shrink to nothing", True)
    method = METHOD + (SPRINGS if len(enclosure.intercepts) else "")
    return _bound(row, replace(found, upper=found.upper + enclosure.slack), method, True)


def _rough(field: Field, index: int, row: Row, at: Coordinates, budget: int) -> Bound:
    found = estimate(
        lambda places: field.residual(field.positions(places, at))[..., index],
        at.box,
        row.peak,
        relative=RELATIVE,
        of_load=OF_LOAD,
        budget=budget,
    )
    return _bound(row, found, ESTIMATE, False)


def _bound(row: Row, found: Found, method: str, rigorous: bool) -> Bound:
    polished = max(row.peak, found.met)
    return Bound(row.sample_peak, polished, found.upper, row.unit, method, rigorous, found.cells, found.complete)


def _open(mechanism: Mechanism) -> bool:
    """Whether the mechanism is an open tree, but for joints that copy others, with linear springs at joints only."""
    model = mechanism.model
    active = model.eq_active0.astype(bool)
    copies = (model.eq_type == mujoco.mjtEq.mjEQ_JOINT) & ~model.eq_data[:, 2:5].any(axis=1)
    plain = not (model.jnt_stiffnesspoly.any() or model.jnt_springyield.any())
    tendons = model.tendon_stiffness.any() or model.tendon_stiffnesspoly.any()
    return bool(plain and not tendons and not (active & ~copies).any())
