"""Limits on springs and counterweights: force, slack, length, stroke, stiffness, mass."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from equipoise import units
from equipoise.affine import Array, Unknown
from equipoise.balancers.counterweight import Counterweight
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError
from equipoise.limits.limit import Setting
from equipoise.solve.program import Rows


@dataclass(frozen=True)
class Force:
    """min <= f <= max of a spring's force, N, at every state; f > 0 pulls."""

    spring: str
    max: units.Force | None = None
    min: units.Force | None = None

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """B theta <= max - f0 and -B theta <= f0 - min, one row per state."""
        spring = setting.find(self.spring, Spring, "force")
        length, _ = spring.path.deform(setting.states)
        basis, known = spring.law.force_basis(length)
        return _sides(f"force of {self.spring}", "N", basis, known, spring.unknowns, low=self.min, high=self.max)


@dataclass(frozen=True)
class Slack:
    """A tension spring never pushes: f >= 0 at every state."""

    spring: str

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """-B theta <= f0, one row per state."""
        spring = setting.find(self.spring, Spring, "slack")
        length, _ = spring.path.deform(setting.states)
        basis, known = spring.law.force_basis(length)
        return _sides(f"slack of {self.spring}", "N", basis, known, spring.unknowns, low=0.0, high=None)


@dataclass(frozen=True)
class Length:
    """min <= l <= max of a spring's length, m, at every state; the geometry alone decides."""

    spring: str
    max: units.Length | None = None
    min: units.Length | None = None

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """Rows without unknowns, one per state."""
        spring = setting.find(self.spring, Spring, "length")
        length, _ = spring.path.deform(setting.states)
        none = np.zeros((*length.shape, 0), dtype=length.dtype)
        return _sides(f"length of {self.spring}", "m", none, length, (), low=self.min, high=self.max)


@dataclass(frozen=True)
class Stroke:
    """max l - min l <= max over the sweep, m."""

    spring: str
    max: units.Length

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """Every length against the shortest, and the longest against every length."""
        spring = setting.find(self.spring, Spring, "stroke")
        length, _ = spring.path.deform(setting.states)
        _positive(self.max, "stroke", self.spring)
        longest = np.take_along_axis(length, np.real(length).argmax(-1)[..., None], axis=-1)
        shortest = np.take_along_axis(length, np.real(length).argmin(-1)[..., None], axis=-1)
        excess = np.concatenate([length - shortest, longest - length], axis=-1)
        none = np.zeros((*excess.shape, 0), dtype=excess.dtype)
        rows = _sides(f"stroke of {self.spring}", "m", none, excess, (), low=None, high=self.max)
        count = length.shape[-1]
        return tuple(Rows(r.limit, r.unit, r.G, r.h, (), np.arange(2 * count) % count, scale=r.scale) for r in rows)


@dataclass(frozen=True)
class Stiffness:
    """min <= k <= max of a spring's rate, N/m, found or given."""

    spring: str
    max: units.Stiffness | None = None
    min: units.Stiffness | None = None

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """One row per side."""
        spring = setting.find(self.spring, Spring, "stiffness")
        unknown = [u for u in spring.unknowns if u.name == f"{spring.owner}.k"]
        given = getattr(spring.law, "k", None)
        if unknown:
            basis, known = np.ones((1, 1)), np.zeros(1)
        elif given is not None:
            known = np.atleast_1d(given)
            basis = np.zeros((*known.shape, 0))
        else:
            raise InputError(f"spring {self.spring} has no stiffness", where="limit stiffness", hint="limit its force")
        return _sides(f"stiffness of {self.spring}", "N/m", basis, known, tuple(unknown), low=self.min, high=self.max)


@dataclass(frozen=True)
class MassCap:
    """m <= max of a counterweight's mass, kg; a free place also stays within its reach."""

    counterweight: str
    max: units.Mass

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """One row."""
        weight = setting.find(self.counterweight, Counterweight, "mass")
        mass = [u for u in weight.unknowns if u.name == f"{weight.owner}.m"]
        basis, known = (np.ones((1, 1)), np.zeros(1)) if mass else (np.zeros((1, 0)), np.array([weight.mass]))
        return _sides(f"mass of {self.counterweight}", "kg", basis, known, tuple(mass), low=None, high=self.max)


def implied(balancers: Iterable[Spring | Counterweight], setting: Setting) -> tuple[Rows, ...]:
    """Rows that balancers ask for by themselves: closed coils, free lengths above them, reach of counterweights."""
    rows: list[Rows] = []
    for balancer in balancers:
        if isinstance(balancer, Spring):
            rows += _closed(balancer, setting)
        elif balancer.reach is not None:
            rows += _reach(balancer)
    return tuple(rows)


def _closed(spring: Spring, setting: Setting) -> list[Rows]:
    """The coils touch below the closed length; an unknown free length lies between closed and shortest length."""
    closed = spring.law.closed
    if closed is None and not any(u.name == f"{spring.owner}.k_free_length" for u in spring.unknowns):
        return []
    length, _ = spring.path.deform(setting.states)
    state = np.arange(length.shape[-1])
    rows: list[Rows] = []
    if closed is not None:
        none = np.zeros((*length.shape, 0), dtype=length.dtype)
        limit = f"closed length of {spring.name} ({units.text(float(np.real(np.ravel(closed)[0])), 'm')})"
        rows.append(Rows(limit, "m", none, length - closed, (), state, scale=_scale(length)))
    unknowns = {u.name.removeprefix(f"{spring.owner}."): u for u in spring.unknowns}
    if "k_free_length" not in unknowns:
        return rows
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
        where = state if bound is length else np.array([-1])
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


def _sides(
    what: str, unit: str, basis: Array, known: Array, unknowns: tuple[Unknown, ...], *, low: Any, high: Any
) -> tuple[Rows, ...]:
    """Rows of low <= basis theta + known <= high, one per state."""
    if low is None and high is None:
        raise InputError(f"{what} has neither min nor max", where="limits", hint="give min, max or both")
    if low is not None and high is not None and low > high:
        raise InputError(f"{what}: min {low:g} is above max {high:g} {unit}", where="limits")
    state = np.arange(known.shape[-1])
    rows = []
    if high is not None:
        scale = max(abs(high), 1e-9) if high else _scale(known)
        rows.append(
            Rows(f"{what} <= {units.text(high, unit)}", unit, basis, high - known, unknowns, state, scale=scale)
        )
    if low is not None:
        scale = abs(low) if low else _scale(known)
        rows.append(Rows(f"{what} >= {units.text(low, unit)}", unit, -basis, known - low, unknowns, state, scale=scale))
    return tuple(rows)


def _scale(known: Array) -> float:
    return max(float(np.abs(np.real(known)).max(initial=0.0)), 1.0)


def _positive(value: float, what: str, name: str) -> None:
    if not value > 0:
        raise InputError(f"the {what} limit of {name} is {value:g}, it must be positive", where="limits")
