"""What every law answers: a force affine in its unknowns, f = B(l) theta + f0, with its integral E(l) and slope."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from equipoise.affine import Array, Unknown
from equipoise.balancers.laws.stored import Stored, store
from equipoise.units import along_path, unit_marks

FORCE = "N or N m"
RATE = "N/m or N m/rad"


@dataclass(frozen=True)
class Share:
    """One parameter's share of a law: force = basis * parameter, energy = integral * parameter.

    unit is the parameter's on a path in m or, after `or`, on one in rad; given is its value where it is known,
    None where the program finds it; basis, its integral and its slope over the length follow the length.
    """

    parameter: str
    unit: str
    given: Any
    basis: Any
    integral: Any
    slope: Any
    lower: float = -np.inf


@dataclass(frozen=True)
class Law(ABC):
    """Common ground of the laws: a law says its shares, the rest follows.

    along names the units of the paths that the law acts on: `m` for lengths, `rad` for angles, whose forces are
    torques. degree is that of the force as a polynomial of the length, None where it is no polynomial; pushes says
    whether the spring is a strut, which can only push; sources are keys in references.bib.
    """

    along: ClassVar[tuple[str, ...]] = ("m",)
    sources: ClassVar[tuple[str, ...]] = ()
    closes_free: ClassVar[bool] = False

    @property
    def degree(self) -> int | None:
        """Degree of the force as a polynomial of the length."""
        return 1

    @property
    def pushes(self) -> bool:
        """Whether the spring is a strut that can only push."""
        return False

    @property
    def own_mass(self) -> Any:
        """Mass, kg, that a real part brings along; the spring's `mass` comes on top."""
        return 0.0

    @property
    def drag(self) -> float | None:
        """Friction force of the spring itself, N, either way: 0 where there is none, None where it is not stated."""
        return 0.0

    @property
    def remarks(self) -> tuple[str, ...]:
        """What a description says beside the parameters."""
        return ()

    @property
    def span(self) -> tuple[Any, Any]:
        """Least and largest length at which the law holds, None where it has no such end."""
        return None, None

    @property
    def defined_beyond(self) -> bool:
        """Whether the force means something outside the span, where the spring only cannot be built."""
        return False

    @property
    def span_words(self) -> str:
        """What the ends of the span are called in messages."""
        return "span"

    @abstractmethod
    def shares(self, length: Array) -> tuple[Share, ...]:
        """The law's parameters with force and energy per unit of each, at lengths (..., N)."""

    def unknowns(self, owner: str, along: str = "m") -> tuple[Unknown, ...]:
        """The unknowns that the program must find, named `owner.parameter`, on a path in m or rad."""
        return tuple(
            Unknown(f"{owner}.{share.parameter}", along_path(share.unit, along), share.lower)
            for share in self.shares(np.ones(1))
            if share.given is None
        )

    def force_basis(self, length: Array) -> tuple[Array, Array]:
        """B (..., N, P) and f0 (..., N) of f = B theta + f0, N or N m; f > 0 pulls the ends together."""
        return self._split(length, "basis")

    def energy_basis(self, length: Array) -> tuple[Array, Array]:
        """E (..., N, P) and e0 (..., N) of the stored energy E theta + e0, J, with dE/dl = B."""
        return self._split(length, "integral")

    def slope_basis(self, length: Array) -> tuple[Array, Array]:
        """S (..., N, P) and s0 (..., N) of the rate df/dl = S theta + s0, N/m or N m/rad, with S = dB/dl."""
        return self._split(length, "slope")

    def _split(self, length: Array, what: str) -> tuple[Array, Array]:
        shares = self.shares(length)
        known = np.zeros_like(length)
        for share in shares:
            if share.given is not None:
                known = known + share.given * getattr(share, what)
        free = np.broadcast_arrays(length, *(getattr(share, what) for share in shares if share.given is None))[1:]
        return (np.stack(free, axis=-1) if free else np.zeros((*length.shape, 0), dtype=length.dtype)), known

    def force_at(self, length: Array, values: Mapping[str, float]) -> Array:
        """Force (..., N) at lengths (..., N) for given values of the law's unknowns {parameter: value}."""
        basis, known = self.force_basis(length)
        free = [share.parameter for share in self.shares(np.ones(1)) if share.given is None]
        return basis @ np.array([values[parameter] for parameter in free]) + known

    def line(self, values: Mapping[str, float]) -> tuple[float, float] | None:
        """(c0, c1) of a force c0 + c1 l for given values of the unknowns, None where it is not affine in l."""
        if self.degree is None or self.degree > 1:
            return None
        low, high = self.force_at(np.array([0.0, 1.0]), values)
        return float(low), float(high - low)

    def stored(self, values: Mapping[str, float], low: float, high: float) -> Stored:
        """What a simulator's tendon can hold of the law between two lengths, and how far off that is."""
        return store(lambda length: self.force_at(length, values), low, high, self.degree)

    def parameters(self, values: Mapping[str, float]) -> dict[str, float]:
        """All parameters, found and given, SI; values are those of the unknowns {parameter: value}."""
        found: dict[str, float] = {}
        for share in self.shares(np.ones(1)):
            found[share.parameter] = float(values[share.parameter] if share.given is None else share.given)
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name not in found and isinstance(value, int | float) and not isinstance(value, bool):
                found[field.name] = float(value)
        return found

    def details(self, values: Mapping[str, float], length: Array) -> dict[str, tuple[Any, str]]:  # noqa: ARG002
        """What else is worth knowing of it over lengths (N,): {words: (value or (least, largest), SI unit)}."""
        return {}

    def parameter_units(self, along: str = "m") -> dict[str, str]:
        """SI units of everything that `parameters` may name, on a path in m or rad."""
        units = {field.name: "" for field in fields(self)} | unit_marks(type(self))
        units |= {share.parameter: share.unit for share in self.shares(np.ones(1))}
        return {name: along_path(unit, along) for name, unit in units.items()}
