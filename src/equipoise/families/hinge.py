"""Families of balancers for a hinge, each with a working member."""

from __future__ import annotations

import math
from dataclasses import replace

from equipoise.balancers.counterweight import Counterweight
from equipoise.balancers.laws import Coil, Constant, Gas, HydroPneumatic, Nitrogen, Torsion, ZeroFreeLength
from equipoise.balancers.paths import (
    Absolute,
    Cable,
    Cam,
    ConstantEnergy,
    Gear,
    InvertedSliderCrank,
    Line,
    Pulley,
    ScotchYoke,
    SliderCrank,
)
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError
from equipoise.families.family import ARAKELIAN, QUAGLIA, ZHANG, Family, Trial
from equipoise.families.site import Site
from equipoise.limits import Elongation, Force
from equipoise.mechanism import Point

NAME = "s"
FREE = 1.2
"""Free length of a spring that a cable stretches, in shares of the room."""
TURN = 2 * math.pi
STRETCH = Elongation(NAME, min=0.05, max=1.0)
PRESS = Elongation(NAME, min=-0.6, max=-0.02)
PRESSURE, HYDRAULIC = 1.2e7, 2.0e7
"""Working pressures, Pa, that size the cylinders' areas."""


def _ideal(site: Site) -> Trial:
    path = Line(site.fixed(0.0, site.room), site.moving(0.0, 0.6 * site.room))
    return Trial((Spring(NAME, path, ZeroFreeLength()),))


def _hooked(site: Site) -> Trial:
    """An extension spring between two pins: where, and how long, is found."""
    path = InvertedSliderCrank(site.angle, 0.3 * site.room, site.room, phase=-site.top)
    free = {
        f"{NAME}.path.crank": (0.1 * site.room, 0.5 * site.room),
        f"{NAME}.path.distance": (0.6 * site.room, site.room),
        f"{NAME}.path.phase": (-site.top - 0.5, -site.top + 0.5),
    }
    return Trial((Spring(NAME, path, Coil(None)),), free, (STRETCH,))


def _cable(site: Site) -> Trial:
    """The spring lies along the body before the joint; its cable runs through an eye above the axis."""
    back, eye = site.fixed(math.radians(170), site.room), site.fixed(0.0, site.room)
    through = (back, Pulley(eye.body, eye.at), site.moving(0.0, 0.6 * site.room))
    # What of the cable lies beyond the eye stretches the spring beyond its free length.
    path = Cable(through, offset=FREE * site.room - _apart(back, eye))
    return Trial((Spring(NAME, path, Coil(FREE * site.room)),))


def _apart(a: Point, b: Point) -> float:
    return math.dist(a.at, b.at)


def _dyad(site: Site) -> Trial:
    path = SliderCrank(site.angle, 0.35 * site.room, site.room, phase=-site.top)
    free = {
        f"{NAME}.path.crank": (0.15 * site.room, 0.5 * site.room),
        f"{NAME}.path.rod": (0.6 * site.room, 2.0 * site.room),
        f"{NAME}.path.phase": (-site.top - 0.3, -site.top + 0.3),
    }
    return Trial((Spring(NAME, path, Coil(None)),), free, (PRESS,))


def _rod(site: Site) -> Trial:
    path = InvertedSliderCrank(site.angle, 0.4 * site.room, site.room, phase=-site.top, rod=2.4 * site.room)
    return Trial((Spring(NAME, path, Coil(None)),), {}, (PRESS,))


def _cam(site: Site) -> Trial:
    lift = ConstantEnergy(0.4 * site.room, 0.9)
    path = Cam(site.angle, lift, phase=-site.top, offset=1.2 * site.room, scale=-1.0)
    return Trial((Spring(NAME, path, Coil(None)),), {}, (PRESS,))


def _gear(site: Site) -> Trial:
    half = Gear(site.angle, 0.5, offset=-0.5 * site.top)
    # The yoke's own side follows where the joint works: the crank never passes the spring's free place.
    middle = 0.5 * (0.5 * (site.low + site.high) - site.top)
    side = -1.0 if math.sin(middle) > 0 else 1.0
    path = ScotchYoke(half, side * 0.6 * site.room, offset=1.5 * site.room)
    return Trial((Spring(NAME, path, Coil(1.5 * site.room)),), {}, (Force(NAME, max=0.0),))


def _weight(site: Site) -> Trial:
    """Straight below the axis where the load is highest."""
    return Trial((Counterweight(NAME, site.moving(math.pi + site.up - site.top, site.room)),))


def _torsion(site: Site) -> Trial:
    """Wound up by a turn at most."""
    return Trial((Spring(NAME, site.angle, Torsion(rest=-site.top)),), {f"{NAME}.law.rest": (-TURN, TURN)})


def _yoke(site: Site) -> ScotchYoke:
    return ScotchYoke(site.angle, 0.6 * site.room, phase=0.5 * math.pi - site.top)


def _pivot(site: Site) -> tuple[InvertedSliderCrank, dict[str, tuple[float, float]]]:
    path = InvertedSliderCrank(site.angle, 0.2 * site.room, site.room, phase=-site.top)
    return path, {f"{NAME}.path.phase": (-site.top - 0.3, -site.top + 0.3)}


def _constant_yoke(site: Site) -> Trial:
    """A force that pulls lifts the load where the yoke is shortest at its highest place."""
    path = _yoke(site)
    return Trial((Spring(NAME, replace(path, radius=-path.radius), Constant()),))


def _constant_pivot(site: Site) -> Trial:
    path, free = _pivot(site)
    return Trial((Spring(NAME, path, Constant()),), free)


def _area(site: Site, arm: float, pressure: float) -> float:
    return site.load / arm / pressure


def _gas(site: Site) -> Trial:
    """A gas strut that pulls on the pivot, with the volume that suits it."""
    path, free = _pivot(site)
    area = _area(site, 0.2 * site.room, PRESSURE)
    law = Gas(area, 1.3 * area * site.room, site.room, action="pull", exponent=1.2)
    free |= {f"{NAME}.law.volume": (0.5 * area * site.room, 10.0 * area * site.room)}
    return Trial((Spring(NAME, path, law),), free)


def _gas_yoke(site: Site) -> Trial:
    path = _yoke(site)
    area = _area(site, 0.6 * site.room, PRESSURE)
    return Trial((Spring(NAME, path, Gas(area, 10 * area * site.room, 0.0, exponent=1.2)),), _turned(path))


def _hydro(site: Site) -> Trial:
    path = _yoke(site)
    area = _area(site, 0.6 * site.room, HYDRAULIC)
    volume = 10 * area * site.room
    law = HydroPneumatic(area, 1.4 * volume, volume, 0.0, exponent=Nitrogen(0.5, at=HYDRAULIC))
    return Trial((Spring(NAME, path, law),), _turned(path))


def _turned(path: ScotchYoke) -> dict[str, tuple[float, float]]:
    return {f"{NAME}.path.phase": (path.phase - 0.3, path.phase + 0.3)}


def _bodies(site: Site) -> tuple[str, ...]:
    """The bodies that the driven joints move; raises InputError unless all are hinges of one plane."""
    model = site.mechanism.model
    names = tuple(model.body(model.jnt_bodyid[joint]).name for joint in site.mechanism.driven_ids)
    for name in names:
        try:
            Absolute(name).check(site.mechanism, NAME)
        except InputError as error:
            raise InputError(f"the arrangement needs a planar arm: {error.message}") from None
    return names


def _structure_one(site: Site) -> Trial:
    """Parallelograms bring every link's angle to the base; a constant force pulls each crank to its pivot."""
    springs, free = [], {}
    for index, body in enumerate(_bodies(site), 1):
        name = f"{NAME}{index}"
        path = InvertedSliderCrank(Absolute(body), 0.2 * site.room, 1.2 * site.room, phase=-0.5 * math.pi)
        springs.append(Spring(name, path, Constant()))
        free[f"{name}.path.phase"] = (-0.5 * math.pi - 0.3, -0.5 * math.pi + 0.3)
    return Trial(tuple(springs), free, (), whole=True)


def _structure_two(site: Site) -> Trial:
    """Cables over equal pulleys bring every link's angle to a Scotch yoke with a gas spring."""
    springs, free = [], {}
    area = _area(site, 0.6 * site.room, PRESSURE)
    for index, body in enumerate(_bodies(site), 1):
        name = f"{NAME}{index}"
        path = ScotchYoke(Absolute(body), 0.6 * site.room)
        springs.append(Spring(name, path, Gas(area, 10 * area * site.room, 0.0, exponent=1.2)))
        free[f"{name}.path.phase"] = (-0.3, 0.3)
    return Trial(tuple(springs), free, (), whole=True)


IDEAL = "no spring has zero free length; a cable and an eye (B), or a rod through a pivot (C I), make one of a coil"


HINGE = (
    Family("zero-free-length spring between two pins", "A", 1, _ideal, ARAKELIAN + QUAGLIA, IDEAL),
    Family("extension spring hooked straight on", "A", 1, _hooked, ARAKELIAN),
    Family("spring, cable and eye", "B", 3, _cable, ARAKELIAN),
    Family("slider-crank and compression spring", "C I", 4, _dyad, ARAKELIAN + ZHANG),
    Family("rod through a pivot and compression spring", "C I", 3, _rod, ARAKELIAN),
    Family("cam and compression spring", "C II", 3, _cam, ARAKELIAN),
    Family("2:1 gear, Scotch yoke and compression spring", "C III", 5, _gear, ARAKELIAN),
    Family("counterweight", "", 1, _weight),
    Family("torsion spring", "", 1, _torsion),
    Family("constant-force spring between two pins", "", 1, _constant_pivot, QUAGLIA),
    Family("constant-force spring on a Scotch yoke", "", 3, _constant_yoke, QUAGLIA),
    Family("gas strut between two pins", "", 1, _gas, QUAGLIA),
    Family("gas spring on a Scotch yoke", "", 3, _gas_yoke, QUAGLIA),
    Family("hydro-pneumatic cylinder on a Scotch yoke", "", 4, _hydro, QUAGLIA),
    Family("structure I: parallelograms, pivots, constant force", "", 4, _structure_one, QUAGLIA),
    Family("structure II: cables, Scotch yokes, gas springs", "", 6, _structure_two, QUAGLIA),
)
"""Families for a hinge; parts of the two arrangements are counted for every link."""
