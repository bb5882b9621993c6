"""Section 3.2.2: pneumatic and hydro-pneumatic springs, on yokes and on pivots."""

from __future__ import annotations

import functools
import math
from dataclasses import replace
from typing import Any

import numpy as np

import equipoise as eq
from equipoise.affine import Array
from equipoise.claim import Claim, Source
from equipoise.papers.quaglia_yin_2015.robots import CRANK, JOINT, LARGEST, along, left, mean, pivoted, yoke

BAR = 1e5
AMBIENT = 101325.0
ADIABATIC = 1.4
NITROGEN = eq.Nitrogen(at=168.45 * BAR + AMBIENT)
FORCE = LARGEST[0] / CRANK
STROKE = 2 * CRANK


def on_yoke(ratio: float, exponent: Any, gauge: float, ambient: float = AMBIENT) -> eq.Gas:
    """Link 1's gas spring on its yoke: `ratio` of auxiliary to swept volume, charged to `gauge` Pa at mid-stroke."""
    area = FORCE / gauge
    volume = area * STROKE * (ratio + 0.5)
    return eq.Gas(area, volume, 0.0, gauge, exponent, "push", "gauge", ambient)


def yoke_error(gas: eq.Gas, sweep: eq.Sweep | None = None) -> Array:
    """Error (N,), percent, over (-90, 90) deg."""
    return left(1, yoke("s", JOINT, gas, phase=0.0), sweep or along())


def strut(eta: float, exponent: Any, gauge: float = 168.0 * BAR, ra: float = 6.0) -> eq.Gas:
    """A pulling strut from pin to pivot at alpha5 = 90 deg; eta is its gas volume over A a10 where link 1 is level."""
    length = CRANK * math.hypot(1.0, ra)
    area = LARGEST[0] * length / (ra * CRANK**2) / gauge
    return eq.Gas(area, eta * area * length, length, gauge, exponent, "pull", "gauge")


def strut_error(gas: eq.Gas, ra: float = 6.0) -> Array:
    """Error (N,), percent, of the strut on the pivot over (-90, 90) deg."""
    return left(1, pivoted("s", JOINT, gas, 90.0, ra), along())


@functools.cache
def needed(target: float, exponent: float, gauge: float, ambient: float = AMBIENT) -> float:
    """The least ratio of auxiliary to swept volume that brings the mean error on the yoke down to `target` percent."""
    from scipy.optimize import brentq

    def above(ratio: float) -> float:
        return float(mean(yoke_error(on_yoke(ratio, exponent, gauge, ambient)), along())) - target

    root: Any = brentq(above, 0.6, 400.0, xtol=1e-6)
    return root


def claims(P: Source) -> list[Claim]:
    """What the section says, and what sections 3.1.1 and 4 say of gas springs."""
    sweep = along()
    sizes = {ratio: mean(yoke_error(on_yoke(ratio, ADIABATIC, 7 * BAR)), sweep) for ratio in (2.0, 5.0, 10.0, 50.0)}
    return [
        P.sentence(
            "with a big auxiliary volume a pneumatic spring gives an almost constant force",
            "3.1.1, 3.2.2",
            sizes[50.0],
            lambda value: value < 1 and list(sizes.values()) == sorted(sizes.values(), reverse=True),
            "%",
            note="mean error on link 1's yoke, auxiliary volume 50 times the swept one, quick motion, 7 bar gauge; "
            + ", ".join(f"{ratio:g} times: {value:.3f} %" for ratio, value in list(sizes.items())[:-1]),
        ),
        *_equations(P),
        *_sizes(P),
        P.sentence(
            "structure I, too, is approximately balanced by pneumatic springs of constant force",
            "4",
            mean(strut_error(strut(1e9, ADIABATIC)), sweep),
            lambda value: value < 6,
            "%",
            correction="approximately; but on a pivot a big volume is the worst choice: the rate of a strut's gas "
            "should be F/a10, so its volume near n A a10 P/(P - Pa)",
            note=f"mean error at alpha5 = 90 deg, ra1 = 6 with an infinite volume; "
            f"{mean(strut_error(strut(1.4, ADIABATIC)), sweep):.4f} % with V = 1.4 A a10 at 168 bar gauge",
        ),
    ]


def _equations(P: Source) -> list[Claim]:
    sweep, gauge = along(), 6.738 * BAR
    ratio = needed(2.8, ADIABATIC, gauge)
    quick, slow = (on_yoke(ratio, n, gauge) for n in (ADIABATIC, 1.0))
    length = CRANK * np.linspace(-1, 1, 201)
    volume, pressure = quick.gas_volume(length), quick.pressures(length, {})
    filled = (volume - on_yoke(ratio, 1.0, gauge).area * STROKE * ratio) / quick.area
    vacuum = mean(yoke_error(on_yoke(ratio, ADIABATIC, gauge, 0.0)), sweep)
    felt = mean(yoke_error(quick), sweep)
    bias = 0.5 / ratio
    return [
        P.sentence(
            "in adiabatic condition P1 V1 = P0 V0",
            "Eq. 37",
            np.ptp(pressure * volume**ADIABATIC) / (pressure * volume**ADIABATIC).mean(),
            lambda spread: spread < 1e-9,
            "",
            correction="P V^n is constant with n = 1.4; P V = const is the isothermal, slow limit",
            note=f"relative spread of P V^1.4 over the stroke. Auxiliary volume {ratio:.3f} times the swept one, 6.738 "
            f"bar gauge: mean error {felt:.3f} % quickly, {mean(yoke_error(slow), sweep):.3f} % slowly",
        ),
        P.sentence(
            "V1 = Vaux + x1 A1",
            "Eq. 37",
            np.abs(filled - (length + CRANK)).max(),
            lambda gap: gap < 1e-12,
            "m",
            note="largest difference of (V1 - Vaux)/A1 from the piston's place x1, counted from full compression",
        ),
        P.sentence(
            "F1 = P1 A1",
            "Eq. 38",
            felt / vacuum,
            lambda factor: factor > 1,
            "",
            correction="F1 = (P1 - Pa) A1: the ambient pressure pushes back, so the error grows by P0/(P0 - Pa)",
            note="ratio of the mean errors with and without ambient pressure, 6.738 bar gauge; "
            f"{1 + AMBIENT / (168.45 * BAR):.4f} at 168.45 bar gauge",
        ),
        P.sentence(
            "F1 is about P0 V0 A1 / Vaux",
            "Eq. 38",
            100 * bias,
            lambda value: value > 1,
            "%",
            correction="about P0 A1 where P0 is the pressure at mid-stroke; dividing V0 by Vaux instead adds half the "
            "swept volume over the auxiliary one",
            note=f"by which P0 V0 A1/Vaux is too big at Vaux = {ratio:.3f} times the swept volume",
        ),
        P.underspecified(
            "friction is negligible",
            "3.2.2",
            None,
            note="no coefficient is printed. A sliding block in the cross costs mu F b |sin th|, on average 2 mu/pi of "
            "the largest torque: 6.4 % at mu = 0.1, more than the 2.8 % of the pivot that the cross replaces",
        ),
    ]


def _sizes(P: Source) -> list[Claim]:
    air, oil = 6.738 * BAR, 168.45 * BAR
    bottles = [on_yoke(needed(2.8, ADIABATIC, gauge), ADIABATIC, gauge) for gauge in (air, oil)]
    swept = [1e3 * gas.area * STROKE for gas in bottles]
    stiff = float(NITROGEN.exponents(293.15)[0])
    real = mean(yoke_error(replace(bottles[1], exponent=NITROGEN)), along())
    at_200 = on_yoke(needed(2.8, ADIABATIC, 200 * BAR), ADIABATIC, 200 * BAR)
    top = float(at_200.pressures(np.array([-CRANK]), {})[0] - AMBIENT) / BAR
    reach = float(bottles[1].pressures(np.array([-CRANK]), {})[0] - AMBIENT) / BAR
    return [
        P.sentence(
            "a hydro-pneumatic spring gives the same force in a more compact structure",
            "3.2.2",
            bottles[0].volume / bottles[1].volume,
            lambda factor: factor > 1,
            "",
            note=f"gas volumes for link 1 and a mean error of 2.8 %: {1e3 * bottles[0].volume:.2f} l at 6.738 bar "
            f"gauge (bore 100 mm), {1e3 * bottles[1].volume:.4f} l at 168.45 bar (ram 20 mm), of which the cylinders "
            f"sweep {swept[0]:.2f} and {swept[1]:.3f} l. Bore and crank do not matter: V0 is about pi0 n C1max / (pi e "
            f"(P0 - Pa)). As a real gas nitrogen has n = {stiff:.3f} at 168 bar: {real:.3f} % quickly with the same "
            "bottle",
        ),
        P.underspecified(
            "pressure that the spring can supply",
            "3.2.2",
            "200",
            "bar",
            note=f"neither force, bore nor volume are printed. F1 = {FORCE:g} N needs {1e4 * at_200.area:.4g} cm2 at "
            f"200 bar gauge; sized for 2.8 % that spring reaches {top:.1f} bar when compressed, a ram of 20 mm "
            f"{reach:.1f} bar",
        ),
        P.underspecified(
            "it can be charged and discharged at a high frequency",
            "3.2.2",
            None,
            note="no frequency, valve or line is given. Heat flow between slow and quick motion costs at most "
            "pi P0 V0 kappa^2 (n - 1)/2 per cycle, kappa = A b/V0: 2 % of the energy that goes to and fro",
        ),
    ]
