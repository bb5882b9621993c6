"""What the manipulator of Arakelian & Smith 2008 can do with other parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import equipoise as eq
from equipoise.papers.arakelian_smith_2008 import model
from equipoise.papers.arakelian_smith_2008.model import COUNTER_ROTATED, EXACT, LEGS, SLENDER, WHEEL, L, thrice
from equipoise.papers.paper import Improvement
from equipoise.tasks import settle, task_of

OVER = "the regular drivers, 0.3 s"
REACH = {"crank": 0.103433, "rod": 0.108095}
ADDED = 3 * (6.7 + 2.1)
"""What bars of 0.5 kg lack of Table 1's masses, kg."""
RATIO = 4.0


def improved() -> Sequence[Improvement]:
    """Mass for moment, gears of another ratio, a flywheel for a given motor."""
    return [_weights(), _gears(), _wheel()]


def _weights() -> Improvement:
    """Force balance for all motions with the least moment that the published mass allows."""
    mechanism = eq.rrr3(
        model.PIVOTS, model.PINS, thrice(L), thrice(L), pose=model.START, gravity=(0, 0, 0),
        crank_masses=thrice(SLENDER.crank[0]), rod_masses=thrice(SLENDER.rod[0]),
        platform_mass=model.PLATFORM, platform_inertia=SLENDER.platform,
    )  # fmt: skip
    weights = [
        eq.Counterweight(f"{kind}_{i}", eq.Point(f"{kind}_{i}"), reach=REACH[kind], shape=eq.Plate())
        for kind in REACH
        for i in LEGS
    ]
    aims = [eq.Aim("moment"), eq.Aim("mass", cap=ADDED)]
    task = task_of(mechanism, weights, model.sweep(samples=61), None, aims, [eq.Balanced("force")])
    solved = settle(task)
    gap = solved.solution.gap
    return Improvement(
        what="place, mass and inertia of six flat counterweights within the radii 103.4 and 108.1 mm, of the published "
        "mass, the force balanced for all motions",
        over=OVER,
        norm="rms",
        published=float(np.sqrt(np.mean(model.base(EXACT)[1] ** 2))),
        ours=gap.primal,
        unit="N m",
        values={"mass": f"{ADDED:g} kg in all", "rod_1": f"{solved.values['rod_1.m']:.3f} kg"},
        certificate="convex",
        note="moment left; the legs need not be balanced one by one. 30 kg would bring it to 2.58 N m",
    )


def _gears() -> Improvement:
    """The same balance with gears that turn faster."""
    inertias = [value / RATIO for value in COUNTER_ROTATED.gears]
    moment = model.base(replace(COUNTER_ROTATED, gears=(0.0, 0.0)))[1]
    for rotor in model.rotors(COUNTER_ROTATED):
        fast = replace(rotor, ratio=RATIO, inertia=(rotor.inertia or 0.0) / RATIO)
        moment = moment + fast.effort(model.states(), "moment").b @ model.NORMAL
    return Improvement(
        what="ratio of the gears",
        over=OVER,
        norm="peak",
        published=sum(COUNTER_ROTATED.gears) * 3,
        ours=sum(inertias) * 3,
        unit="kg m^2",
        values={"I4": f"{inertias[0]:.5f} kg m^2", "I5": f"{inertias[1]:.3f} kg m^2", "ratio": f"{RATIO:g}"},
        certificate="exact",
        note=f"inertia of the six gears; moment left {model.largest(moment):.1g} N m; the drives carry "
        f"{1 + RATIO:g} times the links' inertia instead of 2",
    )


def _wheel() -> Improvement:
    """The smallest flywheel for a motor of 3000 rpm and 200 W."""
    moment, spin = model.base(WHEEL)[1], model.held(WHEEL)[1]
    wheel = eq.Flywheel("wheel", speed=3000 * np.pi / 30, power=200.0)
    law = wheel.law(model.time(), np.outer(moment, model.NORMAL), np.outer(spin, model.NORMAL))
    return Improvement(
        what="inertia of the flywheel for a motor of 3000 rpm and 200 W",
        over=OVER,
        norm="peak",
        published=model.largest(model.law().power),
        ours=model.largest(law.power),
        unit="W",
        values={"I*": f"{law.inertia:.5f} kg m^2", "speed": f"{model.largest(law.speed):.1f} rad/s"},
        certificate="exact",
        note="power of the flywheel's motor; its torque is the moment itself, whatever the inertia",
    )
