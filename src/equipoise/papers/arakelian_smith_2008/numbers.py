"""Table 1, the drivers and the figures: every printed number of sections 3.2, 4.1 and 5."""

from __future__ import annotations

import math

import numpy as np

from equipoise.affine import Array
from equipoise.claim import Claim, Reason, Source
from equipoise.papers.arakelian_smith_2008 import model
from equipoise.papers.arakelian_smith_2008.model import (
    AS_PRINTED,
    COUNTER_ROTATED,
    EXACT,
    PRINTED,
    SIDE,
    SLENDER,
    TABLE,
    WHEEL,
    L,
    base,
    largest,
    law,
)

RADIUS = 0.082
LISTED = ((0.18, 0.0), (0.28, 0.0), (0.22, 0.087))
EQUAL = "x_P3 = 0.23: the corners of an equilateral triangle, as the equal r_i ask"


def table(P: Source) -> list[Claim]:
    """Table 1 and the platform."""
    corners = np.array(LISTED)
    radii = np.linalg.norm(corners - corners.mean(axis=0), axis=1)
    true = SIDE / math.sqrt(3)
    where = "3.2, Table 1"
    claims = [
        P.number("platform's inertia m R^2 / 2", "3.2", "0.01", 3 * RADIUS**2 / 2, "kg m^2"),
        P.number("point masses m_i", "3.2", "1", 3 / 3, "kg"),
        P.number("r_i = R / sqrt 2", "3.2", "0.058", RADIUS / math.sqrt(2), "m"),
        P.number(
            "X_O3", where, "0.22", 0.23, "m", note="leg 3 closes at t = 0 only for X_O3 = x_P3, and Table 1's r_i ask "
            "x_P3 = 0.23",
        ),
        P.number("Y_O3", where, "0.4", 0.23 * math.sqrt(3), "m", note="0.39837 m closes leg 3"),
        P.number("x_P3", where, "0.22", 0.23, "m", note="side 0.1 m and r_i = 0.058 m for all three ask 0.23"),
        P.number("y_P3", where, "0.087", SIDE * math.sqrt(3) / 2, "m"),
        P.number("x_P1", where, "0.18", L, "m", note="leg 1: crank at 60 deg, rod at -60"),
        P.number("x_P2", where, "0.28", 0.46 - L, "m", note="leg 2: crank at 240, rod at 120"),
    ]  # fmt: skip
    for leg, radius in enumerate(radii.tolist(), 1):
        near = abs(radius - 0.058) <= 5e-4
        words = None if near else Reason(EQUAL, true)
        claims.append(P.number(f"r_{leg} from the listed corners", where, "0.058", radius, "m", correction=words))
    claims += [_rod(P, leg) for leg in (1, 2, 3)]
    m2, m3 = 7.2, 2.6
    r2, r3 = -(m3 + 1) * L / m2, -L / m3
    words = "the table lists magnitudes: section 3.1.1 says that the radii are negative"
    wrong = largest(base(model.LITERAL)[0])
    claims += [
        P.number("r_2S by Eq. 14", where, "0.09", r2, "m", correction=Reason(words, -r2),
                 note=f"taken as positive the force grows to {wrong:.0f} N"),
        P.number("r_3S by Eq. 13", where, "0.07", r3, "m", correction=Reason(words, -r3),
                 note=f"rounded from {-r3:.6f}: {largest(base(TABLE)[0]):.3f} N of {largest(base(SLENDER)[0]):.1f} N"),
        P.underspecified("I_4 by Eq. 18", where, "0.068", "kg m^2",
                         note=f"the gear's own inertia is not given: {model.turned(TABLE)[0]:.5f} without it, 0.00586 "
                         "kg m^2 would be its share"),
        P.underspecified("I_5 by Eq. 19", where, "0.2", "kg m^2",
                         note=f"the gear's own inertia is not given: {model.turned(TABLE)[1]:.5f} without it, 0.00504 "
                         "kg m^2 would be its share"),
        P.underspecified("masses and inertias of links with weights", where, "7.2, 2.6, 0.02, 0.017", "kg, kg m^2",
                         note="only the sums with counterweights are given; bars of 0.5 kg with counterweights of 6.7 "
                         "and 2.1 kg at -0.1034 and -0.1081 m have them"),
    ]  # fmt: skip
    return claims


def drivers(P: Source) -> list[Claim]:
    """The motion."""
    rates = model.states().rates
    assert rates is not None
    ends = np.abs([rates.driven_velocity[[0, -1]], rates.driven_acceleration[[0, -1]]]).max()
    gap = float(np.linalg.norm(model.elbow(2, 4 / 3) - model.elbow(3, 10 / 3, (*model.PIVOTS[:2], (0.22, 0.4)))))
    chain = 2 * L + 0.058 * math.sqrt(3)
    pins = np.array([(0.18, 0.0), (0.28, 0.0), (0.23, SIDE * math.sqrt(3) / 2)])
    elbows = np.array([model.elbow(leg, a) for leg, a in zip((1, 2, 3), PRINTED[0], strict=True)])
    regular = _least_measure()
    return [
        P.sentence(
            "the drivers have zero velocity and acceleration at start and end",
            "3.2",
            float(ends),
            lambda rate: rate < 1e-9,
            "rad/s, rad/s^2",
            note="largest of them",
        ),
        P.sentence(
            "Table 1 lists a manipulator that assembles at the start of the motion",
            "3.2, Table 1",
            1e3 * (gap - chain),
            lambda open_by: open_by <= 0,
            "mm",
            note=f"gap: A2 and A3 are {1e3 * gap:.2f} mm apart, rod, platform and rod span {1e3 * chain:.2f} mm; "
            "digits that fit (0.23 for both 0.22) close it",
        ),
        P.sentence(
            "a = (1/3, 4/3, 10/3), b = (1/6, -1/6, 1/12) moves the manipulator",
            "3.2",
            regular,
            lambda least: least > 0.1,
            correction="a_3 = 5/3, b_3 = -1/12, or the mirror image a_1 = -1/3, a_2 = 2/3: of the 64 combinations of "
            "elbows and signs of b_i only these are regular throughout",
            note="least singular value of the rods' lines over the motion; with the printed ones legs 2 and 3 and the "
            f"platform are stretched out at t = 0 ({model.measure(pins, elbows):.1g}), where the motion branches and "
            "torques are unbounded",
        ),
    ]


def figures(P: Source) -> list[Claim]:
    """Figures 6 to 8 and 10, Table 2, the conclusions."""
    force, moment = base(COUNTER_ROTATED)
    reactions = model.torques(COUNTER_ROTATED).sum(axis=1)
    _, _, pull = model.angles()
    wheel, rows = law(), [model.row(t) for t in (0.05, 0.15, 0.25)]
    rods = "; ".join(f"{pull[r, 3]:.4f}, {pull[r, 4]:.4f}, {pull[r, 5]:.4f}" for r in rows)
    still = base(WHEEL)[0]
    growth = np.abs(model.torques(COUNTER_ROTATED)).max() / np.abs(model.torques(EXACT)).max()
    rounded = "r_3S = -0.0692308 m as Eq. 13 asks, on the regular drivers"
    return [
        *(
            P.sentence(
                f"the bearing forces along {axis} add up to nothing",
                f"3.2, Fig. {number}",
                largest(force[:, column]),
                lambda left: left < 1e-10,
                "N",
                correction=rounded,
                note=f"largest sum; with Table 1's digits {largest(base(TABLE)[0][:, column]):.3f} N, bare links "
                f"{largest(base(SLENDER)[0][:, column]):.1f} N. The curves of single bearings cannot be compared",
            )
            for axis, number, column in (("X", 6, 0), ("Y", 7, 2))
        ),
        P.sentence(
            "the moment of the bearing forces and the reactions of the input torques cancel",
            "3.2, Fig. 8",
            largest(moment),
            lambda left: left < 1e-10,
            "N m",
            correction=rounded + ", I_4 = 0.067722 kg m^2",
            note=f"largest sum of the two; each reaches {largest(reactions):.2f} N m (-19.95, -12.81, 10.43, 6.149, "
            f"5.396 N m at 0.05 to 0.25 s); with Table 1's digits {largest(base(AS_PRINTED)[1]):.4f} N m are left",
        ),
        P.sentence(
            "I_pl = 0.015 kg m^2 cannot be replaced by three point masses",
            "4.1",
            float(model.factors(WHEEL)[-1]),
            lambda rest: abs(rest) > 1e-6,
            "kg m^2",
            note="dI_pl that the masses at 57.7 mm lack; at 70.7 mm they would have it",
        ),
        P.sentence(
            "static substitution alone balances the force in the same way",
            "4.1",
            largest(still),
            lambda left: left < 1e-10,
            "N",
            note="largest force left with I_pl = 0.015 kg m^2",
        ),
        P.underspecified(
            "angular accelerations of the links",
            "4.1, Table 2",
            None,
            "rad/s^2",
            note=f"the table is an image; ours of links 3i at 0.05, 0.15, 0.25 s: {rods}",
        ),
        P.sentence(
            "with I* = 0.01 kg m^2 the law of Fig. 10 balances the moment completely",
            "4.1, Fig. 10",
            largest(base(WHEEL)[1] + wheel.torque),
            lambda left: left < 1e-10,
            "N m",
            note=f"largest moment left; acceleration {wheel.acceleration.max():+.1f} to {wheel.acceleration.min():.1f} "
            f"rad/s^2, speed up to {wheel.speed.max():.2f} rad/s, {wheel.angle[-1]:.4f} rad at the end, where it "
            "rests; the figure is an image",
        ),
        P.sentence(
            "counter-rotations increase the inertia of the system",
            "5",
            growth,
            lambda factor: factor > 1.5,
            note="factor on the largest input torque, against counterweights alone; their mass is not given",
        ),
    ]


def _rod(P: Source, leg: int) -> Claim:
    """The length |A_i P_i| from the listed points and the printed theta_i(0)."""
    pivots = (*model.PIVOTS[:2], (0.22, 0.4))
    tip = np.array(LISTED[leg - 1])
    length = float(np.linalg.norm(tip - model.elbow(leg, PRINTED[0][leg - 1], pivots)))
    return P.number(f"l_3{leg} = |A_{leg} P_{leg}| from the listed points", "3.2, Table 1", "0.18", length, "m")


def _least_measure() -> float:
    import equipoise as eq

    values: Array = eq.platform_measure(model.states())
    return float(values.min())
