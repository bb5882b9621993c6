"""Functions of time carried with their first and second derivative, so that nothing is differenced."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array


@dataclass(frozen=True, eq=False)
class Jet:
    """f, f' and f'' at N instants; the rules of differentiation are exact."""

    value: Array
    rate: Array
    bend: Array

    @staticmethod
    def time(t: Array) -> Jet:
        """t itself."""
        return Jet(t, np.ones_like(t), np.zeros_like(t))

    @staticmethod
    def constant(value: float, like: Array) -> Jet:
        """A number at every instant."""
        zero = np.zeros_like(like)
        return Jet(zero + value, zero, zero)

    def through(self, f: Array, df: Array, ddf: Array) -> Jet:
        """g(self) from g, g', g'' at self: (g f)'' = g'' f'^2 + g' f''."""
        return Jet(f, df * self.rate, ddf * self.rate**2 + df * self.bend)

    def __neg__(self) -> Jet:
        return Jet(-self.value, -self.rate, -self.bend)

    def __add__(self, other: Jet) -> Jet:
        return Jet(self.value + other.value, self.rate + other.rate, self.bend + other.bend)

    def __sub__(self, other: Jet) -> Jet:
        return self + -other

    def __mul__(self, other: Jet) -> Jet:
        f, g = self, other
        bend = f.bend * g.value + 2.0 * f.rate * g.rate + f.value * g.bend
        return Jet(f.value * g.value, f.rate * g.value + f.value * g.rate, bend)

    def __truediv__(self, other: Jet) -> Jet:
        g = other.value
        return self * other.through(1.0 / g, -1.0 / g**2, 2.0 / g**3)

    def __pow__(self, other: Jet) -> Jet:
        if not (other.rate.any() or other.bend.any()) and np.all(other.value == other.value.flat[0]):
            return self._to_the(float(other.value.flat[0]))
        return FUNCTIONS["exp"](other * FUNCTIONS["log"](self))

    def _to_the(self, n: float) -> Jet:
        x = self.value

        def term(factor: float, power: float) -> Array:
            # 0 * x**-1 is no derivative of a constant
            return factor * x**power if factor else np.zeros_like(x)

        return self.through(x**n, term(n, n - 1.0), term(n * (n - 1.0), n - 2.0))


def _rule(f: Callable[[Array], Array], df: Callable[[Array], Array], ddf: Callable[[Array], Array]) -> Rule:
    return lambda jet: jet.through(f(jet.value), df(jet.value), ddf(jet.value))


Rule = Callable[[Jet], Jet]

FUNCTIONS: dict[str, Rule] = {
    "sin": _rule(np.sin, np.cos, lambda x: -np.sin(x)),
    "cos": _rule(np.cos, lambda x: -np.sin(x), lambda x: -np.cos(x)),
    "tan": _rule(np.tan, lambda x: 1 + np.tan(x) ** 2, lambda x: 2 * np.tan(x) * (1 + np.tan(x) ** 2)),
    "asin": _rule(np.arcsin, lambda x: (1 - x**2) ** -0.5, lambda x: x * (1 - x**2) ** -1.5),
    "acos": _rule(np.arccos, lambda x: -((1 - x**2) ** -0.5), lambda x: -x * (1 - x**2) ** -1.5),
    "atan": _rule(np.arctan, lambda x: 1 / (1 + x**2), lambda x: -2 * x / (1 + x**2) ** 2),
    "sinh": _rule(np.sinh, np.cosh, np.sinh),
    "cosh": _rule(np.cosh, np.sinh, np.cosh),
    "tanh": _rule(np.tanh, lambda x: 1 - np.tanh(x) ** 2, lambda x: -2 * np.tanh(x) * (1 - np.tanh(x) ** 2)),
    "exp": _rule(np.exp, np.exp, np.exp),
    "log": _rule(np.log, lambda x: 1 / x, lambda x: -1 / x**2),
    "sqrt": _rule(np.sqrt, lambda x: 0.5 * x**-0.5, lambda x: -0.25 * x**-1.5),
}
"""The functions of the grammar, with f' and f''."""
