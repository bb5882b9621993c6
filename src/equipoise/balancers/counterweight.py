"""Counterweights: masses whose place is given or found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np

from equipoise.affine import Affine, Array, Block, Unknown
from equipoise.balancers.paths.bodies import add_point_mass
from equipoise.balancers.spring import STORAGE
from equipoise.errors import InputError, nearest
from equipoise.loops import ancestors
from equipoise.mechanism import Mechanism, Point
from equipoise.states import States
from equipoise.units import Length, Mass

MOMENTS = ("mx", "my", "mz")


@dataclass(frozen=True)
class Counterweight:
    """A mass on a body, at a given point or, with `reach`, anywhere within a cube about that point.

    effort = m (-g . J(p)) + sum_i m_i (-g . dJ/dr_i): the moments m_i = m (r - p)_i make a free place affine.
    at is the point p (link frame, m); mass in kg, None where unknown; reach in m bounds |r_i - p_i|, None
    keeps the weight at p. Unknowns are name.m (kg) and name.mx, my, mz (kg m).
    """

    name: str
    at: Point
    mass: Mass | None = None
    reach: Length | None = None
    like: str | None = None

    @property
    def owner(self) -> str:
        """The name that the unknowns carry."""
        return self.like or self.name

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Mass, and the three first moments where the place is free."""
        mass = () if self.mass is not None else (Unknown(f"{self.owner}.m", "kg", lower=0.0),)
        moments = () if self.reach is None else tuple(Unknown(f"{self.owner}.{axis}", "kg m") for axis in MOMENTS)
        return mass + moments

    def check(self, mechanism: Mechanism) -> None:
        """Raise InputError for a body that is not there or cannot move, or a reach that is not a length."""
        if not ancestors(mechanism.model, mechanism.body_id(self.at.body)):
            raise InputError(
                f"counterweight {self.name} sits on {self.at.body}, which no joint moves",
                where=f"counterweight {self.name}",
                hint="put it on a moving body",
            )
        if self.reach is not None and not self.reach > 0:
            raise InputError(f"the reach is {self.reach:g} m, it must be positive", where=f"counterweight {self.name}")

    def effort(self, states: States, goal: str) -> Affine:
        """The counterweight's share of `hold` (per driven joint), `energy` or `storage` (J)."""
        if goal == "hold":
            blocks, columns = states.mechanism.driven_blocks, self._columns(states, states.weight_effort)
        elif goal == "energy":
            blocks = (Block("energy", "J"),)
            columns = [column[..., None] for column in self._columns(states, states.weight_energy)]
        elif goal == "storage":
            # A weight stores no elastic energy; what it costs is counted as m |g| over one metre.
            blocks = (STORAGE,)
            size = np.full((len(states), 1), float(np.linalg.norm(states.mechanism.gravity)))
            columns = [size] + [0.0 * size] * (len(self._columns(states, states.weight_energy)) - 1)
        else:
            raise InputError(f"there is no goal {goal!r}", hint=nearest(goal, ["hold", "energy", "storage"]))
        if self.mass is None:
            return Affine(blocks, np.zeros_like(columns[0]), self.unknowns, np.stack(columns, axis=-1))
        wide = np.stack(columns[1:], axis=-1) if columns[1:] else np.zeros((*columns[0].shape, 0))
        return Affine(blocks, self.mass * columns[0], self.unknowns, wide)

    def _columns(self, states: States, answer: object) -> list[Array]:
        """Effort or energy per kg at the point, then per kg m along each axis of the body."""
        base = answer(self.at, 1.0)  # type: ignore[operator]
        columns = [np.asarray(base)]
        if self.reach is not None:
            x, y, z = self.at.at
            for shifted in (
                Point(self.at.body, (x + 1, y, z)),
                Point(self.at.body, (x, y + 1, z)),
                Point(self.at.body, (x, y, z + 1)),
            ):
                columns.append(answer(shifted, 1.0) - base)  # type: ignore[operator]
        return columns

    def place(self, values: Mapping[str, float]) -> tuple[float, Array]:
        """Mass, kg, and position (3,), m in the body's frame, for given values of the unknowns."""
        mass = float(values[f"{self.owner}.m"] if self.mass is None else self.mass)
        where = np.array(self.at.at, dtype=float)
        if self.reach is not None and mass > 0:
            where = where + np.array([values[f"{self.owner}.{axis}"] for axis in MOMENTS]) / mass
        return mass, where

    def install(self, spec: mujoco.MjSpec, values: Mapping[str, float], states: States) -> None:  # noqa: ARG002
        """Add the counterweight to a MuJoCo model as a body of its own."""
        mass, where = self.place(values)
        add_point_mass(spec, self.name, self.at.body, where, mass)
