"""What can be made: extension springs over wire sizes, spring indices, coils and initial tensions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equipoise.errors import InputError
from equipoise.parts.catalogue import Catalogue
from equipoise.parts.extension import ExtensionSpring
from equipoise.parts.wire import MM, Series, grade, preferred_sizes
from equipoise.units import Length, Number


@dataclass(frozen=True)
class MakeableGrid:
    """Extension springs that can be wound: preferred wire sizes x spring indices x coils x shares of initial tension.

    grade of the wire and the series of its sizes (`metric`, `inch`); wire (least, largest), m, narrows them; index and
    coils are values to try; tension the shares of the largest initial tension that can be wound; loop the height of
    one loop over the inside diameter. Springs that cannot be wound are left out and counted by reason.
    """

    grade: str = "EN 10270-1 SH"
    series: Series = "metric"
    wire: tuple[Length, Length] | None = None
    index: tuple[Number, ...] = (5.0, 6.5, 8.0, 10.0, 12.5, 15.0)
    coils: tuple[Number, ...] = (8.0, 11.0, 15.0, 20.0, 27.0, 36.0, 50.0, 67.0, 90.0, 120.0)
    tension: tuple[Number, ...] = (0.4, 0.8)
    loop: Number = 1.0

    def catalogue(self) -> Catalogue:
        """All springs of the grid that can be wound; raises InputError where there is none."""
        low, high = self.wire or grade(self.grade).range
        sizes = preferred_sizes(self.series)
        sizes = sizes[(sizes >= low * (1 - 1e-9)) & (sizes <= high * (1 + 1e-9))]
        axes = (sizes, self.index, self.coils, self.tension)
        empty = [name for name, axis in zip(("wire", "index", "coils", "tension"), axes, strict=True) if not len(axis)]
        if empty:
            raise InputError(f"no {empty[0]} to try", where="grid", hint=_sizes_between(self.series, low, high))
        d, w, n, share = (part.ravel() for part in np.meshgrid(*map(np.asarray, axes), indexing="ij"))
        # A hair less than the most that can be wound, so that rounding for the order stays below it.
        bare = ExtensionSpring.of_rows(wire=d, diameter=w * d, coils=n, grade=self.grade, loop=self.loop)
        tension = _rounded(np.asarray(share * bare.largest_tension))
        diameter = np.round(w * d / MM, 2) * MM
        springs = ExtensionSpring.of_rows(
            wire=d, diameter=diameter, coils=n, grade=self.grade, initial_tension=tension, loop=self.loop
        )
        bad = {fault.reason: np.asarray(fault.rows) & np.ones(len(d), dtype=bool) for fault in springs.faults()}
        travel = np.asarray(springs.largest_force - springs.tension) / springs.k
        bad["no travel left beside the initial tension"] = ~(travel > 0)
        good = np.flatnonzero(~np.any(list(bad.values()), axis=0))
        if not len(good):
            said = ", ".join(f"{int(rows.sum())} {reason}" for reason, rows in bad.items() if rows.any())
            raise InputError(f"none of {len(d)} springs can be wound: {said}", where="grid", hint="widen the grid")

        def make(row: int) -> ExtensionSpring:
            i = good[row]
            return ExtensionSpring(
                float(d[i]), float(diameter[i]), float(n[i]), self.grade, float(tension[i]), loop=float(self.loop)
            )

        return Catalogue(
            name=f"springs wound of {grade(self.grade).name}",
            part=tuple(f"wire {d[i] / MM:g} D {diameter[i] / MM:g} n {n[i]:g} F0 {tension[i]:g} N" for i in good),
            form=("extension",) * len(good),
            rate=np.asarray(springs.k)[good],
            free_length=np.asarray(springs.own_length)[good],
            initial_tension=tension[good],
            travel=travel[good],
            mass=np.asarray(springs.own_mass)[good],
            width=(diameter + d)[good],
            line=good,
            make=make,
            remarks=tuple(f"{int(rows.sum())} left out: {reason}" for reason, rows in bad.items() if rows.any()),
        )


def _sizes_between(series: str, low: float, high: float) -> str:
    return f"the {series} series has no size between {low / MM:g} and {high / MM:g} mm, or a list is empty"


def _rounded(tension: np.ndarray) -> np.ndarray:
    """Rounded down to two digits."""
    ten = 10.0 ** np.floor(np.log10(np.maximum(tension, 1e-6)) - 1)
    return np.floor(tension / ten) * ten
