"""Linear synthesis of a slider-crank compensator through prescribed positions: a start for `shape`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import SliderCrank
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError, nearest
from equipoise.mechanism import Mechanism
from equipoise.sweep import Sweep
from equipoise.units import Angle, Energy

APART = 1e-6
SCAN = 240
RANK = 1e-9


@dataclass(frozen=True)
class Prescribed:
    """Crank, rod and phase of a slider-crank dyad that keep the energy constant at prescribed positions.

        E(y_i) + V(q_i) = C,   y_i^2 = 2 y_i cos u_i z1 + 2 y_i sin u_i z2 + z3
        crank = hypot(z1, z2),  phase = -atan2(z2, z1),  rod = sqrt(z3 + crank^2)

    at are positions q_i of the joint that drives the dyad, rad; u_i its input angle there; V the weight's energy,
    counted from its lowest over a full turn (or over the sweep, where loops forbid one); E the spring's, from its
    unstressed length; y_i the slider's place. Three positions are met exactly, more by least squares. energy is C,
    J; where it is left out, the C is taken whose dyad leaves the least largest effort at the positions. side says
    whether the spring pushes the slider away (y below the unstressed length) or pulls it. The dyad's own weights and
    an offset of the slider's line are left out: this is a start. Eqs. 5 to 19 of [zhang_arakelian_2023], with
    hypot and atan2. Raises InputError for fewer than three positions, positions that coincide, an energy below its
    domain, a spring whose force is no straight line with a known rate, and positions that no dyad meets.
    """

    at: tuple[Angle, ...]
    energy: Energy | None = None
    side: Literal["push", "pull"] = "push"
    sources: ClassVar[tuple[str, ...]] = ("zhang_arakelian_2023",)

    def __post_init__(self) -> None:
        count = len(self.at)
        if count < 3:
            raise InputError(
                f"{count} prescribed position{'s' * (count != 1)}: three lengths need at least three",
                where="prescribed",
                hint="prescribe three positions or more",
            )
        order = np.sort(np.asarray(self.at, dtype=float))
        gaps = np.diff(order)
        if gaps.min() < APART:
            both = float(np.degrees(order[int(gaps.argmin())]))
            raise InputError(
                f"two prescribed positions coincide at {both:.6g} deg",
                where="prescribed",
                hint="prescribe positions that differ",
            )

    def apply(self, mechanism: Mechanism, spring: Spring, sweep: Sweep) -> Spring:
        """The spring with the dyad that the positions prescribe; weights include the mean payload of the sweep."""
        dyad, rest, rate = _parts(spring)
        joint = _joint(mechanism, dyad, spring.name)
        task = _Task(spring.name, dyad, rest, rate, *_weight(mechanism, sweep, dyad, joint, self.at), self.side)
        energy = task.best() if self.energy is None else float(self.energy)
        return replace(spring, path=task.dyad_of(energy))


@dataclass(frozen=True, eq=False)
class _Task:
    """Input angles u (N,) with weight energies V and efforts dV/du there, and a linear spring."""

    name: str
    dyad: SliderCrank
    rest: float
    rate: float
    u: Array
    potential: Array
    slope: Array
    side: str

    @property
    def domain(self) -> tuple[float, float]:
        """Energies C for which the spring has a real and positive length at every position."""
        low = float(self.potential.max())
        high = float(self.potential.min()) + 0.5 * self.rate * self.rest**2 if self.side == "push" else np.inf
        return low, high

    def dyad_of(self, energy: float) -> SliderCrank:
        """The dyad that one energy prescribes."""
        where = f"spring {self.name}, prescribed"
        low, high = self.domain
        if energy < low:
            raise InputError(
                f"the energy C is {energy:.6g} J, below its domain: the weight alone has {low:.6g} J at a prescribed "
                "position",
                where=where,
                hint=f"give at least {low:.6g} J, or leave the energy out to have the best one taken",
            )
        if energy >= high:
            raise InputError(
                f"the energy C is {energy:.6g} J, above its domain: at {high:.6g} J the spring has no length left",
                where=where,
                hint="give less energy, a stiffer spring or a longer one",
            )
        sign = -1.0 if self.side == "push" else 1.0
        y = self.rest + sign * np.sqrt(2 * (energy - self.potential) / self.rate)
        system = np.stack([2 * y * np.cos(self.u), 2 * y * np.sin(self.u), np.ones_like(y)], axis=1)
        z, _, rank, _ = np.linalg.lstsq(system, y * y, rcond=RANK)
        crank = float(np.hypot(z[0], z[1]))
        square = float(z[2]) + crank**2
        phase = -float(np.arctan2(z[1], z[0]))
        along = y - crank * np.cos(self.u + phase)
        if rank < 3 or square <= 0 or crank <= 0 or along.min() * along.max() <= 0:
            raise InputError(
                f"no dyad meets the prescribed positions with an energy of {energy:.6g} J",
                where=where,
                hint="prescribe other positions, or another energy",
            )
        sense: Literal["forward", "backward"] = "forward" if along.min() > 0 else "backward"
        return replace(self.dyad, crank=crank, rod=float(np.sqrt(square)), phase=phase, sense=sense)

    def residual(self, energy: float) -> float:
        """The largest |dV/du + f dy/du| at the positions, N m; infinite where no dyad is found."""
        try:
            dyad = self.dyad_of(energy)
            dyad.insist(self.u + dyad.phase)
        except InputError:
            return np.inf
        length, slope = dyad.curve(self.u + dyad.phase)
        return float(np.abs(self.slope + self.rate * (length - self.rest) * slope).max())

    def best(self) -> float:
        """The energy whose dyad leaves the least largest effort at the positions."""
        from scipy.optimize import minimize_scalar

        low, high = self.domain
        high = min(high, low + 4 * (float(np.ptp(self.potential)) + abs(low)))
        scan = low + (high - low) * (np.arange(SCAN) + 0.5) / SCAN
        values = np.array([self.residual(float(energy)) for energy in scan])
        if not np.isfinite(values).any():
            raise InputError(
                "no dyad meets the prescribed positions at any energy",
                where=f"spring {self.name}, prescribed",
                hint="prescribe other positions, or change the spring",
            )
        middle, step = float(scan[values.argmin()]), float(scan[1] - scan[0])
        found: Any = minimize_scalar(
            self.residual, bounds=(middle - step, middle + step), method="bounded", options={"xatol": 1e-9 * middle}
        )
        return float(found.x) if found.fun <= values.min() else middle


def _parts(spring: Spring) -> tuple[SliderCrank, float, float]:
    """The dyad, and the unstressed length, m, and rate, N/m, of its spring."""
    where = f"spring {spring.name}, prescribed"
    if not isinstance(spring.path, SliderCrank):
        raise InputError(
            f"prescribed positions need a slider-crank, spring {spring.name} has the path "
            f"{type(spring.path).__name__.lower()}",
            where=where,
            hint="write `path: {slider_crank: {input: ...}}`",
        )
    if spring.path.offset != 0:
        raise InputError(
            "prescribed positions are met by dyads whose slider's line passes through the shaft: offset is "
            f"{spring.path.offset:g} m",
            where=where,
            hint="set the offset to 0, or give crank and rod yourself",
        )
    line = None if spring.unknowns else spring.law.line({})
    if line is None or line[1] <= 0:
        raise InputError(
            "prescribed positions need a straight force line with a known positive rate, "
            f"spring {spring.name} has none",
            where=where,
            hint="give the law's rate and length, for example `coil: {free_length: 1 m, k: 1 N/mm}`",
        )
    return spring.path, -line[0] / line[1], line[1]


def _joint(mechanism: Mechanism, dyad: SliderCrank, name: str) -> str:
    """The one driven joint that turns the dyad."""
    turn: Any = dyad.input
    joints = list(turn.terms(mechanism.model)[0])
    if len(joints) != 1 or joints[0] not in mechanism.driven:
        raise InputError(
            f"the dyad of spring {name} follows {', '.join(joints)}: prescribed positions are of one driven joint",
            where=f"spring {name}, prescribed",
            hint=nearest(joints[0], list(mechanism.driven)),
        )
    return joints[0]


def _weight(
    mechanism: Mechanism, sweep: Sweep, dyad: SliderCrank, joint: str, at: tuple[float, ...]
) -> tuple[Array, Array, Array]:
    """Input angles, weight energies from the lowest, and their slopes over the input angle at joint positions."""
    column = mechanism.driven.index(joint)
    home = mechanism.reference[mechanism.model.jnt_qposadr[mechanism.driven_ids]]

    def over(positions: Array) -> tuple[Array, Array, Array, Array]:
        poses = np.tile(home, (len(positions), 1))
        poses[:, column] = positions
        states = mechanism.states(sweep.at_poses(poses))
        u, rate = dyad.input.deform(states)
        # Rows run scenario by scenario.
        shape = (len(sweep.scenarios), len(positions))
        energy = (states.potential.reshape(shape)).mean(axis=0)
        effort = states.holding[:, column].reshape(shape).mean(axis=0)
        return u[: len(positions)], rate[: len(positions), column], energy, effort

    u, rate, energy, effort = over(np.asarray(at, dtype=float))
    return u, energy - _lowest(over, sweep.poses[:, column]), effort / rate


def _lowest(over: object, swept: Array) -> float:
    """The least weight energy over a full turn, which is a sine of the angle; over the sweep where there is none."""
    turn = 2 * np.pi * np.arange(4) / 4
    try:
        energy = over(turn)[2]  # type: ignore[operator]
    except InputError:
        return float(over(swept)[2].min())  # type: ignore[operator]
    mean, a, b = energy.mean(), 0.5 * (energy[0] - energy[2]), 0.5 * (energy[1] - energy[3])
    size = float(np.hypot(a, b))
    if abs(energy[0] - energy[1] + energy[2] - energy[3]) > 1e-9 * max(size, 1e-300):
        return float(over(swept)[2].min())  # type: ignore[operator]
    return float(mean) - size
