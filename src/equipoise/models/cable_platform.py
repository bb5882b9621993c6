"""Cable platforms: a point, a planar body or a spatial body that cables hold from fixed anchors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError, nearest
from equipoise.mechanism import Mechanism, Platform, Point
from equipoise.models.parts import (
    COUNTERCLOCKWISE,
    EARTH,
    Gravity,
    Inertial,
    add_body,
    add_joint,
    finish,
    interval,
    new_spec,
    not_negative,
    positive,
    vector,
)
from equipoise.sag import Sag
from equipoise.units import Force, Inertia, Joint, Length, Mass

BODY = "platform"
TURNS = {"yaw": (0.0, 0.0, 1.0), "pitch": (0.0, 1.0, 0.0), "roll": (1.0, 0.0, 0.0)}
COINCIDENT = 1e-9


def cable_platform(
    anchors: tuple[tuple[Length, ...], ...],
    attachments: tuple[tuple[Length, ...], ...] | None = None,
    *,
    cables: tuple[str, ...] | None = None,
    mass: Mass = 0.0,
    com: tuple[Length, ...] | None = None,
    inertia: tuple[Inertia, Inertia, Inertia] | None = None,
    length: Length | None = None,
    limits: Mapping[str, tuple[Joint, Joint]] | None = None,
    t_min: Force | Sag | tuple[Force, ...] = 0.0,
    t_max: Force | tuple[Force, ...] | None = None,
    gravity: Gravity = EARTH,
    name: str = "cable_platform",
) -> Mechanism:
    """A platform held by cables; its driven joints are its own position and turn, its cables are tendons.

        W(x) t + w = 0,   w_i-th column of W = [u_i; (R b_i) x u_i],   u_i = (a_i - p - R b_i) / |a_i - p - R b_i|

    anchors a_i (m, 2) or (m, 3), world axes, m; two coordinates are (x, z) and the platform stays in that plane.
    attachments b_i, as many, in the platform's frame from its reference point p; without them the platform is a
    point. Joints: x, z (and `turn`, counter-clockwise) in the plane; x, y, z (and yaw, pitch, roll: the body turns
    about z, then its own y, then its own x) in space; slides are the world coordinates of p.
    cables names them, default cable_1 ...; mass in kg at com (platform frame, m, default p), inertia about com
    along the platform's axes, kg m^2. length l in m makes forces and moments comparable: the resultant is
    (F, M / l), default l = the root mean square of |b_i|. limits {joint: (low, high)}; slides are limited to
    the box of the anchors by default. The reference posture is the anchors' mean. t_min and t_max, N, are the tensions
    that the cables may have, one for all or one for each; `Sag` asks for the t_min that keeps a rope straight. They
    decide what `analyze` calls feasible and what motors may do; a spring's own limits stand in the problem.

    Raises InputError for too few cables (n + 1 hold n degrees of freedom against any load, n can hold a weight),
    for cables that coincide, anchors and attachments that do not match, t_min above t_max, and numbers that mean
    nothing.
    """
    a = _points(anchors, "anchors", name)
    size = a.shape[1]
    b = None if attachments is None else _points(attachments, "attachments", name, like=a)
    m, heavy = len(a), not_negative(mass, "mass", "kg", name)
    joints = _joints(size, b is not None)
    _enough(m, len(joints), heavy > 0 and any(gravity), name)
    names = tuple(f"cable_{i + 1}" for i in range(m)) if cables is None else tuple(cables)
    _distinct(names, a, b, name)
    ends = np.zeros((m, size)) if b is None else b
    ranges = _ranges(joints, a, limits or {}, name)
    spec = new_spec(name, gravity)
    spec.compiler.savecompiled = False
    middle = vector(com if com is not None else (0.0,) * size, size, "com", name)
    axes = (0.0, 0.0, 0.0) if inertia is None else vector(inertia, 3, "inertia", name)
    weight = Inertial(heavy, tuple(_space(np.array(middle))), axes)  # type: ignore[arg-type]
    body = add_body(spec.worldbody, BODY, weight)
    for joint, (axis, slide) in joints.items():
        add_joint(body, joint, axis=axis, slide=slide, limits=ranges[joint])
    for cable, anchor, end in zip(names, a, ends, strict=True):
        _add_cable(spec, body, cable, _space(anchor), _space(end))
    reach = float(np.sqrt((ends**2).sum(1).mean()))
    metric = positive(length, "length", "m", name) if length is not None else reach or 1.0
    allowed = _tensions(t_min, t_max, a, name)
    platform = Platform(Point(BODY), _rows(size, b is not None), metric, names, *allowed)
    reference = [*a.mean(0), *[0.0] * (len(joints) - size)]
    return replace(finish(spec, tuple(joints), reference, "centre"), platform=platform)


def _points(values: Any, what: str, where: str, like: Array | None = None) -> Array:
    if not isinstance(values, Sequence | np.ndarray) or len(values) == 0:
        raise InputError(f"{what} is {values!r}, a list of points is needed", where=where)
    size = len(values[0]) if isinstance(values[0], Sequence | np.ndarray) else 0
    if like is not None:
        size = like.shape[1]
        if len(values) != len(like):
            raise InputError(f"{len(values)} attachments for {len(like)} anchors", where=where, hint="one per cable")
    elif size not in (2, 3):
        raise InputError(f"{what}[0] is {values[0]!r}, it must be (x, z) or (x, y, z)", where=where)
    return np.array([vector(point, size, f"{what}[{i}]", where) for i, point in enumerate(values)])


def _joints(size: int, turns: bool) -> dict[str, tuple[tuple[float, float, float], bool]]:
    """Joints of the platform in order: {name: (axis, whether it slides)}."""
    slides = {axis: (tuple(np.eye(3)["xyz".index(axis)]), True) for axis in ("xz" if size == 2 else "xyz")}
    hinges = {"turn": COUNTERCLOCKWISE} if size == 2 else TURNS
    return slides | ({joint: (axis, False) for joint, axis in hinges.items()} if turns else {})


def _rows(size: int, turns: bool) -> tuple[tuple[float, ...], ...]:
    """Rows of S (n, 6) that pick the platform's wrench from (F, M) in world axes."""
    forces = [0, 2] if size == 2 else [0, 1, 2]
    rows = [tuple(np.eye(6)[axis]) for axis in forces]
    if turns and size == 2:
        rows.append((0.0, 0.0, 0.0, *COUNTERCLOCKWISE))
    elif turns:
        rows += [tuple(np.eye(6)[axis]) for axis in (3, 4, 5)]
    return tuple(rows)


def _space(point: Array) -> tuple[float, float, float]:
    x, *rest = (float(value) for value in point)
    return (x, 0.0, rest[0]) if len(rest) == 1 else (x, rest[0], rest[1])


def _enough(cables: int, freedoms: int, weighs: bool, where: str) -> None:
    if cables < freedoms or (cables == freedoms and not weighs):
        needed = freedoms if weighs else freedoms + 1
        hint = f"add cables; {freedoms + 1} hold it against any load"
        hint += "" if weighs else f", {freedoms} only under its own weight: give `mass`" if cables == freedoms else ""
        raise InputError(
            f"{cables} cables cannot hold a platform with {freedoms} degrees of freedom, at least {needed} are needed",
            where=where,
            hint=hint,
        )


def _distinct(names: tuple[str, ...], a: Array, b: Array | None, where: str) -> None:
    if len(names) != len(a):
        raise InputError(f"{len(names)} names for {len(a)} cables", where=where, hint="name every cable, or none")
    if len(set(names)) < len(names):
        raise InputError("two cables have the same name", where=where, hint="name each cable once")
    rows = a if b is None else np.hstack([a, b])
    for i in range(len(a)):
        for j in range(i):
            if np.abs(rows[i] - rows[j]).max() <= COINCIDENT * (1 + np.abs(a).max()):
                what = "anchors" if b is None else "anchors and attachments"
                raise InputError(
                    f"the {what} of {names[j]} and {names[i]} coincide at {tuple(a[i].tolist())}",
                    where=where,
                    hint="remove one of the two, or move it",
                )


def _tensions(low: Any, high: Any, a: Array, where: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Least and largest tension of every cable."""
    if isinstance(low, Sag):
        low = low.tension(float(np.linalg.norm(a[:, None] - a, axis=-1).max()))
    found = []
    for value, what in ((low, "t_min"), (np.inf if high is None else high, "t_max")):
        each = tuple(value) if isinstance(value, Sequence) else (value,) * len(a)
        if len(each) != len(a):
            raise InputError(f"{len(each)} values of {what} for {len(a)} cables", where=where, hint="one, or one each")
        found.append(tuple(float(one) if np.isinf(one) else not_negative(one, what, "N", where) for one in each))
    for least, most in zip(*found, strict=True):
        if not least < most:
            raise InputError(f"t_min is {least:g} N, t_max {most:g} N: no tension is left", where=where)
    return found[0], found[1]


def _ranges(
    joints: Mapping[str, Any], a: Array, limits: Mapping[str, Any], where: str
) -> dict[str, tuple[float, float] | None]:
    for joint in limits:
        if joint not in joints:
            raise InputError(f"there is no joint {joint!r} to limit", where=where, hint=nearest(joint, list(joints)))
    found: dict[str, tuple[float, float] | None] = {}
    for index, joint in enumerate(joints):
        if joint in limits:
            found[joint] = interval(limits[joint], f"limits of {joint}", where)
        elif index < a.shape[1] and np.ptp(a[:, index]) > 0:
            found[joint] = float(a[:, index].min()), float(a[:, index].max())
        else:
            found[joint] = None
    return found


def _add_cable(spec: mujoco.MjSpec, body: Any, name: str, anchor: Any, end: Any) -> None:
    spec.worldbody.add_site(name=f"{name}_anchor", pos=list(anchor))
    body.add_site(name=f"{name}_end", pos=list(end))
    tendon = spec.add_tendon(name=name)
    tendon.wrap_site(f"{name}_anchor")
    tendon.wrap_site(f"{name}_end")
