"""Where a mechanism of cranks and sliders sits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism, Point
from equipoise.states import States
from equipoise.units import Number

SQUARE = 1e-9


@dataclass(frozen=True)
class Mount:
    """The frame of a crank: its shaft at a point of a body, where it points at angle zero, and about what it turns.

        p = at + x e + y (a x e)

    at is the shaft's point (body's own frame, m); direction e and axis a are vectors of the same body, of any
    length and square to each other: e is where the crank points at angle zero, angles count positive about a. The
    defaults are those of planar mechanisms: from +x counter-clockwise in x-z.
    """

    at: Point
    direction: tuple[Number, Number, Number] = (1.0, 0.0, 0.0)
    axis: tuple[Number, Number, Number] = (0.0, -1.0, 0.0)

    @property
    def frame(self) -> tuple[Array, Array, Array]:
        """Unit vectors e, a x e and a (3,) in the body's frame."""
        e, a = (np.array(v, dtype=float) / np.linalg.norm(v) for v in (self.direction, self.axis))
        return e, np.cross(a, e), a

    def check(self, mechanism: Mechanism, where: str) -> None:
        """Raise InputError for a body that is not there, and for vectors that are zero or not square."""
        mechanism.body_id(self.at.body)
        for what, vector in (("direction", self.direction), ("axis", self.axis)):
            if not np.linalg.norm(vector) > 0 or not np.isfinite(vector).all():
                raise InputError(f"the {what} of the mount is {tuple(vector)}, which points nowhere", where=where)
        cosine = float(self.frame[0] @ self.frame[2])
        if abs(cosine) > SQUARE:
            raise InputError(
                f"direction and axis of the mount stand at {np.degrees(np.arccos(cosine)):.6g} deg, not at 90 deg",
                where=where,
                hint="direction is where the crank points at angle zero, so it is square to the axis",
            )

    def point(self, x: Any, y: Any) -> Point:
        """The point (x, y) of the mount's plane, m, in its body's frame."""
        e, f, _ = self.frame
        return Point(self.at.body, tuple(self.at.at[i] + x * e[i] + y * f[i] for i in range(3)))

    def moving(self, states: States, place: tuple[Any, Any], pace: tuple[Any, Any], rate: Array) -> tuple[Array, Array]:
        """World position and Jacobian of a point at (x, y) that moves by (dx, dy)/du as u moves by rate du/dq."""
        position, jacobian = states.point(self.point(*place))
        e, f, _ = self.frame
        turned = states.rotation(self.at.body)[0]
        drift = np.asarray(pace[0])[..., None] * (turned @ e) + np.asarray(pace[1])[..., None] * (turned @ f)
        return position, jacobian + drift[..., None] * rate[..., None, :]


def along_mount(at: Point, direction: Array) -> Mount:
    """A mount at a point whose direction is given and whose axis is any square to it."""
    e = np.asarray(direction, dtype=float) / np.linalg.norm(direction)
    axis = np.cross(e, np.eye(3)[int(np.abs(e).argmin())])
    return Mount(at, tuple(e.tolist()), tuple((axis / np.linalg.norm(axis)).tolist()))
