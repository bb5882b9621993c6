"""A spring is a path times a law."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Affine, Array, Block, Unknown
from equipoise.balancers.laws import Law, Stored, Weight, WireMass
from equipoise.balancers.paths import Path, Place
from equipoise.balancers.paths.bodies import add_point_mass
from equipoise.errors import InputError, nearest
from equipoise.mechanism import ANSWERED, Mechanism, Point
from equipoise.momentum import FORCE, MASS, MOMENT
from equipoise.parameters import tag
from equipoise.states import States
from equipoise.units import Mass, Measured, Number, along_path, unit_marks

STORAGE = Block("stored energy", "J")


@dataclass(frozen=True)
class Spring:
    """A spring of one law on one path: effort f(l) dl/dq, energy E(l).

    mass is the spring's own, kg, a number or a WireMass that follows the rate. Its centre lies at the share mass_at
    of the way from the path's first end to its last, and it acts as 1 - mass_at at the first and mass_at at the last:
    half at each end by default, which is exact for zero free length. like names the spring whose unknowns this one
    shares.
    """

    name: str
    path: Path
    law: Law
    mass: Mass | WireMass = 0.0
    like: str | None = None
    mass_at: Number = 0.5

    @property
    def owner(self) -> str:
        """The name that the unknowns carry."""
        return self.like or self.name

    @cached_property
    def unknowns(self) -> tuple[Unknown, ...]:
        """What the program must find for this spring."""
        return self.law.unknowns(self.owner, self.path.unit)

    @cached_property
    def own_mass(self) -> Any:
        """The spring's own mass, kg, with that of a real part."""
        if not isinstance(self.mass, WireMass):
            return self.mass + self.law.own_mass
        rate = getattr(self.law, "k", None)
        if rate is None:
            raise InputError(
                f"the wire mass of spring {self.name} grows with the root of its rate, so the rate cannot stay unknown",
                where=f"spring {self.name}",
                hint=f"give law.k a value, and free it in `shape` as {self.name}.law.k",
            )
        return self.mass.of(rate)

    @property
    def masses(self) -> tuple[tuple[Place, Any], ...]:
        """Places and masses, kg, of the spring's own mass, lumped, and of its path's parts."""
        return (*self._lumped, *((place, mass) for place, mass in self.path.weights() if np.any(mass)))

    @property
    def _lumped(self) -> tuple[tuple[Place, Any], ...]:
        own = np.asarray(self.own_mass)
        ends = [place for place, _ in self.path.ends()]
        if not np.any(own) or not ends:
            return ()
        shares = (1 - self.mass_at, self.mass_at) if len(ends) > 1 else (1.0,)
        return tuple((place, share * own) for place, share in zip(ends, shares, strict=True))

    def check(self, mechanism: Mechanism) -> None:
        """Raise InputError where the spring cannot act on the mechanism."""
        where = f"spring {self.name}"
        self.path.check(mechanism, self.name)
        self._check_units(where)
        if np.any(np.real(self.own_mass) < 0):
            raise InputError(f"the mass of spring {self.name} is negative", where=where)
        if np.isrealobj(self.mass_at) and not np.all(
            (np.greater_equal(self.mass_at, 0)) & np.less_equal(self.mass_at, 1)
        ):
            raise InputError(
                f"mass_at is {float(np.ravel(self.mass_at)[0]):g}, it must lie in 0..1",
                where=where,
                hint="0 is the path's first end, 1 its last, 0.5 the middle",
            )

    def _check_units(self, where: str) -> None:
        unit, law = self.path.unit, tag(type(self.law))
        if unit not in self.law.along:
            other = "a length, in m" if unit == "rad" else "an angle, in rad"
            raise InputError(
                f"law {law} acts along {other}, the path answers {unit}",
                where=where,
                hint=f"laws for a path in {unit}: linear, zero_free_length, constant, polynomial"
                + (", torsion; or wind a cable on a drum" if unit == "rad" else ", coil, gas"),
            )
        for name, mark in unit_marks(type(self.law)).items():
            value, wanted = getattr(self.law, name), along_path(mark, unit)
            for item in value if isinstance(value, tuple) else (value,):
                if isinstance(item, Measured) and item.unit not in ("", wanted):
                    raise InputError(f"law.{name} is in {item.unit}, on this path it must be in {wanted}", where=where)

    def check_span(self, states: States) -> None:
        """Raise InputError where a length of the states leaves the span in which the law holds; candidates may."""
        if self.law.defined_beyond or all(end is None for end in self.law.span):
            return
        length = self.path.deform(states)[0]
        if length.ndim > 1 or np.iscomplexobj(length) or any(np.ndim(end) for end in self.law.span):
            return
        for bound, reached, side in zip(self.law.span, (length.min(), length.max()), (1, -1), strict=True):
            if bound is not None and side * (reached - float(bound)) < -1e-12 * abs(float(bound)):
                raise InputError(
                    f"it reaches {reached:.6g} {self.path.unit}, "
                    f"the {self.law.span_words} of its law ends at {float(bound):.6g} {self.path.unit}",
                    where=f"spring {self.name}",
                    hint="move its ends, narrow the sweep, or change the law",
                )

    def effort(self, states: States, goal: str) -> Affine:
        """The spring's share of a goal.

        `hold`: (B theta + f0) dl/dq plus the weight of its own mass, per driven joint;
        `drive`: the same plus the inertia of its own mass; `force`, `moment`: its own mass alone; `mass`, kg;
        `energy`: E theta + e0 plus the potential of its own mass, J; `storage`: the elastic part alone, J.
        """
        if goal in ("force", "moment"):
            first, block = (0, FORCE) if goal == "force" else (3, MOMENT)
            shake = np.zeros((len(states), 3)) + self._shake(states)[..., first : first + 3]
            return Affine((block,), shake, self.unknowns, np.zeros((*shake.shape, len(self.unknowns))))
        if goal == "mass":
            own = np.real(np.zeros((1, 1)) + self.own_mass)
            return Affine((MASS,), own, self.unknowns, np.zeros((*own.shape, len(self.unknowns))))
        if goal in ("hold", "drive"):
            rate, basis, b = self.factors(states)
            if goal == "drive":
                b = b + sum(states.point_inertia(point, mass) for point, mass in self._moving)
            return Affine(states.mechanism.driven_blocks, b, self.unknowns, basis[..., None, :] * rate[..., :, None])
        length, _ = self.path.deform(states)
        if goal in ("energy", "storage"):
            basis, known = self.law.energy_basis(length)
            own = self._weight(states, goal) if goal == "energy" else 0.0
            name = Block("energy", "J") if goal == "energy" else STORAGE
            return Affine((name,), (known + own)[..., None], self.unknowns, basis[..., None, :])
        raise InputError(f"there is no goal {goal!r}", hint=nearest(goal, ANSWERED))

    @property
    def _moving(self) -> list[tuple[Point, Any]]:
        """Points and masses, kg, that inertia counts; raises InputError where a mass moves within its body."""
        found = [(place, mass) for place, mass in self.masses if not isinstance(place, Point) or place.body != "world"]
        for place, _ in found:
            if not isinstance(place, Point):
                raise InputError(
                    f"the inertia of spring {self.name}'s own mass is not known: its ends move within bodies",
                    where=f"spring {self.name}",
                    hint="leave its mass out for goals of a motion",
                )
        return found  # type: ignore[return-value]

    def _shake(self, states: States) -> Any:
        return sum((states.point_wrench(point, mass) for point, mass in self._moving), start=np.zeros((1, 6)))

    def deform(self, states: States) -> tuple[Array, Array]:
        """The path's l (..., N) and dl/dq (..., N, nd), worked out once for efforts and limits of the same states."""
        known = self.__dict__.get("_deformed")
        if known is None or known[0] is not states:
            known = states, self.path.deform(states)
            object.__setattr__(self, "_deformed", known)
        return known[1]

    def factors(self, states: States) -> tuple[Array, Array, Array]:
        """dl/dq (..., N, nd), B (..., N, P) and the constant (..., N, nd) of its effort dl/dq (B theta) + constant."""
        length, rate = self.deform(states)
        basis, known = self.law.force_basis(length)
        return rate, basis, known[..., None] * rate + self._weight(states, "hold")

    def _weight(self, states: States, goal: str) -> Any:
        answer = states.weight_effort if goal == "hold" else states.weight_energy
        return sum((answer(place, mass) for place, mass in self.masses), 0.0)

    def force(self, states: States, values: Mapping[str, float]) -> tuple[Array, Array]:
        """Length (N,), m, and force (N,), N, for given values of the unknowns {name: value}."""
        length, _ = self.path.deform(states)
        basis, known = self.law.force_basis(length)
        return length, basis @ self._theta(values) + known

    def _theta(self, values: Mapping[str, float]) -> Array:
        return np.array([values[unknown.name] for unknown in self.unknowns])

    def own(self, values: Mapping[str, float]) -> dict[str, float]:
        """The values of this spring's unknowns by parameter: `k` for `s1.k`."""
        return {unknown.name.removeprefix(f"{self.owner}."): values[unknown.name] for unknown in self.unknowns}

    def parameters(self, values: Mapping[str, float]) -> dict[str, float]:
        """All parameters of the law, found and given, SI; an unknown free length is read from its product."""
        return self.law.parameters(self.own(values))

    def stored(self, values: Mapping[str, float], states: States) -> Stored:
        """What a tendon can hold of the law over the lengths of the states."""
        length = self.path.deform(states)[0]
        return self.law.stored(self.own(values), float(length.min()), float(length.max()))

    def install(self, spec: mujoco.MjSpec, values: Mapping[str, float], states: States) -> None:
        """Add the spring and its lumped mass to a MuJoCo model.

        A force line or cubic that a tendon can hold becomes a native tendon spring, a constant part a tendon actuator;
        any other law is stored as the cubic nearest to it over the lengths of the states.
        """
        tendon = self.path.install(spec, self.name, states)
        if isinstance(self.law, Weight):
            tendon.armature = self.law.parameters(self.own(values))["m"]
        stored = self.stored(values, states)
        constant, *stiffness = stored.coefficients
        if constant == 0.0 or any(stiffness[1:]):
            tendon.stiffness = stiffness
            tendon.springlength = [stored.rest] * 2
            bias = [-constant, 0.0, 0.0]
        else:
            bias = [-constant + stiffness[0] * stored.rest, -stiffness[0], 0.0]
        if any(bias):
            actuator = spec.add_actuator(name=actuator_name(self.name), target=tendon.name)
            actuator.trntype = mujoco.mjtTrn.mjTRN_TENDON
            actuator.gaintype = mujoco.mjtGain.mjGAIN_FIXED
            actuator.gainprm[0] = 0.0
            actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
            actuator.biasprm[:3] = bias
        for side, (place, mass) in zip("ab", self._lumped, strict=False):
            point = place if isinstance(place, Point) else place.seat(states.mechanism.model, self.name)
            add_point_mass(spec, f"{self.name}_mass_{side}", point.body, point.at, float(mass))


def actuator_name(spring: str) -> str:
    """The actuator that stands for what a tendon cannot hold of a spring."""
    return f"{spring}_force"
