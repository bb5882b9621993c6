"""Where errors come from: each source's slope of the residual, exact to first order."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.assemble import Balancer, effort
from equipoise.balancers.counterweight import Counterweight
from equipoise.balancers.spring import Spring
from equipoise.mechanism import Mechanism
from equipoise.parameters import candidates, geometry, read
from equipoise.scattering.scatter import Scatter
from equipoise.states import States, ancestors
from equipoise.sweep import Sweep
from equipoise.tilt import Tilt

STEP = 1e-30
STEEL = -2.5e-4
"""Change of a steel spring's rate per K, relative; from memory of the trade, unsourced."""


@dataclass(frozen=True, eq=False)
class Source:
    """One thing that may be off: its tolerance (two standard deviations) in `unit`, and what one unit does.

    slope (N, R) is the residual's derivative; tunable says whether a designer could make an adjuster of it.
    """

    name: str
    tolerance: float
    unit: str
    slope: Array
    tunable: bool = False


def sources(
    mechanism: Mechanism,
    balancers: Sequence[Balancer],
    sweep: Sweep,
    states: States,
    goal: str,
    values: dict[str, float],
    scatter: Scatter,
) -> tuple[Source, ...]:
    """All sources whose tolerance is not zero and that move the residual at all; goal is hold or drive."""
    design = _Found(mechanism, tuple(balancers), sweep, states, goal, values)
    found = [*_forces(design, scatter), *_places(design, scatter), *_robot(design, scatter), *_lean(design, scatter)]
    return tuple(source for source in found if source.tolerance > 0 and np.any(source.slope))


@dataclass(frozen=True, eq=False)
class _Found:
    """A design as far as its errors go."""

    mechanism: Mechanism
    balancers: tuple[Balancer, ...]
    sweep: Sweep
    states: States
    goal: str
    values: dict[str, float]

    def residual(self, mechanism: Mechanism, balancers: Sequence[Balancer], states: States) -> Array:
        total = effort(mechanism, balancers, states, self.goal)
        return total.b + total.A @ np.array([self.values[unknown.name] for unknown in total.unknowns])


def _forces(design: _Found, scatter: Scatter) -> Iterator[Source]:
    """Rates, rest lengths, weights, and the temperature that all springs share."""
    warmth = np.zeros_like(design.residual(design.mechanism, (), design.states))
    for balancer in design.balancers:
        name = balancer.name
        if isinstance(balancer, Counterweight):
            weight = design.residual(design.mechanism, [balancer], design.states)
            bare = design.residual(design.mechanism, (), design.states)
            yield Source(f"{name}'s mass", scatter.rate, "", weight - bare, tunable=True)
        if not isinstance(balancer, Spring):
            continue
        length, rate = balancer.path.deform(design.states)
        theta = np.array([design.values[unknown.name] for unknown in balancer.unknowns])
        basis, known = balancer.law.force_basis(length)
        stiffness, stiff = balancer.law.slope_basis(length)
        force, slope = (basis @ theta + known)[:, None], (stiffness @ theta + stiff)[:, None]
        yield Source(f"{name}'s rate", scatter.rate, "", force * rate, tunable=True)
        straight = balancer.path.unit == "m"
        free, unit = (scatter.rest_length, "m") if straight else (scatter.rest_angle, "rad")
        yield Source(f"{name}'s rest {'length' if straight else 'angle'}", free, unit, -slope * rate, tunable=True)
        warmth = warmth + _per_kelvin(balancer, length, theta)[:, None] * rate
    yield Source("temperature", scatter.temperature, "K", warmth)


def _per_kelvin(spring: Spring, length: Array, theta: Array) -> Array:
    """Change of a spring's force (N,), per K: that of its gas, or of steel."""
    at = getattr(spring.law, "temperature", None)
    if isinstance(at, int | float):
        warmer: Any = replace(spring.law, temperature=at + 1j * STEP)
        basis, known = warmer.force_basis(length)
        return np.imag(basis @ theta + known) / STEP
    basis, known = spring.law.force_basis(length)
    return STEEL * (basis @ theta + known)


def _places(design: _Found, scatter: Scatter) -> Iterator[Source]:
    """Every coordinate, length and angle of paths and counterweights."""
    for index, balancer in enumerate(design.balancers):
        found = [(name, unit) for name, unit in geometry(balancer) if unit in ("m", "rad")]
        found = [(name, unit) for name, unit in found if read(design.balancers, name) is not None]
        if not found:
            continue
        names = [name for name, _ in found]
        at = np.array([read(design.balancers, name) for name in names], dtype=float)
        moved = candidates(design.balancers, names, at + 1j * STEP * np.eye(len(at)))
        residual = design.residual(design.mechanism, [moved[index]], design.states)
        slopes = np.broadcast_to(np.imag(residual) / STEP, (len(at), *residual.shape[-2:]))
        for (name, unit), slope in zip(found, slopes, strict=True):
            tolerance = scatter.anchor if unit == "m" else scatter.angle
            yield Source(name, tolerance, unit, slope, tunable=True)


def _robot(design: _Found, scatter: Scatter) -> Iterator[Source]:
    """Masses of the moving bodies, with their inertia, and the payload's."""
    model = design.mechanism.model
    if scatter.mass > 0:
        bare = design.residual(design.mechanism, (), design.states)
        for body in range(1, model.nbody):
            if ancestors(model, body) and model.body_mass[body] > 0:
                heavier = _heavier(design.mechanism, body)
                slope = design.residual(heavier, (), heavier.states(design.sweep)) - bare
                yield Source(f"mass of {model.body(body).name}", scatter.mass, "", slope)
    states = design.states
    for index, (point, mass) in enumerate(zip(states.payload_points, states.payload_mass.T, strict=True)):
        name = "payload" if len(states.payload_points) == 1 else f"payload {index + 1}"
        lift = states.weight_effort(point, mass)
        if design.goal == "drive":
            lift = lift + states.point_inertia(point, mass)
        yield Source(name, scatter.payload, "", lift)


def _heavier(mechanism: Mechanism, body: int) -> Mechanism:
    """The mechanism with a body of twice its mass and inertia."""
    model = copy.copy(mechanism.model)
    model.body_mass[body] *= 2
    model.body_inertia[body] *= 2
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return replace(mechanism, model=model, _batches={})


def _lean(design: _Found, scatter: Scatter) -> Iterator[Source]:
    """The base's tilt about two level axes; what motors hold is linear in gravity."""
    if not (scatter.tilt > 0 and np.any(design.mechanism.gravity)):
        return
    leans = list(Tilt(scatter.tilt, directions=4).apply(design.mechanism).values())[1:]
    first, second, back, rear = (design.residual(m, design.balancers, m.states(design.sweep)) for m in leans)
    for label, one, other in (("tilt of the base", first, back), ("tilt of the base, across", second, rear)):
        yield Source(label, scatter.tilt, "rad", (one - other) / (2 * math.sin(scatter.tilt)))
