"""Abstract, sections 1, 2 and 5, claim by claim."""

from __future__ import annotations

import math

import numpy as np

import equipoise as eq
from equipoise.claim import Claim, Source
from equipoise.papers.arakelian_ghazaryan_2008 import cubic, model
from equipoise.papers.arakelian_ghazaryan_2008.model import (
    WIRE_1,
    WIRE_S1,
    WIRE_S2,
    Y_B,
    G,
    M,
    R,
    best_rate,
    heavy_rate,
    light_rate,
    moment,
    rms,
    zero_free_length,
)

P = Source("arakelian-ghazaryan-2008")
ROUNDING = 1e-9


def theory_claims() -> list[Claim]:
    """Abstract and sections 1 and 2."""
    light, heavy = light_rate(), heavy_rate()
    with_mass = moment(zero_free_length(heavy, WIRE_1))
    ignored = moment(zero_free_length(light, WIRE_1))
    by_tension = moment(eq.Spring("s", model.LINE, eq.Coil(0.4, k=heavy, initial_tension=0.4 * heavy)))
    ideal = moment(zero_free_length(heavy))
    lumps = _distributed(heavy)
    diameter = (8 * WIRE_1.diameter**3 * WIRE_1.coils * heavy / WIRE_1.shear_modulus) ** 0.25
    by_diameter = WIRE_1.density * WIRE_1.wire_length * math.pi * diameter**2 / 4
    best = rms(best_rate())
    printed = cubic.PRINTED
    fair = cubic.Cubic(1.0, 1.0, 2.0)
    confluent = cubic.Cubic(1.0, -5.0, 3.0)  # (z - 1)^2 (z + 3)
    double = -cubic.first_part(confluent, mended=True) - confluent.a / 3
    level, hanging, preloaded = (
        _cable(heavy, *how) for how in (((-0.5, 0.16), 0.0), ((0.0, -0.4), 0.0), ((0.0, -0.4), 0.5))
    )
    return [
        P.sentence(
            "with the spring's mass in the equation a spring of zero free length balances the link exactly",
            "abstract, 2.1",
            float(np.abs(with_mass).max()),
            lambda left: left < ROUNDING,
            "N m",
            note="largest unbalanced moment at the rate of Eqs. 8-10 must be at rounding level",
        ),
        P.sentence(
            "on a cable over a pulley the mass of the spring has no influence on the balancing",
            "1",
            level,
            lambda moment: moment < ROUNDING,
            "N m",
            correction="holds for a spring that lies level",
            note=f"largest moment that its mass adds; a hanging one pulls at the cable with half its weight and adds "
            f"{hanging:.3f} N m, which a preload of that half takes away exactly (to {preloaded:.1g} N m)",
        ),
        P.sentence(
            "where springs are jointed to links their mass must enter the equations",
            "1",
            float(np.abs(ignored).max()),
            lambda left: left > ROUNDING,
            "N m",
            note="largest moment that the mass of the weightless design's own spring (k = 299 N/m) leaves",
        ),
        P.sentence(
            "computing rate and mass by turns approaches the balance",
            "1",
            float(_turns()),
            lambda turns: turns < 20,
            "turns",
            note="turns from the weightless rate until the rate is right to 1e-9; the quadratic needs none",
        ),
        P.sentence(
            "F0 = k l0 makes the spring one of zero free length",
            "2.1",
            float(np.abs(by_tension - ideal).max()),
            lambda gap: gap < ROUNDING,
            "N m",
            note="largest difference of the two moments; a steel coil cannot be wound with such an initial tension "
            "(section 3.1 needs about 290 MPa of torsion, winding gives under 100)",
        ),
        P.sentence(
            "a uniformly stretched spring acts as half its mass at A",
            "2.1, Eq. 4",
            float(np.abs(lumps).max()),
            lambda gap: gap < ROUNDING,
            "N m",
            note="largest difference to 200 lumps spread along the line from B to A",
        ),
        P.sentence(
            "the mass follows from the rate by Eq. 7",
            "2.1, Eqs. 5-7",
            by_diameter / float(WIRE_1.of(heavy)) - 1,
            lambda gap: abs(gap) < ROUNDING,
            note="relative difference to Eqs. 5 and 6 with the wire diameter in between",
        ),
        P.sentence(
            "with a non-zero free length complete balancing of the link is impossible",
            "2.2",
            best,
            lambda left: left > ROUNDING,
            "N m",
            note="least rms over all rates with l0 = 0.3 m, 5 deg grid: above zero",
        ),
        P.sentence(
            "Eq. 14 minimises the rms of the unbalanced moment",
            "2.2, Eqs. 12-14",
            100 * (rms(cubic.squared_sum().roots[1] ** 2) / best - 1),
            lambda excess: excess < 1e-4,
            "%",
            note="excess of its rms over the least one: Eq. 14 squares the sum of the moments where Eq. 13 "
            "sums their squares, so it only makes the mean moment zero; products of sums in Eqs. 20-22 must become "
            "sums of products",
        ),
        P.sentence(
            "t = arccos(R sqrt(Q^3) / 3) in the three-root case",
            "2.2, Eq. 29",
            printed.R / math.sqrt(printed.Q**3),
            lambda x: abs(x) <= 1,
            correction="t = arccos(R / sqrt(Q^3)) / 3",
            note=f"argument of the arccos, at most 1 in magnitude; as printed {printed.R * printed.Q**1.5 / 3:.0f}",
        ),
        P.sentence(
            "A = -sign(R) (cbrt|R| + sqrt(R^2 - Q^3)) in the one-root case",
            "2.2, Eqs. 30-32",
            fair.left(fair.single_root(cubic.first_part(fair, mended=True))),
            lambda left: abs(left) < ROUNDING,
            correction="the cube root spans the whole bracket",
            note="what the root leaves in z^3 + z^2 + z + 2; as printed "
            f"{fair.left(fair.single_root(cubic.first_part(fair, mended=False))):.3g}",
        ),
        P.sentence(
            "where A = B the double root is -A - a/3",
            "2.2, Eq. 33",
            confluent.left(double),
            lambda left: abs(left) < 1e-6,
            correction="A with the cube root over the whole bracket",
            note="what the root leaves in (z - 1)^2 (z + 3)",
        ),
    ]


def conclusion_claims() -> list[Claim]:
    """Section 5."""
    light, heavy = light_rate(), heavy_rate()
    weight = float(np.abs(moment()).max())
    loaded = weight * heavy / light
    share = 50 * float(WIRE_S1.of(522) + WIRE_S2.of(522)) / M
    return [
        P.number("error caused by neglecting the spring's mass", "5", "8", 100 * (heavy / light - 1), "%"),
        P.at_most(
            "error that neglecting the spring's mass can reach, in the paper's own examples",
            "5",
            "8",
            share,
            "%",
            note="the leg of section 4: half the two springs' mass over M",
        ),
        P.sentence(
            "the mass of the spring increases the moment to be balanced",
            "5",
            loaded - weight,
            lambda gain: gain > 0,
            "N m",
            note=f"from {weight:.4f} to {loaded:.4f} N m at 120 deg, section 3.1",
        ),
        P.sentence(
            "the rate found minimises the rms of the torque at the joint",
            "5",
            100 * (rms(1114.0) / rms(best_rate()) - 1),
            lambda excess: excess < 1e-4,
            "%",
            note="excess of the rms at the printed 1114 N/m on the 5 deg grid, see Eq. 14; the least rms is at "
            f"{best_rate():.2f} N/m",
        ),
        P.underspecified(
            "errors of 10-20 % by practical restrictions and assumptions",
            "5",
            "10 to 20",
            "%",
            note="quoted from another study without its data",
        ),
    ]


def _turns() -> int:
    """Turns of `mass from rate, rate from mass` until the rate is right to 1e-9."""
    rates = eq.iterated_rates(model.link(), [zero_free_length(1.0, WIRE_1)], model.states(5))
    return next(turn for turn, rate in enumerate(rates) if abs(rate / heavy_rate() - 1) < ROUNDING)


def _cable(k: float, foot: tuple[float, float], relief: float) -> float:
    """Largest moment added by the mass of a spring from `foot` by a cable over the pulley at B, N m.

    The last 0.3 m before the pulley are cable; relief is the part of the weight that a preload takes.
    """
    mass, eye, cable = float(WIRE_1.of(k)), eq.Pulley("world", (0.0, 0.0, Y_B)), 0.3
    points = (eq.Point("world", (foot[0], 0.0, foot[1])), eye, eq.Point("link", (R, 0.0, 0.0)))
    path = eq.Cable(points, offset=-cable)
    bare = moment(eq.Spring("s", path, eq.Linear(k, k * cable)), step=5)
    laden = moment(eq.Spring("s", path, eq.Linear(k, k * cable - relief * mass * G), mass=mass), step=5)
    return float(np.abs(laden - bare).max())


def _distributed(k: float) -> np.ndarray:
    """Moment of the spring's weight: 200 lumps along the line less half the mass at A, N m."""
    mass, states = float(WIRE_1.of(k)), model.states(5)
    share = (np.arange(200) + 0.5) / 200
    spread = sum(states.weight_effort(eq.Point("link", (R * s, 0.0, 0.0)), mass / 200) for s in share)
    return spread - states.weight_effort(eq.Point("link", (R, 0.0, 0.0)), mass / 2)
