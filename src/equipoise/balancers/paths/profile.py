"""Cam profiles: a lift by angle, as a smooth spline or in closed form."""

from __future__ import annotations

import csv
import functools
import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path as File
from typing import Any, Literal

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.units import Angle, Length, Number

FULL = 2.0 * math.pi
CLOSED = 1e-9
LEAST = 1e-3


class Lift(ABC):
    """What a cam's profile answers: lift and slope by angle, as pieces of cubics that a simulator can follow."""

    @property
    def turn(self) -> tuple[float, float] | None:
        """The angles between which it runs, rad; None for one that goes round and round."""
        return None

    @abstractmethod
    def __call__(self, u: Any) -> tuple[Any, Any]:
        """Lift and its derivative, m and m/rad, at angles u of any shape, real or complex."""

    @abstractmethod
    def pieces(self, u: Any) -> tuple[Array, Array]:
        """Where a cubic that is right at each angle u starts, rad, and its coefficients (4, ...), highest first."""

    def room(self, u: Any) -> Any:
        """How far, rad, angles u are inside the profile."""
        return np.full_like(u, np.inf)


@dataclass(frozen=True)
class ConstantEnergy(Lift):
    """The cam on which an ordinary spring keeps a weight's energy constant, in closed form.

        lift = base sqrt(1 - share cos u),   k lift^2 / 2 = k base^2 / 2 - (k base^2 share / 2) cos u

    A spring of rate k that is free at lift 0 balances a weight of V = W cos u exactly where k base^2 share = 2 W. base
    is the lift at u = 90 deg, m; share, between 0 and 1, is how much of the spring's energy comes and goes: little
    makes a round cam and a strong spring that never lets go, 1 would be a pointed cam and the least spring. Raises
    InputError for a share outside.
    """

    base: Length
    share: Number = 0.9

    def __post_init__(self) -> None:
        if isinstance(self.share, int | float) and not 0 < self.share < 1:
            raise InputError(
                f"the share of energy that comes and goes is {self.share:g}, it lies between 0 and 1",
                where="cam profile",
                hint="0.9 is a cam that can be made; at 1 it has a point",
            )

    def __call__(self, u: Any) -> tuple[Any, Any]:
        """Lift and its derivative."""
        lift = self.base * np.sqrt(1.0 - self.share * np.cos(u))
        return lift, 0.5 * self.base**2 * self.share * np.sin(u) / lift

    def pieces(self, u: Any) -> tuple[Array, Array]:
        """The tangent at each angle."""
        lift, slope = self(u)
        return u, np.stack([0.0 * lift, 0.0 * lift, slope, lift])


@dataclass(frozen=True)
class ConstantTorque(Lift):
    """The fusee: the cam on which an ordinary spring gives a constant torque, in closed form.

        lift = base sqrt(1 + share u),   k lift^2 / 2 = k base^2 / 2 + (k base^2 share / 2) u

    A spring of rate k that is free at lift 0 holds a constant torque of k base^2 share / 2 over any range of u > -1 /
    share; on a pinion or drum, a constant force along a slide. base is the lift at u = 0, m; share per rad. Raises
    InputError for a share of zero.
    """

    base: Length
    share: Number

    def __post_init__(self) -> None:
        if isinstance(self.share, int | float) and self.share == 0:
            raise InputError("a share of 0 is a round disc, which gives no torque", where="cam profile")

    def __call__(self, u: Any) -> tuple[Any, Any]:
        """Lift and its derivative."""
        lift = self.base * np.sqrt(self._inside(u))
        return lift, 0.5 * self.base**2 * self.share / lift

    def _inside(self, u: Any) -> Any:
        """1 + share u; of many candidates those that leave the cam's point stay just inside, and a limit says so."""
        square = 1.0 + self.share * u
        if np.ndim(square) < 2:
            worst = float(np.min(np.real(square)))
            if worst <= 0:
                beyond = -worst / abs(float(np.real(self.share)))
                raise InputError(
                    f"the cam turns {beyond:.4g} rad beyond its point, where the lift is 0",
                    where="cam profile",
                    hint="a smaller share, or a phase that keeps 1 + share u above 0",
                )
            return square
        return np.where(np.real(square) > LEAST, square, LEAST)

    def room(self, u: Any) -> Any:
        """How far, in share u, angles are from the cam's point."""
        return 1.0 + self.share * u - LEAST

    def pieces(self, u: Any) -> tuple[Array, Array]:
        """The tangent at each angle."""
        lift, slope = self(u)
        return u, np.stack([0.0 * lift, 0.0 * lift, slope, lift])

    @property
    def turn(self) -> tuple[float, float] | None:
        """Half a turn to either side, or from the point on."""
        far = 0.9 / abs(self.share)
        return (-min(math.pi, far), math.pi) if self.share > 0 else (-math.pi, min(math.pi, far))


@dataclass(frozen=True)
class Profile(Lift):
    """A cam's lift by angle: a cubic spline through (angles, lifts) with two continuous derivatives.

    angles rise, rad; lifts in m. `periodic`: the angles span one turn, the last lift repeats the first, and the
    spline joins on. `clamped`: it starts and ends with slope 0, as a dwell would ask for. `free`: it starts and ends
    as its neighbouring cubic does (not-a-knot). Beyond a profile that is not periodic there is no lift: InputError.
    """

    angles: tuple[Angle, ...]
    lifts: tuple[Length, ...]
    kind: Literal["periodic", "clamped", "free"] = "periodic"

    def __post_init__(self) -> None:
        where = "cam profile"
        if len(self.angles) != len(self.lifts):
            raise InputError(f"{len(self.angles)} angles and {len(self.lifts)} lifts", where=where)
        if len(self.angles) < 4:
            raise InputError(f"{len(self.angles)} points make no profile", where=where, hint="give at least 4")
        steps = np.diff(self.angles)
        if not (steps > 0).all():
            worst = int(np.argmin(steps))
            raise InputError(
                f"the angles do not rise: {math.degrees(self.angles[worst]):.6g} deg is followed by "
                f"{math.degrees(self.angles[worst + 1]):.6g} deg",
                where=where,
            )
        if self.kind == "periodic":
            span = self.angles[-1] - self.angles[0]
            if abs(span - FULL) > 1e-6:
                raise InputError(
                    f"a periodic profile spans 360 deg, this one {math.degrees(span):.6g} deg",
                    where=where,
                    hint="close the turn, or say `kind: clamped`",
                )
            gap = abs(self.lifts[-1] - self.lifts[0])
            if gap > CLOSED:
                raise InputError(
                    f"the last lift differs from the first by {gap * 1e3:.4g} mm, so the profile does not join on",
                    where=where,
                    hint="repeat the first lift at the end, or say `kind: clamped`",
                )

    @staticmethod
    def csv(file: File, kind: Literal["periodic", "clamped", "free"] = "periodic") -> Profile:
        """Read a profile from a CSV file of two columns: angle in deg, lift in mm; one heading line may lead."""
        try:
            with File(file).open(newline="", encoding="utf-8-sig") as stream:
                rows = [row for row in csv.reader(stream) if row and not row[0].lstrip().startswith("#")]
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"the profile cannot be read: {error}", where=str(file)) from None
        table = []
        for number, row in enumerate(rows, 1):
            try:
                angle, lift = (float(cell) for cell in row[:2])
            except ValueError:
                if number == 1:
                    continue
                raise InputError(
                    f"row {number} is {','.join(row)!r}, two numbers are needed",
                    where=str(file),
                    hint="columns are angle in deg and lift in mm",
                ) from None
            table.append((math.radians(angle), 1e-3 * lift))
        angles, lifts = zip(*table, strict=True) if table else ((), ())
        return Profile(angles, lifts, kind)

    @staticmethod
    def pitch(points: tuple[tuple[Length, Length], ...]) -> Profile:
        """The profile of a closed pitch curve (x, y), m, about the shaft, for an in-line follower.

        The follower's roller sits at the curve's radius: as the cam turns by u, lift(u) = rho(-u), with rho the
        radius at the angle from the mount's direction at which the curve's point lies. Points go once round,
        counter-clockwise, without repeating the first.
        """
        place = np.array(points, dtype=float)
        if place.ndim != 2 or len(place) < 3:
            raise InputError(f"{len(points)} points make no pitch curve", where="cam profile", hint="give at least 3")
        radius, turn = np.hypot(*place.T), np.unwrap(np.arctan2(place[:, 1], place[:, 0]))
        if not (np.diff(turn) > 0).all() or not turn[-1] - turn[0] < FULL:
            raise InputError(
                "the pitch curve does not go once round its shaft counter-clockwise",
                where="cam profile",
                hint="list the points in order; an in-line follower needs one radius per angle",
            )
        angles = np.append(-turn[::-1], -turn[-1] + FULL)
        lifts = np.append(radius[::-1], radius[-1])
        return Profile(tuple(angles.tolist()), tuple(lifts.tolist()))

    def __call__(self, u: Any) -> tuple[Array, Array]:
        """Lift and its derivative, m and m/rad, at angles u of any shape, real or complex."""
        start, (c3, c2, c1, c0) = self.pieces(u)
        x = u - start
        return ((c3 * x + c2) * x + c1) * x + c0, (3 * c3 * x + 2 * c2) * x + c1

    def pieces(self, u: Any) -> tuple[Array, Array]:
        """Where the cubic at each angle u starts, rad, and its coefficients (4, ...), highest power first."""
        knots, table = _spline(self)
        turns = (
            FULL * np.floor((np.real(u) - knots[0]) / FULL) if self.kind == "periodic" else np.zeros_like(np.real(u))
        )
        inside = np.real(u) - turns
        if np.ndim(inside) < 2:
            self._insist(inside)
        piece = np.clip(np.searchsorted(knots, inside, side="right") - 1, 0, len(knots) - 2)
        return knots[piece] + turns, table[:, piece]

    @property
    def turn(self) -> tuple[float, float] | None:
        """The angles between which it runs, rad; None where it is periodic."""
        return None if self.kind == "periodic" else (self.angles[0], self.angles[-1])

    def room(self, u: Any) -> Any:
        """How far, rad, angles u are inside the profile, which a periodic one always is."""
        if self.kind == "periodic":
            return np.full_like(u, np.inf)
        middle, half = 0.5 * (self.angles[0] + self.angles[-1]), 0.5 * (self.angles[-1] - self.angles[0])
        return half - (u - middle) * np.where(np.real(u) < middle, -1.0, 1.0)

    def _insist(self, u: Any) -> None:
        """One geometry must stay inside; of many candidates the limits of `shape` judge."""
        low, high = self.angles[0], self.angles[-1]
        room = self.room(u)
        if np.any(room < -1e-9):
            worst = float(np.ravel(u)[int(np.argmin(room))])
            raise InputError(
                f"the cam turns to {math.degrees(worst):.6g} deg, its profile runs from {math.degrees(low):.6g} to "
                f"{math.degrees(high):.6g} deg",
                where="cam profile",
                hint="extend the profile, change the phase, or sweep less",
            )


@functools.lru_cache(maxsize=64)
def _spline(profile: Profile) -> tuple[Array, Array]:
    """Knots (K,) and coefficients (4, K - 1), highest power first."""
    from scipy.interpolate import CubicSpline

    knots, lifts = np.array(profile.angles, dtype=float), np.array(profile.lifts, dtype=float)
    if profile.kind == "periodic":
        lifts[-1] = lifts[0]
    ends = {"periodic": "periodic", "clamped": "clamped", "free": "not-a-knot"}[profile.kind]
    spline = CubicSpline(knots, lifts, bc_type=ends)
    return knots, np.array(spline.c)
