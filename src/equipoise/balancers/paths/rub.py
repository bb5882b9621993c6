"""Where a path rubs: what presses there, and how fast it slides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from equipoise.affine import Array

Kind = Literal["pin", "slide", "rope", "mesh"]


@dataclass(frozen=True, eq=False)
class Rub:
    """A contact of a path: load (N,) per newton (or newton metre) of the spring, and how it slides per joint's rate.

    slide (N, k, nd) is the Jacobian of what slides, a number (k = 1) or a vector. kind `pin`: a plain bearing, in rad,
    `slide`: a guide, in m, both loaded in N; `rope`: a cable over half a turn of sheave, and `mesh`: a gear or belt,
    which lose a share of the power, load times pace.
    """

    kind: Kind
    load: Array
    slide: Array

    @property
    def pace(self) -> Array:
        """How fast it slides (N, nd) as each joint moves by itself, not negative."""
        return np.linalg.norm(self.slide, axis=1)

    def geared(self, slope: Array) -> Rub:
        """The same contact where the spring acts through a slope dl/du (N,)."""
        return replace(self, load=self.load * np.abs(slope))


def turning(u: Array, *contacts: tuple[Kind, Any, Any]) -> tuple[tuple[Kind, Array, Array], ...]:
    """Contacts (kind, load, pace) of a mechanism at crank angles u (N,), pace per rad of the crank, made (N,)."""
    return tuple((kind, np.abs(load) + 0.0 * u, np.abs(pace) + 0.0 * u) for kind, load, pace in contacts)


def of_crank(contacts: Sequence[tuple[Kind, Array, Array]], rate: Array) -> list[Rub]:
    """Contacts per rad of a crank as contacts per joint: rate (N, nd) is du/dq."""
    return [Rub(kind, load, (pace[:, None] * rate)[:, None]) for kind, load, pace in contacts]


def after(kind: Kind, rate: Array, slope: float = 1.0, before: Sequence[Rub] = ()) -> tuple[Rub, ...]:
    """One contact that passes the spring's whole power, l following q at a rate (N, nd), and those before it."""
    one = np.ones(len(rate))
    return (Rub(kind, one, rate[:, None]), *(rub.geared(slope * one) for rub in before))
