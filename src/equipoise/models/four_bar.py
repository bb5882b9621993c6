"""The four-bar linkage."""

from __future__ import annotations

import math
from typing import Literal

from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.models.parts import (
    EARTH,
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
    word,
)
from equipoise.units import Angle, Inertia, Length, Mass, Torque

LINKS = ("crank", "coupler", "rocker")


def four_bar(
    ground: Length,
    crank: Length,
    coupler: Length,
    rocker: Length,
    *,
    masses: tuple[Mass, Mass, Mass] = (0.0, 0.0, 0.0),
    coms: tuple[Planar | None, Planar | None, Planar | None] = (None, None, None),
    inertias: tuple[Inertia | None, Inertia | None, Inertia | None] = (None, None, None),
    branch: Literal["open", "crossed"] = "open",
    limits: tuple[Angle, Angle] | None = None,
    motor_limit: Torque | None = None,
    gravity: Gravity = EARTH,
    name: str = "four_bar",
) -> Mechanism:
    """A planar four-bar linkage in the x-z plane, driven at the crank.

              C
             / \\        B = a (cos t, sin t),  D = (g, 0),  |C - B| = b,  |C - D| = c
        b   /   \\  c
           B     \\      a crank, b coupler, c rocker, g ground, m; t = crank_joint, counter-clockwise from +x
      a   /       \\
         A --------- D
              g

    masses, coms and inertias are those of crank, coupler and rocker: kg; (x, z) in the link's frame, m,
    default mid-length; about the centre of mass along the hinge, kg m^2, default m l^2 / 12. A link's frame
    has x along the link (from A, B and D) and z 90 degrees counter-clockwise from it; the coupler's joint
    angle is relative to the crank, the rocker's counts from +x. branch `open` has C to the left of the way
    from B to D, `crossed` to the right. limits is the crank's range, default unlimited; motor_limit in N m.
    The reference posture has the crank in the middle of the angles at which the linkage assembles.

    Raises InputError for lengths that cannot assemble, for non-positive lengths and negative masses.
    """
    lengths = [
        positive(value, what, "m", name)
        for what, value in zip(("ground", *LINKS), (ground, crank, coupler, rocker), strict=True)
    ]
    word(branch, ("open", "crossed"), "branch", name)
    posture = _closed(lengths, branch, name)
    spec = new_spec(name, gravity)
    first, second, third = (
        rod_inertial(masses[i], lengths[i + 1], coms[i], inertias[i], f"{name}.{LINKS[i]}") for i in range(3)
    )
    bar = add_body(spec.worldbody, "crank", first, length=crank)
    motor = None if motor_limit is None else positive(motor_limit, "motor_limit", "N m", name)
    add_joint(bar, "crank_joint", limits=interval(limits, "limits", name), motor=motor)
    middle = add_body(bar, "coupler", second, pos=(crank, 0.0, 0.0), length=coupler)
    add_joint(middle, "coupler_joint")
    last = add_body(spec.worldbody, "rocker", third, pos=(ground, 0.0, 0.0), length=rocker)
    add_joint(last, "rocker_joint")
    add_pin(spec, "pin", (middle, (coupler, 0.0, 0.0)), (last, (rocker, 0.0, 0.0)))
    return finish(spec, ("crank_joint",), posture, branch)


def _closed(lengths: list[float], branch: str, where: str) -> tuple[float, float, float]:
    """Joint angles of the closed reference posture."""
    ground, crank, coupler, rocker = lengths
    longest = max(range(4), key=lambda index: lengths[index])
    others = sum(lengths) - lengths[longest]
    if lengths[longest] >= others:
        raise InputError(
            f"the linkage cannot assemble: {('ground', *LINKS)[longest]} ({lengths[longest]:g} m) must be shorter "
            f"than the other three together ({others:g} m); it is {lengths[longest] - others:g} m too long",
            where=where,
        )
    angle = 0.5 * sum(crank_range(ground, crank, coupler, rocker))
    x, z = ground - crank * math.cos(angle), -crank * math.sin(angle)
    diagonal = math.hypot(x, z)
    corner = math.acos((diagonal**2 + coupler**2 - rocker**2) / (2.0 * diagonal * coupler))
    turn = math.atan2(z, x) + (corner if branch == "open" else -corner)
    across = crank * math.cos(angle) + coupler * math.cos(turn) - ground
    return angle, turn - angle, math.atan2(crank * math.sin(angle) + coupler * math.sin(turn), across)


def crank_range(ground: float, crank: float, coupler: float, rocker: float) -> tuple[float, float]:
    """Crank angles within 0 to pi at which the linkage assembles, rad.

        |b - c| <= sqrt(a^2 + g^2 - 2 a g cos t) <= b + c

    Lengths in m; the linkage must be able to assemble at all. (0, pi) says that the crank turns fully.
    """
    square, scale = crank**2 + ground**2, 2.0 * crank * ground
    near = min(1.0, (square - (coupler - rocker) ** 2) / scale)
    far = max(-1.0, (square - (coupler + rocker) ** 2) / scale)
    return math.acos(near), math.acos(far)
