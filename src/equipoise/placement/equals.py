"""Springs that act alike: crank and pivot turned together about the joint, their distances swapped."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import InvertedSliderCrank, Line, Mount
from equipoise.balancers.paths.driven import Driven
from equipoise.balancers.spring import Spring
from equipoise.loops import ancestors
from equipoise.mechanism import Mechanism, Point
from equipoise.states import States


def turned(spring: Spring, states: States, angle: float, swapped: bool = False) -> Spring | None:
    """The spring with crank and pivot turned by an angle, rad, about the joint between them; None where it has none.

        l^2 = a^2 + d^2 - 2 a d cos(q + phase)

    does not change as both turn together, nor as crank a and distance d are swapped, so neither does any effort. A
    line must span a single hinge; yokes, dyads and cams turn with their mount, and only the inverted slider-crank can
    be swapped. Springs that have mass hang on where they are: None but for no turn at all.
    """
    if angle == 0 and not swapped:
        return spring
    if spring.masses:
        return None
    path: Any = spring.path
    if isinstance(path, Line):
        moved = _line(path, states, angle, swapped)
    elif isinstance(path, Driven):
        moved = _mounted(path, states.mechanism, angle, swapped)
    else:
        moved = None
    return None if moved is None else replace(spring, path=moved)


def _mounted(path: Any, mechanism: Mechanism, angle: float, swapped: bool) -> Driven | None:
    if swapped and not isinstance(path, InvertedSliderCrank):
        return None
    if swapped:
        path = replace(path, crank=path.distance, distance=path.crank)
    mount = path.at(mechanism.model)
    e, f, _ = mount.frame
    x, y, z = (np.cos(angle) * e + np.sin(angle) * f).tolist()
    return replace(path, mount=Mount(mount.at, (x, y, z), mount.axis))


def _line(path: Line, states: States, angle: float, swapped: bool) -> Line | None:
    hinge = _hinge(path, states)
    if hinge is None:
        return None
    place, axis = hinge
    arms = [states.point(point)[0][0] - place for point in (path.a, path.b)]
    heights = [float(arm @ axis) for arm in arms]
    radial = [arm - height * axis for arm, height in zip(arms, heights, strict=True)]
    sizes = [float(np.linalg.norm(arm)) for arm in radial]
    if min(sizes) <= 0:
        return None
    if swapped:
        radial = [arm * other / own for arm, own, other in zip(radial, sizes, sizes[::-1], strict=True)]
    moved = []
    for point, arm, height in zip((path.a, path.b), radial, heights, strict=True):
        world = place + height * axis + np.cos(angle) * arm + np.sin(angle) * np.cross(axis, arm)
        body = states.mechanism.body_id(point.body)
        x, y, z = (states.kin.xmat[0, body].T @ (world - states.kin.xpos[0, body])).tolist()
        moved.append(Point(point.body, (x, y, z)))
    return Line(*moved)


def _hinge(path: Line, states: States) -> tuple[Array, Array] | None:
    """Point and axis (world, first state) of the only joint between the ends of a line, where it is a hinge."""
    import mujoco

    mechanism = states.mechanism
    model = mechanism.model
    sides = [set(ancestors(model, mechanism.body_id(point.body))) for point in (path.a, path.b)]
    between = sides[0] ^ sides[1]
    if len(between) != 1:
        return None
    joint = int(model.dof_jntid[between.pop()])
    if model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_HINGE:
        return None
    body = int(model.jnt_bodyid[joint])
    turn = states.kin.xmat[0, body]
    return states.kin.xpos[0, body] + turn @ model.jnt_pos[joint], turn @ model.jnt_axis[joint]


def plane_of(spring: Spring, states: States) -> tuple[Array, Array]:
    """Two unit vectors (world, first state) of the plane in which the spring works."""
    axis = np.array([0.0, 1.0, 0.0])
    if isinstance(spring.path, Driven):
        mount = spring.path.at(states.mechanism.model)
        axis = states.rotation(mount.at.body)[0][0] @ mount.frame[2]
    elif isinstance(spring.path, Line):
        hinge = _hinge(spring.path, states)
        axis = axis if hinge is None else hinge[1]
    first = np.asarray(np.cross(axis, np.eye(3)[int(np.abs(axis).argmin())]), dtype=np.float64)
    first /= np.linalg.norm(first)
    return first, np.asarray(np.cross(axis, first), dtype=np.float64)
