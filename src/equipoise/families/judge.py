"""What one member of a family is and does: numbers that can be set beside those of another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from equipoise.affine import Array
from equipoise.assemble import effort
from equipoise.balancers.counterweight import Counterweight
from equipoise.balancers.laws import Coil, Constant, Linear, Torsion, Weight, ZeroFreeLength
from equipoise.balancers.paths import Cam, SliderCrank
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.families.site import Site
from equipoise.friction import Friction
from equipoise.objective import Aim
from equipoise.parameters import tag
from equipoise.rubbing import drags
from equipoise.scattering import Scatter, tolerance
from equipoise.states import States
from equipoise.swept import swept_box

STEEL = 7800.0
SHEAR, SHEAR_STRESS = 81e9, 700e6
BEND, BENDING_STRESS = 206e9, 1000e6
PER_JOULE = {"shear": 4 * SHEAR * STEEL / SHEAR_STRESS**2, "bending": 8 * BEND * STEEL / BENDING_STRESS**2}
"""Least mass of round spring wire per J that it stores, kg/J: rho 4 G / tau^2 in coils, rho 8 E / sigma^2 in torsion
springs, at 700 and 1000 MPa."""
MOST = {"gas": 200e5, "hydro_pneumatic": 350e5}
"""Pressures, Pa, that cylinders and accumulators one can buy stand."""
UNUSED = 1e-9
SPECIMENS = 10_000
"""Specimens from which the 95 % value is read."""


@dataclass(frozen=True)
class Chance:
    """What is not as drawn: how far parts and robot may be off, and how much they rub."""

    scatter: Scatter = field(default_factory=Scatter)
    friction: Friction = field(default_factory=Friction)


@dataclass(frozen=True)
class Facts:
    """Numbers of one member, SI, None where they have no meaning: see docs/choosing.md for what each is."""

    peak: float
    rms: float
    mean: float
    rate: float | None
    energy: float
    mass: float | None
    inertia: float
    torque: float
    room: tuple[float, float, float]
    pin: float | None
    friction: float | None
    high: float


def facts(design: Design, site: Site, motion: States, chance: Chance) -> Facts:
    """Judge a design at a joint: residual over its sweep, everything else of its parts, torque over a motion."""
    row = design.after[site.joint]
    column = design.mechanism.driven.index(site.joint)
    springs = [balancer for balancer in design.balancers if isinstance(balancer, Spring)]
    weights = [balancer for balancer in design.balancers if isinstance(balancer, Counterweight)]
    parts = [_spring(design, spring, column) for spring in springs]
    masses = [mass for _, _, mass, _, _ in parts]
    masses += [float(weight.place(design.values)[0]) for weight in weights]
    known = [mass for mass in masses if mass is not None]
    heavy = weights or any(isinstance(spring.law, Weight) for spring in springs)
    inertia = sum(part[3] for part in parts) + sum(_swung(design, weight, column) for weight in weights)
    pins = [part[4] for part in parts if part[4] is not None]
    pins += [float(w.place(design.values)[0] * np.linalg.norm(design.mechanism.gravity)) for w in weights]
    rates = [part[0] for part in parts if part[0] is not None]
    moving = site.mechanism.effort(motion, "drive").b[:, column] + _held(design, motion)[:, column]
    # Counterweights bring their own inertia; what springs add swings along.
    moving = moving + sum(part[3] for part in parts) * _acceleration(motion, column)
    weight = motion.weight / motion.weight.sum()
    return Facts(
        row.peak,
        row.rms,
        row.mean,
        max(rates, default=None),
        sum(part[1] for part in parts),
        sum(known) if known or heavy else None,
        float(inertia),
        float(np.sqrt(weight @ moving**2)),
        _room(design),
        max(pins, default=None),
        _friction(design, springs, column, chance.friction),
        _high(design, site, chance.scatter),
    )


def _friction(design: Design, springs: Sequence[Spring], column: int, friction: Friction) -> float | None:
    """The largest friction torque of all springs at the joint; None without springs."""
    if not springs:
        return None
    total = sum(drags(spring, design.states, design.values, friction)[:, column] for spring in springs)
    return float(np.max(total))


def _high(design: Design, site: Site, scatter: Scatter) -> float:
    """The 95 % value of the joint's own norm under scatter."""
    aim = Aim(norm=next(aim.norm for aim in design.objective if aim.cap is None), joints=(site.joint,))
    return tolerance(replace(design, objective=(aim,)), scatter, samples=SPECIMENS).band.high


def bare_torque(site: Site, motion: States) -> float:
    """The rms torque or force of the bare joint over the motion."""
    moving = site.mechanism.effort(motion, "drive").b[:, site.mechanism.driven.index(site.joint)]
    return float(np.sqrt(motion.weight / motion.weight.sum() @ moving**2))


def fault(design: Design) -> str:
    """Why a member cannot be had, or nothing."""
    for part, balancer in zip(design.parts(), design.balancers, strict=True):
        if not isinstance(balancer, Spring):
            continue
        pressure = part["details"].get("absolute pressure")
        most = MOST.get(tag(type(balancer.law)))
        if pressure is not None and most is not None and pressure["value"][1] > most:
            return f"{pressure['value'][1] / 1e5:.3g} bar are more than {most / 1e5:g}"
        if max(abs(force) for force in part["force"]) <= UNUSED:
            return "within its limits it does not help"
    return ""


def _spring(
    design: Design, spring: Spring, column: int
) -> tuple[float | None, float, float | None, float, float | None]:
    """Rate, stored energy, least mass, added inertia at the joint and largest pin force of one spring."""
    states = design.states
    length, force = spring.force(states, design.values)
    lever = np.broadcast_to(spring.path.deform(states)[1][..., column], length.shape)
    basis, known = spring.law.slope_basis(length)
    theta = np.array([design.values[unknown.name] for unknown in spring.unknowns])
    rate = float(np.abs(basis @ theta + known).max())
    storage = spring.effort(states, "storage")
    energy = storage.at(np.array([design.values[unknown.name] for unknown in storage.unknowns]))[:, 0]
    mass = _least_mass(spring, float(np.abs(force).max()), rate, float(np.ptp(length)))
    if isinstance(spring.law, Weight):
        mass = spring.parameters(design.values)["m"]
        return None, float(np.ptp(energy)), mass, mass * float((lever**2).max()), float(np.abs(force).max())
    # A third of a spring moves with its end; of one that winds about a shaft next to nothing turns.
    inertia = 0.0 if spring.path.unit == "rad" else (mass or 0.0) / 3 * float((lever**2).max())
    stored = float(energy.max()) if energy.min() >= 0 else float(np.ptp(energy))
    pin = None if spring.path.unit == "rad" else float(np.abs(_pin(spring, states, force)).max())
    return rate, stored, mass, inertia, pin


def _least_mass(spring: Spring, force: float, rate: float, stroke: float) -> float | None:
    """The least wire that stores what the spring stores at its most loaded; None for gas."""
    if isinstance(spring.law, Constant):
        return PER_JOULE["bending"] * force * stroke
    if isinstance(spring.law, Torsion) and rate > 0:
        return PER_JOULE["bending"] * force**2 / (2 * rate)
    if isinstance(spring.law, Coil | Linear | ZeroFreeLength) and rate > 0:
        return PER_JOULE["shear"] * force**2 / (2 * rate)
    return None


def _pin(spring: Spring, states: States, force: Array) -> Array:
    """Force at the pin or roller that moves the spring: more than the spring's own where rod or cam stand aslant."""
    path = spring.path
    if isinstance(path, SliderCrank):
        u = path.crank_angle(states)[0]
        crank, rod = float(path.crank or 0.0), float(path.rod or 0.0)
        return force * rod / np.sqrt(rod**2 - (crank * np.sin(u) - path.offset) ** 2)
    if isinstance(path, Cam):
        lift, slope = path.profile(path.crank_angle(states)[0])
        return force * np.sqrt(1.0 + (slope / np.maximum(np.abs(lift), 1e-9)) ** 2)
    return force


def _swung(design: Design, weight: Counterweight, column: int) -> float:
    """m |J|^2 of a counterweight at the joint, the most over the states."""
    mass, where = weight.place(design.values)
    x, y, z = (float(value) for value in where)
    jacobian = design.states.point(replace(weight.at, at=(x, y, z)))[1][..., column]
    return float(mass * (jacobian**2).sum(axis=-1).max())


def _held(design: Design, motion: States) -> Array:
    """What the balancers do over the motion, counterweights with their inertia."""
    from equipoise.assemble import settled

    fixed: Sequence = settled(design.balancers, design.values)
    springs = [balancer for balancer in fixed if isinstance(balancer, Spring)]
    found = effort(design.mechanism, springs, motion, "hold").b * 0.0
    for balancer in fixed:
        share = balancer.effort(motion, "hold" if isinstance(balancer, Spring) else "drive")
        found = found + share.at(np.array([design.values[unknown.name] for unknown in share.unknowns]))
    return found


def _acceleration(motion: States, column: int) -> Array:
    dof = motion.mechanism.model.jnt_dofadr[motion.mechanism.driven_ids[column]]
    return motion.moving.acceleration[:, dof]


def _room(design: Design) -> tuple[float, float, float]:
    """Sides, m, of the box along the world's axes that all parts sweep, counterweights with their place."""
    corners = [swept_box(b.path, design.states) for b in design.balancers if isinstance(b, Spring)]
    for weight in design.balancers:
        if isinstance(weight, Counterweight):
            x, y, z = (float(value) for value in weight.place(design.values)[1])
            places = design.states.point(replace(weight.at, at=(x, y, z)))[0]
            corners.append(np.stack([places.min(axis=0), places.max(axis=0)]))
    low, high = np.min([c[0] for c in corners], axis=0), np.max([c[1] for c in corners], axis=0)
    x, y, z = (float(side) for side in high - low)
    return x, y, z
