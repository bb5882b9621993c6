"""Rows of two-sided limits."""

from __future__ import annotations

from typing import Any

import numpy as np

from equipoise import units
from equipoise.affine import Array, Unknown
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError
from equipoise.sag import Sag
from equipoise.solve.program import Rows


def sides(
    what: str, unit: str, basis: Array, known: Array, unknowns: tuple[Unknown, ...], low: Any, high: Any
) -> tuple[Rows, ...]:
    """Rows of low <= basis theta + known <= high, one per state."""
    if low is None and high is None:
        raise InputError(f"{what} has neither min nor max", where="limits", hint="give min, max or both")
    if low is not None and high is not None and low > high:
        raise InputError(f"{what}: min {low:g} is above max {high:g} {unit}", where="limits")
    for value in (low, high):
        if isinstance(value, units.Measured) and value.unit not in ("", unit):
            raise InputError(f"{what}: the limit is in {value.unit}, it must be in {unit}", where="limits")
    state = np.arange(known.shape[-1])
    rows = []
    if high is not None:
        scale = max(abs(high), 1e-9) if high else scale_of(known)
        rows.append(
            Rows(f"{what} <= {units.text(high, unit)}", unit, basis, high - known, unknowns, state, scale=scale)
        )
    if low is not None:
        scale = abs(low) if low else scale_of(known)
        rows.append(Rows(f"{what} >= {units.text(low, unit)}", unit, -basis, known - low, unknowns, state, scale=scale))
    return tuple(rows)


def straight(least: float | Sag | None, over: tuple[float, float] | None) -> float | None:
    """A least force as a number: a `Sag` is turned into the force that keeps a cable that straight."""
    if not isinstance(least, Sag):
        return least
    if over is None and least.span is None:
        raise InputError("a sag needs a span", where="limits", hint="add `span`, or `over: [shortest, longest]`")
    return least.tension(0.0 if over is None else float(over[1]))


def path_unit(unit: str, spring: Spring) -> str:
    """Of a unit in two readings the one that fits the spring's path."""
    return units.along_path(unit, spring.path.unit)


def scale_of(known: Array) -> float:
    """What makes violations comparable where a limit is zero."""
    return max(float(np.abs(np.real(known)).max(initial=0.0)), 1.0)
