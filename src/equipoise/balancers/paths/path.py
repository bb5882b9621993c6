"""What every path answers: how a deformation follows the mechanism, what it weighs, how it is built and drawn."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import mujoco

from equipoise.affine import Array
from equipoise.balancers.paths.rub import Rub
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism, Point
from equipoise.states import Spot, States

Place = Point | Spot


@dataclass(frozen=True)
class Moving:
    """A spot said by two functions."""

    where: Callable[[States], tuple[Array, Array]]
    carrier: Callable[[mujoco.MjModel, str], Point]

    def locate(self, states: States) -> tuple[Array, Array]:
        """World position and Jacobian."""
        return self.where(states)

    def seat(self, model: mujoco.MjModel, name: str) -> Point:
        """The point that carries the spot in a model."""
        return self.carrier(model, name)


@dataclass(frozen=True)
class Run:
    """A deformation that follows one straight distance: l = ratio |p_a - p_b| + offset; offset in m."""

    a: Point
    b: Point
    ratio: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, eq=False)
class Need:
    """What a geometry must keep at every state: room (..., N) >= 0, in `unit`, of the size `scale`."""

    limit: str
    unit: str
    room: Array
    scale: float


@dataclass(frozen=True, eq=False)
class Sketch:
    """How a path looks in one state: world coordinates, m.

    spring (2, 3) are the ends of the spring itself; bars (P, 3) each are rigid members, lines (P, 3) each cables
    and guides, discs are (centre (3,), radius, axis (3,)) of pulleys, spirals (centre, axis) of springs that wind
    about a shaft; anchors are the points by which the path hangs on links.
    """

    spring: Array | None = None
    bars: tuple[Array, ...] = ()
    lines: tuple[Array, ...] = ()
    discs: tuple[tuple[Array, float, Array], ...] = ()
    spirals: tuple[tuple[Array, Array], ...] = ()
    anchors: tuple[Point, ...] = ()

    @property
    def points(self) -> list[Array]:
        """All points, each (3,)."""
        found = [place for line in (*self.bars, *self.lines) for place in line] + [place for place, _ in self.spirals]
        return found + list(() if self.spring is None else self.spring)


class Path(ABC):
    """How a spring's deformation l follows the mechanism: l and dl/dq exact, in m or rad.

    Numbers in a path may be complex or carry a leading candidate axis (C, 1); l and dl/dq follow.
    """

    unit: Literal["m", "rad"] = "m"

    @abstractmethod
    def deform(self, states: States) -> tuple[Array, Array]:
        """Deformation l (..., N), m or rad, and its derivative dl/dq_driven (..., N, nd)."""

    def run(self, states: States) -> Run | None:  # noqa: ARG002 - most paths are more than one distance
        """The one straight distance that l follows, whose square is affine in (cos q, sin q) of every hinge."""
        return None

    def along(self, length: Any) -> tuple[Any, Any]:  # noqa: ARG002 - only what hangs on a cable follows it
        """Deformation l (..., M) and dl/dc at lengths c (M,) of the cable that drives it; InputError without one."""
        raise InputError(
            "the spring hangs on no cable, so it gives none a tension",
            hint="use path reel, or another that a winding drives",
        )

    @abstractmethod
    def ends(self) -> tuple[tuple[Place, float], ...]:
        """Places that carry the spring's own mass, with their shares."""

    def weights(self) -> tuple[tuple[Place, Any], ...]:
        """Places and masses, kg, of the path's own parts."""
        return ()

    def rubs(self, states: States) -> tuple[Rub, ...]:  # noqa: ARG002 - a joint's own angle rubs nowhere else
        """Where the path rubs, at the states of one geometry."""
        return ()

    @abstractmethod
    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError where the path of spring `name` cannot act on the mechanism."""

    def needs(self, states: States) -> tuple[Need, ...]:  # noqa: ARG002 - what others need depends on the states
        """What many geometries must keep, for `shape`; a single one has none and raises InputError instead."""
        return ()

    @abstractmethod
    def install(self, spec: mujoco.MjSpec, name: str, states: States) -> mujoco.MjsTendon:
        """Add the path's parts to a model, made for the motion of the states, and a tendon whose length is l."""

    def positions(self, states: States, name: str) -> dict[str, Array]:  # noqa: ARG002
        """Positions (N,) of the joints that `install` adds, by name: where the added loops are closed from."""
        return {}

    def notes(self, states: States, name: str) -> tuple[str, ...]:  # noqa: ARG002
        """What a user of the saved model must know."""
        return ()

    def laws(self, states: States, name: str) -> dict[str, Array]:  # noqa: ARG002
        """Coefficients (N, 5) of joint equalities that `install` adds and one polynomial cannot say, by name."""
        return {}

    @abstractmethod
    def sketch(self, states: States, row: int) -> Sketch:
        """How the path looks in one state."""
