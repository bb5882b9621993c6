"""Springs that have mass: the rate that balances them too, in closed form, exactly or in the mean square."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws import WireMass
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.states import States
from equipoise.sweep import Sweep

STANDARD_GRAVITY = 9.81


def exact_rate_zero_free_length(
    mass: float,
    height: float,
    wires: WireMass | Sequence[WireMass],
    gravity: float = STANDARD_GRAVITY,
    mass_at: float = 0.5,
) -> float:
    """The rate k, N/m, of springs of zero free length that carry a load and their own wire.

        k h = (m + f sum_j m_j(k)) g,   m_j = w_j sqrt(k):   h z^2 - f g sum_j w_j z - m g = 0,   k = z^2

    mass m, kg, is the load reduced to the springs' moving end: m1 s1 / r for a link of mass m1 with its centre at s1
    that holds the spring at r; height h, m, is that of the fixed end above the pivot; mass_at f the share of each
    spring's mass that its moving end carries, 1/2 for a spring that is stretched evenly. Several springs of the same
    rate k (or -k) add their wires. Arakelian & Ghazaryan 2008, Eqs. 4-10, and Eq. 45 with the factor 2 under the
    root that its print lacks [arakelian_ghazaryan_2008]. Raises InputError where mass or height is not positive.
    """
    for name, value in (("mass", mass), ("height", height), ("gravity", gravity)):
        if not value > 0:
            raise InputError(f"the {name} is {value:g}, it must be positive", where="exact_rate_zero_free_length")
    listed = (wires,) if isinstance(wires, WireMass) else tuple(wires)
    half = mass_at * gravity * sum(wire.of(1.0) for wire in listed) / (2 * height)
    return float((half + np.sqrt(half**2 + mass * gravity / height)) ** 2)


@dataclass(frozen=True, eq=False)
class Heavy:
    """The residual of a mechanism with springs of one rate k and wires: r = load + sag sqrt(k) + pull k.

    load, sag and pull (R,) are in N m or N, per sqrt(N/m) and per N/m, one row per state and driven joint; weight (R,)
    are the rows' weights.
    """

    load: Array
    sag: Array
    pull: Array
    weight: Array

    def residual(self, k: float) -> Array:
        """r (R,) at a rate k, N/m."""
        return self.load + self.sag * np.sqrt(k) + self.pull * k

    def rms(self, k: float) -> float:
        """Root of the weighted mean of r^2 over the rows."""
        return float(np.sqrt((self.weight * self.residual(k) ** 2).sum() / self.weight.sum()))

    def cubic(self) -> tuple[float, float, float]:
        """(a, b, c) of z^3 + a z^2 + b z + c = 0 at every stationary point of sum w r^2, z = sqrt(k).

            a = 3 S23 / (2 S33),   b = (S22 + 2 S13) / (2 S33),   c = S12 / (2 S33),   S_ij = sum w c_i c_j

        with c_1 = load, c_2 = sag, c_3 = pull: sums of products, where Arakelian & Ghazaryan 2008, Eqs. 20-22, print
        products of sums, which are stationary where the mean of r vanishes [arakelian_ghazaryan_2008].
        """
        rows = np.stack([self.load, self.sag, self.pull])
        s = (rows * self.weight) @ rows.T
        if not s[2, 2] > 0:
            raise InputError("the springs pull at no state: no rate balances anything", where="exact_rate")
        a, b, c = 3 * s[1, 2], s[1, 1] + 2 * s[0, 2], s[0, 1]
        return float(a / (2 * s[2, 2])), float(b / (2 * s[2, 2])), float(c / (2 * s[2, 2]))


def heavy(mechanism: Mechanism, springs: Sequence[Spring], sweep: Sweep | States) -> Heavy:
    """The rows of a mechanism with springs of one rate: massless laws of unknown k, with WireMass.

    Every spring's law must have `k` as its only unknown, or a given k whose sign alone counts (-1 for a spring that
    pushes); its mass must be a WireMass. Raises InputError otherwise.
    """
    states = sweep if isinstance(sweep, States) else mechanism.states(sweep)
    load = states.holding
    sag, pull = np.zeros_like(load), np.zeros_like(load)
    for spring in springs:
        wire = spring.mass
        rate = getattr(spring.law, "k", None)
        if not isinstance(wire, WireMass) or not hasattr(spring.law, "k"):
            raise InputError(
                f"spring {spring.name} has no rate with a wire mass",
                where=f"spring {spring.name}",
                hint="give it a law with k, and mass: {wire_mass: ...}",
            )
        one = replace(spring.law, k=-1.0 if rate is not None and rate < 0 else 1.0)
        effort = replace(spring, law=one, mass=0.0, like=None).effort(states, "hold")
        if effort.unknowns:
            names = ", ".join(unknown.name for unknown in effort.unknowns)
            raise InputError(f"{names} must be given", where=f"spring {spring.name}")
        bare = replace(spring, law=replace(one, k=0.0), mass=0.0).effort(states, "hold").b
        unit = replace(spring, law=replace(one, k=0.0), mass=wire.of(1.0)).effort(states, "hold").b
        load, pull, sag = load + bare, pull + effort.b - bare, sag + unit - bare
    weight = np.broadcast_to(states.weight[:, None], load.shape)
    return Heavy(load.ravel(), sag.ravel(), pull.ravel(), weight.ravel())


def exact_rate(mechanism: Mechanism, springs: Sequence[Spring], sweep: Sweep | States) -> float:
    """The rate k, N/m, that springs with wire mass need: least rms of the residual over a sweep, in closed form.

    The largest root of Heavy.cubic with the least rms; where the springs can balance exactly (zero free length), it
    balances exactly. Raises InputError where no positive rate lowers the rms.
    """
    rows = heavy(mechanism, springs, sweep)
    roots = np.roots([1.0, *rows.cubic()])
    real = np.real(roots[np.abs(np.imag(roots)) <= 1e-6 * np.abs(roots).max()])
    rates = [float(z * z) for z in real if z > 0]
    if not rates:
        raise InputError("no positive rate lowers the residual", where="exact_rate", hint="move the springs' ends")
    return min(rates, key=rows.rms)


def iterated_rates(
    mechanism: Mechanism, springs: Sequence[Spring], sweep: Sweep | States, tolerance: float = 1e-12, most: int = 200
) -> tuple[float, ...]:
    """The baseline: rate for a known spring mass, mass for that rate, and so on by turns; k_0, k_1, ..., N/m.

        k_0 = -S13 / S33 (weightless),   k_{i+1} = -(S13 + S23 sqrt(k_i)) / S33

    It converges to the exact rate where the residual vanishes; elsewhere to a rate that is not the best, for it
    leaves out how the mass grows with the rate. Ends when two rates agree to `tolerance`; raises InputError where
    they do not within `most` turns, or turn negative.
    """
    rows = heavy(mechanism, springs, sweep)

    def against(force: Array) -> float:
        return float(-(rows.weight * rows.pull * force).sum() / (rows.weight * rows.pull**2).sum())

    rates = [against(rows.load)]
    for _ in range(most):
        if not rates[-1] > 0:
            raise InputError(f"the rate becomes {rates[-1]:g} N/m by turns", where="iterated_rates")
        rates.append(against(rows.load + rows.sag * np.sqrt(rates[-1])))
        if abs(rates[-1] - rates[-2]) <= tolerance * abs(rates[-1]):
            return tuple(rates)
    raise InputError(f"no rate after {most} turns: the wire weighs more than it carries", where="iterated_rates")
