"""Families of balancers for a slide, each with a working member."""

from __future__ import annotations

from dataclasses import replace

from equipoise.balancers.laws import Coil, Constant, Gas, HydroPneumatic, Nitrogen, Torsion, Weight
from equipoise.balancers.paths import Angle, Cam, ConstantTorque, Pinion
from equipoise.balancers.spring import Spring
from equipoise.families.family import ARAKELIAN, QUAGLIA, Family, Trial
from equipoise.families.hinge import HYDRAULIC, NAME, PRESSURE, STRETCH
from equipoise.families.site import Site

TURNS = 40.0
"""How far a clock spring may be wound beyond the sweep, rad."""


def _along(site: Site, offset: float) -> Angle:
    """The slide's position, growing as the load sinks."""
    side = -1.0 if site.load > 0 else 1.0
    return replace(site.angle, ratio=side, offset=offset)


def _pulley(site: Site) -> Trial:
    return Trial((Spring(NAME, _along(site, 0.0), Weight()),))


def _constant(site: Site) -> Trial:
    return Trial((Spring(NAME, _along(site, 0.0), Constant()),))


def _coil(site: Site) -> Trial:
    """An extension spring beside the axis, stretched to twice its length at most."""
    path = _along(site, 4.0 * site.travel)
    return Trial((Spring(NAME, path, Coil(None)),), {f"{NAME}.path.offset": _range(site)}, (STRETCH,))


def _range(site: Site) -> tuple[float, float]:
    shift = max(abs(site.low), abs(site.high))
    return shift + 1.1 * site.travel, shift + 4.0 * site.travel


def _fusee(site: Site) -> Trial:
    radius = site.travel / 9.0
    turned = Pinion(site.angle, radius, offset=-0.5 * (site.low + site.high) / radius)
    side = -1.0 if site.load > 0 else 1.0
    path = Cam(turned, ConstantTorque(0.15 * site.travel, side * 0.15), offset=0.5 * site.travel)
    return Trial((Spring(NAME, path, Coil(0.5 * site.travel)),))


def _clock(site: Site) -> Trial:
    """A torsion spring on a drum, wound up so far beforehand that its torque changes little."""
    turned = Pinion(site.angle, site.travel / 6.0)
    far = TURNS if site.load > 0 else -TURNS
    return Trial((Spring(NAME, turned, Torsion(rest=far)),))


def _gas(site: Site) -> Trial:
    area = abs(site.load) / PRESSURE
    path = replace(site.angle, ratio=1.0 if site.load > 0 else -1.0)
    law = Gas(area, 4 * area * site.travel, 0.0, exponent=1.2)
    return Trial((Spring(NAME, path, law),))


def _hydro(site: Site) -> Trial:
    area = abs(site.load) / HYDRAULIC
    path = replace(site.angle, ratio=1.0 if site.load > 0 else -1.0)
    volume = 10 * area * site.travel
    law = HydroPneumatic(area, 1.4 * volume, volume, 0.0, exponent=Nitrogen(0.5, at=HYDRAULIC))
    return Trial((Spring(NAME, path, law),))


SLIDE = (
    Family("counterweight over a pulley", "", 3, _pulley),
    Family("extension spring beside the axis", "A", 1, _coil, ARAKELIAN),
    Family("coil spring on a fusee (cam) behind a pinion", "C II", 4, _fusee, ARAKELIAN),
    Family("clock spring on a drum", "B", 3, _clock, ARAKELIAN),
    Family("constant-force spring", "", 1, _constant, QUAGLIA),
    Family("gas spring", "", 1, _gas, QUAGLIA),
    Family("hydro-pneumatic cylinder", "", 2, _hydro, QUAGLIA),
)
