"""What the same parts can do: pivot, force, rate and gas volume at their true optimum."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import equipoise as eq
from equipoise.papers.paper import Improvement
from equipoise.papers.quaglia_yin_2015 import pressure
from equipoise.papers.quaglia_yin_2015.robots import (
    CRANK,
    JOINT,
    LARGEST,
    alone,
    along,
    constant_force,
    error,
    ideal,
    left,
    mean,
    norms,
    pivoted,
    workspace,
    yoke,
)
from equipoise.solve.program import Norm

COUNT, FINE = 361, 721
"""Angles that carry the sweeps: the mean is settled by few, and is the slowest program."""
PHASE = (-math.radians(140.0), -math.radians(40.0))
"""The pivot's angle, turned round: alpha from 40 to 140 deg."""


def improved() -> Sequence[Improvement]:
    """Each published design beside the best of its kind."""
    return [*_constant_force(), *_free_length(), *_struts(), *_yokes()]


def _constant_force() -> list[Improvement]:
    found = []
    counts: dict[Norm, int] = {"mean": COUNT, "rms": FINE, "peak": FINE}
    free = {"s.path.phase": PHASE, "s.path.distance": (1.01 * CRANK, 6 * CRANK)}
    for link, alpha in ((1, 86.0), (2, 90.0)):
        spring = pivoted("s", JOINT, eq.Constant(), alpha)
        note = "" if link == 1 else "even about the downward vertical, the workspace forces 90 deg"
        for norm, count in counts.items():
            sweep = along(count=count) if link == 1 else workspace(count)
            published = norms(constant_force(link, sweep, alpha), sweep)
            design = _shaped(link, spring, sweep, free, norm)
            values = {
                f"alpha{link + 4}": _angle(design),
                f"ra{link}": f"{design.geometry['s.path.distance'] / CRANK:.4g}",
                f"F{link}": f"{design.values['s.force']:.2f} N",
            }
            what = f"link {link}, constant force: pivot and force"
            found.append(_improvement(what, link, sweep, norm, published, design, values, note))
    return found


def _free_length() -> list[Improvement]:
    found, sweep = [], along(count=COUNT)
    for ra, n in ((4.0, 2.0), (6.0, 1.5)):
        free_length = CRANK * math.hypot(1.0, ra) * (1 - 1 / n)
        published = norms(error(1, ideal(1, ra, n), sweep, 90.0, ra), sweep)
        spring = pivoted("s", JOINT, eq.Coil(free_length), 90.0, ra)
        design = _shaped(1, spring, sweep, {"s.path.phase": PHASE}, "mean")
        rate = design.values["s.k"]
        ratio = rate * ra * CRANK**2 / LARGEST[0]
        values = {"alpha5": _angle(design), "k": f"{rate:.1f} N/m ({ratio:.5f} of the ideal rate)"}
        what = f"link 1, coil of free length {1e3 * free_length:.1f} mm, ra1 = {ra:g}: pivot angle and rate"
        note = f"published: n = {n:g}, 90 deg. Too stiff a spring wants its pivot beyond 90 deg, too soft a one before"
        found.append(_improvement(what, 1, sweep, "mean", published, design, values, note))
    return found


def _struts() -> list[Improvement]:
    """The gas strut on the pivot: its best volume is finite."""
    found, sweep = [], along(count=COUNT)
    published = norms(constant_force(1, sweep, 86.0), sweep)
    nitrogen = replace(pressure.NITROGEN, adiabatic=0.5)
    cases = ((1.4, "n = 1.4", False), (1.0, "n = 1", False), (1.2, "n = 1.2", True), (nitrogen, "nitrogen", False))
    for exponent, word, turns in cases:
        gas = replace(pressure.strut(1.5, exponent), pressure=None)
        around = gas.area * gas.length
        free: dict[str, Any] = {"s.law.volume": (0.6 * around, 6 * around)}
        design = _shaped(1, pivoted("s", JOINT, gas), sweep, free | ({"s.path.phase": PHASE} if turns else {}), "mean")
        volume = design.geometry["s.law.volume"]
        values = {
            "volume": f"{1e3 * volume:.4f} l ({volume / around:.4f} A a10)",
            "charge": f"{design.values['s.pressure'] / pressure.BAR:.2f} bar gauge",
        } | ({"alpha5": _angle(design)} if turns else {})
        what = f"link 1, gas strut on a pivot, {word}: charge, volume{', angle' if turns else ''}"
        note = f"area {1e4 * gas.area:.4f} cm2; published: constant force at 86 deg. {_elsewhere(design)}"
        found.append(_improvement(what, 1, sweep, "mean", published, design, values, note))
    return found


def _elsewhere(design: eq.Design) -> str:
    """What a strut leaves where the gas follows another exponent than the one it was made for."""
    spring: Any = design.balancers[0]
    sweep, parts = along(count=COUNT), []
    others: dict[str, Any] = {"at n = 1": 1.0, "at n = 1.2": 1.2, "at n = 1.4": 1.4}
    if isinstance(spring.law.exponent, eq.Nitrogen):
        words = ("slowly", "half-way", "quickly")
        others = {word: replace(pressure.NITROGEN, adiabatic=0.5 * i) for i, word in enumerate(words)}
    for word, exponent in others.items():
        law = replace(spring.law, exponent=exponent, pressure=design.values["s.pressure"])
        parts.append(f"{mean(left(1, replace(spring, law=law), sweep), sweep):.3f} % {word}")
    return f"Mean error {', '.join(parts)}"


def _yokes() -> list[Improvement]:
    found, sweep = [], along(count=COUNT)
    for ratio in (5.0, 10.0):
        gas = pressure.on_yoke(ratio, pressure.ADIABATIC, 7 * pressure.BAR)
        published = norms(pressure.yoke_error(gas, sweep), sweep)
        spring = yoke("s", JOINT, replace(gas, pressure=None), phase=0.0)
        design = _shaped(1, spring, sweep, {"s.path.phase": (-0.3, 0.3)}, "mean")
        values = {
            "lead of the crank": f"{math.degrees(design.geometry['s.path.phase']):.3f} deg",
            "charge": f"{design.values['s.pressure'] / pressure.BAR:.4f} bar gauge",
        }
        what = f"link 1, gas on a yoke, bottle of {ratio:g} swept volumes: crank angle and charge"
        note = "published: no lead, 7 bar gauge; n = 1.4"
        found.append(_improvement(what, 1, sweep, "mean", published, design, values, note))
    return found


def _angle(design: eq.Design) -> str:
    return f"{-math.degrees(design.geometry['s.path.phase']):.4f} deg"


def _shaped(link: int, spring: eq.Spring, sweep: eq.Sweep, free: Mapping[str, Any], norm: Norm) -> eq.Design:
    return eq.shape(alone(link), [spring], sweep, free, norm=norm, starts=2)


def _improvement(  # noqa: PLR0917 - one row, its columns in order
    what: str,
    link: int,
    sweep: eq.Sweep,
    norm: Norm,
    published: Mapping[str, float],
    design: eq.Design,
    values: Mapping[str, str],
    note: str,
) -> Improvement:
    row = design.after["link_joint"]
    ours = 100 * {"mean": row.mean, "rms": row.rms, "peak": row.sample_peak}[norm] / LARGEST[link - 1]
    kind = design.certificate.kind
    return Improvement(what, sweep.label, norm, published[norm], ours, "%", values, kind, note)
