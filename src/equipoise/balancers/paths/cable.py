"""Cables over pulleys and through eyes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import bodies
from equipoise.balancers.paths.path import Moving, Path, Place, Sketch
from equipoise.balancers.paths.pulley import Pulley
from equipoise.balancers.paths.taut import Node, Taut, taut
from equipoise.errors import InputError
from equipoise.loops import ancestors
from equipoise.mechanism import Mechanism, Point
from equipoise.states import States
from equipoise.units import Length, Number


@dataclass(frozen=True)
class Cable(Path):
    """A taut cable from point to point over pulleys and through eyes.

        l = ratio L + offset,   L = sum_i t_i + sum_i r_i w_i,   dL/dq = sum_i t_i' . (J_i+1 - J_i)

    through lists Points and Pulleys from the first end to the last, m; t_i are the straight runs between points and
    tangents, t_i' their directions, w_i the angles wrapped about pulleys of radius r_i, and J_i the Jacobians of
    points and centres: a sheave turns freely, so its pull goes through its centre. ratio is that of a tackle (no
    unit), offset in m: minus the cable's own length leaves the spring's. A pulley works in its plane; the cable
    lifts off where it would run straight past it, and a pulley holds up to 270 degrees. The spring sits on the first
    run, at its first point. Raises InputError for a cable that leaves a pulley's plane and for a point inside it.
    """

    through: tuple[Point | Pulley, ...]
    ratio: Number = 1.0
    offset: Length = 0.0

    def deform(self, states: States) -> tuple[Array, Array]:
        """l (..., N), m, and dl/dq (..., N, nd)."""
        cable = self.taut(states)
        return self.ratio * cable.length + self.offset, np.asarray(self.ratio)[..., None] * cable.rate

    def taut(self, states: States) -> Taut:
        """The cable with its runs and wraps."""
        return taut([_node(item, states) for item in self.through])

    def ends(self) -> tuple[tuple[Place, float], ...]:
        """The first point, and the spring's other end on the first run at l from it."""
        return ((self._first, 0.5), (Moving(self._hook, lambda _, name: Point(f"{name}_hook")), 0.5))

    @property
    def _first(self) -> Point:
        first = self.through[0]
        return first.centre if isinstance(first, Pulley) else first

    def _hook(self, states: States) -> tuple[Array, Array]:
        length, rate = self.deform(states)
        along = self.taut(states).direction[..., 0, :]
        turned, _ = states.rotation(self._first.body)
        local = np.einsum("...ij,...i->...j", turned, along)
        at = np.asarray([np.asarray(v) + length * local[..., i] for i, v in enumerate(self._first.at)])
        position, jacobian = states.point(Point(self._first.body, tuple(at)))
        return position, jacobian + along[..., :, None] * rate[..., None, :]

    def weights(self) -> tuple[tuple[Place, Any], ...]:
        """The pulleys."""
        return tuple((item.centre, item.mass) for item in self.through if isinstance(item, Pulley))

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for too few points, a cable whose length never changes, bad radii or masses."""
        where = f"spring {name}"
        if len(self.through) < 2:
            raise InputError(
                f"the cable of spring {name} runs through {len(self.through)} point, two are needed", where=where
            )
        moves = {tuple(ancestors(mechanism.model, mechanism.body_id(item.body))) for item in self.through}
        if len(moves) < 2:
            raise InputError(
                f"all of the cable of spring {name} moves as one, so its length never changes",
                where=where,
                hint="lead it over two bodies with a joint between them",
            )
        for item in (self.through[0], self.through[-1]):
            if isinstance(item, Pulley) and np.any(item.radius):
                raise InputError(
                    f"the cable of spring {name} ends on a pulley, which it would run off",
                    where=where,
                    hint="end it at a point; where a drum winds it, use the path `drum`",
                )
        for number, item in enumerate(self.through, 1):
            if isinstance(item, Pulley):
                item.check(mechanism, f"{where}, through {number}")
        if np.ndim(self.ratio) == 0 and self.ratio == 0:
            raise InputError(f"the ratio of the cable of spring {name} is 0", where=where)

    def install(self, spec: mujoco.MjSpec, name: str) -> mujoco.MjsTendon:
        """A tendon over the same points and pulleys."""
        tendon = spec.add_tendon(name=name)
        for number, item in enumerate(self.through):
            if isinstance(item, Pulley) and item.radius:
                geom = item.install(spec, f"{name}_{number}")
                tendon.wrap_geom(geom.name, "")
            else:
                point = item.centre if isinstance(item, Pulley) else item
                tendon.wrap_site(bodies.add_site(spec, point, f"{name}_{number}").name)
        return tendon

    def sketch(self, states: States, row: int) -> Sketch:
        """The spring on the first run, the cable behind it, and the pulleys."""
        cable = self.taut(states)
        line = cable.outline(row)
        first, last = line[0], line[1]
        share = 0.45
        discs = tuple(
            (states.point(item.centre)[0][row], float(item.radius), states.rotation(item.body)[0][row] @ item.axis)
            for item in self.through
            if isinstance(item, Pulley) and item.radius
        )
        middle = first + share * (last - first)
        return Sketch(spring=np.stack([first, middle]), lines=(np.vstack([middle, line[1:]]),), discs=discs)


def _node(item: Point | Pulley, states: States) -> Node:
    if isinstance(item, Point):
        return Node(*states.point(item))
    position, jacobian = states.point(item.centre)
    axis = np.asarray(item.axis, dtype=float)
    normal = states.rotation(item.body)[0] @ (axis / np.linalg.norm(axis))
    return Node(position, jacobian, item.sense * np.asarray(item.radius), normal)
