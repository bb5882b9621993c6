"""The parallelogram arm of desk lamps and monitor stands."""

from __future__ import annotations

import math

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
    vector,
)
from equipoise.units import Angle, Inertia, Length, Mass, Torque

LINKS = ("arm", "rod", "head")


def parallelogram_arm(
    length: Length,
    post: Planar = (0.0, 0.1),
    *,
    payload: Planar = (0.1, 0.0),
    masses: tuple[Mass, Mass, Mass] = (0.0, 0.0, 0.0),
    coms: tuple[Planar | None, Planar | None, Planar | None] = (None, None, None),
    inertias: tuple[Inertia | None, Inertia | None, Inertia | None] = (None, None, None),
    limits: tuple[Angle, Angle] | None = None,
    motor_limit: Torque | None = None,
    gravity: Gravity = EARTH,
    name: str = "parallelogram_arm",
) -> Mechanism:
    """A parallelogram in the x-z plane whose head keeps its direction, driven at the lower link.

        Q ============ R
        |    rod       |  head        A = origin, Q = A + post, R = H + post
        A ============ H --- P        H = A + l (cos t, sin t), P = H + payload
             arm                      t = arm_joint, counter-clockwise from +x

    length is l, m; post (x, z) leads from the arm's pivot A to the rod's Q and likewise on the head, m.
    The head's axes stay parallel to the world's. Body `payload` sits at P = (x, z) in the head's frame and
    weighs nothing: name it in a sweep's payload. masses, coms and inertias are those of arm, rod and head:
    kg; (x, z) in the link's frame, m (arm and rod have x along the link, default mid-length; the head's
    frame is at H, default the middle of its pivots); about the centre of mass along the hinge, kg m^2
    (default m l^2 / 12; of the head with its pivots' distance). limits is the range of t, default 75 degrees
    to both sides of the middle, where post and arm are square: at 90 degrees the parallelogram is flat and
    the head no longer determined. motor_limit in N m.

    Raises InputError for non-positive lengths and negative masses.
    """
    length = positive(length, "length", "m", name)
    x, z = vector(post, 2, "post", name)
    height = positive(math.hypot(x, z), "distance of the pivots", "m", name)
    middle = math.atan2(z, x) - 0.5 * math.pi
    reach = math.radians(75.0)
    spec = new_spec(name, gravity)
    hub = (0.5 * x, 0.5 * z) if coms[2] is None else coms[2]
    lengths, centres = (length, length, height), (coms[0], coms[1], hub)
    arm_data, rod_data, head_data = (
        rod_inertial(masses[i], lengths[i], centres[i], inertias[i], f"{name}.{LINKS[i]}") for i in range(3)
    )
    arm = add_body(spec.worldbody, "arm", arm_data, length=length)
    motor = None if motor_limit is None else positive(motor_limit, "motor_limit", "N m", name)
    span = interval(limits, "limits", name) or (middle - reach, middle + reach)
    add_joint(arm, "arm_joint", limits=span, motor=motor)
    head = add_body(arm, "head", head_data, pos=(length, 0.0, 0.0))
    add_joint(head, "head_joint")
    px, pz = vector(payload, 2, "payload", name)
    head.add_body(name="payload", pos=[px, 0.0, pz])
    rod = add_body(spec.worldbody, "rod", rod_data, pos=(x, 0.0, z), length=length)
    add_joint(rod, "rod_joint")
    add_pin(spec, "pin", (rod, (length, 0.0, 0.0)), (head, (x, 0.0, z)))
    return finish(spec, ("arm_joint",), (middle, -middle, middle), "home")
