"""Effort against the derivative of energy, for every element of a design."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from equipoise.affine import Affine, Array
from equipoise.assemble import Balancer
from equipoise.design import Design
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.seeding import generator
from equipoise.states import States
from equipoise.verification.simulate import reach

STEP = 0.03
LEVELS = 4
RESOLVED = 1e-7


@dataclass(frozen=True, eq=False)
class Line:
    """States along random driven directions: centre and, level by level, both sides at +-h, h/2, h/4 ..."""

    centre: States
    ahead: tuple[States, ...]
    behind: tuple[States, ...]
    direction: Array
    step: float


def energy_errors(design: Design, poses: int = 64, seed: int = 0) -> dict[str, float]:
    """Largest relative difference of effort and energy derivative, per element and for the total.

        |u . tau - dV(q + h u)/dh| / max |u . tau|

    u are random directions of the driven joints; central differences, extrapolated to h = 0 (Richardson);
    loops are closed at every point. Elements are `gravity` (with payload and the file's own springs), every
    balancer by name, and `total`. An element without effort has error 0; poses whose difference quotients do
    not settle are left out. Raises InputError where no neighbourhood of the sweep's poses closes.
    """
    line = _line(design, poses, seed)
    errors: dict[str, float] = {}
    efforts, slopes, doubts = [], [], []
    for name, element in [("gravity", design.mechanism), *((b.name, b) for b in design.balancers)]:
        effort, slope, doubt = _element(element, line, design)
        errors[name] = _relative(effort, slope, doubt)
        efforts.append(effort)
        slopes.append(slope)
        doubts.append(doubt)
    # The total may vanish by design, so it is judged against what was added up.
    scale = max(float(np.abs(effort).max()) for effort in efforts)
    errors["total"] = _relative(np.sum(efforts, axis=0), np.sum(slopes, axis=0), np.sum(doubts, axis=0), scale)
    return errors


def _line(design: Design, poses: int, seed: int) -> Line:
    sweep = design.sweep
    rng = generator(seed)
    # Poses without weight lie next to anchors, where a cable's direction jumps.
    known = sweep.poses[sweep.weight > 0]
    centre = known[rng.integers(len(known), size=poses)]
    if sweep.box is not None:
        centre = sweep.box[:, 0] + rng.random((poses, len(sweep.box))) * (sweep.box[:, 1] - sweep.box[:, 0])
    direction = rng.standard_normal(centre.shape)
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    if sweep.instants is not None:
        start, end = sweep.instants.region[0]
        moving = design.mechanism.states(sweep.at(rng.uniform(start, end, (poses, 1))))
        tall = np.tile(direction, (len(sweep.scenarios), 1))
        return _first(design, (moving,) * 3, tall)
    # near the rim of what a linkage reaches: stay closer to poses that close
    others = (known[rng.integers(len(known), size=poses)] for _ in range(2))
    return _first(design, itertools.chain([centre], others), direction)


def _first(design: Design, centres: Iterable[Array | States], direction: Array) -> Line:
    """The first line that closes everywhere, with ever shorter steps; raises what bars the last one."""
    steps = (STEP, STEP / 10, STEP / 100)
    for centre, step in zip(centres, steps, strict=False):
        try:
            return _along(design, centre, direction, step)
        except InputError:
            if step == steps[-1]:
                raise
    raise AssertionError("there are as many centres as steps")


def _along(design: Design, centre: Array | States, direction: Array, step: float) -> Line:
    """The line about poses (N, nd), each closed from the reference, or about states, closed from where they stand."""

    def at(distance: float) -> States:
        if isinstance(centre, States):
            states = centre.nearby(centre.driven + distance * direction)
        else:
            states = design.mechanism.states(design.sweep.at_poses(centre + distance * direction))
        reach(design, states)
        return states

    sides = [step / 2**level for level in range(LEVELS)]
    tall = direction if isinstance(centre, States) else np.tile(direction, (len(design.sweep.scenarios), 1))
    return Line(at(0.0), tuple(map(at, sides)), tuple(at(-side) for side in sides), tall, step)


def _element(element: Mechanism | Balancer, line: Line, design: Design) -> tuple[Array, Array, Array]:
    """Effort along the direction, extrapolated derivative of the energy, and how unsettled that is, (N,)."""
    effort = (_value(element.effort(line.centre, "hold"), design) * line.direction).sum(axis=1)
    table = []
    for level, (ahead, behind) in enumerate(zip(line.ahead, line.behind, strict=True)):
        rise = [_value(element.effort(states, "energy"), design)[:, 0] for states in (ahead, behind)]
        table.append((rise[0] - rise[1]) / (2 * line.step / 2**level))
    coarser = table[-1]
    for order in range(1, LEVELS):
        coarser = table[-1]
        table = [fine + (fine - rough) / (4**order - 1) for rough, fine in pairwise(table)]
    return effort, table[-1], np.abs(table[-1] - coarser)


def _value(affine: Affine, design: Design) -> Array:
    return affine.at(np.array([design.values[unknown.name] for unknown in affine.unknowns]))


def _relative(effort: Array, slope: Array, doubt: Array, scale: float = 0.0) -> float:
    scale = max(scale, float(np.abs(effort).max()))
    if scale == 0.0:
        return float(np.abs(slope).max())
    settled = doubt <= RESOLVED * scale
    return float(np.abs(effort - slope)[settled].max(initial=0.0) / scale)
