"""The links and joints of a URDF file, checked to be one tree with numbers in it."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass, replace

import numpy as np

from equipoise.affine import Array
from equipoise.errors import ModelError, nearest
from equipoise.models.urdf_check import check_mimic, check_tree
from equipoise.models.xmlfile import number, numbers

Vector = tuple[float, ...]
_ZERO = (0.0, 0.0, 0.0)
_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
_MOST_LINKS = 1000
_UNLIMITED = 1e6
_ANY = 1e300


@dataclass
class Inertial:
    """Mass (kg), inertia matrix about its centre (3, 3), kg m^2, and the centre's frame in the link (m, rad)."""

    mass: float
    matrix: Array
    xyz: Vector = _ZERO
    rpy: Vector = _ZERO

    def replaced(self, matrix: Array) -> Inertial:
        """The same mass and centre with another inertia matrix."""
        return replace(self, matrix=matrix)


@dataclass
class Link:
    """A link and its inertial, if the file gives one."""

    name: str
    inertial: Inertial | None


@dataclass
class Joint:
    """A joint; `held` is where one that became fixed is stuck (rad, or m if it was a slide)."""

    name: str
    type: str
    parent: str
    child: str
    xyz: Vector
    rpy: Vector
    axis: Vector
    range: tuple[float, float] | None
    effort: float
    damping: float
    friction: float
    mimic: str
    multiplier: float
    offset: float
    was_slide: bool
    held: float = 0.0


@dataclass
class Tree:
    """All links by name and all joints in the order of the file."""

    name: str
    links: dict[str, Link]
    joints: list[Joint]

    def rigid(self) -> dict[str, str]:
        """For every link the first link above it that it is fixed to, itself where it moves."""
        above = {joint.child: joint.parent for joint in self.joints if joint.type == "fixed"}
        result: dict[str, str] = {}
        for name in self.links:
            chain = [name]
            while chain[-1] not in result and chain[-1] in above:
                chain.append(above[chain[-1]])
            first = result.get(chain[-1], chain[-1])
            result.update(dict.fromkeys(chain, first))
        return result


def read_tree(root: ET.Element, where: str) -> Tree:
    """Links and joints of a `robot` element.

    Raises ModelError naming the element that is missing, doubled, not a number or makes no tree.
    """
    if any("xacro" in element.tag for element in root.iter()):
        raise ModelError("this is a xacro template", where=where, hint="run xacro on it and load what it writes")
    for block in root.iter("mujoco"):
        if any(element.tag in ("plugin", "extension") for element in block.iter()):
            raise ModelError("plugins in a file are refused", where=where, hint="remove the plugin from <mujoco>")
    links: dict[str, Link] = {}
    for element in root.findall("link"):
        name = _name(element, "link", links, where)
        links[name] = Link(name, _inertial(element.find("inertial"), name, where))
    joints: dict[str, Joint] = {}
    for element in root.findall("joint"):
        name = _name(element, "joint", joints, where)
        joints[name] = _joint(element, name, where)
    if not links:
        raise ModelError("the robot has no link", where=where, hint="if this came from xacro, expand it again")
    if len(links) > _MOST_LINKS:
        raise ModelError(f"{len(links)} links are more than the {_MOST_LINKS} that are read", where=where)
    check_tree(links, list(joints.values()), where)
    check_mimic(joints, where)
    return Tree(root.get("name") or "", links, list(joints.values()))


def _name(element: ET.Element, kind: str, known: dict, where: str) -> str:
    name = element.get("name", "")
    if not name.strip():
        raise ModelError(f"a {kind} has no name", where=where)
    if name in known:
        raise ModelError(f"two {kind}s are named {name!r}", where=where, hint="rename one of them")
    return name


def _inertial(element: ET.Element | None, link: str, where: str) -> Inertial | None:
    if element is None:
        return None
    mass_element = element.find("mass")
    if mass_element is None or mass_element.get("value") is None:
        raise ModelError(f"link {link!r} has an inertial without a mass", where=where, hint="give <mass value=.../>")
    mass = number(mass_element.get("value"), 0.0, f"mass of link {link!r}", where, 1e9)
    if mass < 0.0:
        raise ModelError(f"link {link!r} has a negative mass, {mass:g} kg", where=where, hint="masses are positive")
    xyz, rpy = _origin(element, f"inertial origin of link {link!r}", where)
    inertia = element.find("inertia")
    found = {} if inertia is None else inertia.attrib
    keys = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    values = [number(found.get(key), 0.0, f"{key} of link {link!r}", where, 1e12) for key in keys]
    xx, xy, xz, yy, yz, zz = values
    return Inertial(mass, np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), xyz, rpy)


def _origin(element: ET.Element, what: str, where: str) -> tuple[Vector, Vector]:
    origin = element.find("origin")
    found = {} if origin is None else origin.attrib
    xyz = numbers(found.get("xyz"), _ZERO, f"{what}: xyz", where)
    return xyz, numbers(found.get("rpy"), _ZERO, f"{what}: rpy", where)


def _joint(element: ET.Element, name: str, where: str) -> Joint:
    kind = element.get("type", "")
    if kind not in _TYPES:
        raise ModelError(f"joint {name!r} has the unknown type {kind[:40]!r}", where=where, hint=nearest(kind, _TYPES))
    ends = [(element.find(side), side) for side in ("parent", "child")]
    parent, child = (("" if found is None else found.get("link", "")) for found, _ in ends)
    if not parent or not child:
        raise ModelError(f"joint {name!r} names no {'child' if parent else 'parent'} link", where=where)

    def attribute(tag: str, key: str, default: float = 0.0, most: float = 1e6) -> float:
        found = element.find(tag)
        return number(None if found is None else found.get(key), default, f"{tag} {key} of joint {name!r}", where, most)

    xyz, rpy = _origin(element, f"origin of joint {name!r}", where)
    effort = abs(attribute("limit", "effort", most=_ANY))
    mimic = element.find("mimic")
    if mimic is not None and not mimic.get("joint"):
        raise ModelError(f"joint {name!r} mimics a joint that is not named", where=where)
    return Joint(
        name=name,
        type=kind,
        parent=parent,
        child=child,
        xyz=xyz,
        rpy=rpy,
        axis=_axis(element, name, where) if kind not in ("fixed", "floating") else (1.0, 0.0, 0.0),
        range=_range(attribute("limit", "lower", most=_ANY), attribute("limit", "upper", most=_ANY), name, where)
        if kind in ("revolute", "prismatic") and _states_limits(element)
        else None,
        effort=effort if effort < 1e9 else 0.0,
        damping=max(0.0, attribute("dynamics", "damping")),
        friction=max(0.0, attribute("dynamics", "friction")),
        mimic="" if mimic is None else mimic.get("joint", ""),
        multiplier=attribute("mimic", "multiplier", 1.0),
        offset=attribute("mimic", "offset"),
        was_slide=kind == "prismatic",
    )


def _axis(element: ET.Element, name: str, where: str) -> Vector:
    found = element.find("axis")
    axis = numbers(None if found is None else found.get("xyz"), (1.0, 0.0, 0.0), f"axis of joint {name!r}", where)
    length = math.hypot(*axis)
    if length < 1e-9:
        raise ModelError(f"the axis of joint {name!r} is zero", where=where, hint="give a direction such as 0 0 1")
    return tuple(value / length for value in axis)


def _states_limits(element: ET.Element) -> bool:
    """Whether a joint states a limit of its position; one with only an effort turns freely, whatever its type."""
    limit = element.find("limit")
    return limit is not None and ("lower" in limit.attrib or "upper" in limit.attrib)


def _range(low: float, high: float, name: str, where: str) -> tuple[float, float] | None:
    if low > high:
        raise ModelError(
            f"joint {name!r} has its limits reversed: lower {low:g} is above upper {high:g}",
            where=where,
            hint="swap them",
        )
    # Limits of 1e16 are how some exporters write "none".
    return None if low <= -_UNLIMITED or high >= _UNLIMITED else (low, high)
