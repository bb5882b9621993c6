"""Arakelian & Ghazaryan 2008, claim by claim: section 3 here, the rest beside it [arakelian_ghazaryan_2008]."""

from __future__ import annotations

import math

from equipoise.claim import Claim, Reason, Source
from equipoise.papers.arakelian_ghazaryan_2008 import cubic, model
from equipoise.papers.arakelian_ghazaryan_2008.leg_claims import leg_claims
from equipoise.papers.arakelian_ghazaryan_2008.model import (
    COM,
    MASS,
    WIRE_1,
    WIRE_2,
    Y_B,
    G,
    R,
    coil,
    heavy_rate,
    light_rate,
    peak,
    rms,
)
from equipoise.papers.arakelian_ghazaryan_2008.theory_claims import conclusion_claims, theory_claims

P = Source("arakelian-ghazaryan-2008")
ROUNDING = 1e-9


def claims() -> list[Claim]:
    """Every printed number and checkable sentence, in the paper's order."""
    return [*theory_claims(), *_zero_free_length(), *_coil(), *_cubic(), *leg_claims(), *conclusion_claims()]


def _zero_free_length() -> list[Claim]:
    light, heavy = light_rate(), heavy_rate()
    shortest = float(coil(1.0).path.deform(model.states(0.1))[0].min())
    note = f"F0 = k l0 with l0 = {shortest:.6f} m, the shortest assembled length, which is not printed"
    by_gauge = WIRE_1.density * WIRE_1.wire_length * math.pi * 0.0036**2 / 4
    rounded = (MASS * COM + 0.5 * by_gauge * R) * G / (Y_B * R)
    index = WIRE_1.diameter / (8 * WIRE_1.diameter**3 * WIRE_1.coils * heavy / WIRE_1.shear_modulus) ** 0.25
    return [
        P.number("rate of the weightless spring", "3.1", "299", light, "N/m"),
        P.number("initial force of the weightless spring", "3.1", "121", light * shortest, "N", note=note),
        P.number(
            "rate with the spring's mass",
            "3.1",
            "324.5",
            heavy,
            "N/m",
            correction=Reason("the wire is rounded to 3.6 mm and its mass put in Eq. 4", rounded),
        ),
        P.number("initial force with the spring's mass", "3.1", "131", heavy * shortest, "N", note=note),
        P.number("mass of the spring", "3.1", "0.8", float(WIRE_1.of(heavy)), "kg"),
        P.between("spring index D/d", "3.1", ("4", "15"), index, note=f"wire {1e3 * WIRE_1.diameter / index:.3f} mm"),
        P.underspecified(
            "the spring respects the admissible maximum extension",
            "3.1",
            None,
            note=f"no limit is printed; from its shortest length it stretches by {1e3 * (R + Y_B - shortest):.1f} mm",
        ),
        P.number(
            "error caused by neglecting the spring's mass",
            "3.1, Fig. 2",
            "8.3",
            100 * (heavy / light - 1),
            "%",
            note="read as m2 r / (2 m1 s1) with the heavier spring's mass: the ratio of the rates less one; the "
            f"spring of 299 N/m itself weighs {float(WIRE_1.of(light)):.3f} kg, "
            f"{50 * float(WIRE_1.of(light)) * R / (MASS * COM):.2f} %",
        ),
    ]


def _coil() -> list[Claim]:
    C1, _, C3 = cubic.sums()
    light = -C1 / C3
    least = math.pi * WIRE_2.diameter * WIRE_2.coils
    return [
        P.number("rate of the weightless spring", "3.2", "990", light, "N/m", note="-C1/C3, 5 deg grid"),
        P.number("mass of that spring", "3.2", "1.1", float(WIRE_2.of(990)), "kg", note="L_w = 8 m and n = 80"),
        P.sentence(
            "a wire of 8 m makes the 80 coils of 40 mm",
            "3.2",
            least,
            lambda length: length <= WIRE_2.wire_length,
            "m",
            note="pi D n, without hooks; 8 m makes 61 coils with the hooks of section 3.1",
        ),
        P.number(
            "largest moment without the spring's mass, k = 990",
            "3.2, Fig. 4",
            "1.81",
            peak(990, 0.0),
            "N m",
            note="printed in N/m",
        ),
        P.number(
            "largest moment with the spring's mass, k = 990",
            "3.2, Fig. 4",
            "3.2",
            peak(990),
            "N m",
            note="printed in N/m",
        ),
    ]


def _cubic() -> list[Claim]:
    C1, C2, C3 = cubic.sums()
    right, wrong = cubic.squared_sum(), cubic.PRINTED
    k, slip = right.roots[1] ** 2, "Eq. 34 as printed, whose coefficient of z lacks C2^2,"
    points = "13 points, 120 to 180 deg by 5, SI units, L_w = 8 m, n = 80"
    found = [
        P.number("C1", "3.2, Eq. 15", "88.454", C1, "N m", note=points),
        P.number("C2", "3.2, Eq. 16", "0.316", C2, "N m / sqrt(N/m)", note=points),
        P.number("C3", "3.2, Eq. 17", "-0.089", C3, "m^2", note=points),
        P.number("coefficient of z^2", "3.2, Eq. 34", "-5.3", right.a),
        P.number("coefficient of z", "3.2, Eq. 34", "-989.7", right.b, slip=Reason("Eq. 21 without C2^2", C1 / C3)),
        P.number("constant term", "3.2, Eq. 34", "1748.8", right.c),
        P.number("Q", "3.2, Eq. 24", "333", right.Q, slip=Reason(slip, wrong.Q)),
        P.number(
            "R",
            "3.2, Eq. 25",
            "-5.3",
            right.R,
            slip=Reason(slip, wrong.R),
            note="zero for any data: with Eq. 14 the cubic falls into a linear and a quadratic factor",
        ),
        P.sentence(
            "R^2 < Q^3: three real roots",
            "3.2",
            right.R**2 - right.Q**3,
            lambda gap: gap < 0,
            note="R^2 - Q^3",
        ),
    ]
    order = {"z1": ("1.76", 2), "z2": ("33.38", 1), "z3": ("-29.84", 0)}
    found += [
        P.number(
            f"root {name}",
            "3.2",
            printed,
            right.roots[index],
            slip=Reason(slip, wrong.roots[index]),
            note="" if name == "z2" else f"by Eqs. 26-28 this root is z{index + 1}",
        )
        for name, (printed, index) in order.items()
    ]
    start, after = peak(990), peak(k)
    return [
        *found,
        P.number("rate with the spring's mass", "3.2", "1114", k, "N/m", slip=Reason(slip, wrong.roots[1] ** 2)),
        P.number(
            "mass of the spring of 1114 N/m", "3.2", "1.16", float(WIRE_2.of(1114)), "kg", note="L_w = 8 m, n = 80"
        ),
        P.number(
            "largest moment with the spring's mass in the equation",
            "3.2, Fig. 6",
            "1.86",
            peak(1114),
            "N m",
            slip=Reason(f"the paper's own equations done right (k = {k:.2f} N/m)", after),
            note="k = 1114 N/m, at 120 deg; likely a misprint of 1.96",
        ),
        P.sentence(
            "a significant improvement over the design that neglects the mass",
            "3.2",
            100 * (1 - peak(1114) / start),
            lambda gain: gain > 30,
            "%",
            note="reduction of the peak from k = 990 to k = 1114 N/m; 42 % by the printed 3.2 and 1.86",
        ),
        P.sentence(
            "minimising Eq. 35 determines all six unknowns",
            "3.2, Eq. 35",
            rms(k),
            lambda left: left < ROUNDING,
            "N m",
            note="rms of a design at which Eq. 35 is already zero: the squared sum vanishes on a five-dimensional set "
            "of designs, good and bad alike; with a sum of squares l0 runs to zero unless it is bounded",
        ),
    ]
