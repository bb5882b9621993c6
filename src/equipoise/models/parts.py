"""What the parametric builders share: checked numbers, links in the x-z plane, pins that close loops."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import mujoco
import numpy as np

from equipoise.errors import InputError
from equipoise.mechanism import Mechanism, compile_spec
from equipoise.units import Acceleration, Length

Elbow = Literal["left", "right"]
SIDES = ("left", "right")
Gravity = tuple[Acceleration, Acceleration, Acceleration]
Planar = tuple[Length, Length]
EARTH = (0.0, 0.0, -9.81)
COUNTERCLOCKWISE = (0.0, -1.0, 0.0)
MASSLESS = 1e-13  # kg and kg m^2: MuJoCo wants some inertia; 1e-12 N m cannot be seen
SLENDER = 1e-6  # part of a thin rod's inertia that it has about its own axis


@dataclass(frozen=True)
class Inertial:
    """Mass (kg), centre of mass (3,) in the link's frame (m), inertia about it along the link's axes (3,) (kg m^2)."""

    mass: float
    com: tuple[float, float, float]
    inertia: tuple[float, float, float]


def number(value: Any, what: str, where: str) -> float:
    """A finite number, or an InputError that names the field."""
    try:
        result = float(value)
    except (TypeError, ValueError):
        raise InputError(f"{what} is {value!r}, a number is needed", where=where) from None
    if not math.isfinite(result):
        raise InputError(f"{what} is {result}, a finite number is needed", where=where)
    return result


def positive(value: Any, what: str, unit: str, where: str) -> float:
    """A number above zero."""
    result = number(value, what, where)
    if result <= 0.0:
        raise InputError(f"{what} is {result:g} {unit}, it must be above 0", where=where)
    return result


def not_negative(value: Any, what: str, unit: str, where: str) -> float:
    """A number of at least zero."""
    result = number(value, what, where)
    if result < 0.0:
        raise InputError(f"{what} is {result:g} {unit}, it must be at least 0", where=where)
    return result


def vector(values: Any, size: int, what: str, where: str) -> tuple[float, ...]:
    """`size` finite numbers."""
    if isinstance(values, str) or not isinstance(values, Sequence | np.ndarray) or len(values) != size:
        raise InputError(f"{what} is {values!r}, {size} numbers are needed", where=where)
    return tuple(number(value, f"{what}[{index}]", where) for index, value in enumerate(values))


def word(value: str, allowed: tuple[str, ...], what: str, where: str) -> str:
    """One of the allowed words."""
    if value not in allowed:
        raise InputError(f"{what} is {value!r}, it must be {' or '.join(allowed)}", where=where)
    return value


def interval(values: Any, what: str, where: str) -> tuple[float, float] | None:
    """Lower and upper limit, or None."""
    if values is None:
        return None
    lower, upper = vector(values, 2, what, where)
    if lower >= upper:
        raise InputError(f"{what} runs from {lower:g} to {upper:g}, the first must be below the second", where=where)
    return lower, upper


def rod_inertial(mass: Any, length: float, com: Any, inertia: Any, where: str) -> Inertial:
    """The inertial data of a link along x: defaults are a centre at mid-length and a thin rod, m l^2 / 12.

    com is a distance along the link, (x, z) or (x, y, z); one number as inertia is that about the y and z
    axes at the centre of mass, three are about x, y and z and must obey the triangle inequality.
    """
    mass = not_negative(mass, "mass", "kg", where)
    if com is None:
        com = 0.5 * length
    if isinstance(com, Sequence | np.ndarray):
        place = vector(com, len(com) if len(com) in (2, 3) else 3, "com", where)
        place = (place[0], 0.0, place[1]) if len(place) == 2 else place
    else:
        place = (number(com, "com", where), 0.0, 0.0)
    if isinstance(inertia, Sequence | np.ndarray) and not isinstance(inertia, str):
        axes = vector(inertia, 3, "inertia", where)
    else:
        about = mass * length**2 / 12.0 if inertia is None else not_negative(inertia, "inertia", "kg m^2", where)
        axes = (SLENDER * about, about, about)
    for axis, value in zip("xyz", axes, strict=True):
        not_negative(value, f"inertia about {axis}", "kg m^2", where)
    if 2.0 * max(axes) > sum(axes) * (1.0 + 1e-9):
        raise InputError(
            f"inertia {axes} kg m^2 belongs to no body: the largest exceeds the sum of the other two", where=where
        )
    return Inertial(mass, (place[0], place[1], place[2]), (axes[0], axes[1], axes[2]))


def new_spec(name: str, gravity: Any) -> mujoco.MjSpec:
    """An empty model in SI units and radians."""
    spec = mujoco.MjSpec()
    spec.modelname = name
    spec.compiler.degree = False
    spec.compiler.savecompiled = False
    spec.option.gravity = vector(gravity, 3, "gravity", name)
    return spec


def add_body(
    parent: Any, name: str, inertial: Inertial, *, pos: Any = (0.0, 0.0, 0.0), length: float = 0.0, turn: float = 0.0
) -> Any:
    """A body at pos in its parent, turned counter-clockwise in the x-z plane, drawn as a bar along x."""
    body = parent.add_body(name=name, pos=list(pos), quat=[math.cos(turn / 2), 0.0, -math.sin(turn / 2), 0.0])
    body.explicitinertial = True
    body.mass = max(inertial.mass, MASSLESS)
    body.ipos = list(inertial.com)
    body.inertia = [max(value, MASSLESS) for value in inertial.inertia]
    if length > 0.0:
        bar = {"type": mujoco.mjtGeom.mjGEOM_CAPSULE, "fromto": [0, 0, 0, length, 0, 0], "size": [0.03 * length, 0, 0]}
        body.add_geom(**bar, contype=0, conaffinity=0, rgba=[0.6, 0.65, 0.7, 1.0])
    return body


def add_joint(
    body: Any,
    name: str,
    *,
    axis: Any = COUNTERCLOCKWISE,
    slide: bool = False,
    limits: tuple[float, float] | None = None,
    motor: float | None = None,
) -> None:
    """A hinge or slide at the body's origin."""
    kind = mujoco.mjtJoint.mjJNT_SLIDE if slide else mujoco.mjtJoint.mjJNT_HINGE
    joint = body.add_joint(name=name, type=kind, axis=list(axis))
    if limits is not None:
        joint.limited, joint.range = mujoco.mjtLimited.mjLIMITED_TRUE, list(limits)
    else:
        joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
    if motor is not None:
        joint.actfrclimited, joint.actfrcrange = mujoco.mjtLimited.mjLIMITED_TRUE, [-motor, motor]


def add_pin(spec: mujoco.MjSpec, name: str, first: tuple[Any, Any], second: tuple[Any, Any]) -> None:
    """A pin that holds a point of one body on a point of another: each is (body, (x, y, z))."""
    for suffix, (body, place) in zip("ab", (first, second), strict=True):
        body.add_site(name=f"{name}_{suffix}", pos=list(place))
    spec.add_equality(
        name=name,
        type=mujoco.mjtEq.mjEQ_CONNECT,
        objtype=mujoco.mjtObj.mjOBJ_SITE,
        name1=f"{name}_a",
        name2=f"{name}_b",
    )


def finish(spec: mujoco.MjSpec, driven: Sequence[str], reference: Sequence[float] = (), branch: str = "") -> Mechanism:
    """Compile; the reference posture becomes a keyframe with the branch's name."""
    if branch:
        spec.add_key(name=branch, qpos=list(reference))
    model = compile_spec(spec, spec.modelname)
    posture = np.array(reference if len(reference) else model.qpos0, dtype=float)
    return Mechanism(spec, model, tuple(driven), posture, spec.modelname)


def two_links(
    foot: Sequence[float], tip: Sequence[float], lengths: tuple[float, float], elbow: str, what: str, where: str
) -> tuple[float, float]:
    """Angle of the first of two links and relative angle of the second, from +x, for a given foot and tip in a plane.

    The elbow lies to the left or to the right of the way from foot to tip.
    """
    across, up = tip[0] - foot[0], tip[1] - foot[1]
    reach, (first, second) = math.hypot(across, up), lengths
    if not abs(first - second) < reach < first + second:
        raise InputError(
            f"{what} does not reach its pin: the distance is {reach:g} m, "
            f"its two links span {abs(first - second):g} to {first + second:g} m",
            where=where,
            hint="choose another `pose`, or other lengths",
        )
    inner = math.acos((reach**2 + first**2 - second**2) / (2 * reach * first))
    angle = math.atan2(up, across) + (inner if elbow == "left" else -inner)
    beyond = math.atan2(tip[1] - foot[1] - first * math.sin(angle), tip[0] - foot[0] - first * math.cos(angle))
    return angle, beyond - angle


def degrees(angle: float) -> str:
    """An angle in words."""
    return f"{math.degrees(angle):.4g} deg"
