"""CASPR's body and cable files: one platform, straight cables."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from equipoise.affine import Array
from equipoise.errors import ModelError, nearest
from equipoise.mechanism import Mechanism
from equipoise.models.cable_platform import cable_platform
from equipoise.models.xmlfile import number, numbers, read_xml
from equipoise.units import Joint, Length

ZERO = (0.0, 0.0, 0.0)
G = 9.81
# CASPR declares its types in a file of its own, or attributes in place; neither can expand.
_DECLARED = re.compile(
    rb'<!DOCTYPE\s+\w+\s*(?:SYSTEM\s+"[^"]*"|SYSTEM\s+\'[^\']*\')?\s*(?:\[(?:\s*<!ATTLIST[^<>\[\]]*>)*\s*\])?\s*>'
)


@dataclass(frozen=True)
class Space:
    """Axes of CASPR's world in which a joint moves, whether the body turns, and the gravity in them."""

    axes: tuple[int, ...]
    turns: bool

    @property
    def gravity(self) -> tuple[float, float, float]:
        """CASPR's weight acts along its -Z; a plane without Z is horizontal."""
        return (0.0, 0.0, -G) if 2 in self.axes else (0.0, 0.0, 0.0)


SPACES = {
    "PLANAR_XY": Space((0, 1), True),
    "PLANAR_XZ": Space((0, 2), True),
    "PLANAR_YZ": Space((1, 2), True),
    "T_XY": Space((0, 1), False),
    "T_XZ": Space((0, 2), False),
    "T_YZ": Space((1, 2), False),
    "T_XYZ": Space((0, 1, 2), False),
    "SPATIAL": Space((0, 1, 2), True),
    "SPATIAL_EULER_XYZ": Space((0, 1, 2), True),
    "SPATIAL_QUATERNION": Space((0, 1, 2), True),
}


def caspr(
    bodies: Path,
    cables: Path,
    *,
    cable_set: str | None = None,
    limits: Mapping[str, tuple[Joint, Joint]] | None = None,
    length: Length | None = None,
    name: str | None = None,
) -> Mechanism:
    """The cable platform that a pair of CASPR files describes: one moving link and cables of two points each.

    bodies and cables are the XML files (SI units); cable_set names a set (default: the file's own default);
    limits and length are those of `cable_platform`; t_min and t_max are the file's force_min and force_max.
    CASPR's plane XY, XZ or YZ becomes (x, z) here, and its rotations a yaw, pitch and roll. The reference point is
    the joint's frame; gravity acts along CASPR's -Z.

    Raises ModelError for malformed XML, missing elements, several links, cables with more than two points,
    and joint types that are no platform, naming file and element; InputError for cables that cannot hold it.
    """
    link = _link(read_xml(Path(bodies), str(bodies), drop=_DECLARED), str(bodies))
    space = _space(link, str(bodies))
    mass, com = _weight(link, str(bodies))
    base = np.array(numbers(link.findtext("parent/location"), ZERO, "location", f"{bodies}, parent"))
    names, anchors, ends, tensions = _cables(
        read_xml(Path(cables), str(cables), drop=_DECLARED), cable_set, str(cables), com
    )
    axes = list(space.axes)
    if not space.turns and np.ptp(ends, axis=0).max() > 0:
        raise ModelError("the platform does not turn, but its cables end at different points", where=str(cables))
    xx, yy, zz = (
        number(link.findtext(f"physical/inertia/{key}"), 0.0, key, str(bodies)) for key in ("Ixx", "Iyy", "Izz")
    )
    made = cable_platform(
        tuple(map(tuple, (anchors - base)[:, axes])),
        tuple(map(tuple, ends[:, axes])) if space.turns else None,
        cables=names,
        mass=mass,
        com=tuple(com[axes]) if space.turns else None,
        inertia=(xx, yy, zz) if min(xx, yy, zz) > 0 else None,
        length=length,
        limits=limits,
        t_min=tuple(low for low, _ in tensions),
        t_max=tuple(high for _, high in tensions),
        gravity=space.gravity,
        name=name or str(link.get("name") or Path(bodies).stem).replace(" ", "_"),
    )
    return replace(made, source=Path(bodies))


def _link(root: ET.Element, where: str) -> ET.Element:
    holder = root if root.tag == "links" else root.find("links")
    found = [] if holder is None else holder.findall("link_rigid")
    if len(found) != 1:
        raise ModelError(
            f"{len(found)} links in the file, a cable platform is one", where=where, hint="give CASPR's *_bodies.xml"
        )
    if number(found[0].findtext("parent/num"), 0.0, "parent/num", where) != 0:
        raise ModelError("the link's parent is not the base", where=where)
    return found[0]


def _space(link: ET.Element, where: str) -> Space:
    joint = link.find("joint")
    kind = (joint.get("type", "") if joint is not None else link.findtext("joint_type") or "").strip()
    if kind not in SPACES:
        raise ModelError(f"joint type {kind!r} is no platform", where=where, hint=nearest(kind, list(SPACES)))
    return SPACES[kind]


def _weight(link: ET.Element, where: str) -> tuple[float, Array]:
    if link.find("physical/mass") is None:
        raise ModelError("the link has no physical/mass", where=where, hint="write 0 for a platform without weight")
    mass = number(link.findtext("physical/mass"), 0.0, "mass", where)
    return mass, np.array(numbers(link.findtext("physical/com_location"), ZERO, "com_location", where))


def _cables(
    root: ET.Element, wanted: str | None, where: str, com: Array
) -> tuple[tuple[str, ...], Array, Array, list[tuple[float, float]]]:
    sets = {str(found.get("id")): found for found in root.iter("cable_set")}
    key = wanted or root.get("default_cable_set") or next(iter(sets), "")
    if key not in sets:
        raise ModelError(f"there is no cable set {key!r}", where=where, hint=nearest(key, list(sets)))
    names, anchors, ends, tensions = [], [], [], []
    for cable in sets[key]:
        if not cable.tag.startswith("cable"):
            continue
        name = str(cable.get("name") or f"cable {len(names) + 1}").strip().replace(" ", "_")
        place = f"{where}, {name}"
        points = cable.findall("attachments/attachment")
        links = [int(number(point.findtext("link"), 0.0, "link", place)) for point in points]
        if sorted(links) != [0, 1]:
            raise ModelError(
                f"a cable runs over links {links}; one end on the base (0) and one on the platform (1) are read",
                where=place,
            )
        where_to = {
            link: np.array(numbers(point.findtext("location"), ZERO, "location", place))
            for link, point in zip(links, points, strict=True)
        }
        reference = str(cable.get("attachment_reference") or "joint").lower()
        if reference not in ("joint", "com"):
            raise ModelError(f"attachment_reference is {reference!r}", where=place, hint="joint or com")
        names.append(name)
        anchors.append(where_to[0])
        ends.append(where_to[1] + (com if reference == "com" else 0.0))
        low, high = (
            number(cable.findtext(f"properties/force_{side}"), default, f"force_{side}", place)
            for side, default in (("min", 0.0), ("max", math.inf))
        )
        tensions.append((low, high))
    if not names:
        raise ModelError(f"cable set {key!r} has no cables", where=where)
    return tuple(names), np.array(anchors), np.array(ends), tensions
