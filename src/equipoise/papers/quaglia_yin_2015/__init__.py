"""Quaglia & Yin 2015: planar articulated robots, balanced by pivoted springs or by yokes [quaglia_yin_2015]."""

from __future__ import annotations

from collections.abc import Sequence

from equipoise.claim import Claim, Source
from equipoise.papers.paper import Paper
from equipoise.papers.quaglia_yin_2015 import dynamics, evolution, examples, pressure, revolute, yokes
from equipoise.papers.quaglia_yin_2015.figures import DRAWINGS
from equipoise.papers.quaglia_yin_2015.improved import improved

SLUG = "quaglia-yin-2015"


def claims() -> Sequence[Claim]:
    """Every printed number and checkable sentence, in the paper's order."""
    source, parts = Source(SLUG), (evolution, revolute, examples, yokes, dynamics, pressure)
    return [claim for part in parts for claim in part.claims(source)]


PAPER = Paper(
    slug=SLUG,
    about="A two-link robot is balanced link by link: by springs between a crank and a fixed pivot where both motors "
    "sit on the base (structure I), by Scotch yokes with constant-force or gas springs where the second motor sits at "
    "the elbow and a cable carries the forearm's angle to the base (structure II).",
    given="Table 1: 100 and 40 kg, 1.2 and 1 m, centres at 0.6 and 0.5 m, cranks of 0.2 m; g = 9.8 m/s2. th1 from -90 "
    "to 90 deg, phi from 18 to 162 deg. Errors count in percent of each link's largest gravity torque, 1058.4 and "
    "196 N m, positive where the spring is too strong.",
    findings=(
        "The ideal spring (zero free length, pivot straight above) balances exactly; each degree by which pivot, crank "
        "or base is tilted costs 1.11 % of the largest torque on average.",
        "The constant force on a pivot leaves 2.77 % at best as published, 2.70 % with pivot and force free, and a "
        "peak of 8.4 %, which other values bring down to 5.4 %. A pivot farther away is better only if its angle "
        "follows.",
        "A spring twice as stiff as the ideal one leaves up to 16.1 %, not 15 %.",
        "Eq. 37's adiabatic law is the isothermal one, and Eq. 38 leaves out the ambient pressure: at 6.7 bar gauge "
        "the error of a gas spring on a yoke is 1.6 times what they give, so 2.8 % takes a bottle of 8.7 swept "
        "volumes.",
        "On a pivot a gas strut of finite volume, near n A a10 P0/(P0 - Pa), leaves a tenth of the error of the "
        "constant force that a big bottle gives.",
        "A payload needs three adjustments: the crank's angle, its torque, and link 1's force. The crank alone, as "
        "in Fig. 27, mends next to nothing.",
        "What link 2's balancer leaves also loads motor 1 of structure II (C1M = -(e1 C1max + e2 C2max)); Eq. 32 lacks "
        "its coupling terms and is good only at rest.",
    ),
    claims=claims,
    improved=improved,
    drawings=DRAWINGS,
)
