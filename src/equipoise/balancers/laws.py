"""Laws: forces affine in their unknowns, f = B(l) theta + f0, with their integral E(l)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from equipoise.affine import Array, Unknown
from equipoise.errors import InputError
from equipoise.units import Density, Force, Length, Number, Pressure, Stiffness


@dataclass(frozen=True)
class Share:
    """One parameter's share of a law: force = basis * parameter, energy = integral * parameter.

    given is its value where it is known, None where the program finds it; basis and integral follow the length.
    """

    parameter: str
    unit: str
    given: Any
    basis: Array
    integral: Array
    lower: float = -np.inf


@dataclass(frozen=True)
class Law:
    """Common ground of the laws: a law says its shares, the rest follows."""

    closed: ClassVar[float | None] = None
    closes_free: ClassVar[bool] = False

    def shares(self, length: Array) -> tuple[Share, ...]:
        """The law's parameters with force and energy per unit of each, at lengths (..., N)."""
        raise NotImplementedError

    def unknowns(self, owner: str) -> tuple[Unknown, ...]:
        """The unknowns that the program must find, named `owner.parameter`."""
        return tuple(
            Unknown(f"{owner}.{share.parameter}", share.unit, share.lower)
            for share in self.shares(np.ones(1))
            if share.given is None
        )

    def force_basis(self, length: Array) -> tuple[Array, Array]:
        """B (..., N, P) and f0 (..., N) of f = B theta + f0, N; f > 0 pulls the ends together."""
        return self._split(length, "basis")

    def energy_basis(self, length: Array) -> tuple[Array, Array]:
        """E (..., N, P) and e0 (..., N) of the stored energy E theta + e0, J, with dE/dl = B."""
        return self._split(length, "integral")

    def _split(self, length: Array, what: str) -> tuple[Array, Array]:
        columns, constant = [], np.zeros_like(length)
        for share in self.shares(length):
            value = np.broadcast_to(getattr(share, what), length.shape)
            if share.given is None:
                columns.append(value)
            else:
                constant = constant + share.given * value
        wide = np.stack(columns, axis=-1) if columns else np.zeros((*length.shape, 0), dtype=length.dtype)
        return wide, constant

    def affine_force(self, values: dict[str, float]) -> tuple[float, float]:
        """(c0, c1) of f = c0 + c1 l for given parameter values; every law here is affine in the length."""
        at = [self._force_at(length, values) for length in (0.0, 1.0)]
        return at[0], at[1] - at[0]

    def _force_at(self, length: float, values: dict[str, float]) -> float:
        shares = self.shares(np.array([length]))
        return sum(
            float(np.ravel(share.basis)[0] if np.ndim(share.basis) else share.basis)
            * float(values[share.parameter] if share.given is None else share.given)
            for share in shares
        )


@dataclass(frozen=True)
class ZeroFreeLength(Law):
    """The ideal spring of static balancing: f = k l, V = k l^2 / 2; k in N/m, None where it is unknown."""

    k: Stiffness | None = None

    def shares(self, length: Array) -> tuple[Share, ...]:
        """One share: the rate."""
        return (Share("k", "N/m", self.k, length, length * length / 2, lower=0.0),)


@dataclass(frozen=True)
class Linear(Law):
    """A straight force line: f = preload + k l; k in N/m, preload in N, each None where it is unknown."""

    k: Stiffness | None = None
    preload: Force | None = None

    def shares(self, length: Array) -> tuple[Share, ...]:
        """Two shares: the rate and the preload at zero length."""
        return (
            Share("k", "N/m", self.k, length, length * length / 2, lower=0.0),
            Share("preload", "N", self.preload, np.ones_like(length), length),
        )


@dataclass(frozen=True)
class Coil(Law):
    """A coil spring: f = F0 + k (l - L0), rigid below its closed length.

    k in N/m; free_length L0 in m, the length at which the force is the initial tension; initial_tension
    F0 >= 0 in N; closed_length in m, below which the coils touch (an extension spring with initial
    tension is closed at its free length unless another value is given). None marks k, L0 or F0 as unknown;
    an unknown free length enters as the product k L0, in which the force is affine.
    """

    free_length: Length | None
    k: Stiffness | None = None
    initial_tension: Force | None = 0.0
    closed_length: Length | None = None

    def __post_init__(self) -> None:
        for name in ("free_length", "initial_tension", "closed_length"):
            value = getattr(self, name)
            if isinstance(value, int | float) and value < 0:
                raise InputError(f"{name} is {value:g}, it cannot be negative", where="law coil")
        real = all(isinstance(value, int | float) for value in (self.closed_length, self.free_length))
        if real and self.closed_length > self.free_length:  # type: ignore[operator]
            raise InputError(
                f"the closed length {self.closed_length:g} m is above the free length {self.free_length:g} m",
                where="law coil",
                hint="a coil cannot be longer closed than free",
            )

    @property
    def closed(self) -> Any:  # type: ignore[override]
        """The length below which the coils touch, m, or None where that is not known."""
        return self.free_length if self.closes_free else self.closed_length

    @property
    def closes_free(self) -> bool:  # type: ignore[override]
        """Whether the coils touch at the free length, as those of an extension spring with initial tension do."""
        return self.closed_length is None and (self.initial_tension is None or bool(np.any(self.initial_tension)))

    def shares(self, length: Array) -> tuple[Share, ...]:
        """Rate, free length where it is unknown, and initial tension."""
        one = np.ones_like(length)
        if self.free_length is not None:
            stretch = length - self.free_length
            return (
                Share("k", "N/m", self.k, stretch, stretch * stretch / 2, lower=0.0),
                Share("initial_tension", "N", self.initial_tension, one, stretch, lower=0.0),
            )
        return (
            Share("k", "N/m", self.k, length, length * length / 2, lower=0.0),
            Share("k_free_length", "N", None, -one, -length, lower=0.0),
            Share("initial_tension", "N", self.initial_tension, one, length, lower=0.0),
        )


@dataclass(frozen=True)
class Constant(Law):
    """A constant-force spring: f = force, V = force l; force in N, None where it is unknown."""

    force: Force | None = None

    def shares(self, length: Array) -> tuple[Share, ...]:
        """One share: the force."""
        return (Share("force", "N", self.force, np.ones_like(length), length, lower=0.0),)


@dataclass(frozen=True)
class WireMass:
    """The mass of a coil's wire, which grows with the square root of its rate.

    m = pi rho L_w sqrt(D^3 n k / (2 G)): the wire diameter follows from d^4 = 8 D^3 n k / G.
    diameter D (mean coil) and wire_length L_w in m, coils n, shear_modulus G in Pa, density rho in kg/m^3,
    k in N/m. Arakelian & Ghazaryan 2008, Eq. 7 [arakelian_ghazaryan_2008].
    """

    diameter: Length
    coils: Number
    wire_length: Length
    shear_modulus: Pressure = 81e9
    density: Density = 7800.0

    def of(self, k: Any) -> Any:
        """Mass, kg, of the spring of rate k, N/m."""
        return (
            self.density
            * np.pi
            * self.wire_length
            * np.sqrt(self.diameter**3 * self.coils * k / (2 * self.shear_modulus))
        )
