"""Interval jets: bounds on a quantity and on its slopes over boxes of parameters, many boxes at once.

Outward rounding is left to the user of the bounds: each operation is exact to a few units in the last place.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array

Interval = tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class Jet:
    """low <= x <= high over every box, and the same for dx/dgamma_j.

    low, high (1 + G, C, N): the value first, then the slopes along the G parameters; C boxes, N states.
    """

    low: Array
    high: Array

    # A ndarray on the left must leave its operators to this class.
    __array_ufunc__ = None

    @staticmethod
    def constant(value: Any, parameters: int) -> Jet:
        """A quantity that no parameter moves, broadcast to (C, N) with ones."""
        plain = np.asarray(value, dtype=float)
        plain = plain.reshape((1,) * (2 - plain.ndim) + plain.shape)
        both = np.zeros((1 + parameters, *plain.shape))
        both[0] = plain
        return Jet(both, both)

    @staticmethod
    def variable(index: int, low: Array, high: Array, parameters: int) -> Jet:
        """Parameter number `index` between low and high (C,)."""
        ends = []
        for end in (low, high):
            both = np.zeros((1 + parameters, len(end), 1))
            both[0, :, 0], both[1 + index] = end, 1.0
            ends.append(both)
        return Jet(*ends)

    @property
    def value(self) -> Interval:
        """Bounds (C, N) of the value."""
        return self.low[0], self.high[0]

    def __add__(self, other: Any) -> Jet:
        if not isinstance(other, Jet):
            return self._through_value(other)
        return Jet(self.low + other.low, self.high + other.high)

    __radd__ = __add__

    def __neg__(self) -> Jet:
        return Jet(-self.high, -self.low)

    def __sub__(self, other: Any) -> Jet:
        return self + (-other)

    def __rsub__(self, other: Any) -> Jet:
        return -self + other

    def _through_value(self, added: Any) -> Jet:
        """The same slopes about a value moved by numbers (N,)."""
        shape = np.broadcast_shapes(self.low.shape, np.shape(added))
        low, high = (np.broadcast_to(end, shape).copy() for end in (self.low, self.high))
        low[0] += added
        high[0] += added
        return Jet(low, high)

    def _scaled(self, factor: Any) -> Jet:
        """Times numbers (N,)."""
        a, b = self.low * factor, self.high * factor
        return Jet(np.minimum(a, b), np.maximum(a, b))

    def __mul__(self, other: Any) -> Jet:
        if not isinstance(other, Jet):
            return self._scaled(other)
        if other is self:
            return self.square()
        value = _times(self.value, other.value)
        left = _times((self.low[1:], self.high[1:]), other.value)
        right = _times(self.value, (other.low[1:], other.high[1:]))
        return _join(value, (left[0] + right[0], left[1] + right[1]))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Jet:
        return self * (other.inverse() if isinstance(other, Jet) else 1.0 / np.asarray(other))

    def __rtruediv__(self, other: Any) -> Jet:
        return self.inverse() * other

    def inverse(self) -> Jet:
        """1 / x; without bounds where x may vanish."""
        low, high = self.value
        clear = (low > 0) | (high < 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            value = np.where(clear, 1 / high, -np.inf), np.where(clear, 1 / low, np.inf)
        least, most = _square(value)
        return self._through(value, (-most, -least))

    def square(self) -> Jet:
        """x^2."""
        low, high = self.value
        return self._through(_square(self.value), (2 * low, 2 * high))

    def sqrt(self) -> Jet:
        """The root of x; what may lie below zero is cut off there."""
        low, high = (np.sqrt(np.maximum(end, 0.0)) for end in self.value)
        with np.errstate(divide="ignore"):
            return self._through((low, high), (0.5 / high, 0.5 / low))

    def sin(self) -> Jet:
        """The sine."""
        return self._through(_sine(self.value), _sine(_shifted(self.value)))

    def cos(self) -> Jet:
        """The cosine."""
        low, high = _sine(self.value)
        return self._through(_sine(_shifted(self.value)), (-high, -low))

    def _through(self, value: Interval, slope: Interval) -> Jet:
        return _join(value, _times((self.low[1:], self.high[1:]), slope))


def total(jets: Sequence[Jet]) -> Jet:
    """The sum of jets."""
    found = jets[0]
    for jet in jets[1:]:
        found = found + jet
    return found


def _join(value: Interval, slopes: Interval) -> Jet:
    ends = []
    for own, moved in zip(value, slopes, strict=True):
        shape = np.broadcast_shapes(own.shape, moved.shape[1:])
        ends.append(np.concatenate([np.broadcast_to(own, shape)[None], np.broadcast_to(moved, (len(moved), *shape))]))
    return Jet(*ends)


def _times(a: Interval, b: Interval) -> Interval:
    with np.errstate(invalid="ignore"):
        first, second, third, fourth = a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]
        low = np.minimum(np.minimum(first, second), np.minimum(third, fourth))
        high = np.maximum(np.maximum(first, second), np.maximum(third, fourth))
    if not np.isfinite(low.sum() + high.sum()):
        # What has no bounds times nothing has none: 0 times infinity is taken for the worst.
        unknown = np.isnan(low) | np.isnan(high)
        low, high = np.where(unknown, -np.inf, low), np.where(unknown, np.inf, high)
    return low, high


def _square(a: Interval) -> Interval:
    low, high = np.abs(a[0]), np.abs(a[1])
    inside = (a[0] <= 0) & (a[1] >= 0)
    return np.where(inside, 0.0, np.minimum(low, high) ** 2), np.maximum(low, high) ** 2


def _shifted(a: Interval) -> Interval:
    return a[0] + 0.5 * np.pi, a[1] + 0.5 * np.pi


def _sine(a: Interval) -> Interval:
    low, high = np.sin(a[0]), np.sin(a[1])

    def holds(place: float) -> NDArray[np.bool_]:
        """Whether place + 2 pi n lies within."""
        turns = np.ceil((a[0] - place) / (2 * np.pi))
        return place + 2 * np.pi * turns <= a[1]

    least = np.where(holds(-0.5 * np.pi), -1.0, np.minimum(low, high))
    return least, np.where(holds(0.5 * np.pi), 1.0, np.maximum(low, high))
