"""A flywheel on the base: it takes the moment over and returns it as its own law of rotation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal

import mujoco
import numpy as np

from equipoise.affine import Affine, Array, Block
from equipoise.balancers.spring import STORAGE
from equipoise.errors import InfeasibleError, InputError, nearest
from equipoise.mechanism import ANSWERED, Mechanism
from equipoise.momentum import FORCE, MASS, MOMENT
from equipoise.states import States
from equipoise.units import Inertia, Mass, Power, Speed, Torque

CLOSE = 1e-4
"""By how much, relatively, a motor's figures may be exceeded: sampled motions know their peaks no better."""
FINER = 12
"""Instants between two samples at which peaks are looked for."""


@dataclass(frozen=True)
class Flywheel:
    """A motor-driven inertia I on the base whose prescribed rotation cancels the moment about its axis n.

        I ddtheta = -n . M,   I dtheta = I w0 - n . (L - L(0)),   M and L those of everything else

    axis (3,) is in world axes; inertia in kg m^2, None for the smallest that keeps the motor within `speed`
    (rad/s) and `power` (W); the torque -n . M does not depend on I, `torque` (N m) is what the motor can give.
    start `rest` begins at w0 = 0, `turning` at the speed w0 that needs the smallest inertia (or, where that is given,
    the lowest speed). The moment along n is thereby no part of the objective; the law is `law(...)`
    [arakelian_smith_2008].
    """

    name: str
    inertia: Inertia | None = None
    axis: tuple[float, float, float] = (0.0, -1.0, 0.0)
    speed: Speed | None = None
    torque: Torque | None = None
    power: Power | None = None
    start: Literal["rest", "turning"] = "rest"
    mass: Mass = 0.0
    like: str | None = None
    sources: ClassVar[tuple[str, ...]] = ("arakelian_smith_2008",)

    owner = property(lambda self: self.name)
    unknowns = property(lambda _self: ())

    @property
    def normal(self) -> Array:
        """The unit axis (3,)."""
        axis = np.asarray(self.axis, dtype=float)
        return axis / np.linalg.norm(axis)

    def check(self, mechanism: Mechanism) -> None:  # noqa: ARG002 - the protocol hands it over
        """Raise InputError for an axis without direction or motor limits that say nothing of the inertia."""
        where = f"flywheel {self.name}"
        if len(self.axis) != 3 or not np.linalg.norm(self.axis) > 0:
            raise InputError(f"the axis {self.axis} has no direction", where=where, hint="axis: [0, -1, 0]")
        if self.start not in ("rest", "turning"):
            hint = nearest(self.start, ("rest", "turning"))
            raise InputError(f"a flywheel cannot start {self.start!r}", where=where, hint=hint)
        for what in ("inertia", "speed", "torque", "power"):
            value = getattr(self, what)
            if value is not None and not value > 0:
                raise InputError(f"the {what} is {value:g}, it must be positive", where=where)
        if self.inertia is None and self.speed is None and self.power is None:
            raise InputError(
                "nothing tells the inertia", where=where, hint="give inertia, or the motor's speed or power"
            )

    def effort(self, states: States, goal: str) -> Affine:
        """Nothing: on the base its weight and force are the base's, its moment is taken in `relieve`."""
        if goal in ("force", "moment"):
            return Affine.known((FORCE if goal == "force" else MOMENT,), np.zeros((len(states), 3)))
        if goal == "mass":
            return Affine.known((MASS,), np.full((1, 1), self.mass))
        if goal in ("hold", "drive"):
            return Affine.known(states.mechanism.driven_blocks, np.zeros_like(states.driven))
        if goal in ("energy", "storage"):
            return Affine.known((Block("energy", "J") if goal == "energy" else STORAGE,), np.zeros((len(states), 1)))
        raise InputError(f"there is no goal {goal!r}", hint=nearest(goal, ANSWERED))

    def relieve(self, moment: Affine) -> Affine:
        """A moment (N, 3) without what lies along the axis: the flywheel's motor gives that."""
        across = np.eye(3) - np.outer(self.normal, self.normal)
        A = np.einsum("ij,...njp->...nip", across, moment.A)
        return Affine(moment.blocks, moment.b @ across, moment.unknowns, A)

    def law(
        self, time: Array, moment: Array, momentum: Array, turned: Array | None = None, form: Mapping[str, float] = {}
    ) -> FlywheelLaw:
        """The rotation over time (N,) that cancels moment and momentum (N, 3) of the rest.

        Where the momentum is a sum of rotations, n . L = d/dt turned (N,), kg m^2 rad, the angle follows in closed
        form; else it is integrated. form {body: kg m^2} is that sum, for the record. Raises InfeasibleError where the
        motor's torque does not suffice, or, for a given inertia, its speed or power.
        """
        where = f"flywheel {self.name}"
        torque, stored = -moment @ self.normal, -(momentum - momentum[0]) @ self.normal
        often = np.linspace(time[0], time[-1], FINER * (len(time) - 1) + 1)
        pull, kept = _between(time, torque, often), _between(time, stored, often)
        most = float(np.abs(pull).max())
        if self.torque is not None and most > self.torque * (1 + CLOSE):
            raise InfeasibleError(
                f"the moment reaches {most:.4g} N m, the motor gives {self.torque:.4g} N m: no inertia changes that",
                where=where,
                hint="a slower motion, a stronger motor, or less moment (counterweights, counter-rotors)",
            )
        ahead = self._ahead(pull, kept) if self.start == "turning" else 0.0
        needs = self._needs(pull, kept + ahead)
        least = max(needs.values(), default=0.0)
        if self.inertia is not None and least > self.inertia * (1 + CLOSE):
            reason = max(needs, key=needs.__getitem__)
            raise InfeasibleError(
                f"{self.inertia:.4g} kg m^2 are too little for the motor's {reason}: {least:.4g} kg m^2 are needed",
                where=where,
                hint="leave the inertia out to get the smallest, or use start: turning",
            )
        inertia = self.inertia or least or np.inf
        speed = (stored + ahead) / inertia
        if turned is None:
            angle = _integral(time, speed)
        else:
            angle = (ahead + momentum[0] @ self.normal) / inertia * (time - time[0]) - (turned - turned[0]) / inertia
        return FlywheelLaw(time, inertia, torque / inertia, speed, angle, torque, needs, dict(form))

    def _needs(self, torque: Array, stored: Array) -> dict[str, float]:
        """Inertia that the motor's speed and power ask for, kg m^2."""
        needs = {}
        if self.speed is not None:
            needs["speed"] = float(np.abs(stored).max()) / self.speed
        if self.power is not None:
            needs["power"] = float(np.abs(torque * stored).max()) / self.power
        return needs

    def _ahead(self, torque: Array, stored: Array) -> float:
        """Momentum to begin with, kg m^2/s, that needs the smallest inertia, or without limits the lowest speed."""
        from scipy.optimize import minimize_scalar

        if self.power is None:
            return -0.5 * float(stored.max() + stored.min())

        def cost(ahead: float) -> float:
            return max(self._needs(torque, stored + ahead).values())

        span = float(np.ptp(stored))
        ends = (-float(stored.max()) - span, -float(stored.min()) + span)
        found: Any = minimize_scalar(cost, bounds=ends, method="bounded", options={"xatol": 1e-10 * span})
        return float(found.x)

    def install(self, spec: mujoco.MjSpec, values: Mapping[str, float], states: States) -> None:
        """Nothing at rest: the flywheel stands on the base."""


@dataclass(frozen=True, eq=False)
class FlywheelLaw:
    """Acceleration (rad/s^2), speed (rad/s) and angle (rad) over time (N,), s, with the motor's torque (N m).

    inertia in kg m^2; needs {reason: kg m^2} are the inertias that speed and power ask for; form {body: K, kg m^2}
    is there where the angle has the closed form theta = w t - sum K_b (alpha_b - alpha_b(0)) / I, alpha_b the body's
    absolute angle, w what the flywheel would turn at without momentum beside it.
    """

    time: Array
    inertia: float
    acceleration: Array
    speed: Array
    angle: Array
    torque: Array
    needs: Mapping[str, float]
    form: Mapping[str, float] = field(default_factory=dict)

    @property
    def power(self) -> Array:
        """What the motor supplies (N,), W."""
        return self.torque * self.speed


def _between(time: Array, values: Array, often: Array) -> Array:
    """A quintic spline through the values at more instants."""
    from scipy.interpolate import make_interp_spline

    return make_interp_spline(time, values, k=min(5, (len(time) - 2) // 2 * 2 + 1))(often)


def _integral(time: Array, values: Array) -> Array:
    """The integral from the first instant (N,), of a quintic spline through the values."""
    from scipy.interpolate import make_interp_spline

    degree = min(5, (len(time) - 2) // 2 * 2 + 1)
    whole = make_interp_spline(time, values, k=degree).antiderivative()
    return whole(time) - whole(time[0])
