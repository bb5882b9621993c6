"""Arakelian & Smith 2008: the reactionless planar 3-RRR [arakelian_smith_2008]."""

from __future__ import annotations

from collections.abc import Sequence

from equipoise.claim import Claim, Source
from equipoise.papers.arakelian_smith_2008 import numbers, theory
from equipoise.papers.arakelian_smith_2008.drawings import DRAWINGS
from equipoise.papers.arakelian_smith_2008.improved import improved
from equipoise.papers.paper import Paper

SLUG = "arakelian-smith-2008"


def claims() -> Sequence[Claim]:
    """Every printed number and checkable sentence, in the paper's order."""
    P = Source(SLUG)
    parts = (
        theory.abstract, theory.substitution, theory.force_balance, theory.moment_balance, numbers.table,
        numbers.drivers, theory.flywheel, numbers.figures,
    )  # fmt: skip
    return [claim for part in parts for claim in part(P)]


PAPER = Paper(
    slug=SLUG,
    about="The platform of a planar 3-RRR is replaced by three point masses at its joints, each leg is balanced by two "
    "counterweights, and the moment by counter-rotating gears on every link, or by one flywheel with a prescribed law "
    "of rotation.",
    given="Table 1: legs of 0.18 and 0.18 m, platform 3 kg with I_pl = 0.01 (or 0.015) kg m2, balanced links of 7.2 "
    "and 2.6 kg with 0.02 and 0.017 kg m2; T = 0.3 s. Where bare links are wanted, uniform bars of 0.5 kg.",
    findings=(
        "The theory is right: Eqs. 13, 14, 18 and 19 leave no force and no moment, to rounding. Table 1 leaves 0.5 % "
        "of the force and 0.8 % of the moment, because r_3S = -0.0692308 m is printed as 0.07.",
        "The printed start is singular: with a_3 = 10/3 rod 2, platform and rod 3 are stretched in one line, where "
        "the motion branches and torques grow without bound; with the printed digits the loop does not even close. The "
        "drivers used here are a_3 = 5/3, b_3 = -1/12; the mirror image gives the same curves.",
        "Table 1's x_P3 and X_O3 are 0.23, not 0.22; r_2S and r_3S are negative.",
        "Eq. 22 lacks a sign, brackets and phi'': it gives -9 instead of 947 rad/s2 at 0.05 s.",
        "Six complex conditions are sufficient; five are necessary. One distal link may go without a counterweight.",
        "The angular momentum is a total derivative, so the flywheel's angle is a function of the posture: no drift, "
        "and without any flywheel an orientation phi(x, y) moves the manipulator without reaction.",
        "Force balance alone leaves the moment as it was and triples the drives' torque; counter-rotations double it "
        "again; the flywheel spares the drives, but its motor takes three times their power at I* = 0.01 kg m2.",
    ),
    claims=claims,
    improved=improved,
    drawings=DRAWINGS,
)
