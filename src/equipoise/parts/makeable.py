"""What a winder offers: wire, index, width and number in parallel, and in closed form the springs it makes possible."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.errors import InputError
from equipoise.parts.helical import INDEX, LEAST_COILS
from equipoise.parts.windable import WindableSpring
from equipoise.parts.wire import MM, Series, grade, preferred_sizes
from equipoise.units import Length, Mass, Number, text

INDICES = 8
"""Spring indices that are looked at."""
RESERVE = 0.01
"""Share by which a spring of round sizes is chosen too strong: its own mass is still to be carried."""
PIECES = 4_000_000
"""Numbers in one array of springs against options."""


@dataclass(frozen=True)
class Makeable:
    """Extension springs that can be wound, up to `parallel` of one side by side.

    grade of the wire, the series of its sizes (`metric`, `inch`), wire (least, largest), m; index (least, largest) of
    D / d; width, m, the largest outside diameter; loop the height of a loop over the inside diameter. step, m, is what
    mean coil diameters are rounded to, turn what coils are; mass, kg, the most that a spring with those in parallel to
    it may weigh. Raises InputError where no size is left.
    """

    grade: str = "EN 10270-1 SH"
    series: Series = "metric"
    wire: tuple[Length, Length] | None = None
    index: tuple[Number, Number] = (5.0, 12.0)
    width: Length = 0.06
    parallel: int = 4
    loop: Number = 1.0
    step: Length = 0.5 * MM
    turn: Number = 0.5
    mass: Mass | None = None

    def __post_init__(self) -> None:
        low, high = self.index
        if not INDEX[0] <= low < high <= INDEX[1]:
            raise InputError(
                f"the index runs from {low:g} to {high:g}", where="make.index", hint="[5, 12], within 4 to 20"
            )
        for name in ("width", "parallel", "loop", "step", "turn", "mass"):
            value = getattr(self, name)
            if value is not None and not value > 0:
                raise InputError(f"{name} is {value:g}, it must be positive", where=f"make.{name}")
        if not len(self.sizes):
            first, last = self.wire or grade(self.grade).range
            raise InputError(
                f"no {self.series} size of {grade(self.grade).name} from {first / MM:g} to {last / MM:g} mm winds a "
                f"spring of index {low:g} within {text(self.width, 'm')}",
                where="make",
                hint="widen wire or width",
            )

    @cached_property
    def sizes(self) -> Array:
        """Wire sizes (M,), m, that are kept in stock and fit the width."""
        material = grade(self.grade)
        low, high = self.wire or material.range
        found = preferred_sizes(self.series)
        fits = (found >= low * (1 - 1e-9)) & (found <= high * (1 + 1e-9)) & material.covers(found)
        return found[fits & (found * (self.index[0] + 1) <= self.width * (1 + 1e-9))]

    def freed(self, name: str) -> dict[str, tuple[float, float]]:
        """Between which values wire and index of a spring may move, by parameter."""
        low, high = float(self.sizes.min()), float(self.sizes.max())
        wire = {f"{name}.law.wire": (low, high)} if high > low else {}
        return {**wire, f"{name}.law.index": (float(self.index[0]), float(self.index[1]))}

    def start(self, option: Indices, room: float | None = None) -> WindableSpring:
        """An option as a spring still to be wound."""
        place = int(np.ravel(option)[0])
        wire, index, _ = self.options.columns
        return self.law(float(wire[place]), float(index[place]), float(self.parallel), room)

    def law(self, wire: Any, index: Any, number: Any, room: float | None = None) -> WindableSpring:
        """A spring still to be wound, or rows of them."""
        return WindableSpring(wire, index, number, self.grade, self.loop, room, self.width, self.mass)

    @cached_property
    def options(self) -> WindableSpring:
        """Every wire with several indices, as many in parallel as may be: rows (O,)."""
        d, C = (part.ravel() for part in np.meshgrid(self.sizes, np.linspace(*self.index, INDICES), indexing="ij"))
        slim = (C + 1) * d <= self.width * (1 + 1e-9)
        return self.law(d[slim], C[slim], float(self.parallel))

    @cached_property
    def _shares(self) -> tuple[Array, Array, Array, Array, Array]:
        """Per option (O,): a = S / F_max, b = F0_max / F_max, H, F_max, and the most that its mass can stretch; SI."""
        law, most = self.options, np.asarray(self.options.largest_force)
        reach = most / np.maximum(law.least_rate, 1e-12)
        return np.asarray(law.stack) / most, np.asarray(law.largest_tension) / most, np.asarray(law.hooks), most, reach

    def least_free(self, short: Array, long: Array) -> Array:
        """Least free length L0 (C,), m, of springs hooked on straight at lengths short to long (C,); inf where none.

        At full strength, k (l_max - L0) = F_max, the polygon of a `WindableSpring` leaves

            a (l_max - L0) <= l_min - H,   (a - b) (l_max - L0) <= L0 - H
        """
        return self._over(self._least, (short, long), np.minimum, np.inf)

    def most_straight(self, short: Array, long: Array, free: Array) -> tuple[Array, Indices]:
        """The stiffest springs hooked on straight, with the free length (C,): their rate (C,), N/m, and the option."""

        def force(short: Array, long: Array, free: Array) -> Array:
            return np.where(self._least(short, long) <= free * (1 + 1e-9), self._shares[3] / (long - free), 0.0)

        return self._best(force, (short, long, free))

    def longest_behind(self, stroke: Array, room: Array) -> Array:
        """Largest extension l - L0 (C,), m, of springs in rooms (C,) behind a cable, over strokes (C,); -inf if none.

        a x + H + x - b x <= room,   a x + H + stroke <= room
        """

        def reach(stroke: Array, room: Array) -> Array:
            a, b, hooks, _, far = self._shares
            found = np.minimum(np.minimum((room - hooks) / (1 + a - b), (room - hooks - stroke) / a), far)
            return np.where(found >= stroke, found, -np.inf)

        return self._over(reach, (stroke, room), np.maximum, -np.inf)

    def most_behind(self, stroke: Array, room: Array, extension: Array) -> tuple[Array, Indices]:
        """The stiffest springs behind a cable at extensions of up to (C,), m: their rate (C,), N/m, and the option."""

        def force(stroke: Array, room: Array, extension: Array) -> Array:
            a, b, hooks, most, far = self._shares
            fits = (a * extension + hooks + stroke <= room) & ((1 + a - b) * extension + hooks <= room)
            fits &= extension <= far
            return np.where(fits, most / extension, 0.0)

        return self._best(force, (stroke, room, extension * (1 - 1e-9)))

    def mass_at(self, option: Indices, rate: Array) -> Array:
        """Own mass (C,), kg, of options (C,) with rates (C,), N/m; 0 where there is no rate."""
        law = self.options
        wire, index, _ = law.columns
        coils = (law.stack / wire)[option] / np.maximum(rate, 1e-300)
        some = self.law(wire[option], index[option], float(self.parallel))
        return np.where(rate > 0, np.asarray(some.mass_of(coils)), 0.0)

    def _least(self, short: Array, long: Array) -> Array:
        a, b, hooks, _, far = self._shares
        found = np.maximum(long - np.minimum((short - hooks) / a, far), ((a - b) * long + hooks) / (1 + a - b))
        return np.where(found < short, np.maximum(found, 0.0), np.inf)

    def _over(self, value: Any, numbers: tuple[Array, ...], pick: np.ufunc, none: float) -> Array:
        found = [pick.reduce(value(*part), axis=-1, initial=none) for part in self._parts(numbers)]
        return np.concatenate(found) if found else np.zeros(0)

    def _best(self, value: Any, numbers: tuple[Array, ...]) -> tuple[Array, Indices]:
        best, which = [np.zeros(0)], [np.zeros(0, dtype=np.intp)]
        for part in self._parts(numbers):
            found = value(*part)
            which.append(found.argmax(axis=-1))
            best.append(found.max(axis=-1))
        return np.concatenate(best), np.concatenate(which)

    def _parts(self, numbers: tuple[Array, ...]) -> list[tuple[Array, ...]]:
        step = max(1, PIECES // len(self._shares[0]))
        wide = np.broadcast_arrays(*map(np.asarray, numbers))
        return [tuple(one[start : start + step, None] for one in wide) for start in range(0, len(wide[0]), step)]

    def round(self, law: WindableSpring, k: float, product: float, length: Array) -> list[WindableSpring]:
        """The lightest and the nearest of all springs of stocked wire and round diameter that serve; or the nearest.

        law says what was found with free wire and index, k, N/m, and product k L0, N, its values over lengths (N,).
        The lightest is that of the fewest in parallel.
        """
        rows = self._round(law.room)
        short = _misses(rows, k, product, float(length.min()), float(length.max()))
        wire, index, number = rows.columns
        mass = np.asarray(rows.mass_of(rows.stack / (wire * k)))
        near = np.abs(np.log(wire / law.wire)) + np.abs(np.log(index / law.index)) + 0.1 * number
        near = near + 0.1 * np.abs(number - law.number)
        serves = short <= -RESERVE
        orders = [np.lexsort((mass, number, ~serves, np.where(serves, 0.0, short)))]
        orders.append(np.lexsort((near, np.where(short <= 0.0, 0.0, short))))
        picked = list(dict.fromkeys(int(order[0]) for order in orders))
        return [self.law(float(wire[at]), float(index[at]), float(number[at]), law.room) for at in picked]

    def _round(self, room: float | None) -> WindableSpring:
        """All stocked wires with round diameters, one to `parallel` of each: rows."""
        diameters = np.arange(1, int(self.width / self.step) + 1) * self.step
        axes = (self.sizes, diameters, np.arange(1.0, self.parallel + 1))
        d, D, N = (part.ravel() for part in np.meshgrid(*axes, indexing="ij"))
        index = D / d
        fits = (index >= self.index[0]) & (index <= self.index[1]) & (D + d <= self.width * (1 + 1e-9))
        return self.law(d[fits], index[fits], N[fits], room)


def _misses(rows: WindableSpring, k: float, product: float, low: float, high: float) -> Array:
    """By what share (O,) rows of springs miss what serves with k, N/m, and k L0, N, from length low to high, m."""
    stack, tension = np.asarray(rows.stack), np.asarray(rows.largest_tension)
    closed = stack + rows.hooks * k
    found = [
        (k * high - product) / np.asarray(rows.largest_force) - 1,
        LEAST_COILS * k * rows.wire / stack - 1,
        rows.least_rate / k - 1,
    ]
    if rows.room is None:
        found += [closed / (k * low) - 1, (closed - product - tension) / (k * low)]
    else:
        needed = closed + k * (high - low)
        found += [(closed + k * high - product - tension) / (k * rows.room) - 1, needed / (k * rows.room) - 1]
    return np.max(np.broadcast_arrays(*found), axis=0)
