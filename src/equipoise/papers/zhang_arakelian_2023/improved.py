"""What the compensator of Zhang & Arakelian 2023 can do with the same spring."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Literal

import numpy as np

import equipoise as eq
from equipoise.papers.paper import Improvement
from equipoise.papers.zhang_arakelian_2023 import model
from equipoise.papers.zhang_arakelian_2023.model import (
    MANY,
    THREE,
    Dyad,
    at,
    design,
    largest,
    link,
    over,
    rms,
    synthesis,
)
from equipoise.reporting.numbers import quantity

BOUNDS = {"s.path.crank": (0.05, 0.3), "s.path.rod": (0.2, 0.9), "s.path.phase": (-0.3, 0.3)}
NAMES = {"s.path.crank": "r", "s.path.rod": "l", "s.path.phase": "beta"}

Norm = Literal["rms", "peak"]


def improved() -> Sequence[Improvement]:
    """The best of the linear synthesis, then the dyad shaped freely."""
    both = tuple(BOUNDS)
    return [
        _family(MANY, "121 positions"),
        _family(THREE, "30, 90, 150 deg"),
        *(_shaped(both, "r, l and beta", norm) for norm in ("rms", "peak")),
        *(_shaped(both[:2], "r and l, beta = 0", norm) for norm in ("rms", "peak")),
    ]


def _published(norm: Norm) -> float:
    """The better of the two published designs."""
    states = model.states()
    judge = {"rms": rms, "peak": largest}[norm]
    return min(judge(design(positions)[1].moment(states)) for positions in (THREE, MANY))


def _family(positions: tuple[float, ...], words: str) -> Improvement:
    states = model.states()
    energy = model.best_energy(at(*positions), rms, states)
    dyad = synthesis(at(*positions), energy)
    moment = dyad.moment(states)
    return Improvement(
        what=f"energy C of the linear synthesis, {words}",
        over="30 to 150 deg by 1",
        norm="rms",
        published=_published("rms"),
        ours=rms(moment),
        unit="N m",
        values={"C": quantity(energy, "J")} | _words(dyad),
        certificate="scan of C",
        note=f"peak {largest(moment):.4g} N m",
    )


@functools.cache
def shaped(names: tuple[str, ...], norm: Norm) -> eq.Design:
    """The dyad with these parameters free, started from the published one."""
    start = design(MANY)[1] if "s.path.phase" in names else Dyad(design(MANY)[1].r, design(MANY)[1].l, 0.0)
    bounds = {name: BOUNDS[name] for name in names}
    return eq.shape(link(), [start.spring()], over(), bounds, norm=norm, starts=len(names))


def _shaped(names: tuple[str, ...], words: str, norm: Norm) -> Improvement:
    found = shaped(names, norm)
    row = found.after[model.JOINT]
    r, rod = found.geometry["s.path.crank"], found.geometry["s.path.rod"]
    return Improvement(
        what=words,
        over="30 to 150 deg by 1",
        norm=norm,
        published=_published(norm),
        ours=found.certificate.primal,
        unit="N m",
        values=_words(Dyad(r, rod, -found.geometry.get("s.path.phase", 0.0))),
        certificate=found.certificate.kind,
        note=f"peak {row.sample_peak:.4g} N m" if norm == "rms" else f"rms {row.rms:.4g} N m",
    )


def _words(dyad: Dyad) -> dict[str, str]:
    return {
        "r": quantity(dyad.r, "m", 5),
        "l": quantity(dyad.l, "m", 5),
        "beta": f"{np.degrees(dyad.beta) + 0.0:.4g} deg",
    }
