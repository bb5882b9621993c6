"""The compression spring of round wire, with its solid length and buckling."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from equipoise.affine import Array
from equipoise.parts import coil
from equipoise.parts.coil import Correction
from equipoise.parts.helical import Helical, first_of
from equipoise.parts.part import Clause, Fault
from equipoise.parts.wire import MM
from equipoise.units import Length, Number

WORKING, SOLID = 0.50, 0.56
"""Allowed shares of Rm of the uncorrected shear stress, at work [fossee_bhandari] and at solid [caruso_en_springs]."""

Ends = Literal["ground", "closed"]


def solid_length(wire: Any, total_coils: Any, ends: Ends = "ground") -> Any:
    """L_c = n_t d with closed and ground ends, (n_t + 1.5) d with closed ends, m [caruso_en_springs]."""
    return (total_coils + (0.0 if ends == "ground" else 1.5)) * wire


def least_gap(wire: Any, diameter: Any, coils: Any) -> Any:
    """S_a = n (.0015 D^2 / d + .1 d): the sum of gaps left at the shortest working length, m [caruso_en_springs]."""
    return coils * (0.0015 * diameter**2 / wire + 0.1 * wire)


def buckling_deflection(free_length: Any, diameter: Any, seating: Any, young: Any, shear: Any) -> Any:
    """Deflection s_K, m, at which a compression spring of free length L0, m, buckles; inf where it never does.

        s_K = L0 / (2 (1 - g)) [1 - sqrt(1 - (1 - g) / (.5 + g) (pi D / (nu L0))^2)],   g = G / E

    seating nu: .5 both ends flat and guided, .7 one of them hinged, 1 both hinged, 2 one free [caruso_en_springs].
    """
    g = shear / young
    root = 1 - (1 - g) / (0.5 + g) * (np.pi * diameter / (seating * free_length)) ** 2
    safe = np.where(np.real(root) > 0, root, 1.0)
    return np.where(np.real(root) > 0, free_length * 0.5 / (1 - g) * (1 - np.sqrt(safe)), np.inf)[()]


@dataclass(frozen=True)
class CompressionSpring(Helical):
    """A compression spring: f = N R (l - leader - L0), negative: it pushes; R = G d^4 / (8 D^3 n).

    wire d, diameter D (mean), free_length L0, m, coils n (active; two more lie at the ends), grade of the wire; ends
    ground or only closed; number N act in parallel; leader, m, is a rod between spring and hook; seating nu of its
    ends against buckling, None where a pin or sleeve guides it. The working range ends at the longest of: the solid
    length with the least gaps, the length at .5 Rm, and the length at which it buckles. Raises InputError for a wire
    outside its grade, an index outside 4..20, fewer than 2 coils, and a free length below the shortest working one.
    After EN 13906-1 as others quote it [fossee_bhandari, caruso_en_springs].
    """

    free_length: Length = 0.1
    number: Number = 1.0
    leader: Length = 0.0
    ends: Ends = "ground"
    seating: Number | None = 1.0
    kind: ClassVar[str] = "compression spring"
    standard: ClassVar[str] = "EN 13906-1"
    sources: ClassVar[tuple[str, ...]] = ("fossee_bhandari", "caruso_en_springs")

    @property
    def pushes(self) -> bool:
        """It can only push."""
        return True

    @property
    def k(self) -> Any:
        """Rate, N/m, of all the springs in parallel."""
        return self.number * coil.rate(self.wire, self.diameter, self.coils, self.material.shear)

    @property
    def rest(self) -> Any:
        """Free length, leader included, m."""
        return self.free_length + self.leader

    @property
    def total_coils(self) -> Any:
        """n + 2."""
        return self.coils + 2

    @property
    def solid(self) -> Any:
        """Solid length L_c, m."""
        return solid_length(self.wire, self.total_coils, self.ends)

    @property
    def largest_force(self) -> Any:
        """The largest static force, N, of all the springs in parallel."""
        return self.number * WORKING * self.strength / coil.shear_stress(1.0, self.wire, self.diameter)

    @property
    def deflections(self) -> tuple[Any, Any, Any]:
        """Deflections, m, at the least gaps, at the largest force and where it buckles."""
        gaps = self.free_length - self.solid - least_gap(self.wire, self.diameter, self.coils)
        force = self.largest_force / self.k
        if self.seating is None:
            return gaps, force, np.inf
        made = self.material
        return gaps, force, buckling_deflection(self.free_length, self.diameter, self.seating, made.young, made.shear)

    @property
    def span(self) -> tuple[Any, Any]:
        """The shortest working length, and the free one."""
        return self.rest - coil.smallest(*self.deflections), self.rest

    def faults(self) -> Iterator[Fault]:
        """What cannot be wound, or has no way to go."""
        yield from super().faults()
        yield Fault(
            "free length below the shortest working length",
            self.deflections[0],
            first_of(self.free_length),
            f"the free length {first_of(self.free_length) / MM:.4g} mm leaves no way to go: solid it is "
            f"{first_of(self.solid) / MM:.4g} mm",
            "give a longer free length, fewer coils or a thinner wire",
            "m",
        )

    def clauses(self, length: Array) -> Iterator[Clause]:
        """Shear at work, shear at solid, and buckling, at the shortest of lengths (N,)."""
        each = float(coil.shear_stress(1.0, self.wire, self.diameter))
        deflection = float(self.rest - length.min())
        strength, rate = float(self.strength), float(self.k / self.number)
        yield Clause("shear", deflection * rate * each, WORKING * strength, "Pa", "fossee_bhandari")
        solid = (self.free_length - self.solid) * rate * each
        yield Clause("shear at solid", float(solid), SOLID * strength, "Pa", "caruso_en_springs")
        buckles = float(self.deflections[2])
        if np.isfinite(buckles):
            yield Clause("deflection before buckling", deflection, buckles, "m", "caruso_en_springs")

    def plain_stress(self, length: Array) -> Array:
        """tau of the coil."""
        return coil.shear_stress(self.k / self.number * (self.rest - length), self.wire, self.diameter)

    def fatigue(self, length: Array, *, peened: bool = False, correction: Correction = "wahl") -> float:
        """Safety against fatigue between the lengths (N,) [machinecalcs]."""
        stress = self.stress(length, correction)
        return float(coil.fatigue_safety(stress.min(), stress.max(), self.strength, peened=peened))

    @property
    def natural_frequency(self) -> Any:
        """First surge mode, Hz."""
        return coil.natural_frequency(self.wire, self.diameter, self.coils, self.material.shear, self.material.density)

    def order_line(self) -> str:
        """`EN 13906-1, wire EN 10270-1 SH 7, D 42, n 8, nt 10, L0 110, ground ends, R ...`, mm and N/mm."""
        ends = "closed and ground ends" if self.ends == "ground" else "closed ends"
        return (
            f"{self.head()}, nt {self.total_coils:.4g}, L0 {self.free_length / MM:.4g}, {ends}, "
            f"R {self.k / self.number / 1e3:.4g} N/mm"
        )
