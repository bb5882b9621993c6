"""What the same parts can do: pivot, force, rate and gas volume chosen by their true optimum."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
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
    norms,
    pivoted,
    workspace,
    yoke,
)
from equipoise.solve.program import Norm

COUNT = 721
ANGLE = (math.radians(40.0), math.radians(140.0))


def improved() -> Sequence[Improvement]:
    """Each published design beside the best of its kind."""
    return [*_constant_force(), *_free_length(), *_struts(), *_yokes()]


def _constant_force() -> list[Improvement]:
    found = []
    free = {"s.path.phase": (-ANGLE[1], -ANGLE[0]), "s.path.distance": (CRANK * 1.01, 6 * CRANK)}
    for link, sweep, alpha in ((1, along(count=COUNT), 86.0), (2, workspace(COUNT), 90.0)):
        published = norms(constant_force(link, sweep, alpha), sweep)
        for norm in ("mean", "rms", "peak"):
            design = _shaped(link, pivoted("s", JOINT, eq.Constant(), alpha), sweep, free, norm)
            values = {
                f"alpha{link + 4}": f"{-math.degrees(design.geometry['s.path.phase']):.4f} deg",
                f"ra{link}": f"{design.geometry['s.path.distance'] / CRANK:.4g}",
                f"F{link}": f"{design.values['s.force']:.2f} N",
            }
            what = f"link {link}, constant force: pivot and force"
            note = "" if link == 1 else "the range is even about the downward vertical, so 90 deg is forced"
            found.append(_improvement(what, link, sweep, norm, published[norm], design, values, note))
    return found


def _free_length() -> list[Improvement]:
    found, sweep = [], along(count=COUNT)
    for ra, n in ((4.0, 2.0), (6.0, 1.5)):
        law, level = ideal(1, ra, n), CRANK * math.hypot(1.0, ra)
        spring = pivoted("s", JOINT, eq.Coil(free_length=level * (1 - 1 / n)), 90.0, ra)
        published = norms(error(1, law, sweep, 90.0, ra), sweep)
        design = _shaped(1, spring, sweep, {"s.path.phase": (-ANGLE[1], -ANGLE[0])}, "mean")
        rate = design.values["s.k"] * ra * CRANK**2 / LARGEST[0]
        values = {
            "alpha5": f"{-math.degrees(design.geometry['s.path.phase']):.4f} deg",
            "k": f"{design.values['s.k']:.1f} N/m ({rate:.5f} of the ideal rate)",
        }
        what = (
            f"spring of free length {1e3 * level * (1 - 1 / n):.1f} mm (n = {n:g}), ra1 = {ra:g}: pivot angle and rate"
        )
        note = "a spring that is too stiff wants its pivot beyond 90 deg, one too soft before it"
        found.append(_improvement(what, 1, sweep, "mean", published["mean"], design, values, note))
    return found


def _struts() -> list[Improvement]:
    """The gas strut on the pivot: its best volume is finite."""
    found, sweep = [], along(count=COUNT)
    level = CRANK * math.hypot(1.0, 6.0)
    published = norms(constant_force(1, sweep, 90.0), sweep)["mean"]
    for exponent, free_angle in ((1.4, False), (1.0, False), (1.2, True)):
        start = pressure.strut(exponent, exponent)
        gas = eq.Gas(start.area, start.volume, level, None, exponent, "pull", "gauge")
        free = {"s.law.volume": (0.6 * start.area * level, 6 * start.area * level)}
        if free_angle:
            free["s.path.phase"] = (-ANGLE[1], -ANGLE[0])
        design = _shaped(1, pivoted("s", JOINT, gas, 90.0), sweep, free, "mean")
        volume = design.geometry["s.law.volume"]
        values = {
            "volume": f"{1e3 * volume:.4f} l ({volume / (start.area * level):.4f} A a10)",
            "charge": f"{design.values['s.pressure'] / pressure.BAR:.2f} bar gauge",
        }
        if free_angle:
            values["alpha5"] = f"{-math.degrees(design.geometry['s.path.phase']):.4f} deg"
        what = f"link 1, gas strut on the pivot, exponent {exponent:g}: volume and charge"
        what += " and pivot angle" if free_angle else " at alpha5 = 90 deg"
        note = f"area {1e4 * start.area:.4f} cm2; the published constant force is the limit of an infinite volume"
        found.append(_improvement(what, 1, sweep, "mean", published, design, values, note))
    return found


def _yokes() -> list[Improvement]:
    found, sweep = [], along(count=COUNT)
    for ratio in (5.0, 10.0):
        gas = pressure.on_yoke(ratio, pressure.ADIABATIC, 7 * pressure.BAR)
        published = norms(pressure.yoke_error(gas, sweep), sweep)["mean"]
        free_gas = eq.Gas(gas.area, gas.volume, 0.0, None, gas.exponent, "push", "gauge")
        spring = yoke("s", JOINT, free_gas, phase=0.0)
        design = _shaped(1, spring, sweep, {"s.path.phase": (-0.3, 0.3)}, "mean")
        values = {
            "lead of the crank": f"{math.degrees(design.geometry['s.path.phase']):.3f} deg",
            "charge": f"{design.values['s.pressure'] / pressure.BAR:.4f} bar gauge",
        }
        what = f"link 1, gas spring on the yoke, auxiliary volume {ratio:g} times the swept one: crank angle and charge"
        found.append(_improvement(what, 1, sweep, "mean", published, design, values, "7 bar gauge, quick motion"))
    return found


def _shaped(link: int, spring: eq.Spring, sweep: eq.Sweep, free: Mapping[str, Any], norm: Norm) -> eq.Design:
    return eq.shape(alone(link), [spring], sweep, free, norm=norm, starts=2)


def _improvement(  # noqa: PLR0917
    what: str,
    link: int,
    sweep: eq.Sweep,
    norm: str,
    published: float,
    design: eq.Design,
    values: Mapping[str, str],
    note: str,
) -> Improvement:
    row = design.after["link_joint"]
    ours = 100 * {"mean": row.mean, "rms": row.rms, "peak": row.sample_peak}[norm] / LARGEST[link - 1]
    unit = "% of the largest torque"
    kind = design.certificate.kind
    return Improvement(what, sweep.label, norm, published, ours, unit, values, kind, note)
