"""The delta robot: a platform that three arms with parallelogram forearms move without turning it."""

from __future__ import annotations

import math

import mujoco
import numpy as np

from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.models.parts import (
    EARTH,
    Gravity,
    Inertial,
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
    two_links,
    vector,
)
from equipoise.units import Angle, Inertia, Length, Mass, Torque

Place = tuple[Length, Length, Length]
THIRDS = (0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0)


def delta(
    base_radius: Length,
    arm: Length,
    forearm: Length,
    platform_radius: Length,
    *,
    azimuths: tuple[Angle, Angle, Angle] = THIRDS,
    pose: Place | None = None,
    arm_mass: Mass = 0.0,
    arm_com: Place | None = None,
    arm_inertia: Inertia | None = None,
    forearm_mass: Mass = 0.0,
    forearm_com: Place | None = None,
    forearm_inertia: Inertia | None = None,
    platform_mass: Mass = 0.0,
    platform_com: Place = (0.0, 0.0, 0.0),
    limits: tuple[Angle, Angle] | None = None,
    motor_limit: Torque | None = None,
    gravity: Gravity = EARTH,
    name: str = "delta",
) -> Mechanism:
    """A delta robot that hangs below its base, driven at its three arms.

        R u_i + a (cos q_i u_i + sin q_i z) + l d_i = (x, y, z) + r u_i,   |d_i| = 1,   i = 1, 2, 3

    u_i points horizontally at azimuths[i] from +x about z; R base_radius and r platform_radius to the joints, a arm
    and l forearm, m; q_i = arm_i_joint counts from the horizontal outward, upward positive; platform_x, platform_y
    and platform_z are the platform, which does not turn. A forearm is a parallelogram of two equal rods: they move
    alike, so one body stands for both, on the hinges forearm_i_swing (about the arm's axis, relative to the arm) and
    forearm_i_tilt (sideways). pose is the platform in the reference posture (default: arms horizontal), knees outward.

    arm_mass, forearm_mass (both rods), platform_mass in kg; coms (x, y, z) in the link's frame, x along the link, y
    along its hinge's axis reversed (horizontal), m, default mid-length; inertias about them across the link, kg m^2,
    default m l^2 / 12. limits of the arms (rad), motor_limit in N m.

    Raises InputError for a pose that a leg does not reach or that stretches it, and for numbers no link has.
    """
    sizes = {"base_radius": base_radius, "platform_radius": platform_radius}
    outer, inner = (not_negative(value, what, "m", name) for what, value in sizes.items())
    arm, forearm = positive(arm, "arm", "m", name), positive(forearm, "forearm", "m", name)
    angles = vector(azimuths, 3, "azimuths", name)
    place = _hanging(outer + arm - inner, forearm, name) if pose is None else vector(pose, 3, "pose", name)
    motor = None if motor_limit is None else positive(motor_limit, "motor_limit", "N m", name)
    mine = rod_inertial(arm_mass, arm, arm_com, arm_inertia, f"{name}.arm")
    pair = rod_inertial(forearm_mass, forearm, forearm_com, forearm_inertia, f"{name}.forearm")
    com = vector(platform_com, 3, "platform_com", name)
    plate_mass = not_negative(platform_mass, "platform_mass", "kg", name)
    spec = new_spec(name, gravity)
    posture, driven, ends = [], [], []
    for i, azimuth in enumerate(angles):
        label, out = i + 1, np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
        posture += _leg(np.array(place) + (inner - outer) * out, azimuth, (arm, forearm), label, name)
        upper = add_body(spec.worldbody, f"arm_{label}", mine, pos=(outer * out).tolist(), length=arm)
        upper.quat = [math.cos(azimuth / 2), 0.0, 0.0, math.sin(azimuth / 2)]
        add_joint(upper, f"arm_{label}_joint", limits=interval(limits, "limits", name), motor=motor)
        lower = add_body(upper, f"forearm_{label}", pair, pos=(arm, 0.0, 0.0), length=forearm)
        add_joint(lower, f"forearm_{label}_swing")
        add_joint(lower, f"forearm_{label}_tilt", axis=(0.0, 0.0, 1.0))
        driven.append(f"arm_{label}_joint")
        ends.append(((lower, (forearm, 0.0, 0.0)), inner * out))
    plate = add_body(spec.worldbody, "platform", Inertial(plate_mass, (com[0], com[1], com[2]), (0.0, 0.0, 0.0)))
    plate.add_geom(type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[max(inner, 0.01 * arm), 0.02 * arm, 0.0], contype=0,
                   conaffinity=0, rgba=[0.6, 0.65, 0.7, 1.0])  # fmt: skip
    for axis, direction in zip("xyz", np.eye(3).tolist(), strict=True):
        add_joint(plate, f"platform_{axis}", axis=direction, slide=True)
    for i, (tip, pin) in enumerate(ends):
        add_pin(spec, f"pin_{i + 1}", tip, (plate, tuple(pin.tolist())))
    return finish(spec, driven, [*posture, *place], "hanging")


def _hanging(across: float, forearm: float, where: str) -> tuple[float, float, float]:
    """The platform where all arms are horizontal."""
    if not abs(across) < forearm:
        raise InputError(
            f"with horizontal arms the forearm ({forearm:g} m) would have to span {abs(across):g} m sideways",
            where=where,
            hint="give the platform's `pose`, or other lengths",
        )
    return 0.0, 0.0, -math.sqrt(forearm**2 - across**2)


def _leg(
    tip: np.ndarray, azimuth: float, lengths: tuple[float, float], label: int, where: str
) -> tuple[float, float, float]:
    """Arm, swing and tilt angles for a forearm's tip (3,) seen from the arm's hinge, world axes; knee outward."""
    arm, forearm = lengths
    along = math.cos(azimuth) * tip[0] + math.sin(azimuth) * tip[1]
    aside = math.cos(azimuth) * tip[1] - math.sin(azimuth) * tip[0]
    if not abs(aside) < forearm:
        raise InputError(
            f"leg {label} does not reach its pin: it lies {abs(aside):g} m aside, the forearm is {forearm:g} m long",
            where=where,
            hint="choose another `pose`, or other lengths",
        )
    plane = (number(along, "pose", where), number(tip[2], "pose", where))
    q, swing = two_links((0.0, 0.0), plane, (arm, math.sqrt(forearm**2 - aside**2)), "left", f"leg {label}", where)
    return q, swing, math.asin(aside / forearm)
