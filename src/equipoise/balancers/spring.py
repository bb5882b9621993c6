"""A spring is a path times a law."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Affine, Array, Block, Unknown
from equipoise.balancers.laws import Law, WireMass
from equipoise.balancers.paths import Path, Place
from equipoise.balancers.paths.bodies import outline
from equipoise.errors import InputError, nearest
from equipoise.mechanism import Mechanism, Point
from equipoise.states import States
from equipoise.units import Mass

STORAGE = Block("stored energy", "J")


@dataclass(frozen=True)
class Spring:
    """A spring of one law on one path: effort f(l) dl/dq, energy E(l).

    mass is the spring's own, kg, lumped half at each end (exact for zero free length), a number or a
    WireMass that follows the rate; like names the spring whose unknowns this one shares.
    """

    name: str
    path: Path
    law: Law
    mass: Mass | WireMass = 0.0
    like: str | None = None

    @property
    def owner(self) -> str:
        """The name that the unknowns carry."""
        return self.like or self.name

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """What the program must find for this spring."""
        return self.law.unknowns(self.owner)

    @property
    def own_mass(self) -> Any:
        """The spring's own mass, kg."""
        if not isinstance(self.mass, WireMass):
            return self.mass
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
        own = self.own_mass
        shares = ((place, share * np.asarray(own)) for place, share in self.path.ends()) if np.any(own) else ()
        return (*shares, *((place, mass) for place, mass in self.path.weights() if np.any(mass)))

    def check(self, mechanism: Mechanism) -> None:
        """Raise InputError where the spring cannot act on the mechanism."""
        self.path.check(mechanism, self.name)
        if np.any(np.real(self.own_mass) < 0):
            raise InputError(f"the mass of spring {self.name} is negative", where=f"spring {self.name}")

    def effort(self, states: States, goal: str) -> Affine:
        """The spring's share of a goal.

        `hold`: (B theta + f0) dl/dq plus the weight of its own mass, per driven joint;
        `energy`: E theta + e0 plus the potential of its own mass, J; `storage`: the elastic part alone, J.
        """
        length, rate = self.path.deform(states)
        if goal == "hold":
            basis, known = self.law.force_basis(length)
            b = known[..., None] * rate + self._weight(states, goal)
            return Affine(states.mechanism.driven_blocks, b, self.unknowns, basis[..., None, :] * rate[..., :, None])
        if goal in ("energy", "storage"):
            basis, known = self.law.energy_basis(length)
            own = self._weight(states, goal) if goal == "energy" else 0.0
            name = Block("energy", "J") if goal == "energy" else STORAGE
            return Affine((name,), (known + own)[..., None], self.unknowns, basis[..., None, :])
        raise InputError(f"there is no goal {goal!r}", hint=nearest(goal, ["hold", "energy", "storage"]))

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

    def parameters(self, values: Mapping[str, float]) -> dict[str, float]:
        """All parameters of the law, found and given, SI; an unknown free length is read from its product."""
        shares = self.law.shares(np.ones(1))
        found = {
            share.parameter: float(values[f"{self.owner}.{share.parameter}"] if share.given is None else share.given)
            for share in shares
        }
        free = getattr(self.law, "free_length", None)
        if free is not None:
            found["free_length"] = float(free)
        elif "k_free_length" in found and found.get("k", 0.0) > 0:
            found["free_length"] = found["k_free_length"] / found["k"]
        return found

    def install(self, spec: mujoco.MjSpec, values: Mapping[str, float]) -> None:
        """Add the spring and its lumped mass to a MuJoCo model.

        A force line that a tendon can hold becomes a native tendon spring, any other a tendon actuator.
        """
        tendon = self.path.install(spec, self.name)
        own = {unknown.name.removeprefix(f"{self.owner}."): values[unknown.name] for unknown in self.unknowns}
        intercept, slope = self.law.affine_force(own)
        if slope > 0 and intercept <= 0:
            tendon.stiffness[0] = slope
            tendon.springlength = [-intercept / slope] * 2
        else:
            actuator = spec.add_actuator(name=f"{self.name}_force", target=tendon.name)
            actuator.trntype = mujoco.mjtTrn.mjTRN_TENDON
            actuator.gaintype = mujoco.mjtGain.mjGAIN_FIXED
            actuator.gainprm[0] = 0.0
            actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
            actuator.biasprm[:3] = [-intercept, -slope, 0.0]
        for side, (place, share) in zip("ab", self.path.ends() if self.own_mass else (), strict=False):
            point = place if isinstance(place, Point) else place.seat(outline(spec), self.name)
            add_point_mass(spec, f"{self.name}_mass_{side}", point.body, point.at, share * float(self.own_mass))


def add_point_mass(spec: mujoco.MjSpec, name: str, body: str, at: Any, mass: float) -> None:
    """Add a point mass as a body welded at a point of another; none for zero mass or the world."""
    if mass == 0.0 or body == "world":
        return
    carrier = spec.body(body).add_body(name=name)
    carrier.pos = [float(value) for value in at]
    carrier.mass = mass
    carrier.ipos = [0.0, 0.0, 0.0]  # said, else the saved file lacks it and MuJoCo refuses to read it back
    carrier.inertia = [0.0, 0.0, 0.0]
    carrier.explicitinertial = True
