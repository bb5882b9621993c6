"""What a spring that is still to be wound must keep: rows that are linear in its rate and the product k L0."""

from __future__ import annotations

from typing import Any

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.spring import Spring
from equipoise.limits.limit import Setting
from equipoise.parts.helical import LEAST_COILS
from equipoise.parts.windable import WindableSpring
from equipoise.solve.program import Rows
from equipoise.units import text


def winding(spring: Spring, setting: Setting) -> list[Rows]:
    """The polygon of a `WindableSpring`; none for other laws."""
    law = spring.law
    if not isinstance(law, WindableSpring):
        return []
    length: Array = spring.deform(setting.states)[0]
    shortest = np.take_along_axis(length, np.real(length).argmin(-1)[..., None], axis=-1)
    made = _Rows(spring, np.arange(length.shape[-1]))
    stack, hooks = np.asarray(law.stack), np.asarray(law.hooks)
    most, tension = np.asarray(law.largest_force), np.asarray(law.largest_tension)
    rows = [
        made.row("strength", length, -1.0, most, scale=most),
        made.row("tension", -length, 1.0, 0.0, scale=most),
        made.row("coils", np.atleast_1d(np.asarray(LEAST_COILS * law.wire)), 0.0, stack, scale=stack),
    ]
    if law.heaviest is not None:
        rate = np.atleast_1d(law.least_rate)
        rows.append(made.row("mass", -np.ones_like(rate), 0.0, -rate, scale=rate))
    if law.room is None:
        rows.append(made.row("closed length", hooks - length, 0.0, -stack, scale=stack))
        rows.append(made.row("initial tension", np.atleast_1d(hooks), -1.0, tension - stack, scale=stack))
    else:
        rows.append(made.row("room", hooks + length - law.room, -1.0, tension - stack, scale=stack))
        rows.append(made.row("room", hooks + length - shortest - law.room, 0.0, -stack, scale=stack))
    return rows + _numbers(spring, law)


class _Rows:
    """Rows over rate and product of one spring, or over the product alone where the rate is given."""

    def __init__(self, spring: Spring, states: Any) -> None:
        self.spring, self.states = spring, states
        self.given = spring.law.k  # type: ignore[attr-defined]

    def row(self, what: str, rate: Array, product: float, limit: Any, *, scale: Any) -> Rows:
        """rate k + product (k L0) <= limit, per state or once."""
        one, h = np.broadcast_arrays(rate, limit)
        unknowns = self.spring.unknowns
        if self.given is not None:
            h = h - one * self.given
            unknowns = unknowns if product else ()
            G = np.full((*h.shape, len(unknowns)), product, dtype=h.dtype)
        else:
            G = np.stack(np.broadcast_arrays(one, product + 0.0 * h), axis=-1)
        state = self.states if h.shape[-1] == len(self.states) else None
        words = f"{what} of {self.spring.name} as it can be wound"
        return Rows(words, "N", G, h, unknowns, state, scale=float(np.abs(np.real(scale)).max()))


def _numbers(spring: Spring, law: WindableSpring) -> list[Rows]:
    """Wire, index and width, where these are not fixed."""
    found = [(fault.reason, fault.room, fault.scale, fault.unit) for fault in law.sample.faults()]
    if law.width is not None:
        found.append((f"width above {text(law.width, 'm')}", law.width - np.asarray(law.outside), law.width, "m"))
    rows = []
    for words, room, scale, unit in found:
        free = np.asarray(room)
        if free.ndim or np.any(np.real(free) < 0):
            free = np.atleast_1d(free)
            none = np.zeros((*free.shape, 0), dtype=free.dtype)
            rows.append(Rows(f"{words}: {spring.name}", unit, none, free, (), scale=scale))
    return rows
