"""Sections 2 and 3.1.1: what gravity asks for, and how springs can answer."""

from __future__ import annotations

import math

import numpy as np

import equipoise as eq
from equipoise.claim import Claim, Source
from equipoise.papers.quaglia_yin_2015.robots import (
    CENTRES,
    CRANK,
    GRAVITY,
    JOINT,
    LARGEST,
    LENGTHS,
    MASSES,
    along,
    both,
    constant_force,
    first,
    ideal,
    mean,
    pairs,
    pivoted,
    second,
    states,
    workspace,
    worst,
    yoke,
)

DRIVEN = ("arm_joint", "crank_joint")
S1, S2 = (moment / 9.8 for moment in LARGEST)


def claims(P: Source) -> list[Claim]:
    """What the two sections say."""
    return [*_gravity(P), *_guides(P)]


def _gravity(P: Source) -> list[Claim]:
    robot = first()
    here = robot.states(both(*pairs(15, 12)))
    t1, t2 = here.driven.T
    eg = 9.8 * (100 * 0.6 * np.sin(t1) + 40 * (0.5 * np.sin(t2) + 1.2 * np.sin(t1)))
    torque = np.stack([LARGEST[0] * np.cos(t1), LARGEST[1] * np.cos(t2)], axis=1)
    springs = [pivoted(joint, eq.Angle(joint), ideal(i + 1)) for i, joint in enumerate(DRIVEN)]
    stored = sum(spring.effort(here, "energy").b[:, 0] for spring in springs)
    moves = workspace()
    falls = moves.weight[np.cos(moves.poses[:, 0]) > 0].sum() / moves.weight.sum()
    return [
        P.sentence(
            "gravity's energy is Eg = m1 g r1 sin th1 + m2 g (r2 sin th2 + l1 sin th1)",
            "Eq. 3",
            np.ptp(here.potential - eg),
            lambda spread: spread < 1e-9,
            "J",
            note="spread of the difference from the robot's energy over the workspace",
        ),
        P.sentence(
            "its slopes are (m1 r1 + m2 l1) g cos th1 and m2 r2 g cos th2",
            "Eqs. 4, 5",
            np.abs(here.holding - torque).max(),
            lambda gap: gap < 1e-8,
            "N m",
            note="largest difference from the holding torques of the robot with its parallelogram",
        ),
        P.sentence(
            "where th1 or th2 decreases, gravity's energy goes into the springs, and back",
            "2.1, Fig. 1",
            100 * falls,
            lambda share: 0 < share < 100,
            "%",
            correction="true where cos th > 0; elsewhere it is the other way round, and only the sum of both energies "
            "stays",
            note="share of link 2's workspace in which its weight falls as th2 decreases",
        ),
        P.sentence(
            "a proper design balances the robot perfectly in all configurations",
            "abstract, 4",
            worst(here, springs),
            lambda value: value < 1e-8,
            "N m",
            note=f"largest holding torque with both ideal springs of structure I; the energy of weights and springs "
            f"spreads by {np.ptp(here.potential + stored):.1g} J over the workspace",
        ),
        P.sentence(
            "the masses of links 3 and 4 are left out",
            "3",
            _heavy_linkage(),
            lambda value: value < 1e-8,
            "N m",
            correction="nothing has to be left out: with 3 and 4 kg in links 3 and 4, S1 = m1 r1 + m2 l1 + m4 l1/2 and "
            "S2 = m2 r2 - m3 l3/2 - m4 l3 in place of the paper's sums balance exactly",
            note="largest holding torque with ideal springs, link 3 0.4 m behind the pivot",
        ),
        P.sentence(
            "a third joint about the vertical needs no balancing",
            "4",
            _turret(),
            lambda value: value < 1e-8,
            "N m",
            note="largest torque about the vertical, and change of the other two torques, over 256 poses of structure "
            "II on a turntable",
        ),
    ]


def _guides(P: Source) -> list[Claim]:
    """Figs. 4 to 9: a spring on a prismatic guide, which a Scotch yoke is; then a pivot in its place."""
    sweep = along()
    leads = (0.0, 30.0, 90.0, 200.0)
    turned = max(_with_guide(sweep, eq.Constant(LARGEST[0] / CRANK), lead) for lead in leads)
    soft = {share: _with_guide(sweep, _soft(share)) for share in (0.1, 0.01)}
    pivot = mean(constant_force(1, sweep, 90.0), sweep)
    return [
        P.sentence(
            "constant forces on prismatic guides balance perfectly, F1 b1 = (m1 r1 + m2 l1) g, F2 b2 = m2 r2 g",
            "Eq. 6, Fig. 5",
            _guided(),
            lambda value: value < 1e-8,
            "N m",
            note=f"largest holding torque of structure I over its workspace; F1 = {LARGEST[0] / CRANK:g} N, "
            f"F2 = {LARGEST[1] / CRANK:g} N",
        ),
        P.sentence(
            "the angle delta by which spring and crank are shifted together is arbitrary",
            "3.1.1, Fig. 6",
            turned,
            lambda value: value < 1e-9,
            "%",
            note="largest error for delta = 0, 30, 90 and 200 deg",
        ),
        P.sentence(
            "a mechanical spring of low rate approximates the constant force",
            "3.1.1",
            soft[0.01],
            lambda value: value < 1 and abs(soft[0.1] / value - 10) < 1e-6,
            "%",
            note="largest error on the guide where the force changes by 1 % over the crank's radius, k b = 0.01 F; it "
            "is 50 k b/F %. On a revolute pivot the ideal rate is F/a10, not 0",
        ),
        P.sentence(
            "a revolute pivot in place of the guide brings an error",
            "3.1.1, Fig. 9",
            pivot,
            lambda value: value > 1,
            "%",
            note="mean error of the constant force at alpha5 = 90 deg, ra1 = 6; 0 on the guide",
        ),
    ]


def _heavy_linkage() -> float:
    crank, masses = -0.4, (3.0, 4.0)
    robot = first(masses)
    s1 = S1 + masses[1] * 0.6
    s2 = S2 + masses[0] * crank / 2 + masses[1] * crank
    here = robot.states(both(*pairs(30, 24)))
    rates = [9.8 * s / (6 * CRANK**2) for s in (s1, s2)]
    laws = zip(DRIVEN, rates, strict=True)
    return worst(here, [pivoted(joint, eq.Angle(joint), eq.ZeroFreeLength(k=k)) for joint, k in laws])


def _turret() -> float:
    """Structure II on a turntable: the turntable's own torque, and what it changes of the others', N m."""
    links = [
        eq.Link("turntable", 0.3, 60.0, com=(0.05, 0.2), axis=(0, 0, 1)),
        eq.Link("link1", LENGTHS[0], MASSES[0], com=CENTRES[0], at=(0.1, 0.4)),
        eq.Link("link2", LENGTHS[1], MASSES[1], com=CENTRES[1]),
    ]
    robot = eq.chain(links, gravity=GRAVITY)
    over = eq.Sweep.sobol(robot, 256)
    without = second().states(eq.Sweep(over.poses[:, 1:], over.weight, "the same without turntable")).holding
    held = robot.states(over).holding
    return float(np.abs(held - np.concatenate([np.zeros((len(without), 1)), without], axis=1)).max())


def _guided() -> float:
    here = first().states(both(*pairs(15, 12)))
    forces = [moment / CRANK for moment in LARGEST]
    inputs = [eq.Angle("arm_joint"), eq.Angle("crank_joint")]
    return worst(
        here, [yoke(f"yoke{i}", a, eq.Constant(f)) for i, (a, f) in enumerate(zip(inputs, forces, strict=True))]
    )


def _soft(share: float) -> eq.Linear:
    """A straight force line through the right force at mid-stroke; the force changes by `share` over one radius."""
    force = LARGEST[0] / CRANK
    return eq.Linear(k=share * force / CRANK, preload=force)


def _with_guide(sweep: eq.Sweep, law: object, lead: float = 0.0) -> float:
    """Largest error, percent, of a spring on a guide of link 1 that is turned by `lead` deg together with its crank."""
    here = states(1, sweep)
    turned = math.radians(lead)
    mount = eq.Mount(eq.Point("world"), direction=(math.cos(turned), 0.0, math.sin(turned)))
    spring = yoke("s", JOINT, law, mount=mount)
    return 100 * worst(here, [spring]) / LARGEST[0]
