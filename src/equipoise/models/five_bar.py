"""The planar five-bar: two cranks at the base and two couplers that share a pin."""

from __future__ import annotations

import math

from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.models.parts import (
    EARTH,
    SIDES,
    Elbow,
    Gravity,
    Planar,
    add_body,
    add_joint,
    add_pin,
    finish,
    interval,
    new_spec,
    positive,
    rod_inertial,
    two_links,
    vector,
    word,
)
from equipoise.units import Angle, Inertia, Length, Mass, Torque

REACH = 0.75
"""How far, as a share of its length, each leg of the default pose is stretched."""


def five_bar(
    ground: Length,
    cranks: tuple[Length, Length],
    couplers: tuple[Length, Length],
    *,
    pose: tuple[Length, Length] | None = None,
    elbows: tuple[Elbow, Elbow] = ("left", "right"),
    crank_masses: tuple[Mass, Mass] = (0.0, 0.0),
    crank_coms: tuple[Planar | None, Planar | None] = (None, None),
    crank_inertias: tuple[Inertia | None, Inertia | None] = (None, None),
    coupler_masses: tuple[Mass, Mass] = (0.0, 0.0),
    coupler_coms: tuple[Planar | None, Planar | None] = (None, None),
    coupler_inertias: tuple[Inertia | None, Inertia | None] = (None, None),
    limits: tuple[Angle, Angle] | None = None,
    motor_limit: Torque | None = None,
    gravity: Gravity = EARTH,
    name: str = "five_bar",
) -> Mechanism:
    """A planar five-bar (RRRRR) in the x-z plane, driven at both cranks.

                 P
              /     \\           a_1 (cos t_1, sin t_1) + b_1 (cos s_1, sin s_1) = P
         b_1 /       \\ b_2      (g, 0) + a_2 (cos t_2, sin t_2) + b_2 (cos s_2, sin s_2) = P
            B         D
        a_1  \\       /  a_2     a_i cranks, b_i couplers, g ground, m; t_i = crank_i_joint, counter-clockwise
              A --- E           from +x; s_i = t_i + coupler_i_joint
                 g

    pose is P in the reference posture (default: both legs stretched to 3/4 of their length, above the base), m;
    elbows the side of the way from A to P, and from E to P, on which B and D lie: together they name the assembly
    branch. masses (kg), coms ((x, z) in the link's frame, x along the link, m, default mid-length) and inertias about
    them (kg m^2, default m l^2 / 12). limits of both cranks (rad), motor_limit in N m. What is carried at P is a
    payload at [coupler_1, b_1, 0, 0].

    Raises InputError for a pose that a leg does not reach or that stretches it, and for numbers no link has.
    """
    ground = positive(ground, "ground", "m", name)
    firsts = [positive(value, f"cranks[{i}]", "m", name) for i, value in enumerate(cranks)]
    seconds = [positive(value, f"couplers[{i}]", "m", name) for i, value in enumerate(couplers)]
    tip = _above(ground, firsts, seconds, name) if pose is None else vector(pose, 2, "pose", name)
    motor = None if motor_limit is None else positive(motor_limit, "motor_limit", "N m", name)
    spec = new_spec(name, gravity)
    posture, driven, ends = [], [], []
    for i, foot in enumerate(((0.0, 0.0), (ground, 0.0))):
        label, first, second = i + 1, firsts[i], seconds[i]
        side = word(elbows[i], SIDES, "elbows", name)
        posture += two_links(foot, tip, (first, second), side, f"leg {label}", name)
        mine = rod_inertial(crank_masses[i], first, crank_coms[i], crank_inertias[i], f"{name}.crank_{label}")
        next_ = rod_inertial(coupler_masses[i], second, coupler_coms[i], coupler_inertias[i], f"{name}.coupler_{label}")
        crank = add_body(spec.worldbody, f"crank_{label}", mine, pos=(foot[0], 0.0, foot[1]), length=first)
        add_joint(crank, f"crank_{label}_joint", limits=interval(limits, "limits", name), motor=motor)
        coupler = add_body(crank, f"coupler_{label}", next_, pos=(first, 0.0, 0.0), length=second)
        add_joint(coupler, f"coupler_{label}_joint")
        driven.append(f"crank_{label}_joint")
        ends.append((coupler, (second, 0.0, 0.0)))
    add_pin(spec, "pin", *ends)
    return finish(spec, driven, posture, "-".join(elbows))


def _above(ground: float, firsts: list[float], seconds: list[float], where: str) -> tuple[float, float]:
    """Where both legs are stretched to REACH of their lengths, above the base."""
    near, far = (REACH * (first + second) for first, second in zip(firsts, seconds, strict=True))
    across = (ground**2 + near**2 - far**2) / (2.0 * ground)
    square = near**2 - across**2
    if square <= 0:
        raise InputError(
            f"the legs do not meet above the base where each is stretched to {100 * REACH:g} % of its length",
            where=where,
            hint="give the `pose` of the shared pin",
        )
    return across, math.sqrt(square)
