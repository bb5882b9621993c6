"""The slider-crank."""

from __future__ import annotations

import math
from typing import Literal

from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.models.parts import (
    EARTH,
    Gravity,
    Inertial,
    Planar,
    add_body,
    add_joint,
    add_pin,
    finish,
    interval,
    new_spec,
    not_negative,
    number,
    positive,
    rod_inertial,
    word,
)
from equipoise.units import Angle, Inertia, Length, Mass, Torque


def slider_crank(
    crank: Length,
    rod: Length,
    *,
    offset: Length = 0.0,
    direction: Angle = 0.0,
    masses: tuple[Mass, Mass, Mass] = (0.0, 0.0, 0.0),
    coms: tuple[Planar | None, Planar | None] = (None, None),
    inertias: tuple[Inertia | None, Inertia | None] = (None, None),
    branch: Literal["forward", "backward"] = "forward",
    limits: tuple[Angle, Angle] | None = None,
    motor_limit: Torque | None = None,
    gravity: Gravity = EARTH,
    name: str = "slider_crank",
) -> Mechanism:
    """A slider-crank in the x-z plane, driven at the crank.

           B
        a / \\  b                 s = a cos u +- sqrt(b^2 - (a sin u - e)^2),  u = t - direction
         /   \\
        A     [C]--> s           a crank, b rod, e offset of the slider's line, m
        ------------- line       t = crank_joint, counter-clockwise from +x; s = slider_joint, m

    The slider's line has the angle `direction` from +x and lies `offset` to its left of the crank's pivot A,
    which is the world's origin; s counts from A's foot on it. masses are those of crank, rod and slider, kg;
    coms (x, z) and inertias those of crank and rod in their own frames (x along the link from A and B), with
    mid-length and m l^2 / 12 as defaults; the slider's mass sits at C. branch `forward` takes the plus sign.
    limits is the crank's range, default unlimited; motor_limit in N m. The reference posture has the crank
    in the middle of the angles at which the rod reaches the line.

    Raises InputError for a rod that never reaches the line, for non-positive lengths and negative masses.
    """
    crank, rod = positive(crank, "crank", "m", name), positive(rod, "rod", "m", name)
    offset, direction = number(offset, "offset", name), number(direction, "direction", name)
    word(branch, ("forward", "backward"), "branch", name)
    posture = _closed(crank, rod, offset, direction, sign=1.0 if branch == "forward" else -1.0, where=name)
    spec = new_spec(name, gravity)
    first = rod_inertial(masses[0], crank, coms[0], inertias[0], f"{name}.crank")
    second = rod_inertial(masses[1], rod, coms[1], inertias[1], f"{name}.rod")
    point = Inertial(not_negative(masses[2], "mass", "kg", f"{name}.slider"), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    bar = add_body(spec.worldbody, "crank", first, length=crank)
    motor = None if motor_limit is None else positive(motor_limit, "motor_limit", "N m", name)
    add_joint(bar, "crank_joint", limits=interval(limits, "limits", name), motor=motor)
    middle = add_body(bar, "rod", second, pos=(crank, 0.0, 0.0), length=rod)
    add_joint(middle, "rod_joint")
    foot = (-offset * math.sin(direction), 0.0, offset * math.cos(direction))
    block = add_body(spec.worldbody, "slider", point, pos=foot, turn=direction)
    add_joint(block, "slider_joint", axis=(1.0, 0.0, 0.0), slide=True)
    add_pin(spec, "pin", (middle, (rod, 0.0, 0.0)), (block, (0.0, 0.0, 0.0)))
    return finish(spec, ("crank_joint",), posture, branch)


def _closed(
    crank: float, rod: float, offset: float, direction: float, *, sign: float, where: str
) -> tuple[float, float, float]:
    """Joint positions of the closed reference posture."""
    if abs(offset) >= crank + rod:
        raise InputError(
            f"the rod never reaches the slider's line: |offset| ({abs(offset):g} m) must be less than crank + rod "
            f"({crank + rod:g} m); it is {abs(offset) - crank - rod:g} m too large",
            where=where,
        )
    low, high = max(-1.0, (offset - rod) / crank), min(1.0, (offset + rod) / crank)
    angle = 0.5 * (math.asin(low) + math.asin(high))
    across = crank * math.sin(angle) - offset
    along = sign * math.sqrt(rod**2 - across**2)
    return angle + direction, math.atan2(-across, along) - angle, crank * math.cos(angle) + along
