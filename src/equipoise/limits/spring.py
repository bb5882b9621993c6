"""Limits on springs and counterweights: force, slack, length, stroke, stiffness, mass."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar, cast

import numpy as np

from equipoise import units
from equipoise.affine import Array
from equipoise.balancers.counterweight import Counterweight
from equipoise.balancers.laws.law import FORCE, RATE
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError
from equipoise.limits import curve
from equipoise.limits.limit import Setting
from equipoise.limits.realisable import room
from equipoise.limits.sides import path_unit, scale_of, sides, straight
from equipoise.limits.winding import winding
from equipoise.parts.part import Part
from equipoise.sag import Sag
from equipoise.solve.program import Rows


@dataclass(frozen=True)
class Force(curve.OverInterval):
    """min <= f <= max of a spring's force, N, or torque, N m, at every state, or over an interval of length.

    f > 0 pulls. With over (low, high), m or rad, it holds for every length in between, see `limits.curve`; samples
    asks for that many equally spaced lengths only, and nothing between them. A `Sag` as min asks for the force that
    keeps a cable straight: over its longest length, unless it says its span.
    """

    spring: str
    max: units.Pull | None = None
    min: units.Pull | Sag | None = None
    over: tuple[units.Extent, units.Extent] | None = None
    samples: int | None = None
    orders: ClassVar[tuple[int, ...]] = (0,)

    def __post_init__(self) -> None:
        object.__setattr__(self, "min", straight(self.min, self.over))

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """B theta <= max - f0 and -B theta <= f0 - min, one row per state."""
        spring = setting.find(self.spring, Spring, "force")
        if self.over is not None:
            return curve.rows(cast("curve.Curve", self), spring)
        if self.samples is not None:
            raise InputError("samples are asked for over no interval", where="limit force", hint="add `over`")
        length, _ = spring.deform(setting.states)
        basis, known = spring.law.force_basis(length)
        return sides(
            f"force of {self.spring}", path_unit(FORCE, spring), basis, known, spring.unknowns, self.min, self.max
        )


@dataclass(frozen=True)
class Slack:
    """A tension spring never pushes: f >= 0 at every state. A strut has no slack: raises InputError."""

    spring: str

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """-B theta <= f0, one row per state."""
        spring = setting.find(self.spring, Spring, "slack")
        if spring.law.pushes:
            raise InputError(
                f"{self.spring} is a strut that pushes, it cannot go slack",
                where="limit slack",
                hint=f"leave the limit out, or write {{force: {self.spring}, max: 0 N}} to keep it pushing",
            )
        length, _ = spring.deform(setting.states)
        basis, known = spring.law.force_basis(length)
        return sides(f"slack of {self.spring}", path_unit(FORCE, spring), basis, known, spring.unknowns, 0.0, None)


@dataclass(frozen=True)
class Length:
    """min <= l <= max of a spring's length, m, or angle, rad, at every state; the geometry alone decides."""

    spring: str
    max: units.Extent | None = None
    min: units.Extent | None = None

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """Rows without unknowns, one per state."""
        spring = setting.find(self.spring, Spring, "length")
        length, _ = spring.deform(setting.states)
        none = np.zeros((*length.shape, 0), dtype=length.dtype)
        return sides(f"length of {self.spring}", spring.path.unit, none, length, (), self.min, self.max)


@dataclass(frozen=True)
class Stroke:
    """max l - min l <= max over the sweep, m or rad."""

    spring: str
    max: units.Extent

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """Every length against the shortest, and the longest against every length."""
        spring = setting.find(self.spring, Spring, "stroke")
        length, _ = spring.deform(setting.states)
        _positive(self.max, "stroke", self.spring)
        longest = np.take_along_axis(length, np.real(length).argmax(-1)[..., None], axis=-1)
        shortest = np.take_along_axis(length, np.real(length).argmin(-1)[..., None], axis=-1)
        excess = np.concatenate([length - shortest, longest - length], axis=-1)
        none = np.zeros((*excess.shape, 0), dtype=excess.dtype)
        rows = sides(f"stroke of {self.spring}", spring.path.unit, none, excess, (), None, self.max)
        count = length.shape[-1]
        return tuple(Rows(r.limit, r.unit, r.G, r.h, (), np.arange(2 * count) % count, scale=r.scale) for r in rows)


@dataclass(frozen=True)
class Stiffness:
    """min <= df/dl <= max of a spring's rate, N/m or N m/rad, found or given; at every state where it varies."""

    spring: str
    max: units.Rate | None = None
    min: units.Rate | None = None

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """One row per side for a straight force line, else one per side and state."""
        spring = setting.find(self.spring, Spring, "stiffness")
        if spring.law.degree == 0:
            raise InputError(f"spring {self.spring} has no stiffness", where="limit stiffness", hint="limit its force")
        length, _ = spring.deform(setting.states)
        straight = spring.law.degree == 1
        basis, known = spring.law.slope_basis(length[..., :1] if straight else length)
        if straight and not np.ndim(getattr(spring.law, "k", 0.0)):
            # The rate itself follows no geometry: one plain row.
            basis, known = np.real(basis.reshape(-1, *basis.shape[-2:])[0]), np.real(known.reshape(-1, 1)[0])
        unit = path_unit(RATE, spring)
        return sides(f"stiffness of {self.spring}", unit, basis, known, spring.unknowns, self.min, self.max)


@dataclass(frozen=True)
class MassCap:
    """m <= max of a counterweight's mass, kg; a free place also stays within its reach. For all masses: goal `mass`."""

    counterweight: str
    max: units.Mass

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """One row."""
        weight = setting.find(self.counterweight, Counterweight, "mass")
        mass = [u for u in weight.unknowns if u.name == f"{weight.owner}.m"]
        basis, known = (np.ones((1, 1)), np.zeros(1)) if mass else (np.zeros((1, 0)), np.array([weight.mass]))
        return sides(f"mass of {self.counterweight}", "kg", basis, known, tuple(mass), None, self.max)


def implied(balancers: Iterable[object], setting: Setting) -> tuple[Rows, ...]:
    """Rows that balancers ask for by themselves: spans of laws, needs of paths, reach of counterweights."""
    rows: list[Rows] = []
    for balancer in balancers:
        if isinstance(balancer, Spring):
            rows += _span(balancer, setting)
            rows += _needs(balancer, setting)
            rows += _making(balancer)
            rows += winding(balancer, setting)
        elif isinstance(balancer, Counterweight) and balancer.reach is not None:
            rows += room(balancer) if balancer.second else _reach(balancer)
    return tuple(rows)


def _needs(spring: Spring, setting: Setting) -> list[Rows]:
    """What the geometry of a path must keep where it is not fixed: rods that reach, points outside of pulleys."""
    rows = []
    for need in spring.path.needs(setting.states):
        none = np.zeros((*need.room.shape, 0), dtype=need.room.dtype)
        state = np.arange(need.room.shape[-1])
        rows.append(Rows(f"{need.limit} of {spring.name}", need.unit, none, need.room, (), state, scale=need.scale))
    return rows


def _making(spring: Spring) -> list[Rows]:
    """What a part needs to be made, where its numbers are not fixed: an index, a wire that is known, and so on."""
    rows = []
    for fault in spring.law.faults() if isinstance(spring.law, Part) else ():
        room = np.asarray(fault.room)
        if room.ndim:
            none = np.zeros((*room.shape, 0), dtype=room.dtype)
            rows.append(Rows(f"{fault.reason}: {spring.name}", fault.unit, none, room, (), scale=fault.scale))
    return rows


def _span(spring: Spring, setting: Setting) -> list[Rows]:
    """The lengths stay within the law's span; an unknown free length lies between closed and shortest length."""
    law = spring.law
    free = any(u.name == f"{spring.owner}.k_free_length" for u in spring.unknowns)
    if all(end is None for end in law.span) and not free:
        return []
    length, _ = spring.deform(setting.states)
    rows: list[Rows] = []
    for end, side in zip(law.span, (1.0, -1.0), strict=True):
        if end is not None:
            room = side * (length - end)
            none = np.zeros((*room.shape, 0), dtype=room.dtype)
            value = units.text(float(np.real(np.ravel(end)[0])), spring.path.unit)
            limit = f"{law.span_words} of {spring.name} ({value})"
            rows.append(
                Rows(limit, spring.path.unit, none, room, (), np.arange(room.shape[-1]), scale=scale_of(length))
            )
    return rows + _free_length(spring, length) if free else rows


def _free_length(spring: Spring, length: Array) -> list[Rows]:
    """closed <= L0, and L0 <= l where the coils touch at the free length, in terms of the product k L0."""
    rows: list[Rows] = []
    closed = spring.law.span[0]
    unknowns = {u.name.removeprefix(f"{spring.owner}."): u for u in spring.unknowns}
    rate, product = unknowns.get("k"), unknowns["k_free_length"]
    given = getattr(spring.law, "k", None)
    bounds = [(length, 1.0)] if spring.law.closes_free else []
    bounds += [(np.broadcast_to(closed, (1,)), -1.0)] if closed is not None else []
    for bound, side in bounds:
        # side (k_free_length - k bound) <= 0, in which both are unknowns unless k is given.
        if rate is not None:
            G = np.stack(np.broadcast_arrays(-side * bound, side), axis=-1)
            h, over = np.zeros(bound.shape), (rate, product)
        else:
            assert given is not None
            G, h, over = np.full((*bound.shape, 1), side), side * given * bound, (product,)
        where = np.arange(length.shape[-1]) if bound is length else np.array([-1])
        rows.append(Rows(f"free length of {spring.name}", "N", G, h, over, where))
    return rows


def _reach(weight: Counterweight) -> list[Rows]:
    """|m_i| <= reach * m along each axis of the body."""
    assert weight.reach is not None
    unknowns = weight.unknowns
    moments = unknowns[-3:]
    G = np.vstack([np.eye(3), -np.eye(3)])
    limit = f"reach of {weight.name} ({units.text(weight.reach, 'm')})"
    if weight.mass is not None:
        return [
            Rows(limit, "kg m", G, np.full(6, weight.reach * weight.mass), moments, scale=weight.reach * weight.mass)
        ]
    return [Rows(limit, "kg m", np.hstack([np.full((6, 1), -weight.reach), G]), np.zeros(6), unknowns)]


def _positive(value: float, what: str, name: str) -> None:
    if not value > 0:
        raise InputError(f"the {what} limit of {name} is {value:g}, it must be positive", where="limits")
