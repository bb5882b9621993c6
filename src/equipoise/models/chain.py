"""Serial arms from a plain table of lengths and masses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.models.parts import (
    COUNTERCLOCKWISE,
    EARTH,
    Gravity,
    Planar,
    add_body,
    add_joint,
    finish,
    interval,
    new_spec,
    positive,
    rod_inertial,
    vector,
    word,
)
from equipoise.units import Angle, Force, Inertia, Length, Mass, Number, Torque

Spatial = tuple[Length, Length, Length]


@dataclass(frozen=True)
class Link:
    """One link of a chain and the joint before it; the joint is called `<name>_joint`.

    The link's frame sits at its joint, x along the link; at joint position zero it is parallel to the
    frame of the link before it.

    length       m, where the next joint sits by default
    mass         kg; 0 is allowed
    com          centre of mass in the link's frame, m: distance along x, (x, z) or (x, y, z); default mid-length
    inertia      about the centre of mass, kg m^2: one number for the y and z axes (y is the axis of planar
                 hinges), or three for x, y, z; default a thin rod, m l^2 / 12
    joint        `hinge` or `slide`
    axis         joint axis in the parent link's frame; default the planar hinge, or x for a slide
    at           joint origin in the parent link's frame, m: distance along x, (x, z) or (x, y, z); default its tip
                 (the first link's counts from the base, along the world's axes)
    limits       range of a hinge, rad; stroke is the range of a slide, m; default unlimited
    motor_limit  N m for a hinge; motor_force, N, for a slide
    """

    name: str
    length: Length
    mass: Mass = 0.0
    com: Length | Planar | Spatial | None = None
    inertia: Inertia | tuple[Inertia, Inertia, Inertia] | None = None
    joint: Literal["hinge", "slide"] = "hinge"
    axis: tuple[Number, Number, Number] | None = None
    at: Length | Planar | Spatial | None = None
    limits: tuple[Angle, Angle] | None = None
    stroke: tuple[Length, Length] | None = None
    motor_limit: Torque | None = None
    motor_force: Force | None = None


def chain(
    links: Sequence[Link],
    *,
    datum: Literal["right", "up"] = "right",
    base: Spatial = (0.0, 0.0, 0.0),
    gravity: Gravity = EARTH,
    name: str = "chain",
) -> Mechanism:
    """A serial arm of links, every joint driven, planar in x-z unless axes say otherwise.

        p_i = sum_{k <= i} l_k (cos s_k, sin s_k),  s_k = q_1 + ... + q_k   (datum `right`)

    links are `Link`s from the base outwards; q are relative joint angles, rad. datum `right` starts along +x
    and counts counter-clockwise (hinge axis (0, -1, 0)); datum `up` starts along +z and counts clockwise
    (axis (0, 1, 0)). z of a link's frame is 90 degrees counter-clockwise from x with either. base (3,) is
    where the first joint sits, m; gravity (3,), m/s^2, is zero for an arm in a horizontal plane.

    Raises InputError naming the link and field for a non-positive length, a negative mass, an inertia that
    belongs to no body, limits of the wrong kind, a repeated name.
    """
    if not links:
        raise InputError("links is empty, a chain needs at least one", where=name)
    word(datum, ("right", "up"), "datum", name)
    names = [link.name for link in links]
    for link in links:
        if not link.name or link.name == "world" or names.count(link.name) > 1:
            raise InputError(f"link name {link.name!r} is empty, reserved or used twice", where=name)
    spec = new_spec(name, gravity)
    body = spec.worldbody
    place: Any = vector(base, 3, "base", name)
    clockwise = datum == "up"
    for index, link in enumerate(links):
        where = f"{name}.{link.name}"
        length = positive(link.length, "length", "m", where)
        offset = (0.0, 0.0, 0.0) if link.at is None else _place(link.at, where)
        if index == 0:
            pos = tuple(a + b for a, b in zip(place, offset, strict=True))
        else:
            pos = place if link.at is None else offset
        inertial = rod_inertial(link.mass, length, link.com, link.inertia, where)
        turn = 0.5 * math.pi if clockwise and index == 0 else 0.0
        body = add_body(body, link.name, inertial, pos=pos, length=length, turn=turn)
        _add_joint(body, link, clockwise, where)
        place = (length, 0.0, 0.0)
    return finish(spec, [f"{link.name}_joint" for link in links])


def _place(at: Any, where: str) -> tuple[float, ...]:
    if not isinstance(at, Sequence):
        return *vector((at,), 1, "at", where), 0.0, 0.0
    place = vector(at, len(at) if len(at) in (2, 3) else 3, "at", where)
    return (place[0], 0.0, place[1]) if len(place) == 2 else place


def _add_joint(body: Any, link: Link, clockwise: bool, where: str) -> None:
    word(link.joint, ("hinge", "slide"), "joint", where)
    slide = link.joint == "slide"
    of_hinge, of_slide = ("limits", "motor_limit"), ("stroke", "motor_force")
    wrong, right = (of_hinge, of_slide) if slide else (of_slide, of_hinge)
    for field, instead in zip(wrong, right, strict=True):
        if getattr(link, field) is not None:
            raise InputError(f"{field} does not belong to a {link.joint}", where=where, hint=f"use {instead}")
    if link.axis is not None:
        axis = vector(link.axis, 3, "axis", where)
        positive(math.hypot(*axis), "length of axis", "", where)
    elif slide:
        axis = (1.0, 0.0, 0.0)
    else:
        axis = tuple(-value for value in COUNTERCLOCKWISE) if clockwise else COUNTERCLOCKWISE
    limits = interval(link.stroke if slide else link.limits, "stroke" if slide else "limits", where)
    given, unit = (link.motor_force, "N") if slide else (link.motor_limit, "N m")
    motor = None if given is None else positive(given, "motor_force" if slide else "motor_limit", unit, where)
    add_joint(body, f"{link.name}_joint", axis=axis, slide=slide, limits=limits, motor=motor)
