"""What holds a peak up although no added part can lower it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.solve.program import Program

NOTHING = 1e-9
"""Share of the load below which a row counts as beyond reach, and a peak as gone."""
OWN = 1e-6
PAYLOAD = 1e-3
"""How near to the peak, relatively, a floor must come to be the one that holds it."""


@dataclass(frozen=True)
class Floor:
    """A lower bound of the peak that the design has reached.

    cause `own`: the row's own load, which nothing that may change reaches; cause `payload`: half of what the
    payload's scenarios differ by, |r_1 - r_2| / 2 <= max(|r_1|, |r_2|), whatever serves both of them.
    """

    row: str
    cause: str


def floors(program: Program, theta: Array, sizes: Array, rows: tuple[str, ...], scenarios: int) -> tuple[Floor, ...]:
    """Floors of the first norm of a program, where that is a peak.

    theta (P,) the solution, sizes (P,) by how much each unknown may change; rows name the blocks; the states
    are those of one payload scenario after the other.
    """
    term = next(term for term in program.terms if term.cap is None)
    peak, load = term.value(theta), max(program.loads)
    if term.norm != "peak" or peak <= NOTHING * load:
        return ()
    residual = term.residual(theta)
    held = term.magnitudes(residual).max(axis=0) >= peak * (1 - OWN)
    moved = (np.abs(term.A) * sizes).max(axis=(0, 2), initial=0.0)
    reach = np.maximum.reduceat(moved, np.cumsum((0, *term.sizes[:-1])))
    own = held & (reach <= NOTHING * load)
    found = [Floor(row, "own") for row, here in zip(rows, own, strict=True) if here]
    if scenarios > 1 and all(size == 1 for size in term.sizes):
        half = np.ptp(residual.reshape(scenarios, -1, len(rows)), axis=0).max(axis=0) / 2
        shared = ~own & (half >= peak * (1 - PAYLOAD))
        found += [Floor(row, "payload") for row, here in zip(rows, shared, strict=True) if here]
    return tuple(found)
