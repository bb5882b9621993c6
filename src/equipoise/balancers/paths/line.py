"""The straight line between two points."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths.bodies import add_site
from equipoise.balancers.paths.path import Path, Run, Sketch
from equipoise.balancers.paths.rub import Rub
from equipoise.errors import InputError
from equipoise.loops import ancestors
from equipoise.mechanism import Mechanism, Point
from equipoise.states import States


@dataclass(frozen=True)
class Line(Path):
    """A straight line between two points of two bodies.

    l = |p_a - p_b|, dl/dq = (p_a - p_b) . (J_a - J_b) / l; l in m, dl/dq (N, nd) in m/rad or m/m.
    Points are in the bodies' own link frames; `world` is the base.
    """

    a: Point
    b: Point

    def deform(self, states: States) -> tuple[Array, Array]:
        """Length l (..., N) and its derivative dl/dq_driven (..., N, nd).

        Where the ends coincide the direction is undefined; the derivative is zero there, which is what
        a zero-free-length spring needs.
        """
        position_a, jacobian_a = states.point(self.a)
        position_b, jacobian_b = states.point(self.b)
        gap = position_a - position_b
        length = np.sqrt((gap * gap).sum(-1))
        rate = np.einsum("...i,...ij->...j", gap, jacobian_a - jacobian_b)
        return length, rate / np.where(length == 0, 1.0, length)[..., None]

    def run(self, states: States) -> Run:  # noqa: ARG002 - the same at all states
        """Itself."""
        return Run(self.a, self.b)

    def rubs(self, states: States) -> tuple[Rub, ...]:
        """A pin at each end, which turns as the line swings against its body; a twist about the line is free."""
        (position_a, jacobian_a), (position_b, jacobian_b) = states.point(self.a), states.point(self.b)
        gap, pace = position_a - position_b, jacobian_a - jacobian_b
        square = np.maximum((gap * gap).sum(-1), 1e-18)[:, None, None]
        swing = np.cross(gap[..., None], pace, axis=1) / square
        one, found = np.ones(len(gap)), []
        for point in (self.a, self.b):
            against = swing - states.rotation(point.body)[1]
            twist = gap[..., None] * np.einsum("ni,nij->nj", gap, against)[:, None, :] / square
            found.append(Rub("pin", one, against - twist))
        return tuple(found)

    def ends(self) -> tuple[tuple[Point, float], ...]:
        """Points that carry the spring's own mass, with their shares."""
        return ((self.a, 0.5), (self.b, 0.5))

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError where no motion of the mechanism can change the length."""
        bodies = [mechanism.body_id(point.body) for point in (self.a, self.b)]
        if ancestors(mechanism.model, bodies[0]) == ancestors(mechanism.model, bodies[1]):
            same = self.a.body == self.b.body
            what = f"both on {self.a.body}" if same else f"on {self.a.body} and {self.b.body}, which move as one"
            raise InputError(
                f"the ends of spring {name} are {what}: its length never changes",
                where=f"spring {name}",
                hint="put the ends on two bodies with a joint between them",
            )

    def install(self, spec: mujoco.MjSpec, name: str, states: States) -> mujoco.MjsTendon:  # noqa: ARG002
        """Add the path to a model as a spatial tendon between two sites."""
        tendon = spec.add_tendon(name=name)
        for side, point in (("a", self.a), ("b", self.b)):
            tendon.wrap_site(add_site(spec, point, f"{name}_{side}").name)
        return tendon

    def sketch(self, states: States, row: int) -> Sketch:
        """The spring between its two ends."""
        ends = (self.a, self.b)
        return Sketch(spring=np.stack([states.point(point)[0][row] for point in ends]), anchors=ends)
