"""Section 3.1.2, structure I: lengths, torques and rates of a spring between a crank pin and a fixed pivot."""

from __future__ import annotations

import math

import numpy as np

import equipoise as eq
from equipoise.affine import Array
from equipoise.claim import Claim, Source
from equipoise.papers.quaglia_yin_2015.robots import (
    CRANK,
    JOINT,
    LARGEST,
    TINY,
    alone,
    along,
    at,
    constant_force,
    error,
    ideal,
    matched,
    mean,
    pivoted,
    states,
)

WIRE = 700e6**2 / (4 * 79.5e9 * 7800)
"""Energy, J/kg, that a kilogram of spring wire holds at a shear stress of 700 MPa."""


def eq_23(th1: Array, n: float, ra: float) -> Array:
    """Eq. 23 as printed, percent; th1 in rad."""
    ratio = np.sqrt(1 + ra**2) / np.sqrt(1 + ra**2 - 2 * ra * np.sin(th1))
    return 100 * (ratio - n * ratio + n - 1) * np.cos(th1)


def claims(P: Source) -> list[Claim]:
    """Section 3.1.2: lengths, torques, and the rate that balances."""
    alpha, ra = 77.0, 3.3
    sweep = along()
    here = states(1, sweep)
    th1 = here.driven[:, 0]
    spring = pivoted("s", JOINT, eq.Linear(k=3000.0, preload=150.0), alpha, ra)
    length, force = spring.force(here, {})
    r, turn = ra * CRANK, math.radians(alpha)
    a1 = np.sqrt(r**2 + CRANK**2 - 2 * CRANK * r * np.cos(turn - th1))
    eq_14 = force * r * CRANK / a1 * np.sin(turn - th1)
    ours = -spring.effort(here, "hold").b[:, 0]
    return [
        P.sentence(
            "length of the spring, a1 = sqrt(r5^2 + b1^2 - 2 b1 r5 cos(alpha5 - th1))",
            "Eq. 7",
            float(np.abs(length - a1).max()),
            lambda gap: gap < 1e-12,
            "m",
            note="largest difference at alpha5 = 77 deg, ra1 = 3.3; Eq. 8, the arm r5 b1 sin(alpha5 - th1) / a1, is "
            "read from Eq. 14",
        ),
        P.sentence(
            "torque of a spring, F r5 b1 sin(alpha5 - th1) / a1",
            "Eqs. 9, 14, 15",
            float(np.abs(ours - eq_14).max()),
            lambda gap: gap < 1e-9,
            "N m",
            note="largest difference from F da1/dth1 of a spring with rate and preload",
        ),
        P.sentence(
            "link 1 asks for the largest torque at th1 = 0",
            "Eq. 10",
            float(np.degrees(th1[np.argmax(np.abs(here.holding[:, 0]))])),
            lambda angle: abs(angle) < TINY,
            "deg",
            note=f"(m1 r1 + m2 l1) g = {np.abs(here.holding[:, 0]).max():.10g} N m",
        ),
        P.sentence(
            "the constant force that carries link 1 at th1 = 0",
            "Eqs. 10, 11",
            abs(float(constant_force(1, at(0.0), 86.0)[..., 0])),
            lambda value: abs(value) < TINY,
            "%",
            note=f"error at th1 = 0; at alpha5 = 86 deg and ra1 = 6 the force is {matched(1, 86.0)[0]:.3f} N, "
            f"at 90 deg {matched(1, 90.0)[0]:.3f} N",
        ),
        P.sentence(
            "the error is gravity's torque less the spring's",
            "Eq. 12",
            float(constant_force(1, at(-90.0), 84.0)[..., 0]),
            lambda value: value > 0,
            "%",
            correction="the sign of Eq. 12 is turned: Eqs. 19 to 23 and the text of Fig. 14 count spring less gravity",
            note="error at th1 = -90 deg, alpha5 = 84 deg, which the text of Fig. 14 calls positive",
        ),
        *_rate(P),
        *_stiffer(P),
        P.underspecified(
            "springs add little mass, where counterweights add inertia",
            "1",
            None,
            note="no material or stress is printed. The ideal spring of link 1 stores up to "
            f"{_stored():.0f} J at ra1 = 6; wire at 700 MPa holds tau^2/(4 G rho) = {WIRE:.1f} J/kg (G = 79.5 GPa, "
            f"rho = 7800 kg/m3), so it weighs at least {_stored() / WIRE:.1f} kg",
        ),
        P.sentence(
            "link 2 asks for the largest torque m2 r2 g where it is level",
            "Eq. 24",
            float(states(2, at(0.0)).holding[0, 0] - LARGEST[1]),
            lambda gap: abs(gap) < 1e-9,
            "N m",
            note=f"difference from m2 r2 g = {LARGEST[1]:g} N m",
        ),
    ]


def _stored() -> float:
    """Most energy, J, in the ideal spring of link 1 over (-90, 90) deg."""
    here = states(1, along())
    return float(pivoted("s", JOINT, eq.ZeroFreeLength(ideal(1).k)).effort(here, "storage").b.max())


def _rate(P: Source) -> list[Claim]:
    sweep = along()
    found = eq.balance(alone(1), [pivoted("s", JOINT, eq.Linear())], sweep)
    k, preload = found.values["s.k"], found.values["s.preload"]
    a10 = CRANK * math.sqrt(37)
    level = pivoted("s", JOINT, ideal(1)).force(states(1, at(0.0)), {})
    return [
        P.sentence(
            "a10 is the spring's deformation at th1 = 0",
            "Eq. 13",
            a10,
            lambda value: abs(value - float(level[0][0])) < 1e-12,
            "m",
            correction="a10 is the distance from pin to pivot; it is the deformation only of a spring of zero free "
            "length. In general F = k (a - L0)",
            note="alpha5 = 90 deg, ra1 = 6",
        ),
        P.sentence(
            "no error is left with k1id r5 b1 = C1max and F10 = k1id a10",
            "Eqs. 16-18",
            float(found.after["link_joint"].peak),
            lambda peak: peak < 1e-8,
            "N m",
            note=f"rate and preload found freely at ra1 = 6: k = {k:.8g} N/m (Eq. 18: 4410), force at zero length "
            f"{abs(preload):.1g} N, so F10 = k a10 = {k * a10 + preload:.8g} N; certificate {found.certificate.kind}",
        ),
        P.sentence(
            "the ideal spring's initial length is of the order of a10, which is hard to build",
            "3.1.2",
            a10,
            lambda value: value > 1,
            "m",
            note="at ra1 = 6 and th1 = 0 the ideal spring is stretched by all of a10, the length of link 1; a guided "
            "spring, or a cable over a pulley, takes its own length out of the line",
        ),
    ]


def _stiffer(P: Source) -> list[Claim]:
    circle = along(-180.0, 180.0)
    th1 = states(1, circle).driven[:, 0]
    cases = [(n, ra) for n in (0.0, 0.5, 1.7, 2.0, 3.0) for ra in (1.5, 4.0, 9.0)]
    gap = max(float(np.abs(error(1, ideal(1, ra, n), circle, 90.0, ra) - eq_23(th1, n, ra)).max()) for n, ra in cases)
    twice = error(1, ideal(1, 4.0, 2.0), circle, 90.0, 4.0)
    worst = int(np.argmax(np.abs(twice) * (np.cos(th1) > 0)))
    below = np.abs(twice[np.sin(th1) < 0]).max()
    mirrored = error(1, ideal(1, 4.0, 2.0), at(180.0 - np.degrees(th1)), 90.0, 4.0)
    spring = pivoted("s", JOINT, ideal(1, 4.0, 2.0), 90.0, 4.0)
    length, force = (float(part[0]) for part in spring.force(states(1, at(0.0)), {}))
    stretch = force / (2 * LARGEST[0] / (4 * CRANK**2)) / length
    average = {n: float(mean(error(1, ideal(1, 4.0, n), circle, 90.0, 4.0), circle)) for n in (0.0, 1.5, 2.0, 3.0)}
    return [
        P.sentence(
            "error of a spring n times as stiff as the ideal one",
            "Eqs. 20, 22, 23",
            gap,
            lambda value: value < TINY,
            "%",
            note="largest difference from Eq. 23 over the circle, n from 0 to 3, ra1 from 1.5 to 9; shorter: "
            "e = (n - 1)(1 - a10/a1) cos th1",
        ),
        P.sentence(
            "a spring n times as stiff needs 1/n of the deformation",
            "Eq. 21",
            stretch,
            lambda value: abs(value - 0.5) < 1e-12,
            "",
            note="deformation over a10 at th1 = 0, n = 2",
        ),
        P.sentence(
            "n = 1 leaves no error",
            "Fig. 11",
            float(np.abs(error(1, ideal(1, 4.0), circle, 90.0, 4.0)).max()),
            lambda value: value < TINY,
            "%",
            note="ra1 = 4, whole circle",
        ),
        P.at_most(
            "error of a spring twice as stiff, ra1 = 4",
            "Fig. 11",
            "15",
            float(np.abs(twice).max()),
            "%",
            note=f"largest magnitude over the circle, at th1 = {abs(np.degrees(th1[worst])):.1f} deg and its mirror "
            f"image; {abs(float(eq_23(np.radians(60.0), 2.0, 4.0))):.2f} % at 60 deg, as a coarse grid shows, and "
            f"{below:.2f} % where th1 < 0",
        ),
        P.sentence(
            "the error is not symmetric over the circle but within (0, 180) and (0, -180) deg",
            "Fig. 11",
            float(np.abs(mirrored + twice).max()),
            lambda value: value < TINY,
            "%",
            correction="antisymmetric about +-90 deg: e(180 deg - th1) = -e(th1); its magnitude is symmetric",
            note="largest |e(180 deg - th1) + e(th1)|",
        ),
        P.sentence(
            "mean error over the rate",
            "Fig. 12",
            average[2.0],
            lambda value: all(abs(average[n] - abs(n - 1) * value) < 1e-6 for n in average),
            "%",
            note="at n = 2, ra1 = 4; |n - 1| (2 s / (pi ra1)) (s - ra1) with s = sqrt(1 + ra1^2): straight in |n - 1|; "
            "the constant force is n = 0. The figure's numbers are not in the text",
        ),
    ]
