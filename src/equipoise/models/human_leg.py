"""A human leg by body mass and stature, from published anthropometric tables."""

from __future__ import annotations

import csv
import functools
from dataclasses import dataclass, replace
from importlib.resources import files
from typing import Literal

from equipoise.mechanism import Mechanism
from equipoise.models.parts import EARTH, Gravity, add_body, add_joint, finish, interval, new_spec, positive, word
from equipoise.models.parts import Inertial as Weighted
from equipoise.units import Angle, Length, Mass

TABLES = ("winter", "de_leva_male")
SLENDER = 1e-3  # share of a segment's inertia that it has about its own axis: no matter in the plane


@dataclass(frozen=True)
class Segment:
    """Mass (kg), length (m), centre of mass from the proximal joint along the limb (m), inertia about it (kg m^2)."""

    mass: float
    length: float
    com: float
    inertia: float

    @property
    def weighted(self) -> Weighted:
        """What a body along x needs."""
        return Weighted(self.mass, (self.com, 0.0, 0.0), (SLENDER * self.inertia, self.inertia, self.inertia))


def human_leg(
    mass: Mass,
    height: Length,
    table: Literal["winter", "de_leva_male"] = "winter",
    *,
    hip: tuple[Angle, Angle] = (-2.0943951023931953, -0.5235987755982988),
    knee: tuple[Angle, Angle] = (-2.0943951023931953, 0.0),
    gravity: Gravity = EARTH,
    name: str = "leg",
) -> Mechanism:
    """A leg in the x-z plane: thigh and shank with the foot at right angles, driven at hip and knee.

        m_s = a_s mass,   l_s = b_s height,   c_s = f_s l_s,   I_s = m_s (r_s l_s)^2

    mass of the body, kg, and height (stature), m, of a person who faces +x; joints `hip` (the thigh's angle from
    +x counter-clockwise: -90 deg hangs straight down, the default range lifts it 60 deg forward and 30 deg back)
    and `knee` (negative flexes), both from their ranges, rad. Bodies `thigh` and `shank` have x along the limb.
    table names the shares a, b, f, r: `winter` (Dempster's cadavers, adapted by Winter; lengths of Drillis and
    Contini) or `de_leva_male` (Zatsiorsky's living men, adjusted by de Leva) [bmc_segments, amber_segments,
    drillis_contini_1966]. The foot of `de_leva_male` is taken on the shank's line, half the ankle's height below
    the ankle, which is ours. Raises InputError for a mass or height that is not positive, and an unknown table.
    """
    thigh, shank = segments(mass, height, table, name)
    spec = new_spec(name, gravity)
    upper = add_body(spec.worldbody, "thigh", thigh.weighted, length=thigh.length)
    add_joint(upper, "hip", limits=interval(hip, "hip", name))
    lower = add_body(upper, "shank", shank.weighted, pos=(thigh.length, 0.0, 0.0), length=shank.length)
    add_joint(lower, "knee", limits=interval(knee, "knee", name))
    return replace(finish(spec, ("hip", "knee")), sources=sources(table))


def sources(table: str) -> tuple[str, ...]:
    """Keys in references.bib of where a table's shares come from."""
    return tuple(dict.fromkeys(key for (name, _), row in _lines() if name == table for key in row["source"].split()))


def segments(mass: Mass, height: Length, table: str, where: str = "leg") -> tuple[Segment, Segment]:
    """Thigh and shank with foot of a person of `mass`, kg, and `height`, m."""
    mass, height = positive(mass, "mass", "kg", where), positive(height, "height", "m", where)
    word(table, TABLES, "table", where)

    def of(segment: str) -> Segment:
        row = rows()[table, segment]
        m, length = row["mass"] * mass, row["length"] * height
        return Segment(m, length, row["com"] * length, m * (row["gyration"] * length) ** 2)

    thigh = of("thigh")
    if (table, "shank_and_foot") in rows():
        return thigh, of("shank_and_foot")
    shank, foot = of("shank"), of("foot")
    drop = 0.5 * rows()["stature", "ankle"]["length"] * height
    return thigh, _joined(shank, Segment(foot.mass, 0.0, shank.length + drop, foot.inertia))


def _joined(a: Segment, b: Segment) -> Segment:
    mass = a.mass + b.mass
    com = (a.mass * a.com + b.mass * b.com) / mass
    inertia = sum(s.inertia + s.mass * (s.com - com) ** 2 for s in (a, b))
    return Segment(mass, a.length, com, inertia)


@functools.cache
def rows() -> dict[tuple[str, str], dict[str, float]]:
    """{(table, segment): {mass, length, com, gyration}} of data/body_segments.csv, shares."""
    shares = ("mass", "length", "com", "gyration")
    return {place: {share: float(row[share]) for share in shares if row[share]} for place, row in _lines()}


def _lines() -> list[tuple[tuple[str, str], dict[str, str]]]:
    text = (files("equipoise") / "data" / "body_segments.csv").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    return [((row["table"], row["segment"]), row) for row in csv.DictReader(lines)]
