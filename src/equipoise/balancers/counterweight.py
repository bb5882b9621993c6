"""Counterweights: masses whose place, and whose distribution, are given or found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Affine, Array, Block, Unknown
from equipoise.balancers.paths.bodies import add_point_mass
from equipoise.balancers.shapes import AXES, Disc, Plate, PointMass, Shape, Solid
from equipoise.balancers.spring import STORAGE
from equipoise.errors import InputError, nearest
from equipoise.loops import ancestors
from equipoise.mechanism import ANSWERED, Mechanism, Point
from equipoise.momentum import FORCE, MASS, MOMENT, inertial_effort, wrench
from equipoise.states import States
from equipoise.units import Length, Mass

MOMENTS = ("mx", "my", "mz")
POINT = PointMass()
SECOND = (("sxx", 0, 0), ("syy", 1, 1), ("szz", 2, 2), ("sxy", 0, 1), ("sxz", 0, 2), ("syz", 1, 2))


@dataclass(frozen=True)
class Counterweight:
    """A mass on a body, at a given point or, with `reach`, anywhere within a cube about that point.

    effort = m (-g . J(p)) + sum_i m_i (-g . dJ/dr_i): the moments m_i = m (r - p)_i make a free place affine.
    at is the point p (link frame, m); mass in kg, None where unknown; reach in m bounds |r_i - p_i|, None
    keeps the weight at p. shape is what its inertia follows: a PointMass, a Disc, or with reach a Plate or a
    Solid, whose second moments about p are unknowns within what a body can have. Unknowns are name.m (kg),
    name.mx, my, mz (kg m), name.J (Plate) or name.sxx ... syz (Solid, kg m^2).
    """

    name: str
    at: Point
    mass: Mass | None = None
    reach: Length | None = None
    shape: Shape = POINT
    like: str | None = None

    @property
    def owner(self) -> str:
        """The name that the unknowns carry."""
        return self.like or self.name

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Mass, the first moments where the place is free, the second ones where the distribution is."""
        found = [] if self.mass is not None else [Unknown(f"{self.owner}.m", "kg", lower=0.0)]
        found += [Unknown(f"{self.owner}.{MOMENTS[i]}", "kg m") for i in self.directions]
        found += [Unknown(f"{self.owner}.{name}", "kg m^2") for name, _ in self.second]
        return tuple(found)

    @property
    def directions(self) -> tuple[int, ...]:
        """Axes of the body along which the place is free."""
        if self.reach is None:
            return ()
        across = AXES.index(self.shape.axis) if isinstance(self.shape, Plate) else -1
        return tuple(i for i in range(3) if i != across)

    @property
    def second(self) -> tuple[tuple[str, Array], ...]:
        """Names of the free second moments and what (4, 4) one kg m^2 of each adds about the point."""
        found: list[tuple[str, Array]] = []
        if isinstance(self.shape, Plate):
            spread = np.zeros((4, 4))
            for i in self.directions:
                spread[i, i] = 0.5
            found.append(("J", spread))
        if isinstance(self.shape, Solid):
            for name, i, j in SECOND:
                spread = np.zeros((4, 4))
                spread[i, j] = spread[j, i] = 1.0
                found.append((name, spread))
        return tuple(found)

    def check(self, mechanism: Mechanism) -> None:
        """Raise InputError for a body that is not there or cannot move, or a shape that cannot be."""
        where = f"counterweight {self.name}"
        body = mechanism.body_id(self.at.body)
        if not ancestors(mechanism.model, body):
            raise InputError(
                f"counterweight {self.name} sits on {self.at.body}, which no joint moves",
                where=where,
                hint="put it on a moving body",
            )
        if self.reach is not None and not self.reach > 0:
            raise InputError(f"the reach is {self.reach:g} m, it must be positive", where=where)
        if isinstance(self.shape, Plate | Solid) and self.reach is None:
            raise InputError(
                "a free distribution needs room: the reach is missing", where=where, hint="add `reach: 50 mm`"
            )
        if isinstance(self.shape, Disc) and self.reach is not None:
            raise InputError(
                "a disc with a free place is not affine in its unknowns",
                where=where,
                hint="give the place and no reach, free the place in `shape`, or use shape: plate",
            )
        if isinstance(self.shape, Plate) and not moves_in_plane(mechanism, body, AXES.index(self.shape.axis)):
            raise InputError(
                f"{self.at.body} does not move in the plane across its {self.shape.axis} axis",
                where=where,
                hint="use shape: solid, or name the axis that its motion turns about",
            )

    def effort(self, states: States, goal: str) -> Affine:
        """The counterweight's share of a goal.

        `hold`, `drive` per driven joint; `force`, `moment` about the world origin; `mass`, kg; `energy`, J;
        `storage`: what it costs, m |g| over one metre, J.
        """
        if goal in ("hold", "energy"):
            answer = states.weight_effort if goal == "hold" else states.weight_energy
            blocks, columns = states.mechanism.driven_blocks, self._columns(answer)
            if goal == "energy":
                blocks, columns = (Block("energy", "J"),), [column[..., None] for column in columns]
            columns += [0.0 * columns[0]] * len(self.second)
        elif goal in ("storage", "mass"):
            # A weight stores no elastic energy; what it costs is counted as m |g| over one metre.
            blocks, rows = ((STORAGE,), len(states)) if goal == "storage" else ((MASS,), 1)
            scale = float(np.linalg.norm(states.mechanism.gravity)) if goal == "storage" else 1.0
            others = len(self.directions) + len(self.second)
            columns = [np.full((rows, 1), scale)] + [np.zeros((rows, 1))] * others
        elif goal in ("drive", "force", "moment"):
            return self._moving(states, goal)
        else:
            raise InputError(f"there is no goal {goal!r}", hint=nearest(goal, ANSWERED))
        return self._affine(blocks, np.stack(columns, axis=-1))

    def _affine(self, blocks: tuple[Block, ...], columns: Array) -> Affine:
        """Columns (..., N, R, 1 + rest) as an affine; the mass is known or an unknown."""
        if self.mass is None:
            return Affine(blocks, np.zeros_like(columns[..., 0]), self.unknowns, columns)
        return Affine(blocks, self.mass * columns[..., 0], self.unknowns, columns[..., 1:])

    def _moving(self, states: States, goal: str) -> Affine:
        if self.reach is not None and isinstance(self.shape, PointMass) and goal != "force":
            raise InputError(
                f"the {goal} of a point mass with a free place is not affine in its unknowns",
                where=f"counterweight {self.name}",
                hint="use shape: plate (or solid), give the place and no reach, or free the place in `shape`",
            )
        if goal == "drive":
            hold = self.effort(states, "hold")
            inertia = self._affine(hold.blocks, inertial_effort(states, self.at.body, self.basis))
            return replace(hold, b=hold.b + inertia.b, A=hold.A + inertia.A)
        first, block = (0, FORCE) if goal == "force" else (3, MOMENT)
        return self._affine((block,), wrench(states.placement(self.at.body), self.basis)[..., first : first + 3, :])

    @property
    def basis(self) -> Array:
        """Pseudo-inertia (..., 1 + rest, 4, 4) in the body's frame of one kg at the point, one kg m, one kg m^2."""
        at = np.stack(np.broadcast_arrays(*self.at.at), axis=-1)
        at = at[..., 0, :] if at.ndim > 1 else at  # candidates carry an axis for the states
        x = np.concatenate([at, np.ones((*at.shape[:-1], 1))], axis=-1)
        point = x[..., :, None] * x[..., None, :]
        if isinstance(self.shape, PointMass | Disc):
            point = point.copy()
            point[..., :3, :3] += self.shape.own()
        columns = [point]
        for i in self.directions:
            along = np.eye(4)[i]
            columns.append(along[:, None] * x[..., None, :] + x[..., :, None] * along)
        columns += [np.broadcast_to(spread, point.shape) for _, spread in self.second]
        return np.stack(columns, axis=-3)

    def _columns(self, answer: Any) -> list[Array]:
        """Effort or energy per kg at the point, then per kg m along each free axis of the body."""
        base = answer(self.at, 1.0)
        columns = [np.asarray(base)]
        for i in self.directions:
            at = list(self.at.at)
            at[i] = at[i] + 1
            columns.append(answer(Point(self.at.body, (at[0], at[1], at[2])), 1.0) - base)
        return columns

    def place(self, values: Mapping[str, float]) -> tuple[float, Array]:
        """Mass, kg, and position (3,), m in the body's frame, for given values of the unknowns."""
        mass = float(values[f"{self.owner}.m"] if self.mass is None else self.mass)
        where = np.array(self.at.at, dtype=float)
        if mass > 0:
            for i in self.directions:
                where[i] += values[f"{self.owner}.{MOMENTS[i]}"] / mass
        return mass, where

    def inertia(self, values: Mapping[str, float]) -> Array:
        """Inertia (3, 3) about its own centre of mass along the body's axes, kg m^2."""
        mass, where = self.place(values)
        if isinstance(self.shape, PointMass | Disc):
            own = mass * self.shape.own()
        else:
            arm = where - np.array(self.at.at, dtype=float)
            spread = sum(values[f"{self.owner}.{name}"] * matrix for name, matrix in self.second)
            own = np.asarray(spread)[:3, :3] - mass * np.outer(arm, arm)
            if isinstance(self.shape, Plate):  # only the polar moment is meant: spread it evenly in the plane
                plane = np.diag([float(i in self.directions) for i in range(3)])
                own = 0.5 * np.trace(own) * plane
        return np.trace(own) * np.eye(3) - own

    def settled(self, values: Mapping[str, float]) -> Counterweight:
        """The same weight with its place known, where a free point mass has found it."""
        if self.reach is None or not isinstance(self.shape, PointMass):
            return self
        mass, where = self.place(values)
        x, y, z = where.tolist()
        return replace(self, at=Point(self.at.body, (x, y, z)), mass=mass, reach=None)

    def install(self, spec: mujoco.MjSpec, values: Mapping[str, float], states: States) -> None:  # noqa: ARG002
        """Add the counterweight to a MuJoCo model as a body of its own."""
        mass, where = self.place(values)
        add_point_mass(spec, self.name, self.at.body, where, mass, self.inertia(values))


def moves_in_plane(mechanism: Mechanism, body: int, axis: int) -> bool:
    """Whether every joint that moves a body turns about its `axis`, or slides across it."""
    model = mechanism.model
    data = mujoco.MjData(model)
    data.qpos[:] = mechanism.reference
    mujoco.mj_kinematics(model, data)
    normal = data.xmat[body].reshape(3, 3)[:, axis]
    joints = {int(model.dof_jntid[dof]) for dof in ancestors(model, body)}
    for joint in joints:
        along = abs(float(data.xaxis[joint] @ normal))
        kind = model.jnt_type[joint]
        turns = kind == mujoco.mjtJoint.mjJNT_HINGE and along > 1 - 1e-9
        slides = kind == mujoco.mjtJoint.mjJNT_SLIDE and along < 1e-9
        if not (turns or slides):
            return False
    return True
