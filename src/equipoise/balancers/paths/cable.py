"""Cables over pulleys and through eyes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import bodies
from equipoise.balancers.paths.mount import along_mount
from equipoise.balancers.paths.path import Moving, Need, Path, Place, Run, Sketch
from equipoise.balancers.paths.pulley import Pulley
from equipoise.balancers.paths.rigging import guides, rig, wraps
from equipoise.balancers.paths.rub import Rub
from equipoise.balancers.paths.swivel import Swivel
from equipoise.balancers.paths.taut import CLOSE, Node, Taut, clearances, embraces, taut
from equipoise.errors import InputError
from equipoise.loops import ancestors
from equipoise.mechanism import Mechanism, Point
from equipoise.states import States
from equipoise.units import Length, Number


@dataclass(frozen=True)
class Cable(Path):
    """A taut cable from point to point over pulleys and through eyes.

        l = ratio L + offset,   L = sum_i t_i + sum_i r_i w_i,   dL/dq = sum_i t_i' . (J_i+1 - J_i)

    through lists Points, Pulleys and Swivels from the first end to the last, m; t_i are the straight runs between
    points and tangents, t_i' their directions, w_i the angles wrapped about pulleys of radius r_i, and J_i the
    Jacobians of points and centres: a sheave turns freely, so its pull goes through its centre. ratio is that of a
    tackle (no unit), offset in m: minus the cable's own length leaves the spring's. A pulley works in its plane; the
    cable lifts off where it would run straight past it. With ratio 1 and no offset the whole cable is the spring, an
    elastic cord; else the spring hangs on the first point and pulls the cable's end along the first run. Raises
    InputError for a cable that leaves a pulley's plane, a point inside a pulley and a wrap that may be a turn off.
    """

    through: tuple[Point | Pulley | Swivel, ...]
    ratio: Number = 1.0
    offset: Length = 0.0

    def deform(self, states: States) -> tuple[Array, Array]:
        """l (..., N), m, and dl/dq (..., N, nd)."""
        cable = self.taut(states)
        return self.ratio * cable.length + self.offset, np.asarray(self.ratio)[..., None] * cable.rate

    def taut(self, states: States) -> Taut:
        """The cable with its runs and wraps."""
        return taut(self._nodes(states))

    def run(self, states: States) -> Run | None:
        """The only run between bodies that move against each other, where the cable goes through eyes alone."""
        if any(wraps(item) for item in self.through):
            return None
        points = self.points
        model = states.mechanism.model
        groups = [ancestors(model, states.mechanism.body_id(point.body)) for point in points]
        moving = [index for index, (one, other) in enumerate(pairwise(groups)) if one != other]
        if len(moving) != 1:
            return None
        a, b = points[moving[0]], points[moving[0] + 1]
        apart = np.linalg.norm(states.point(a)[0][0] - states.point(b)[0][0])
        still = float(self.taut(states).length[0] - apart)
        return Run(a, b, float(self.ratio), float(self.ratio * still + self.offset))

    def embraces(self, states: States) -> list[tuple[int, Array, Array]]:
        """Place among `through`, wrap (..., N), rad, and its rate (..., N, nd) of each pulley, were none left."""
        return embraces(self._nodes(states))

    def clearances(self, states: States) -> list[tuple[Array, Array]]:
        """How far, m, the neighbours of pulleys are from their rims, and from their centres, (..., N)."""
        return clearances(self._nodes(states))

    def rubs(self, states: States) -> tuple[Rub, ...]:
        """Every sheave by the share of half a turn that the cable wraps; an eye by the angle it turns the cable.

        Of a tackle of n falls the i-th moves by i / n of the cable, over half a turn of a sheave: (n - 1) / 2 in all.
        """
        cable = self.taut(states)
        tackle = (1 - abs(float(self.ratio))) / 2
        found = [Rub("rope", np.full(len(cable.rate), tackle), cable.rate[:, None])] if tackle > 0 else []
        for index in range(1, len(self.through) - 1):
            before, after = cable.direction[:, index - 1], cable.direction[:, index]
            pace = cable.rate[:, None]
            if cable.nodes[index].wraps:
                wrap = np.maximum(cable.wrap[:, index], 0.0)
                found.append(Rub("rope", np.abs(self.ratio) * wrap / np.pi, pace))
            else:
                turn = np.arccos(np.clip((before * after).sum(-1), -1.0, 1.0))
                found.append(Rub("slide", np.abs(self.ratio) * turn, pace))
        return tuple(found)

    def ends(self) -> tuple[tuple[Place, float], ...]:
        """An elastic cord's two ends; of a cable with a spring the first point and the hook at l from it."""
        if self._cord:
            return ((self.points[0], 0.5), (self.points[-1], 0.5))
        return ((self.points[0], 0.5), (Moving(self._hook, lambda _, name: Point(f"{name}_hook")), 0.5))

    @property
    def _cord(self) -> bool:
        """Whether the spring is the whole cable."""
        plain = np.ndim(self.ratio) == 0 and np.ndim(self.offset) == 0
        return plain and self.ratio == 1 and self.offset == 0

    @property
    def points(self) -> tuple[Point, ...]:
        """The points that it passes, of pulleys their centres, of swivels where the run meets them."""
        return tuple(item if isinstance(item, Point) else item.centre for item in self.through)

    def _nodes(self, states: States) -> list[Node]:
        places = [states.point(point)[0] for point in self.points]
        nodes = []
        for index, item in enumerate(self.through):
            if isinstance(item, Swivel):
                nodes.append(item.node(states, places[index - 1], places[index + 1]))
            else:
                nodes.append(_node(item, states))
        return nodes

    def _hook(self, states: States) -> tuple[Array, Array]:
        length, rate = self.deform(states)
        first = self.points[0]
        mechanism = states.mechanism
        lead, follow = (ancestors(mechanism.model, mechanism.body_id(item.body)) for item in self.through[:2])
        if lead != follow:
            raise InputError(
                f"the spring has mass, and the cable's first run leads from {first.body} to {self.through[1].body}, "
                "which move against each other",
                where="cable",
                hint="put an eye (a pulley of radius 0) on the first body, so that the spring lies along that body",
            )
        along = self.taut(states).direction[..., 0, :]
        turned, _ = states.rotation(first.body)
        local = np.einsum("...ij,...i->...j", turned, along)
        x, y, z = (np.asarray(v) + length * local[..., i] for i, v in enumerate(first.at))
        position, jacobian = states.point(Point(first.body, (x, y, z)))
        return position, jacobian + along[..., :, None] * rate[..., None, :]

    def weights(self) -> tuple[tuple[Place, Any], ...]:
        """The pulleys."""
        return tuple((item.centre, item.mass) for item in self.through if not isinstance(item, Point))

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
            if wraps(item) or isinstance(item, Swivel):
                raise InputError(
                    f"the cable of spring {name} ends on a pulley, which it would run off",
                    where=where,
                    hint="end it at a point; where a drum winds it, use the path `drum`",
                )
        for number, item in enumerate(self.through, 1):
            if not isinstance(item, Point):
                item.check(mechanism, f"{where}, through {number}")
            if isinstance(item, Swivel):
                self._check_swivel(mechanism, number - 1, f"{where}, through {number}")
        if np.ndim(self.ratio) == 0 and self.ratio == 0:
            raise InputError(f"the ratio of the cable of spring {name} is 0", where=where)

    def _check_swivel(self, mechanism: Mechanism, index: int, where: str) -> None:
        """Raise InputError for a swivel that nothing fixed leads to, or beside another round pulley."""
        item, before, after = self.through[index], self.through[index - 1], self.through[index + 1]
        lead, follow = (ancestors(mechanism.model, mechanism.body_id(one.body)) for one in (before, item))
        if lead != follow:
            raise InputError(
                f"the run that reaches the swivel leads from {before.body} to {item.body}, which move against each "
                "other, so it is no line to swivel about",
                where=where,
                hint="put an eye on the swivel's body before it",
            )
        if wraps(before) or wraps(after):
            raise InputError("a swivel stands beside another round pulley", where=where, hint="put an eye between them")

    def needs(self, states: States) -> tuple[Need, ...]:
        """No point runs into a pulley."""
        return tuple(
            Need("clearance of the pulleys", "m", room - CLOSE * distance, float(np.real(distance).max()))
            for room, distance in self.clearances(states)
            if room.ndim > 1
        )

    def install(self, spec: mujoco.MjSpec, name: str, states: States) -> mujoco.MjsTendon:
        """A tendon over the same points and pulleys; where l is not its length, a hook on the first run reads l."""
        cable = self.taut(states)
        if self._cord:
            return rig(spec, name, self.through, cable, states)
        tendon = rig(spec, f"{name}_cable", self.through, cable, states)
        first = self.points[0]
        along = states.rotation(first.body)[0][0].T @ cable.direction[0, 0]
        frame = bodies.add_frame(spec, along_mount(first, along), f"{name}_frame")
        hook = bodies.add_body(frame, f"{name}_hook", bodies.NOTHING)
        bodies.add_joint(hook, f"{name}_hook", axis=bodies.SLIDING, slide=True)
        reading = bodies.read_joint(spec, name, f"{name}_hook")
        law = spec.add_equality(
            name=f"{name}_tackle",
            type=mujoco.mjtEq.mjEQ_TENDON,
            objtype=mujoco.mjtObj.mjOBJ_TENDON,
            name1=reading.name,
            name2=tendon.name,
        )
        start = bodies.zero_length(spec, tendon.name)
        law.data[:5] = [float(self.ratio) * start + float(self.offset), float(self.ratio), 0.0, 0.0, 0.0]
        return reading

    def positions(self, states: States, name: str) -> dict[str, Array]:
        """The guides between pulleys, and the hook."""
        cable = self.taut(states)
        if self._cord:
            return guides(self.through, cable, states, name)
        return {f"{name}_hook": self.deform(states)[0], **guides(self.through, cable, states, f"{name}_cable")}

    def sketch(self, states: States, row: int) -> Sketch:
        """The spring on the first run, the cable behind it, and the pulleys."""
        cable = self.taut(states)
        line = cable.outline(row)
        first, last = line[0], line[1]
        share = 0.45
        discs = tuple(
            (node.position[row], abs(float(node.turn)), node.normal[row])
            for node in cable.nodes
            if node.wraps and node.normal is not None
        )
        middle = first + share * (last - first)
        return Sketch(
            spring=np.stack([first, middle]), lines=(np.vstack([middle, line[1:]]),), discs=discs, anchors=self.points
        )


def _node(item: Point | Pulley, states: States) -> Node:
    if isinstance(item, Point):
        return Node(*states.point(item))
    position, jacobian = states.point(item.centre)
    axis = np.asarray(item.axis, dtype=float)
    normal = states.rotation(item.body)[0] @ (axis / np.linalg.norm(axis))
    return Node(position, jacobian, item.sense * np.asarray(item.radius), normal, item.nominal)
