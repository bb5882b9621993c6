"""Guide pulleys that swivel about the run that reaches them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths.pulley import Spatial, check_wheel
from equipoise.balancers.paths.taut import Node
from equipoise.mechanism import Mechanism, Point
from equipoise.states import States
from equipoise.units import Length, Mass

ASIDE = 1e-12
"""m: how near the line it swivels about a cable's next place has no side any more."""


@dataclass(frozen=True)
class Swivel:
    """A pulley whose fork turns about the run that reaches it, so that its plane follows the cable wherever it leads.

        c = at + radius e,   e = (h - (h . u) u) / |h - (h . u) u|,   h from at to the cable's next place

    The run from the place before, on the same body, meets the pulley at `at` (body's own frame, m) along u; c is its
    centre, radius that of the cable's centre line. So the cable turns from 0 to 360 deg about u freely, which also is
    what a ring of rollers or a rounded lip does, and in a plane two rollers side by side. Once it leads straight back
    it meets itself. radius 0 is an eye; mass in kg, at `at`.
    """

    body: str
    at: Spatial = (0.0, 0.0, 0.0)
    radius: Length = 0.0
    mass: Mass = 0.0

    @property
    def centre(self) -> Point:
        """Where the run meets it, as a point of its body."""
        return Point(self.body, self.at)

    def check(self, mechanism: Mechanism, where: str) -> None:
        """Raise InputError for a body that is not there, a negative radius or mass."""
        mechanism.body_id(self.body)
        check_wheel(self.radius, self.mass, where)

    def node(self, states: States, before: Array, after: Array) -> Node:
        """The pulley between the places (..., N, 3) before and after it."""
        position, jacobian = states.point(self.centre)
        if not np.any(np.real(self.radius)):
            return Node(position, jacobian)
        along, aside = directions(before, position, after)
        local = np.einsum("nij,...ni->...nj", states.rotation(self.body)[0], aside)
        radius = np.asarray(self.radius)
        x, y, z = (np.asarray(self.at[i]) + radius * local[..., i] for i in range(3))
        centre = states.point(Point(self.body, (x, y, z)))
        return Node(*centre, radius, np.cross(along, aside), np.pi / 2)


def directions(before: Array, position: Array, after: Array) -> tuple[Array, Array]:
    """Unit vectors (..., N, 3) along the run that reaches a place, and square to it towards the next one."""
    along = position - before
    along = along / np.sqrt((along * along).sum(-1))[..., None]
    gap = after - position
    aside = gap - (gap * along).sum(-1)[..., None] * along
    size = np.sqrt((aside * aside).sum(-1))
    lost = np.real(size) < ASIDE
    if lost.any():
        # Straight ahead every side serves as well.
        spare = np.real(np.cross(along, np.eye(3)[np.abs(np.real(along)).argmin(-1)]))
        spare = spare / np.linalg.norm(spare, axis=-1)[..., None]
        aside, size = np.where(lost[..., None], spare, aside), np.where(lost, 1.0, size)
    return along, aside / size[..., None]
