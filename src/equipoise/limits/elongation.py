"""Limits on how far a coil spring is stretched beyond its free length."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from equipoise import units
from equipoise.affine import Array
from equipoise.balancers.laws import Coil, Torsion
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError
from equipoise.limits.limit import Setting
from equipoise.parts import CompressionSpring, ExtensionSpring, StockSpring, WindableSpring
from equipoise.parts.part import StraightPart
from equipoise.solve.program import Rows


@dataclass(frozen=True)
class Elongation:
    """min <= (l - L0) / L0 <= max of a coil's elongation at every state, shares of its free length L0.

        k l - (1 + max) k L0 <= 0,   (1 + min) k L0 - k l <= 0

    affine also where rate k and free length are found; of a part its own length counts, without its leader. Raises
    InputError for a spring that is no coil.
    """

    spring: str
    max: units.Number | None = None
    min: units.Number | None = None

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """One row per side and state."""
        spring = _coil(setting, self.spring, "elongation")
        found = []
        for bound, sign, word in ((self.max, 1.0, "<="), (self.min, -1.0, ">=")):
            if bound is not None:
                words = f"elongation of {self.spring} {word} {100 * bound:.4g} %"
                found.append(_rows(setting, spring, words, sign, 1.0 + bound, 0.0))
        if not found:
            raise InputError("elongation has neither min nor max", where="limits", hint="give min, max or both")
        return tuple(found)


@dataclass(frozen=True)
class Extension:
    """How far a spring goes from its rest at every state, which its room, or its coils, decide.

        l - L0 <= max of a coil, m: k (l - max) - k L0 <= 0;   |q - rest| <= max of a torsion spring, rad

    Raises InputError for a spring that is neither, and a limit that is not positive.
    """

    spring: str
    max: units.Extent

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """One row per state, of a torsion spring one per state and side."""
        if not self.max > 0:
            raise InputError(f"the extension limit is {self.max:g}, it must be positive", where="limits")
        if isinstance(setting.find(self.spring, Spring, "extension").law, Torsion):
            return self._twist(setting)
        spring = _coil(setting, self.spring, "extension")
        words = f"extension of {self.spring} <= {units.text(self.max, 'm')}"
        return (_rows(setting, spring, words, 1.0, 1.0, self.max),)

    def _twist(self, setting: Setting) -> tuple[Rows, ...]:
        """+-(k q - k rest) - k max <= 0, without k where rest, or rate, is known."""
        spring = setting.find(self.spring, Spring, "extension")
        law: Any = spring.law
        angle = spring.path.deform(setting.states)[0]
        state, words = np.arange(angle.shape[-1]), f"twist of {self.spring} <= {units.text(self.max, 'rad')}"
        unknowns = {u.name.removeprefix(f"{spring.owner}."): u for u in spring.unknowns}
        found = []
        for sign in (1.0, -1.0):
            if law.rest is not None:
                none = np.zeros((*angle.shape, 0), dtype=angle.dtype)
                found.append(Rows(words, "rad", none, self.max - sign * (angle - law.rest), (), state, scale=0.1))
                continue
            product, room = -sign * np.ones_like(angle), sign * angle - self.max
            if law.k is None:
                G, free = np.stack([room, product], axis=-1), (unknowns["k"], unknowns["k_rest"])
                found.append(Rows(words, "N m", G, np.zeros(angle.shape), free, state))
            else:
                found.append(Rows(words, "N m", product[..., None], -law.k * room, (unknowns["k_rest"],), state))
        return tuple(found)


def _coil(setting: Setting, name: str, limit: str) -> Spring:
    spring = setting.find(name, Spring, limit)
    if not isinstance(spring.law, Coil | ExtensionSpring | CompressionSpring | StockSpring | WindableSpring):
        raise InputError(f"spring {name} is no coil, so it has no free length", where=f"limit {limit}")
    return spring


def _rows(setting: Setting, spring: Spring, words: str, sign: float, factor: float, room: float) -> Rows:
    """sign (k (l - room) - factor k L0) <= 0, or without k where the free length is known."""
    law: Any = spring.law
    length: Array = spring.path.deform(setting.states)[0] - getattr(law, "leader", 0.0) - room
    state = np.arange(length.shape[-1])
    straight = isinstance(spring.law, StraightPart)
    free = law.rest - law.leader if straight else law.free_length
    if free is not None:
        none = np.zeros((*length.shape, 0), dtype=np.result_type(length, free))
        return Rows(words, "m", none, sign * (factor * free - length), (), state, scale=0.1)
    unknowns = {u.name.removeprefix(f"{spring.owner}."): u for u in spring.unknowns}
    product = -sign * factor * np.ones_like(length)
    rate = law.k
    if rate is None:
        G = np.stack([sign * length, product], axis=-1)
        return Rows(words, "N", G, np.zeros(length.shape), (unknowns["k"], unknowns["k_free_length"]), state)
    return Rows(words, "N", product[..., None], -sign * rate * length, (unknowns["k_free_length"],), state)
