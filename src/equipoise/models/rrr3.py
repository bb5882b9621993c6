"""The planar 3-RRR: a platform on three two-link legs driven at the base."""

from __future__ import annotations

import math

import numpy as np

from equipoise.affine import Array
from equipoise.mechanism import Mechanism
from equipoise.models.parts import (
    EARTH,
    SIDES,
    Elbow,
    Gravity,
    Inertial,
    Planar,
    add_body,
    add_joint,
    add_pin,
    finish,
    new_spec,
    not_negative,
    number,
    positive,
    rod_inertial,
    two_links,
    vector,
    word,
)
from equipoise.states import States
from equipoise.units import Angle, Inertia, Length, Mass, Torque

Three = tuple[Length, Length, Length]


def rrr3(
    bases: tuple[Planar, Planar, Planar],
    platform: tuple[Planar, Planar, Planar],
    cranks: Three,
    rods: Three,
    *,
    pose: tuple[Length, Length, Angle] = (0.0, 0.0, 0.0),
    elbows: tuple[Elbow, Elbow, Elbow] = ("left", "left", "left"),
    crank_masses: tuple[Mass, Mass, Mass] = (0.0, 0.0, 0.0),
    crank_coms: tuple[Planar | None, Planar | None, Planar | None] = (None, None, None),
    crank_inertias: tuple[Inertia | None, Inertia | None, Inertia | None] = (None, None, None),
    rod_masses: tuple[Mass, Mass, Mass] = (0.0, 0.0, 0.0),
    rod_coms: tuple[Planar | None, Planar | None, Planar | None] = (None, None, None),
    rod_inertias: tuple[Inertia | None, Inertia | None, Inertia | None] = (None, None, None),
    platform_mass: Mass = 0.0,
    platform_com: Planar = (0.0, 0.0),
    platform_inertia: Inertia = 0.0,
    motor_limit: Torque | None = None,
    gravity: Gravity = EARTH,
    name: str = "rrr3",
) -> Mechanism:
    """A planar 3-RRR parallel manipulator in the x-z plane, driven at its three base joints.

        O_i + l_i (cos t_i, sin t_i) + r_i (cos s_i, sin s_i) = (x, z) + R(phi) p_i,   i = 1, 2, 3

    bases are O_i and platform p_i in the platform's own frame, m; cranks l_i and rods r_i are lengths, m;
    t_i = crank_i_joint, counter-clockwise from +x; s_i = t_i + rod_i_joint; platform_x, platform_z and
    platform_turn are (x, z, phi). pose is the reference posture and elbows the side of the way from O_i to P_i on
    which its elbow lies: together they name the assembly branch. masses (kg), coms ((x, z) in the link's frame, x
    along the link, m, default mid-length) and inertias about them (kg m^2, default m l^2 / 12) of cranks and
    rods; those of the platform in its frame. motor_limit in N m; gravity (0, 0, 0) for a manipulator that lies flat.

    Raises InputError for a pose that a leg does not reach or that stretches it, and for numbers no link has.
    """
    feet = [vector(base, 2, f"bases[{i}]", name) for i, base in enumerate(bases)]
    pins = [vector(point, 2, f"platform[{i}]", name) for i, point in enumerate(platform)]
    x, z, phi = (number(value, "pose", name) for value in pose)
    motor = None if motor_limit is None else positive(motor_limit, "motor_limit", "N m", name)
    spec = new_spec(name, gravity)
    about = not_negative(platform_inertia, "platform_inertia", "kg m^2", name)
    com = vector(platform_com, 2, "platform_com", name)
    own = Inertial(
        not_negative(platform_mass, "platform_mass", "kg", name), (com[0], 0.0, com[1]), (about / 2, about, about / 2)
    )
    posture, driven, tips = [], [], []
    for i in range(3):
        label = i + 1
        first, second = positive(cranks[i], f"cranks[{i}]", "m", name), positive(rods[i], f"rods[{i}]", "m", name)
        turn = (
            x + math.cos(phi) * pins[i][0] - math.sin(phi) * pins[i][1],
            z + math.sin(phi) * pins[i][0] + math.cos(phi) * pins[i][1],
        )
        side = word(elbows[i], SIDES, "elbows", name)
        posture += two_links(feet[i], turn, (first, second), side, f"leg {label}", name)
        masses = (
            rod_inertial(crank_masses[i], first, crank_coms[i], crank_inertias[i], f"{name}.crank_{label}"),
            rod_inertial(rod_masses[i], second, rod_coms[i], rod_inertias[i], f"{name}.rod_{label}"),
        )
        foot = (feet[i][0], 0.0, feet[i][1])
        crank = add_body(spec.worldbody, f"crank_{label}", masses[0], pos=foot, length=first)
        add_joint(crank, f"crank_{label}_joint", motor=motor)
        rod = add_body(crank, f"rod_{label}", masses[1], pos=(first, 0.0, 0.0), length=second)
        add_joint(rod, f"rod_{label}_joint")
        driven.append(f"crank_{label}_joint")
        tips.append((rod, (second, 0.0, 0.0)))
    plate = add_body(spec.worldbody, "platform", own)
    add_joint(plate, "platform_x", axis=(1.0, 0.0, 0.0), slide=True)
    add_joint(plate, "platform_z", axis=(0.0, 0.0, 1.0), slide=True)
    add_joint(plate, "platform_turn")
    for i, tip in enumerate(tips):
        add_pin(spec, f"pin_{i + 1}", tip, (plate, (pins[i][0], 0.0, pins[i][1])))
    return finish(spec, driven, [*posture, x, z, phi], "-".join(elbows))


def platform_measure(states: States) -> Array:
    """How far the platform of a 3-RRR is from losing control (N,): 0 where its rods meet in a point or are parallel.

    The smallest singular value of the rows [d_i, (q_i x d_i) / r], d_i unit vectors along the rods, q_i the pins
    seen from the platform's centre of pins, r (m) their mean distance from it; pure numbers.
    """
    pins = np.stack([_pin(states, i) for i in (1, 2, 3)], axis=1)
    elbows = np.stack([states.kin.xpos[:, states.mechanism.body_id(f"rod_{i}")] for i in (1, 2, 3)], axis=1)
    along = pins - elbows
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    arm = pins - pins.mean(axis=1, keepdims=True)
    lever = (arm[..., 0] * along[..., 2] - arm[..., 2] * along[..., 0]) / np.linalg.norm(arm, axis=2).mean()
    rows = np.stack([along[..., 0], along[..., 2], lever], axis=2)
    return np.linalg.svd(rows, compute_uv=False)[:, -1]


def _pin(states: States, i: int) -> Array:
    model = states.mechanism.model
    place = model.site(f"pin_{i}_a").pos
    body = states.mechanism.body_id(f"rod_{i}")
    return states.kin.xpos[:, body] + states.kin.xmat[:, body] @ place
