"""Section 3.2.1, structure II: Scotch yokes, a cable with pulleys, and the adjustment to a payload."""

from __future__ import annotations

import math

import numpy as np

import equipoise as eq
from equipoise.affine import Array
from equipoise.claim import Claim, Source
from equipoise.papers.quaglia_yin_2015.robots import CRANK, JOINT, LARGEST, alone, pairs, second, worst, yoke

FORCES = tuple(moment / CRANK for moment in LARGEST)


def upper(force: float = FORCES[0], phase: float = math.pi) -> eq.Spring:
    """Link 1's yoke, at its own joint."""
    return yoke("yoke1", eq.Angle("link1_joint"), eq.Constant(force), phase)


def fore(force: float = FORCES[1], phase: float = math.pi) -> eq.Spring:
    """Link 2's yoke, on the lower pulley, which the cable keeps parallel to link 2."""
    return yoke("yoke2", eq.Absolute("link2"), eq.Constant(force), phase)


def poses() -> eq.Sweep:
    """Structure II over its workspace: joint angles th1 and th2 - th1."""
    th1, th2 = pairs(15, 12)
    return eq.Sweep(np.stack([th1, th2 - th1], axis=1), np.ones(len(th1)), "workspace")


def claims(P: Source) -> list[Claim]:
    """What the section says."""
    robot = second()
    here = robot.states(poses())
    everywhere = robot.states(eq.Sweep.sobol(robot, 512))
    one = alone(2).states(eq.Sweep.grid(alone(2), {"link_joint": (-math.pi, math.pi, 73)}))
    single = yoke("s", JOINT, eq.Constant(FORCES[1]))
    stored, angle = single.effort(one, "hold").b[:, 0], one.driven[:, 0]
    alone_1 = here.holding + upper().effort(here, "hold").b
    return [
        P.sentence(
            "a constant force on a cross mechanism balances one link, F1 b1 = m1 g r1",
            "Eq. 26, Fig. 22",
            worst(one, [single]),
            lambda value: value < 1e-8,
            "N m",
            note="largest holding torque over the circle, with link 2's data",
        ),
        P.sentence(
            "the spring's energy changes by dEe = F b cos th dth, as much as gravity's",
            "Eqs. 27, 31, 34, 36",
            np.abs(stored + LARGEST[1] * np.cos(angle)).max(),
            lambda value: value < 1e-8,
            "N m",
            correction="dEe = -F b cos th dth: what balances is d(Eg + Ee) = 0. As printed, both energies rise "
            "together and a motor would have to supply them; Fig. 1 and its text have it right",
            note="largest |dEe/dth + F b cos th|",
        ),
        P.sentence(
            "both yokes of structure II hold it at rest, F1 b1 = (m1 r1 + m2 l1) g and F2 b2 = m2 g r2",
            "Eqs. 30, 33",
            worst(everywhere, [upper(), fore()]),
            lambda value: value < 1e-8,
            "N m",
            note=f"largest torque of either motor, all joint angles; F1 = {FORCES[0]:g} N, F2 = {FORCES[1]:g} N",
        ),
        P.sentence(
            "link 1 balances by its own force alone, since C2M = 0",
            "Eq. 30",
            np.abs(alone_1[:, 0]).max(),
            lambda value: abs(value - LARGEST[1]) < 1e-6,
            "N m",
            correction="only while link 2 is balanced as well: C1M = -(e1 C1max + e2 C2max), C2M = -e2 C2max, so what "
            "link 2's spring leaves loads motor 1 too. In structure I the two do not mix",
            note="largest torque of motor 1 with link 2's spring off: all of C2max",
        ),
        P.sentence(
            "cable and pulleys turn the lower pulley as link 2 turns",
            "3.2.1, Fig. 24",
            _unequal(here.driven, 1.0),
            lambda value: value < 1e-8,
            "N m",
            correction="only with pulleys of equal radius, which the paper does not ask for",
            note=f"largest torque of either motor; {_unequal(here.driven, 0.9):.3g} N m where the upper pulley's "
            "radius is 0.9 of the lower one's",
        ),
        P.sentence(
            "structure I has a limited workspace, structure II a wider one",
            "4",
            worst(everywhere, [upper(), fore()]),
            lambda value: value < 1e-8,
            "N m",
            note="largest motor torque of structure II over all joint angles; structure I must keep phi between 0 and "
            "180 deg, where its parallelogram is flat, and the example keeps another 18 deg away",
        ),
        P.underspecified(
            "a motor at the elbow makes link 2 heavier",
            "4",
            None,
            note="its mass is not printed and stands in no equation; every kg at O2 adds l1 g = 11.76 N m to link 1's "
            "largest torque, 15 kg 16.7 % of it",
        ),
        _payload(P),
    ]


def _unequal(joints: Array, ratio: float) -> float:
    """Largest motor torque (N m) of structure II if the pulley on link 2 has `ratio` times the lower one's radius.

    The lower pulley stands at psi = th1 + ratio (th2 - th1), joints (N, 2) being th1 and th2 - th1.
    """
    robot = second()
    sweep = eq.Sweep(joints, np.ones(len(joints)), "workspace")
    here = robot.states(sweep)
    held = here.holding + upper().effort(here, "hold").b
    pull = LARGEST[1] * np.cos(joints[:, 0] + ratio * joints[:, 1])
    return float(np.abs(held - np.stack([pull, ratio * pull], axis=1)).max())


def _payload(P: Source) -> Claim:
    robot, load = second(), eq.Payload("link2", 10.0, (1.05, 0.0, 0.12))
    here = robot.states(eq.Sweep.sobol(robot, 512, payload=[load]))
    link1, link2 = eq.payload_rule(robot, load)
    forces, lead = [rule.force(CRANK) for rule in (link1, link2)], math.pi + link2.lead
    full, turned = [upper(forces[0]), fore(forces[1], lead)], [upper(), fore(phase=lead)]
    return P.sentence(
        "turning the crank on the lower pulley adapts the balancer to a payload",
        "3.2.1, Fig. 27",
        worst(here, full),
        lambda value: value < 1e-8,
        "N m",
        correction="the angle is one of three: the crank turns by the angle of the joint centre of gravity, F2 b2 "
        "becomes g |m2 r2 + mp (x + i y)|, and F1 b1 becomes g (m1 r1 + (m2 + mp) l1)",
        note=f"largest torque of either motor with all three, 10 kg at (1.05, 0.12) m: crank "
        f"{math.degrees(link2.lead):.4f} deg, F1 = {forces[0]:.6g} N, F2 = {forces[1]:.6g} N. By the crank alone "
        f"{worst(here, turned):.4g} N m is left, without any change {worst(here, [upper(), fore()]):.4g} N m",
    )
