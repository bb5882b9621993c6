"""The extension spring of round wire, with loops and initial tension."""

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
from equipoise.parts.wire import MM, UNSOURCED
from equipoise.units import Force, Length, Number

BODY, HOOK_BENDING, HOOK_TORSION = 0.45, 0.75, 0.40
"""Allowed shares of Rm: shear in the body [aabag_extension], bending and torsion in the hook [tinmy_hooks]."""
BANDS = {"bench": (0.135, 0.00625), "automatic": (0.075, 0.00375)}
"""(a, b) of the largest initial shear stress (a - b w) Rm by way of coiling; unsourced numbers."""

Coiling = Literal["bench", "automatic"]


def largest_initial_stress(index: Any, strength: Any, coiling: Coiling = "bench") -> Any:
    """tau0 <= (a - b w) Rm, Pa, that can be wound into an extension spring of index w from wire of strength Rm, Pa.

    That it is a share of Rm which falls with the index is aabag's [aabag_extension]; a and b are unsourced.
    """
    a, b = BANDS[coiling]
    share = a - b * index
    return np.where(np.real(share) > 0, share, 0.0)[()] * strength


def hook_bending_factor(radius: Any, wire: Any) -> Any:
    """K_A = (4 C^2 - C - 1) / (4 C (C - 1)), C = 2 r / d, at the far side of a loop of mean radius r [machinecalcs]."""
    c = 2 * radius / wire
    return (4 * c * c - c - 1) / (4 * c * (c - 1))


def hook_torsion_factor(radius: Any, wire: Any) -> Any:
    """K_B = (4 C - 1) / (4 C - 4) with C = 2 r / d, where the body bends up into the loop [machinecalcs]."""
    c = 2 * radius / wire
    return (4 * c - 1) / (4 * c - 4)


@dataclass(frozen=True)
class ExtensionSpring(Helical):
    """An extension spring: f = N (F0 + R (l - leader - L0)), closed below L0, with two loops that bear it.

        R = G d^4 / (8 D^3 n),   L0 = (n + 1) d + 2 loop (D - d),   F <= min(body, hook in bending, hook in torsion)
        body .45 Rm = 8 F D/(pi d^3),   hook .75 Rm = F (K_A 16 D/(pi d^3) + 4/(pi d^2)),   .4 Rm = K_B 8 F D/(pi d^3)

    wire d, diameter D (mean), m, coils n, grade of the wire; initial_tension F0, N, of one spring; number N act in
    parallel; leader, m, is a rod or wire between spring and hook; loop is the height of one loop over the inside
    diameter; free_length L0, m, between the insides of the loops, replaces what follows from coils and loops; bend is
    the radius, m, at which the body rises into the loop (two wires where none is said). Static loads; hooks after
    Shigley. Raises InputError for a wire outside its grade, an index outside 4..20, fewer than 2 coils, and an
    initial tension that cannot be wound [aabag_extension, tinmy_hooks, machinecalcs, caruso_en_springs].
    """

    initial_tension: Force = 0.0
    number: Number = 1.0
    leader: Length = 0.0
    loop: Number = 1.0
    free_length: Length | None = None
    bend: Length | None = None
    coiling: Coiling = "bench"
    kind: ClassVar[str] = "extension spring"
    standard: ClassVar[str] = "EN 13906-2"
    sources: ClassVar[tuple[str, ...]] = ("aabag_extension", "tinmy_hooks", "machinecalcs", "caruso_en_springs")

    @property
    def k(self) -> Any:
        """Rate, N/m, of all the springs in parallel."""
        return self.number * coil.rate(self.wire, self.diameter, self.coils, self.material.shear)

    @property
    def body_length(self) -> Any:
        """(n + 1) d, m."""
        return (self.coils + 1) * self.wire

    @property
    def own_length(self) -> Any:
        """Free length L0 over the insides of the loops, m."""
        if self.free_length is not None:
            return self.free_length
        return self.body_length + 2 * self.loop * (self.diameter - self.wire)

    @property
    def total_coils(self) -> Any:
        """Active coils and the wire of two loops, about one turn each."""
        return self.coils + 2

    @property
    def rest(self) -> Any:
        """Length at which the initial tension acts, leader included, m."""
        return self.own_length + self.leader

    @property
    def tension(self) -> Any:
        """Initial tension, N, of all the springs in parallel."""
        return self.number * self.initial_tension

    @property
    def largest_tension(self) -> Any:
        """The largest initial tension, N, of one spring that can be wound."""
        stress = largest_initial_stress(self.index, self.strength, self.coiling)
        return stress / coil.shear_stress(1.0, self.wire, self.diameter)

    @property
    def per_newton(self) -> tuple[tuple[str, Any, float, str], ...]:
        """(words, stress per N, Pa, allowed share of Rm, source) of every clause of one spring."""
        shear = coil.shear_stress(1.0, self.wire, self.diameter)
        rise = 2 * self.wire if self.bend is None else self.bend
        bending = hook_bending_factor(self.diameter / 2, self.wire) * 2 * shear + 4 / (np.pi * self.wire**2)
        return (
            ("body shear", shear, BODY, "aabag_extension"),
            ("hook bending", bending, HOOK_BENDING, "tinmy_hooks"),
            ("hook torsion", hook_torsion_factor(rise, self.wire) * shear, HOOK_TORSION, "tinmy_hooks"),
        )

    @property
    def largest_force(self) -> Any:
        """The largest static force, N, of all the springs in parallel."""
        return self.number * coil.smallest(*(share * self.strength / each for _, each, share, _ in self.per_newton))

    @property
    def span(self) -> tuple[Any, Any]:
        """Closed at rest, and the length at the largest force."""
        return self.rest, self.rest + (self.largest_force - self.tension) / self.k

    def faults(self) -> Iterator[Fault]:
        """What cannot be wound."""
        yield from super().faults()
        tension, most = self.initial_tension, self.largest_tension
        yield Fault(
            "initial tension cannot be wound",
            coil.smallest(tension, most - tension),
            max(abs(first_of(most)), 1e-3),
            f"the initial tension {first_of(tension):.4g} N cannot be wound: 0 to {first_of(most):.4g} N for index "
            f"{first_of(self.index):.3g} and Rm {first_of(self.strength) / 1e6:.0f} MPa ({self.coiling} coiling, "
            "unsourced)",
            "take a thicker wire, a smaller index, or less tension",
            "N",
        )

    def force_of_one(self, length: Array) -> Array:
        """Force (N,), N, in one spring at lengths (N,)."""
        return (self.tension + self.k * (length - self.rest)) / self.number

    def clauses(self, length: Array) -> Iterator[Clause]:
        """Body and hook under the largest force over lengths (N,)."""
        force = float(self.force_of_one(length).max())
        for words, each, share, source in self.per_newton:
            yield Clause(words, force * float(each), share * float(self.strength), "Pa", source)
        most = float(self.largest_tension)
        if self.initial_tension > 0:
            yield Clause("initial tension", float(self.initial_tension), most, "N", UNSOURCED)

    def plain_stress(self, length: Array) -> Array:
        """tau of the body."""
        return coil.shear_stress(self.force_of_one(length), self.wire, self.diameter)

    def fatigue(self, length: Array, *, peened: bool = False, correction: Correction = "wahl") -> float:
        """Safety of the body against fatigue between the lengths (N,); loops are not covered [machinecalcs]."""
        stress = self.stress(length, correction)
        return float(coil.fatigue_safety(stress.min(), stress.max(), self.strength, peened=peened))

    @property
    def natural_frequency(self) -> Any:
        """First surge mode, Hz."""
        return coil.natural_frequency(self.wire, self.diameter, self.coils, self.material.shear, self.material.density)

    @property
    def unsourced(self) -> tuple[str, ...]:
        """The band of initial tension, and the grade where it is."""
        band = ("the largest initial tension",) if np.any(self.initial_tension) else ()
        return (*super().unsourced, *band)

    def order_line(self) -> str:
        """`EN 13906-2, wire EN 10270-1 SH 3.6, D 40, n 61, L0 ..., F0 ..., R ...`, mm, N and N/mm."""
        line = f"{self.head()}, L0 {self.own_length / MM:.4g}"
        tension = f", F0 {self.initial_tension:.4g} N" if self.initial_tension else ", open coiled without F0"
        return f"{line}{tension}, R {self.k / self.number / 1e3:.4g} N/mm"
