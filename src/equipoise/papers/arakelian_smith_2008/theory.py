"""Sections 2 to 3.1 and 4: substitution, conditions, momentum, the flywheel's law [arakelian_smith_2008]."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import equipoise as eq
from equipoise.affine import Array
from equipoise.claim import Claim, Source
from equipoise.momentum import pseudo_inertia, wrench
from equipoise.papers.arakelian_smith_2008 import model
from equipoise.papers.arakelian_smith_2008.model import (
    COUNTER_ROTATED,
    EXACT,
    LEGS,
    OWN,
    PINS,
    PLATFORM,
    SLENDER,
    TABLE,
    WHEEL,
    WHEEL_INERTIA,
    L,
    base,
    largest,
    states,
)

ROUNDING = 1e-10


def _none(value: float) -> bool:
    return value < ROUNDING


def abstract(P: Source) -> list[Claim]:
    """The abstract and the introduction."""
    force, moment = base(COUNTER_ROTATED)
    spun = base(WHEEL)[1] + model.law().torque
    bare, alone = largest(base(SLENDER)[1]), largest(base(EXACT)[1])
    lifted = _weight_torque()
    return [
        P.sentence(
            "the designed manipulators apply no reaction forces or moments to the base during motion",
            "abstract, 1",
            max(largest(force) / largest(base(SLENDER)[0]), largest(moment) / bare),
            _none,
            note="force and moment with counter-rotations, largest over the motion, as shares of those of bare links; "
            f"with Table 1's digits {100 * largest(base(TABLE)[0]) / largest(base(SLENDER)[0]):.2g} % of the force and "
            f"{100 * largest(base(model.AS_PRINTED)[1]) / bare:.2g} % of the moment stay, for r_3S is rounded",
        ),
        P.sentence(
            "angular momentum is brought to zero by counter-rotations or by a flywheel of prescribed rotation",
            "abstract",
            max(largest(moment), largest(spun)),
            _none,
            "N m",
            note="the larger of the two moments that are left",
        ),
        P.sentence(
            "redistributed masses that fix the centre of mass cancel gravity's forces too",
            "1, (a)",
            lifted,
            lambda torque: torque < 1e-9,
            "N m",
            note="largest torque that holds the force-balanced manipulator upright in the field of gravity",
        ),
        P.sentence(
            "after force balancing the moment on the frame can be significant",
            "1",
            100 * alone / bare,
            lambda share: share > 10,
            "%",
            note=f"largest moment that is left, of that before: {alone:.2f} of {bare:.2f} N m, while the drives' "
            f"largest torque grows from {np.abs(model.torques(SLENDER)).max():.1f} to "
            f"{np.abs(model.torques(EXACT)).max():.1f} N m",
        ),
    ]


def substitution(P: Source) -> list[Claim]:
    """Section 2."""
    place = states().placement("platform")
    body = wrench(place, model.bodies(EXACT)["platform"][None])
    masses = eq.point_masses(PLATFORM, PINS, inertia=0.01)
    points = sum(
        wrench(place, pseudo_inertia(float(m), (x, 0.0, z), np.zeros((3, 3)))[None])
        for m, (x, z) in zip(masses.masses, masses.points, strict=True)
    )
    isosceles = 0.058 * np.array([[np.sin(0.9), -np.cos(0.9)], [-np.sin(0.9), -np.cos(0.9)], [0.0, 1.0]])
    uneven = eq.point_masses(PLATFORM, isosceles, inertia=PLATFORM * 0.058**2)
    return [
        P.sentence(
            "three point masses under Eqs. 1 to 4 replace the platform dynamically",
            "2, Eqs. 1-4",
            float(np.abs(body - points)[:, [0, 2, 4]].max()),
            _none,
            "N and N m",
            note="largest difference of force and moment over the motion, masses from `point_masses`",
        ),
        P.sentence(
            "a cylinder is replaced by three masses on the corners of an isosceles triangle at r = R / sqrt 2",
            "2, Fig. 3",
            float(np.abs(np.asarray(uneven.left)).max()),
            _none,
            "kg m^2",
            note="inertia that is left; equal masses at equal r need an equilateral triangle, this one (central angles "
            f"103, 128, 128 deg) takes {uneven.masses[2]:.3f}, {uneven.masses[0]:.3f} and {uneven.masses[1]:.3f} kg",
        ),
    ]


def force_balance(P: Source) -> list[Claim]:
    """Section 3.1.1."""
    every, found = base(EXACT)[0], eq.conditions(model.manipulator())
    (m2, r2, _), (m3, r3, _), mi = SLENDER.crank, SLENDER.rod, PLATFORM / 3
    missing = (-(m3 * r3 + mi * L), -(m2 * r2 + (mi + m3) * L))
    swapped, right = _centre_gap(EXACT, swap=True), _centre_gap(EXACT, swap=False)
    fixed = _centre(EXACT)
    mean = np.mean(model.PIVOTS, axis=0)
    return [
        P.sentence(
            "r_S2i is the distance of S_3i from A_i, r_S3i that of S_2i from O_i, in Eqs. 5 to 12",
            "3.1.1, Eq. 12",
            right,
            _none,
            "m",
            correction="the two are exchanged: r_S2i = O_i S_2i, r_S3i = A_i S_3i",
            note=f"largest difference of a leg's centre to the mechanism's; {swapped:.3g} m as printed",
        ),
        P.sentence(
            "Eqs. 13 and 14 keep the centre of mass still and cancel the force",
            "3.1.1, Eqs. 13-14",
            largest(every),
            _none,
            "N",
            note="largest force left; sufficient, not necessary: of 28 mass parameters force balance binds "
            f"{found.rank} real combinations (5 complex), the six complex equations 12, as they fix how the platform's "
            "mass is split",
        ),
        P.sentence(
            "two counterweights for each leg meet them, with negative radii",
            "3.1.1",
            max(missing),
            lambda moment: moment < 0,
            "kg m",
            note=f"first moment that links 3i lack; links 2i lack {missing[1]:.3f} kg m before the counterweights on "
            "3i are counted: both beyond the joints",
        ),
        P.sentence(
            "the centre of mass then rests in the centre of three fixed masses at O_i",
            "3.1.1",
            float(np.abs(fixed - mean).max()),
            _none,
            "m",
            note="largest distance of the manipulator's centre of mass from that point over the motion",
        ),
    ]


def moment_balance(P: Source) -> list[Claim]:
    """Section 3.1.2."""
    force, moment = base(EXACT)
    pole = np.array([0.3, 0.0, -0.2])
    shifted = moment - np.cross(pole, force) @ model.NORMAL
    unbalanced = np.cross(pole, base(SLENDER)[0]) @ model.NORMAL
    _, speed, pull = model.angles()
    gears = COUNTER_ROTATED.gears
    formula = speed @ model.factors(EXACT)
    legs = pull @ model.factors(EXACT)
    plain = replace(EXACT, gears=(0.0, gears[1]), own=OWN)
    dropped = replace(EXACT, own=OWN)
    literal = largest(model.held(dropped)[1] + speed[:, :3].sum(axis=1) * EXACT.crank[2] - model.held(plain)[1])
    meshes = [rotor.meshes(states(), {})[0] for rotor in model.rotors(COUNTER_ROTATED)]
    reversals, preload = [mesh.reversals for mesh in meshes], max(mesh.preload for mesh in meshes)
    return [
        P.sentence(
            "after force balancing the moment is the same about any point",
            "3.1.2",
            largest(shifted - moment),
            _none,
            "N m",
            note=f"largest change by a pole (0.3, -0.2) m; without force balance {largest(unbalanced):.1f} N m",
        ),
        P.sentence(
            "the moment is the sum of the rates of the legs' angular momenta",
            "Eq. 15",
            largest(legs - moment),
            _none,
            "N m",
            note="largest difference to the rate of momentum of all bodies, platform included",
        ),
        P.sentence(
            "Eq. 16 is the angular momentum of a leg with its gears",
            "Eq. 16",
            largest(model.held(COUNTER_ROTATED)[1]),
            lambda left: left < ROUNDING,
            "kg m^2/s",
            correction="the fourth term is I_5i theta_5i', not I_S2i theta_S2i' as the machine-read text has it",
            note=f"momentum that is left with all terms; to the letter it misses {literal:.3g} kg m^2/s. The sentence "
            "before Eq. 17 means Eq. 16",
        ),
        P.sentence(
            "under Eqs. 13 and 14 it reduces to Eq. 17",
            "Eq. 17",
            largest(formula - model.held(EXACT)[1]),
            _none,
            "kg m^2/s",
            note="largest difference to the mechanism, gears left out; with Table 1's r_3S = 0.07 Eq. 17 is off by "
            f"{largest(speed @ model.factors(TABLE) - model.held(TABLE)[1]):.2g} kg m^2/s, and the pole counts",
        ),
        P.sentence(
            "I_4i and I_5i by Eqs. 18 and 19 balance the moment",
            "Eqs. 18-19",
            largest(base(COUNTER_ROTATED)[1]),
            _none,
            "N m",
            note=f"largest moment left, I4 = {gears[0]:.6f}, I5 = {gears[1]:.4f} kg m^2; at ratio rho they need 1 / "
            "rho of it and the drives carry 1 + rho times the links' inertia",
        ),
        P.sentence(
            "a manipulator under Eqs. 1-4, 13, 14, 19 and 20 is reactionless",
            "3.1.2",
            largest(base(COUNTER_ROTATED)[1]),
            _none,
            "N m",
            correction="(18) and (19): Eq. 20 is the flywheel's",
            note=f"without Eq. 18 {largest(base(replace(COUNTER_ROTATED, gears=(0.0, gears[1])))[1]):.2f} N m are left",
        ),
        P.sentence(
            "oscillating links make noise unless anti-backlash gears are used",
            "3.1.2",
            float(min(reversals)),
            lambda count: count >= 1,
            note=f"least number of torque reversals in a mesh over one motion, of six meshes {sorted(reversals)}",
        ),
        P.sentence(
            "anti-backlash gears keep pushing against the same side of the tooth",
            "3.1.2",
            preload,
            lambda torque: torque > 0,
            "N m",
            note="spring torque that the most loaded of the six meshes needs for it; the paper gives none",
        ),
    ]


def flywheel(P: Source) -> list[Claim]:
    """Section 4."""
    change, speed, pull = model.angles()
    K, law = model.factors(WHEEL), model.law()
    moment, spin = base(WHEEL)[1], model.held(WHEEL)[1]
    table = replace(TABLE, platform=0.015)
    at = model.row(0.05)
    printed = K[:6] @ pull[at, :6] + K[6] / WHEEL_INERTIA
    ratio = np.abs(model.torques(WHEEL)).max() / np.abs(model.torques(COUNTER_ROTATED)).max()
    closed = -(change @ K) / WHEEL_INERTIA
    return [
        P.sentence(
            "a flywheel is constructively more efficient",
            "4",
            100 * ratio,
            lambda share: share < 100,
            "%",
            note="largest input torque with the flywheel, of that with counter-rotations at ratio 1; but its own motor "
            f"must give {largest(law.torque):.2f} N m and {largest(law.power):.0f} W at I* = 0.01 kg m^2, more than "
            f"all three drives ({_drive_power(WHEEL):.0f} W)",
        ),
        P.sentence(
            "Eq. 20 is the angular momentum of the force-balanced manipulator",
            "Eq. 20",
            largest(speed @ K - spin),
            _none,
            "kg m^2/s",
            note="largest difference to the mechanism",
        ),
        P.sentence(
            "Eq. 21 is its moment",
            "Eq. 21",
            largest(pull @ K - moment),
            _none,
            "N m",
            note="largest difference; it holds only as far as Eqs. 13 and 14 do: with Table 1's r_3S it is off by "
            f"{largest(pull @ model.factors(table) - base(table)[1]):.2g} N m",
        ),
        P.sentence(
            "Eq. 22 gives the flywheel's acceleration",
            "Eq. 22",
            largest(-(pull @ K) / WHEEL_INERTIA - law.acceleration),
            lambda gap: gap < 1e-8,
            "rad/s^2",
            correction="theta'' = -(1 / I*) (sum (K_i theta_i'' + K_i+3 theta_i+3'') + dI_pl phi''): the sign, the "
            "brackets and phi'' are missing",
            note=f"at t = 0.05 s {law.acceleration[at]:.2f} rad/s^2, as printed {printed:.2f}",
        ),
        P.sentence(
            "the flywheel annuls the whole moment",
            "4",
            largest(moment + law.torque),
            _none,
            "N m",
            note=f"largest moment left of {largest(moment):.3f} N m",
        ),
        P.sentence(
            "speed and angle follow by integration",
            "4",
            largest(law.angle - closed),
            lambda gap: gap < 1e-6,
            "rad",
            note="largest difference of the integral to the closed form theta = -(1 / I*) (sum (K_i dtheta_i + K_i+3 "
            f"dtheta_i+3) + dI_pl dphi), which needs no integration: {closed[-1]:.5f} rad at the end",
        ),
    ]


def _weight_torque() -> float:
    """Largest holding torque of the force-balanced manipulator with gravity in its plane."""
    at, total = states(), 0.0
    for body, J in model.bodies(EXACT).items():
        x, y, z = (J[:3, 3] / J[3, 3]).tolist()
        total = total + 9.81 * J[3, 3] * at.point(eq.Point(body, (x, y, z)))[1][:, 2]
    return float(np.abs(total).max())


def _centre(masses: model.Masses) -> Array:
    """The manipulator's centre of mass (N, 2), m."""
    at = states()
    first = sum(at.placement(body).frame @ J[:, 3] for body, J in model.bodies(masses).items())
    return np.asarray(first)[:, [0, 2]] / sum(J[3, 3] for J in model.bodies(masses).values())


def _centre_gap(masses: model.Masses, *, swap: bool) -> float:
    """Largest difference of a leg's centre by Eqs. 5 to 12 to the mechanism's."""
    at, worst = states(), 0.0
    (m2, r2, _), (m3, r3, _), mi = masses.crank, masses.rod, PLATFORM / 3
    a, b = (r3, r2) if swap else (r2, r3)
    for i, pivot in zip(LEGS, model.PIVOTS, strict=True):
        J = model.bodies(masses)
        crank, rod = (at.placement(f"{kind}_{i}").frame for kind in ("crank", "rod"))
        first = crank @ J[f"crank_{i}"][:, 3] + rod @ J[f"rod_{i}"][:, 3] + mi * (rod @ np.array([L, 0.0, 0.0, 1.0]))
        u, v = crank[:, [0, 2], 0], rod[:, [0, 2], 0]
        printed = (m2 * a * u + m3 * (L * u + b * v) + mi * L * (u + v)) / (m2 + m3 + mi)
        worst = max(worst, float(np.abs(first[:, [0, 2]] / (m2 + m3 + mi) - np.array(pivot) - printed).max()))
    return worst


def _drive_power(masses: model.Masses) -> float:
    """Largest power that all three drives supply together, W."""
    rates = states().rates
    assert rates is not None
    return float(np.abs((model.torques(masses) * rates.driven_velocity).sum(axis=1)).max())
