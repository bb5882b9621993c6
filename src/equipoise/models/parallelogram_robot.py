"""The two-link robot whose elbow is driven from the base through a parallelogram."""

from __future__ import annotations

import math

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
    number,
    positive,
    rod_inertial,
    vector,
)
from equipoise.units import Angle, Inertia, Length, Mass, Torque

LINKS = ("arm", "forearm", "crank", "rod")
RANGES = ((math.radians(50), math.radians(130)), (math.radians(-40), math.radians(40)))
FLAT = math.radians(2.0)


def parallelogram_robot(
    arm: Length,
    forearm: Length,
    crank: Length = -0.2,
    *,
    masses: tuple[Mass, Mass, Mass, Mass] = (0.0, 0.0, 0.0, 0.0),
    coms: tuple[Planar | None, Planar | None, Planar | None, Planar | None] = (None, None, None, None),
    inertias: tuple[Inertia | None, Inertia | None, Inertia | None, Inertia | None] = (None, None, None, None),
    limits: tuple[tuple[Angle, Angle], tuple[Angle, Angle]] | None = None,
    motor_limits: tuple[Torque, Torque] | None = None,
    gravity: Gravity = EARTH,
    name: str = "parallelogram_robot",
) -> Mechanism:
    """A two-link arm in the x-z plane with both motors on the base; the forearm keeps parallel to a crank.

        C ============ D --- B --------- P     B = l1 (cos t1, sin t1),  P = B + l2 (cos t2, sin t2)
         \\  rod        \\   /  forearm          C = c (cos t2, sin t2),  D = B + C
          A ------------- B                    t1 = arm_joint, t2 = crank_joint: angles of arm and forearm
        crank    arm                           to +x, counter-clockwise

    arm l1 and forearm l2 in m; crank c is where the rod's pins sit on crank and forearm, m along their x,
    negative behind the pivots. Gravity's torques on the two motors do not mix: S1 g cos t1 and S2 g cos t2.
    masses, coms and inertias are those of arm, forearm, crank and rod: kg; (x, z) in the link's frame, m,
    default mid-length; about the centre of mass along the hinge, kg m^2, default m l^2 / 12. All frames have
    x along the link. limits are the ranges of t1 and t2, default 50 to 130 and -40 to 40 degrees: where
    t1 - t2 is 0 or 180 degrees the parallelogram is flat and the forearm no longer determined. motor_limits
    in N m.

    Raises InputError for lengths of zero, negative masses and limits whose middles make it flat.
    """
    lengths = (
        positive(arm, "arm", "m", name),
        positive(forearm, "forearm", "m", name),
        positive(abs(number(crank, "crank", name)), "length of the crank", "m", name),
        arm,
    )
    middle = (0.5 * lengths[0], 0.0), (0.5 * lengths[1], 0.0), (0.5 * crank, 0.0), (0.5 * lengths[0], 0.0)
    data = [
        rod_inertial(masses[i], lengths[i], middle[i] if coms[i] is None else coms[i], inertias[i], f"{name}.{link}")
        for i, link in enumerate(LINKS)
    ]
    spans = RANGES if limits is None else limits
    first, second = (interval(span, f"limits[{i}]", name) for i, span in enumerate(spans))
    motors = (None, None) if motor_limits is None else vector(motor_limits, 2, "motor_limits", name)
    t1, t2 = (0.5 * sum(span or (0.0, 0.0)) for span in (first, second))
    if abs(math.sin(t1 - t2)) < math.sin(FLAT):
        raise InputError(
            f"in the middle of the limits arm and crank stand at {math.degrees(t1):.4g} and {math.degrees(t2):.4g} "
            "deg: the parallelogram is flat",
            where=name,
            hint="keep arm_joint - crank_joint between 0 and 180 deg",
        )
    spec = new_spec(name, gravity)
    upper = add_body(spec.worldbody, "arm", data[0], length=lengths[0])
    add_joint(upper, "arm_joint", limits=first, motor=motors[0])
    fore = add_body(upper, "forearm", data[1], pos=(lengths[0], 0.0, 0.0), length=lengths[1])
    add_joint(fore, "forearm_joint")
    lever = add_body(spec.worldbody, "crank", data[2], length=lengths[2] if crank > 0 else 0.0)
    add_joint(lever, "crank_joint", limits=second, motor=motors[1])
    rod = add_body(lever, "rod", data[3], pos=(crank, 0.0, 0.0), length=lengths[0])
    add_joint(rod, "rod_joint")
    add_pin(spec, "pin", (rod, (lengths[0], 0.0, 0.0)), (fore, (crank, 0.0, 0.0)))
    return finish(spec, ("arm_joint", "crank_joint"), (t1, t2 - t1, t2, t1 - t2), "home")
