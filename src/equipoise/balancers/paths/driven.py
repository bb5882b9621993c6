"""Mechanisms that an angle drives: their output follows one crank angle."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import bodies
from equipoise.balancers.paths.inputs import check_angle
from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.path import Moving, Path, Place
from equipoise.balancers.paths.rub import Kind, Rub, of_crank, turning
from equipoise.balancers.paths.shaft import Shaft
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism, Point
from equipoise.parameters import tag
from equipoise.states import Spot, States

Values = Any


class Driven(Path):
    """A length that follows the angle u + phase of a crank: dl/dq = l'(u + phase) du/dq.

    input gives u, rad. mount says where the mechanism sits; where its parts have mass or its spring has, it must
    be given, else it stands at the input's own shaft.
    """

    input: Shaft
    phase: Any
    mount: Mount | None
    lengths = ""
    remedy = ""

    @abstractmethod
    def curve(self, u: Values) -> tuple[Values, Values]:
        """l and dl/du at crank angles u = input + phase."""

    def room(self, u: Values) -> Values:
        """How far, m, the lengths are from not closing at crank angles u; infinite where they always close."""
        return np.full_like(u, np.inf)

    def crank_angle(self, states: States) -> tuple[Array, Array]:
        """u + phase (..., N) and du/dq (..., N, nd)."""
        angle, rate = self.input.deform(states)
        return angle + self.phase, rate

    def deform(self, states: States) -> tuple[Array, Array]:
        """l (..., N), m, and dl/dq (..., N, nd); raises InputError naming the angle at which lengths do not close."""
        u, rate = self.crank_angle(states)
        self.insist(u)
        length, slope = self.curve(u)
        return length, slope[..., None] * rate

    def along(self, length: Values) -> tuple[Values, Values]:
        """The output at cable lengths and its derivative, where a winding is the input."""
        angle, rate = self.input.along(length)
        output, slope = self.curve(angle + self.phase)
        return output, slope * rate

    def insist(self, u: Array) -> None:
        """One geometry must close at every angle; of many candidates the limits of `shape` judge."""
        room = self.room(u)
        if room.ndim > 1 or not (np.real(room) < 0).any():
            return
        worst = int(np.real(room).argmin())
        where = np.degrees(float(np.real(u[worst] - self.phase)))
        raise InputError(
            f"the {tag(type(self)).replace('_', '-')} cannot close at an input angle of {where:.4g} deg: "
            f"{self.lengths}, {-float(np.real(room[worst])) * 1e3:.4g} mm are missing",
            where=tag(type(self)),
            hint=self.remedy,
        )

    def contacts(self, u: Array) -> tuple[tuple[Kind, Array, Array], ...]:
        """Contacts per N of the spring at crank angles u (N,): kind, load (N,), pace (N,) per rad of the crank."""
        return turning(u, ("pin", 1.0, 1.0))

    def rubs(self, states: States) -> tuple[Rub, ...]:
        """Its own contacts, and those of its input under the torque that it asks for."""
        u, rate = self.crank_angle(states)
        _, slope = self.curve(u)
        return (*of_crank(self.contacts(u), rate), *(rub.geared(slope) for rub in self.input.rubs(states)))

    def at(self, model: mujoco.MjModel) -> Mount:
        """The mount, given or at the input's shaft."""
        return self.input.shaft(model) if self.mount is None else self.mount

    def spot(self, place: Any, part: str) -> Spot:
        """A point that moves in the mount's plane: place(u) -> (x, y), (dx/du, dy/du); `part` names its body."""

        def where(states: States) -> tuple[Array, Array]:
            u, rate = self.crank_angle(states)
            position, pace = place(u)
            return self.at(states.mechanism.model).moving(states, position, pace, rate)

        return Moving(where, lambda _, name: Point(f"{name}_{part}"))

    def fixed(self, x: Any, y: Any) -> Spot:
        """A point of the mount's body, (x, y) in its plane."""

        def where(states: States) -> tuple[Array, Array]:
            return states.point(self.at(states.mechanism.model).point(x, y))

        return Moving(where, lambda model, _: self.at(model).point(x, y))

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for an input that is no angle, a mount that is none, masses without a mount."""
        what = tag(type(self)).replace("_", "-")
        check_angle(self.input, mechanism, name, what)
        if self.mount is not None:
            self.mount.check(mechanism, f"spring {name}")
        for _, mass in self.weights():
            if np.any(np.real(mass) < 0):
                raise InputError(f"a part of the {what} of spring {name} has negative mass", where=f"spring {name}")
        if self.mount is None and any(np.any(mass) for _, mass in self.weights()):
            raise InputError(
                f"the {what} of spring {name} has masses, but does not say where it sits",
                where=f"spring {name}",
                hint="give `mount: {at: [body, x, y, z], direction: [...], axis: [...]}`",
            )

    def weights(self) -> tuple[tuple[Place, Any], ...]:
        """Places and masses of cranks, rods and sliders."""
        return ()

    def drive(self, spec: mujoco.MjSpec, name: str, states: States, length: float) -> tuple[Any, Any]:
        """Add the mount's frame and the crank `<name>_crank` that the input turns; returns both bodies."""
        frame = bodies.add_frame(spec, self.at(states.mechanism.model), f"{name}_frame")
        return frame, self.input.crank(spec, frame, f"{name}_crank", states, self.phase, length)
