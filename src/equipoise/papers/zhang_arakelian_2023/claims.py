"""Zhang & Arakelian 2023, claim by claim [zhang_arakelian_2023]."""

from __future__ import annotations

import math

import numpy as np

import equipoise as eq
from equipoise.claim import Claim, Source
from equipoise.papers.zhang_arakelian_2023 import model
from equipoise.papers.zhang_arakelian_2023.examples import example_claims
from equipoise.papers.zhang_arakelian_2023.model import (
    FREE,
    JOINT,
    MANY,
    MOMENT,
    THREE,
    Dyad,
    G,
    K,
    at,
    design,
    largest,
    link,
    over,
    rms,
    signed_sum,
    synthesis,
)
from equipoise.papers.zhang_arakelian_2023.printed import moment_as_printed

P = Source("zhang-arakelian-2023")
ROUNDING = 1e-9


def claims() -> list[Claim]:
    """Every printed number and checkable sentence, in the paper's order."""
    return [*_introduction(), *_synthesis(), *_moments(), *example_claims()]


def _introduction() -> list[Claim]:
    _, dyad = design(THREE)
    straight = eq.balance(link(), [_direct(eq.Coil(0.2))], over(), norm="rms").certificate
    swivel = eq.InvertedSliderCrank(eq.Angle(JOINT), crank=0.3, distance=0.25)
    rod = eq.balance(link(), [eq.Spring("s", swivel, eq.Linear())], over(), norm="peak")
    states = model.states()
    heavy = largest(dyad.moment(states, dyad.spring(mass=1.0)) - dyad.moment(states))
    raised = dyad.moment(states, dyad.spring(mass=1.0, free=FREE + 0.5 * G / K)) - dyad.moment(states)
    stretch = 100 * (FREE - dyad.height(states)) / FREE
    return [
        P.sentence(
            "an ordinary spring jointed directly to a rotating link cannot balance it completely",
            "abstract, I",
            straight.dual,
            lambda floor: floor > ROUNDING,
            "N m",
            note="certified lower bound of the rms over all rates: a spring of 0.2 m free length from 0.25 m above the "
            "axis to 0.3 m along the link",
        ),
        P.sentence(
            "the mass of the spring does not affect the balancing",
            "abstract, I",
            heavy,
            lambda moment: moment < ROUNDING,
            "N m",
            note="moment added per kg of spring, half of which rides on the slider (twice that per kg of slider): the "
            "slider moves up and down with the link; lifting the spring's foot by W/k, W the riding weight, cancels it "
            f"to {largest(raised):.1g} N m",
        ),
        P.at_most(
            "elongation of a spring over its initial length",
            "I",
            "25",
            float(stretch.max()),
            "%",
            note=f"the paper's own spring is compressed by {stretch.min():.1f} to {stretch.max():.1f} % in example A",
        ),
        P.underspecified(
            "cable and pulley designs leave more than 10-15 % of the moment of gravity",
            "I",
            "10 to 15",
            "%",
            note="neither radii, friction nor geometry are given",
        ),
        P.sentence(
            "an inverted slider-crank with a spring of non-zero length balances a rotating link completely",
            "I",
            rod.certificate.primal,
            lambda left: left < ROUNDING,
            "N m",
            note="largest moment left with a straight force line on the rod; its preload at zero distance comes out as "
            f"{abs(rod.values['s.preload']):.1g} N, so the coil must be free where pin and pivot would meet",
        ),
    ]


def _synthesis() -> list[Claim]:
    energy, dyad = design(THREE)
    states = at(*THREE)
    closure = dyad.height(states) - model.heights(states, energy)
    flat = synthesis(at(60.0, 90.0, 120.0), 180.0)
    domain = MOMENT * (1 + math.cos(math.radians(30)))
    return [
        P.sentence(
            "three prescribed positions are met by one system of three linear equations",
            "III, Eqs. 8-16",
            float(np.abs(closure).max()),
            lambda gap: gap < ROUNDING,
            "m",
            note=f"largest difference of the slider's height at 30, 90 and 150 deg; C must exceed {domain:.2f} J",
        ),
        P.sentence(
            "r = z2 / sin(beta) = z1 / cos(beta), beta = arctan(z2 / z1)",
            "III, Eqs. 17-18",
            flat.r * math.cos(flat.beta) - _z1(at(60.0, 90.0, 120.0), 180.0),
            lambda gap: abs(gap) < ROUNDING,
            "m",
            correction="r = hypot(z1, z2), beta = atan2(z2, z1): z2 / sin(beta) is 0 / 0 at beta = 0",
            note="difference of r cos(beta) to z1",
        ),
    ]


def _moments() -> list[Claim]:
    _, dyad = design(THREE)
    states = model.states()
    true = dyad.moment(states)

    def gap(**slips: bool) -> float:
        return largest(moment_as_printed(dyad, states.driven[:, 0], **slips) - true)

    literal = synthesis(at(*MANY), model.best_energy(at(*MANY), signed_sum))
    other = synthesis(at(*MANY), model.best_energy(at(*MANY), rms)).moment(states)
    return [
        P.sentence(
            "Eq. 24 gives the slider's height",
            "IV, Eqs. 21-24",
            float(np.abs(_height(dyad, states.driven[:, 0]) - dyad.height(states)).max()),
            lambda difference: difference < ROUNDING,
            "m",
            note="largest difference to the mechanism",
        ),
        P.sentence(
            "the rod carries F_sp cos(theta)",
            "IV, Eq. 26",
            gap(cosine=False, sign=False),
            lambda difference: difference < ROUNDING,
            "N m",
            correction="a two-force rod on a guided slider carries F_sp / cos(theta)",
            note=f"largest difference to -dP/dphi; with the cosine {gap(cosine=True, sign=False):.2f} N m",
        ),
        P.sentence(
            "M_ub = -(M_sp + M_G)",
            "IV, Eq. 30",
            gap(cosine=False, sign=False),
            lambda difference: difference < ROUNDING,
            "N m",
            correction="the two moments oppose each other: with the signs of Eqs. 20 and 25 they add up",
            note=f"largest difference to -dP/dphi; with the printed signs {gap(cosine=False, sign=True):.1f} N m",
        ),
        P.sentence(
            "the energy of Eq. 32 makes the unbalanced moment least",
            "IV, Eqs. 31-32",
            100 * (rms(literal.moment(states)) / rms(other) - 1),
            lambda excess: excess < 1e-4,
            "%",
            note="excess of its rms over the least one of the same 121-position family: the sum of signed moments lets "
            f"errors cancel; its peak is {largest(literal.moment(states)):.3f} N m against "
            f"{largest(design(MANY)[1].moment(states)):.3f} N m",
        ),
    ]


def _direct(law: eq.Coil) -> eq.Spring:
    """A coil hooked straight from above the axis to the link."""
    return eq.Spring("s", eq.Line(eq.Point("world", (0.0, 0.0, 0.25)), eq.Point("link", (0.3, 0.0, 0.0))), law)


def _z1(states: eq.States, energy: float) -> float:
    y, phi = model.heights(states, energy), states.driven[:, 0]
    return float(np.linalg.solve(np.stack([2 * y * np.cos(phi), 2 * y * np.sin(phi), 1 + 0 * y], axis=1), y * y)[0])


def _height(dyad: Dyad, phi: np.ndarray) -> np.ndarray:
    """Eq. 24."""
    u = phi - dyad.beta
    return dyad.r * np.cos(u) + np.sqrt(dyad.l**2 - (dyad.r * np.sin(u)) ** 2)
