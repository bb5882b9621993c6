"""One joint's effort over cells: enclosed by the corner values of waves and a remainder of second order."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.verification.boxes import Judged
from equipoise.verification.waves import Axes, corner_values, point_values

MISMATCH = 1e-9
ROUNDING = 1e-13


@dataclass(frozen=True, eq=False)
class Enclosure:
    """r = P + sum_m ((c_m + W_m) s'_m / (2 sqrt s_m) + V_m sqrt s_m) + k (q_j - rest), for S payloads.

    axes        the n joints that move it
    waves       coefficients (F, 3^n) of P for every payload, then of s_m (m^2) and s'_m = ds_m/dq_j in turn, at last of
                V_m (N) and W_m (N) of the riders
    scenarios   S
    intercepts  c_m (M,), N: force of the springs' lines at length zero
    riders      the springs m whose weight moves along a body as their length does; V and W of others are zero
    spring      (k, rest, place of joint j among the axes) of a spring in the file at the joint itself
    slack       what rounding may add to the bound

    s' / sqrt(s) is expanded about the cell's centre (index c), phi(s) = 1 / sqrt(s):

        s' phi(s) = phi_c s' + phi'_c s'_c (s - s_c) + phi'_c (s' - s'_c)(s - s_c) + s' phi''(xi) (s - s_c)^2 / 2

    of which the first two terms are waves, and the others, by the ranges of s and s', the remainder. A product of two
    waves is f g = f_c g + g_c (f - f_c) + (f - f_c)(g - g_c), the last of which goes to the remainder.
    """

    axes: Axes
    waves: Array
    scenarios: int
    intercepts: Array
    spring: tuple[float, float, int]
    riders: tuple[int, ...] = ()
    slack: float = 0.0

    @property
    def size(self) -> int:
        """Numbers held per cell."""
        return 3 * self.waves.size

    def confirmed(self, values: Array, probes: Array, noise: float) -> Enclosure | None:
        """This enclosure with its slack, from values (F, N) at further positions; None where the waves do not fit.

        noise is the size that rounding gives to efforts that should vanish.
        """
        expected = point_values(self.waves, self.axes.basis(probes)).T
        scale = np.maximum(np.abs(values).max(axis=1), np.abs(self.waves).max(axis=1)) + 1e-300
        off = np.abs(values - expected).max(axis=1)
        if (off > MISMATCH * scale + 10 * noise).any():
            return None
        effort = slice(0, self.scenarios)
        return replace(self, slack=float(4 * off[effort].max() + ROUNDING * scale[effort].max()))

    def __call__(self, centre: Array, half: Array) -> Judged:
        """Judge cells |q - centre| <= half, (C, n) both."""
        corners = corner_values(self.waves, self.axes.triangles(centre, half))
        middle = point_values(self.waves, self.axes.basis(centre))
        S = self.scenarios
        value, at_centre, remainder = corners[:, :S], middle[:, :S], np.zeros(len(centre))
        for m, intercept in enumerate(self.intercepts):
            pick = S + 2 * m
            square, centre = corners[:, pick : pick + 2], middle[:, pick : pick + 2]
            if m in self.riders:
                rider = S + 2 * len(self.intercepts) + 2 * self.riders.index(m)
                root, unit = _root(square[:, 0], centre[:, 0]), _expand(1.0, square, centre)
                parts = [
                    _times(root, corners[:, rider], middle[:, rider]),
                    _times(unit, intercept + corners[:, rider + 1], intercept + middle[:, rider + 1]),
                ]
            else:
                parts = [_expand(intercept, square, centre)]
            for extra, there, left in parts:
                value, at_centre = value + extra[:, None], at_centre + there[:, None]
                remainder = remainder + left
        stiffness, rest, own = self.spring
        if stiffness:
            torque = stiffness * (centre[:, own] - rest)
            value, at_centre = value + torque[:, None, None], at_centre + torque[:, None]
            remainder = remainder + stiffness * half[:, own]
        return self._judged(value, at_centre, remainder, corners, half)

    def _judged(self, value: Array, at_centre: Array, remainder: Array, corners: Array, half: Array) -> Judged:
        C, n = half.shape
        largest = np.nan_to_num(np.abs(value), nan=np.inf).reshape(C, -1)
        best = largest.argmax(axis=1)
        cells = np.arange(C)
        top = largest[cells, best]
        payload, corner = np.divmod(best, 3**n)
        met = np.abs(at_centre).max(axis=1)
        met[~np.isfinite(met)] = 0.0
        if n == 0:
            return Judged(top + remainder, met, np.zeros(C, dtype=int))
        digits = corner[:, None] // 3 ** np.arange(n)[::-1] % 3
        virtual = np.take_along_axis(self.axes.virtual(half), digits[..., None], axis=2)[..., 0]
        exact = ~virtual.any(axis=1) & (remainder == 0)
        met[exact] = np.maximum(met, top)[exact]
        share = self._shares(value[cells, payload], corner, digits, virtual)
        spread = sum((self._spread(corners[:, S], corner, digits) for S in range(self.scenarios, len(self.waves))),
                     np.zeros((C, n)))  # fmt: skip
        return Judged(top + remainder, met, _split(share, spread, remainder, half))

    def _shares(
        self, value: Array, corner: NDArray[np.int_], digits: NDArray[np.int_], virtual: NDArray[np.bool_]
    ) -> Array:
        """How much the worst corner's value (C, n) exceeds what the joint's other corners give, where it is virtual."""
        low, here, high = self._along(value, corner, digits)
        with np.errstate(invalid="ignore"):
            sign = np.sign(here[:, :1])
            drop = sign * here - np.maximum(sign * low, sign * high)
        return np.where(virtual, np.maximum(np.nan_to_num(drop), 0.0), 0.0)

    def _spread(self, wave: Array, corner: NDArray[np.int_], digits: NDArray[np.int_]) -> Array:
        """How much each joint changes a wave at the worst corner, relative to the wave (C, n)."""
        low, here, high = self._along(wave, corner, digits)
        change = np.abs(high - here) + np.abs(low - here)
        return change / (np.abs(wave).max(axis=1)[:, None] + 1e-300)

    def _along(self, value: Array, corner: NDArray[np.int_], digits: NDArray[np.int_]) -> tuple[Array, Array, Array]:
        """Values (C, n) at the corner and with each joint at its next and the one after."""
        stride = 3 ** np.arange(digits.shape[1])[::-1]
        base = corner[:, None] - digits * stride
        first, second = (np.take_along_axis(value, base + (digits + turn) % 3 * stride, axis=1) for turn in (1, 2))
        return first, np.take_along_axis(value, corner[:, None] + 0 * digits, axis=1), second


Expanded = tuple[Array, Array, Array]
"""Waves at corners (C, 3^n), the value at centres (C,), and the remainder (C,)."""


def _root(square: Array, s: Array) -> Expanded:
    """sqrt s about the cell's centre: sqrt s_c + (s - s_c) / (2 sqrt s_c), off by (s - s_c)^2 / (8 s_least^(3/2))."""
    least = square.min(axis=1)
    far = (least <= 0) | (s <= 0)
    s, least = np.where(far, 1.0, s), np.where(far, 1.0, least)
    apart = square - s[:, None]
    left = np.where(far, np.inf, np.abs(apart).max(axis=1) ** 2 / (8 * least**1.5))
    wave = np.sqrt(s)[:, None] + apart / (2 * np.sqrt(s)[:, None])
    return np.where(far[:, None], 0.0, wave), np.where(far, np.nan, np.sqrt(s)), left


def _times(one: Expanded, corners: Array, centre: Array) -> Expanded:
    """The product of an expansion and a wave (C, 3^n) with its values at centres (C,)."""
    wave, there, left = one
    known = np.where(np.isnan(there), 0.0, there)
    apart, turned = wave - known[:, None], corners - centre[:, None]
    most = np.abs(turned).max(axis=1)
    with np.errstate(invalid="ignore"):
        loose = (np.abs(apart).max(axis=1) + left) * most + np.abs(centre) * left
    # A wave that vanishes on the whole cell takes an unbounded remainder with it.
    loose = np.where((most == 0) & (centre == 0), 0.0, np.nan_to_num(loose, nan=np.inf, posinf=np.inf))
    return known[:, None] * turned + centre[:, None] * wave, there * centre, loose


def _expand(intercept: float, corners: Array, middle: Array) -> Expanded:
    """Waves of c s' / (2 sqrt s) at corners (C, 3^n), its value at centres (C,) and the remainder (C,)."""
    square, slope = corners[:, 0], corners[:, 1]
    s, ds = middle[:, 0], middle[:, 1]
    least = square.min(axis=1)
    far = (least <= 0) | (s <= 0)
    s, least = np.where(far, 1.0, s), np.where(far, 1.0, least)
    root, bend = s**-0.5, -0.5 * s**-1.5
    wave = intercept / 2 * (root[:, None] * slope + (bend * ds)[:, None] * (square - s[:, None]))
    reach = np.abs(square - s[:, None]).max(axis=1)
    left = np.abs(bend) * np.abs(slope - ds[:, None]).max(axis=1) * reach
    left = left + 0.375 * least**-2.5 * np.abs(slope).max(axis=1) * reach**2
    # While the length may be zero as far as this cell knows, the cell must be split.
    left = np.where(far, np.inf, abs(intercept) / 2 * left)
    return np.where(far[:, None], 0.0, wave), np.where(far, np.nan, intercept / 2 * root * ds), left


def _split(share: Array, spread: Array, remainder: Array, half: Array) -> NDArray[np.int_]:
    """The joint that adds most to the bound: by its virtual corners, or by its part in the remainder."""
    part = spread / (spread.sum(axis=1, keepdims=True) + 1e-300)
    finite = np.where(np.isfinite(remainder), remainder, 0.0)
    total = share + part * finite[:, None]
    total = np.where(np.isfinite(remainder)[:, None], total, part)
    widest = half / (half.max(axis=1, keepdims=True) + 1e-300)
    return np.where(total.max(axis=1) > 0, total.argmax(axis=1), widest.argmax(axis=1))
