"""The extension spring that is still to be wound: wire and index are given, coils and initial tension follow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.laws.law import Law, Share
from equipoise.errors import InfeasibleError, InputError
from equipoise.parts import coil
from equipoise.parts.extension import ExtensionSpring
from equipoise.parts.helical import LEAST_COILS
from equipoise.units import Length, Mass, Number, Stiffness, text

EASE = 1e-6
"""Relative excess that counts as rounding."""


@dataclass(frozen=True)
class WindableSpring(Law):
    """An extension spring of given wire and index whose rate k (or not) and free length L0 are found, f = k (l - L0).

    With wire d, m, spring index C = D / d, N springs in parallel (number), shear modulus G, and loops as high as
    `loop` inside diameters,

        n d k = S = N G d^2 / (8 C^3),   closed length = S / k + H,   H = d (1 + 2 loop (C - 1))

    so for given d, C and N all that can be wound is a polygon in k and k L0: at every length l

        0 <= k l - k L0 <= F_max,   2 k d <= S,   S + H k - k L0 <= F0_max

    and hooked straight on, S + H k <= k l: closed at most at the shortest length, a rod (leader) making up the rest;
    or in a room, m, along a link behind a cable, S + H k + f(l) - min(F0_max, f(l_min)) <= k room. F_max and F0_max
    are strength and largest initial tension of an `ExtensionSpring`. (C + 1) d <= width, m, the largest outside
    diameter; as n d k = S, a largest own mass, heaviest, kg, is a least rate. The own mass itself counts where k, N/m,
    of all in parallel, is given. Raises InputError for a wire outside its grade, an index outside 4..20 and lengths
    that are not positive.
    """

    wire: Length
    index: Number
    number: Number = 1.0
    grade: str = "EN 10270-1 SH"
    loop: Number = 1.0
    room: Length | None = None
    width: Length | None = None
    heaviest: Mass | None = None
    k: Stiffness | None = None
    sources: ClassVar[tuple[str, ...]] = ExtensionSpring.sources
    # What a coil answers where its free length is found.
    free_length: ClassVar[None] = None

    def __post_init__(self) -> None:
        for name in ("wire", "index", "number", "room", "width", "heaviest", "k"):
            value = getattr(self, name)
            if isinstance(value, int | float) and not value > 0:
                raise InputError(f"{name} is {value:g}, it must be positive", where="law windable_spring")
        _ = self.sample

    @property
    def columns(self) -> tuple[Array, Array, Array]:
        """Wire (C,), m, index (C,) and number in parallel (C,) of rows of springs."""
        wire, index, number = np.broadcast_arrays(self.wire, self.index, self.number)
        return wire, index, number

    @cached_property
    def sample(self) -> ExtensionSpring:
        """A spring of this wire and index, whatever its coils: its strength does not depend on them."""
        return ExtensionSpring(
            self.wire, self.index * self.wire, LEAST_COILS, self.grade, number=self.number, loop=self.loop
        )

    @cached_property
    def stack(self) -> Any:
        """S = n d k, N: the force that stretches all in parallel by the length of their coils."""
        shear = self.sample.material.shear
        return self.number * shear * np.asarray(self.wire) ** 2 / (8 * np.asarray(self.index) ** 3)

    @property
    def hooks(self) -> Any:
        """H, m: what of the closed length is no active coil."""
        return self.wire * (1 + 2 * self.loop * (self.index - 1))

    @cached_property
    def largest_force(self) -> Any:
        """F_max, N, of all in parallel."""
        return self.sample.largest_force

    @cached_property
    def largest_tension(self) -> Any:
        """F0_max, N, of all in parallel."""
        return self.number * self.sample.largest_tension

    @property
    def least_rate(self) -> Any:
        """The softest springs in parallel, N/m, that are not too heavy: those with the most coils."""
        if self.heaviest is None:
            return 0.0
        bare, coils = self.mass_of(0.0), self.mass_of(1.0) - self.mass_of(0.0)
        left = np.asarray(self.heaviest - bare)
        none = np.real(left) <= 0
        return np.where(none, np.inf, self.stack / self.wire * coils / np.where(none, 1.0, left))[()]

    @property
    def own_mass(self) -> Any:
        """Own mass, kg, of all in parallel where their rate is given, else 0."""
        return 0.0 if self.k is None else self.mass_of(self.stack / (self.wire * self.k))

    def mass_of(self, coils: Any) -> Any:
        """Own mass, kg, of all in parallel with so many active coils."""
        sample = self.sample
        wire = coil.wire_mass(sample.wire, sample.diameter, sample.total_coils - sample.coils + coils, self.density)
        return self.number * wire

    @property
    def density(self) -> float:
        """Density of the wire, kg/m^3."""
        return self.sample.material.density

    @property
    def outside(self) -> Any:
        """Outside diameter (C + 1) d of one spring, m."""
        return (self.index + 1) * self.wire

    def shares(self, length: Array) -> tuple[Share, ...]:
        """Rate and the product k L0."""
        one = np.ones_like(length)
        return (
            Share("k", "N/m", self.k, length, length * length / 2, one, lower=0.0),
            Share("k_free_length", "N", None, -one, -length, 0.0 * one),
        )

    def parameters(self, values: Mapping[str, float]) -> dict[str, float]:
        """All parameters, the free length and the coils among them."""
        found = super().parameters(values)
        if found["k"] > 0:
            found["free_length"] = found["k_free_length"] / found["k"]
            found["coils"] = self.coils_of(found["k"])
        return found

    def parameter_units(self, along: str = "m") -> dict[str, str]:
        """SI units of everything that `parameters` may name."""
        return super().parameter_units(along) | {"free_length": "m", "coils": ""}

    def coils_of(self, k: float) -> float:
        """Active coils n of springs with the rate k, N/m, of all in parallel."""
        return float(self.stack / (self.wire * k))

    def tensions(self, k: float, product: float, length: Array) -> tuple[float, float]:
        """Least and largest initial tension, N, of all in parallel, with which lengths (N,) can be served."""
        closed, low, high = float(self.stack + self.hooks * k), float(length.min()), float(length.max())
        most = min(float(self.largest_tension), k * low - product)
        least = closed - product if self.room is None else closed + k * (high - self.room) - product
        return max(least, 0.0), most

    def wound(self, k: float, product: float, length: Array) -> ExtensionSpring:
        """The spring with rate k, N/m, and k L0, N, over lengths (N,), m.

        Its initial tension is in the middle of what serves, a leader makes up for what the closed spring is shorter
        (behind a cable the cable's length does). Raises InfeasibleError where it cannot be wound.
        """
        least, most = self.tensions(k, product, length)
        force, reach = k * float(length.max()) - product, float(self.largest_force)
        slack = EASE * reach
        if least > most + slack or force > reach + slack:
            raise InfeasibleError(
                f"no spring of wire {text(self.wire, 'm')} and index {self.index:.3g} serves: it would need "
                f"{text(least, 'N')} of initial tension, {text(most, 'N')} can be, and bears {text(reach, 'N')} of "
                f"{text(force, 'N')}",
                where="law windable_spring",
                hint="shape with it, or take another wire, index or number",
            )
        tension = max(0.0, (least + min(most, float(self.largest_tension))) / 2)
        made = ExtensionSpring(
            self.wire, self.index * self.wire, self.coils_of(k), self.grade, tension / self.number,
            number=self.number, loop=self.loop,
        )  # fmt: skip
        if self.room is not None:
            return made
        leader = max((product + tension) / k - made.own_length, 0.0)
        return ExtensionSpring(
            made.wire, made.diameter, made.coils, made.grade, made.initial_tension,
            number=made.number, leader=leader, loop=made.loop,
        )  # fmt: skip

    def details(self, values: Mapping[str, float], length: Array) -> dict[str, tuple[Any, str]]:
        """Coil diameter, coils, the room for its initial tension, and its strength."""
        k, product = float(values.get("k", self.k or 0.0)), values["k_free_length"]
        if not k > 0:
            return {}
        force = k * length - product
        return {
            "mean coil diameter": (float(self.index * self.wire), "m"),
            "active coils": (self.coils_of(k), ""),
            "closed length": (float(self.stack / k + self.hooks), "m"),
            "initial tension that serves": (self.tensions(k, product, length), "N"),
            "strength, used": (100 * float(force.max() / self.largest_force), "%"),
            "spring index": (float(coil.spring_index(self.wire, self.index * self.wire)), ""),
        }
