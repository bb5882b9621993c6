"""Drivers: how one joint moves over time, with its exact velocity and acceleration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.motion.expression import check, evaluate
from equipoise.motion.jet import Jet
from equipoise.units import Joint, Number, Time

BOUNDARY = {"rest": "clamped", "cycle": "periodic", "free": "not-a-knot"}


class Driver(Protocol):
    """How one joint moves."""

    def at(self, t: Array, duration: float, where: str) -> Jet:
        """Position, velocity and acceleration at t (N,), s, of a motion that lasts `duration`."""
        ...

    def check(self, where: str) -> None:
        """Raise InputError for a driver that cannot mean anything."""
        ...


@dataclass(frozen=True)
class Expression:
    """q = an expression in t, T (the duration), pi and deg; + - * / ** and the usual functions."""

    text: str

    def at(self, t: Array, duration: float, where: str) -> Jet:
        """Differentiated by rule."""
        return evaluate(self.text, t, duration, where)

    def check(self, where: str) -> None:
        """Raise InputError for anything outside the grammar."""
        check(self.text, where)


@dataclass(frozen=True)
class Cycloidal:
    """q = a + (b - a) (s - sin(2 pi s) / (2 pi)), s = t / T: starts and ends without velocity and acceleration.

    a is `start`, b is `end` (rad or m); T the motion's duration.
    """

    start: Joint
    end: Joint

    def at(self, t: Array, duration: float, where: str) -> Jet:  # noqa: ARG002 - the protocol hands it over
        """The cycloid."""
        s, w = t / duration, 2 * np.pi
        span = self.end - self.start
        return Jet(
            self.start + span * (s - np.sin(w * s) / w),
            span * (1 - np.cos(w * s)) / duration,
            span * w * np.sin(w * s) / duration**2,
        )

    def check(self, where: str) -> None:
        """Any two numbers will do."""


@dataclass(frozen=True)
class TimePolynomial:
    """q = c0 + c1 s + c2 s^2 + ..., s = t / T running from 0 to 1; coefficients in rad or m."""

    coefficients: tuple[Joint, ...]

    def at(self, t: Array, duration: float, where: str) -> Jet:  # noqa: ARG002 - the protocol hands it over
        """Differentiated by coefficients."""
        law, s = np.polynomial.Polynomial(self.coefficients), t / duration
        return Jet(law(s), law.deriv(1)(s) / duration, law.deriv(2)(s) / duration**2)

    def check(self, where: str) -> None:
        """Raise InputError without coefficients."""
        if not self.coefficients:
            raise InputError("the polynomial has no coefficients", where=where, hint="write [c0, c1, ...]")


@dataclass(frozen=True)
class TimeSpline:
    """A cubic spline through `values` (rad or m) at `times` (s).

    ends `rest` starts and stops without velocity, `cycle` closes smoothly (first and last value agree), `free`
    makes no demand (not-a-knot). Beyond its times the joint stays where it is.
    """

    times: tuple[Time, ...]
    values: tuple[Joint, ...]
    ends: Literal["rest", "cycle", "free"] = "rest"

    def at(self, t: Array, duration: float, where: str) -> Jet:  # noqa: ARG002 - the protocol hands it over
        """The spline and its derivatives."""
        from scipy.interpolate import CubicSpline

        times, values = np.array(self.times, dtype=float), np.array(self.values, dtype=float)
        law = CubicSpline(times, values, bc_type=BOUNDARY[self.ends])
        inside = (t >= times[0]) & (t <= times[-1])
        held = np.clip(t, times[0], times[-1])
        return Jet(law(held), np.where(inside, law(held, 1), 0.0), np.where(inside, law(held, 2), 0.0))

    def check(self, where: str) -> None:
        """Raise InputError for lists that do not match or times that do not increase."""
        if len(self.times) != len(self.values) or len(self.times) < 2:
            raise InputError(
                f"the spline has {len(self.times)} times and {len(self.values)} values; "
                "as many of each are needed, two at least",
                where=where,
            )
        increasing(np.array(self.times, dtype=float), where)
        if self.ends == "cycle" and abs(self.values[0] - self.values[-1]) > 1e-12 * max(map(abs, self.values)):
            raise InputError(
                f"the cycle does not close: it begins at {self.values[0]:g} and ends at {self.values[-1]:g}",
                where=where,
                hint="repeat the first value at the end, or use ends: rest",
            )


@dataclass(frozen=True, eq=False)
class Samples:
    """A quintic spline through recorded positions: smooth accelerations; fewer than six rows lower the degree."""

    times: Array
    values: Array

    def at(self, t: Array, duration: float, where: str) -> Jet:  # noqa: ARG002 - the protocol hands it over
        """The spline and its derivatives."""
        from scipy.interpolate import make_interp_spline

        law = make_interp_spline(self.times, self.values, k=min(5, (len(self.times) - 2) // 2 * 2 + 1))
        return Jet(law(t), law(t, 1), law(t, 2))

    def check(self, where: str) -> None:
        """Raise InputError for times that do not increase."""
        increasing(self.times, where)


@dataclass(frozen=True)
class Pieces:
    """Chebyshev series one after another: coefficients[k] holds from edges[k] to edges[k + 1], s."""

    edges: tuple[Time, ...]
    coefficients: tuple[tuple[Joint, ...], ...]

    def at(self, t: Array, duration: float, where: str) -> Jet:  # noqa: ARG002 - the protocol hands it over
        """The series and their derivatives."""
        edges = np.array(self.edges, dtype=float)
        which = np.clip(np.searchsorted(edges, t, side="right") - 1, 0, len(self.coefficients) - 1)
        parts = np.empty((3, *np.shape(t)))
        for k in np.unique(which):
            law = np.polynomial.Chebyshev(self.coefficients[k], domain=edges[k : k + 2].tolist())
            here = which == k
            parts[:, here] = law(t[here]), law.deriv(1)(t[here]), law.deriv(2)(t[here])
        return Jet(parts[0], parts[1], parts[2])

    def check(self, where: str) -> None:
        """Raise InputError for edges that do not increase or do not match."""
        if len(self.edges) != len(self.coefficients) + 1:
            raise InputError(
                f"{len(self.edges)} edges for {len(self.coefficients)} pieces; one more edge is needed", where=where
            )
        increasing(np.array(self.edges, dtype=float), where)


def increasing(times: Array, where: str) -> None:
    """Raise InputError, with the first row at fault, unless times increase."""
    wrong = np.flatnonzero(~(np.diff(times) > 0))
    if wrong.size:
        row = int(wrong[0]) + 1
        raise InputError(
            f"time does not increase: {times[row]:g} s follows {times[row - 1]:g} s in row {row + 1}",
            where=where,
            hint="sort the rows by time and remove repeated ones",
        )


def as_driver(value: Driver | Number | str) -> Driver:
    """A driver as it is, a number as a joint that stands still, text as an expression."""
    if isinstance(value, int | float):
        return TimePolynomial((float(value),))
    return Expression(value) if isinstance(value, str) else value
