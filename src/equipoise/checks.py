"""Checks of a problem against its mechanism, each error at the line that causes it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from equipoise import assemble
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError
from equipoise.limits import ExactAt
from equipoise.objective import Aim
from equipoise.parameters import read, write
from equipoise.ranges import pose_vector
from equipoise.states import States
from equipoise.units import Measured

if TYPE_CHECKING:
    from equipoise.problem import Problem

PROBES = 64


def check(problem: Problem) -> None:
    """Raise InputError for bodies, joints, names, bounds and units that do not fit the mechanism."""
    mechanism, balancers = problem.mechanism, _opened(problem)
    with problem.at("sweep"):
        few = problem.sweep.at(problem.sweep.coordinates[:PROBES])
        states = mechanism.states(few)
    if problem.content.discover is not None:
        _discover(problem)
    if problem.trajectory is not None:
        with problem.at("trajectory"):
            mechanism.states(problem.trajectory.at(problem.trajectory.coordinates[:PROBES]))
    for index in range(len(balancers)):
        with problem.at("balancers", index):
            assemble.check(mechanism, balancers[: index + 1])
    for index, balancer in enumerate(balancers):
        if isinstance(balancer, Spring) and not any(
            name.startswith(f"{balancer.name}.path") for name in (*problem.bounds, *problem.adjusters)
        ):
            with problem.at("balancers", index):
                _moves(balancer, states)
                moved = (*problem.bounds, *problem.adjusters)
                if not any(name.startswith(f"{balancer.name}.law") for name in moved):
                    balancer.check_span(states)

    setting = assemble.setting_of(mechanism, balancers, few, states)
    for index, limit in enumerate(problem.limits):
        with problem.at("limits", index):
            if isinstance(limit, ExactAt):
                _poses(problem, limit.poses)
            limit.rows(setting)
    for index, aim in enumerate(problem.objective):
        listed = isinstance(problem.content.objective, tuple)
        with problem.at(*(("objective", index) if listed else ("objective",))):
            _aim(problem, aim)


def _discover(problem: Problem) -> None:
    """What a discovery names must be there, and nothing else may be added."""
    request = problem.content.discover
    assert request is not None
    with problem.at("discover"):
        if problem.content.balancers:
            raise InputError(
                "`discover` and `balancers` stand beside each other",
                hint="keep one: discover finds the balancers itself",
            )
        named = [body for pair in (*(request.pairs or ()), *request.forbid) for body in pair]
        for body in [*named, *(request.points or {}), *(region.body for region in request.keep_out)]:
            problem.mechanism.body_id(body)


def _opened(problem: Problem) -> tuple[Any, ...]:
    """The balancers with parameters that `shape` finds and the file leaves out in the middle of their bounds."""
    middle = {}
    unknowns = {unknown.name for balancer in problem.balancers for unknown in balancer.unknowns}
    ranged = [("adjust", name, pair) for name, pair in problem.adjusters.items() if pair and name not in unknowns]
    for block, name, (low, high) in [*(("shape", name, pair) for name, pair in problem.bounds.items()), *ranged]:
        with problem.at(block, name):
            if low >= high:
                raise InputError(
                    f"the bounds are reversed or equal: [{low:g}, {high:g}]",
                    hint="write the lower bound first, or give the value in the balancer instead",
                )
            if read(problem.balancers, name) is None:
                middle[name] = (low + high) / 2
    return write(problem.balancers, middle)


def _moves(spring: Spring, states: States) -> None:
    length, rate = spring.path.deform(states)
    if np.abs(length).max() == 0:
        raise InputError(
            f"the two ends of spring {spring.name} coincide at every pose",
            hint="move one end away from the joint's axis",
        )
    if np.abs(rate).max() <= 1e-12 * np.abs(length).max():
        raise InputError(
            f"no pose of the sweep changes the length of spring {spring.name} ({length[0]:.4g} m)",
            hint="put both ends off the axis of the joint between them, or sweep that joint",
        )


def _poses(problem: Problem, poses: tuple[Mapping[str, Any], ...]) -> None:
    for pose in poses:
        pose_vector(problem.mechanism, pose)
        problem.joint_units(pose, "exact_at")


def _aim(problem: Problem, aim: Aim) -> None:
    aim.counted(problem.mechanism)
    aim.scales(problem.mechanism)
    allowed = "ratio" if aim.divisor else aim.unit(problem.mechanism)
    for what, value in (("cap", aim.cap), ("target", aim.target)):
        if isinstance(value, Measured) and value.unit and value.unit not in allowed.split(" or "):
            given = "a share" if value.unit == "ratio" else f"in {value.unit}"
            wanted = "a share of the motor limit" if aim.divisor else f"a value in {allowed}"
            raise InputError(
                f"the {what} is {given}, the objective is {wanted}", hint="change the unit, or the divisor"
            )
