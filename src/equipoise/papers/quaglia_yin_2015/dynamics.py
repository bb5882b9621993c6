"""The equations of motion that the paper starts from (Eqs. 1, 25, 29, 32), against MuJoCo's inverse dynamics."""

from __future__ import annotations

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.claim import Claim, Source
from equipoise.papers.quaglia_yin_2015.robots import CENTRES, LARGEST, LENGTHS, MASSES, alone, second

ABOUT_JOINTS = tuple(mass * length**2 / 3 for mass, length in zip(MASSES, LENGTHS, strict=True))
"""I1 and I2 about O1 and O2, kg m^2; the paper prints none, slender rods serve as well as any."""
COUPLING = MASSES[1] * CENTRES[1] * LENGTHS[0]
STATES = 64


def claims(P: Source) -> list[Claim]:
    """What the free body diagrams give, at random states of motion."""
    q, v, a = np.random.default_rng(0).uniform(-2, 2, (3, STATES, 2))
    th, w, wd = (np.cumsum(x, axis=1).T for x in (q, v, a))
    motors, parts = _inverse(second().model, q, v, a)
    single, _ = _inverse(alone(2).model, q[:, :1], v[:, :1], a[:, :1])
    one = ABOUT_JOINTS[1] * a[:, 0] + LARGEST[1] * np.cos(q[:, 0])
    c1, c2 = motors.T
    own = (ABOUT_JOINTS[0] + MASSES[1] * LENGTHS[0] ** 2) * wd[0] + LARGEST[0] * np.cos(th[0])
    turn = COUPLING * np.sin(th[0] - th[1]) * w[1] ** 2
    left = c1 - c2 - turn - own
    fore = c2 - LARGEST[1] * np.cos(th[1]) - ABOUT_JOINTS[1] * wd[1]
    moved = COUPLING * (np.cos(th[0] - th[1]) * wd[0] - np.sin(th[0] - th[1]) * w[0] ** 2)
    sway = COUPLING * np.cos(th[0] - th[1])
    return [
        P.sentence(
            "the motors' torques are I(th) th'' + q(th, th') + G(th)",
            "Eqs. 1, 2",
            np.abs(motors - parts).max(),
            lambda gap: gap < 1e-8,
            "N m",
            note=f"largest difference from MuJoCo's inverse dynamics of structure II over {STATES} random motions; a "
            "balancer that supplies G leaves the other two terms",
        ),
        P.sentence(
            "one link: F1 b1 cos th1 + C1M = m1 g r1 cos th1 + I1 th1''",
            "Eqs. 25, 26",
            np.abs(single[:, 0] - one).max(),
            lambda gap: gap < 1e-8,
            "N m",
            note="largest difference from MuJoCo's inverse dynamics, I1 about O1",
        ),
        P.sentence(
            "link 1 of two: F1 b1 cos th1 + C1M - C2M - m2 r2 l1 (sin(th1 - th2) th2'^2 + cos(th1 - th2) th2') = "
            "(m1 r1 + m2 l1) g cos th1 + (I1 + m2 l1^2) th1''",
            "Eq. 29",
            np.abs(left - sway * wd[1]).max(),
            lambda gap: gap < 1e-8,
            "N m",
            correction="the last term on the left needs th2'', not th2'",
            note=f"largest difference; {np.abs(left - sway * w[1]).max():.4g} N m with th2' as it stands in the "
            "manuscript's text. I1 about O1; at rest Eq. 30 follows only where C2M = 0",
        ),
        P.sentence(
            "link 2: F2 b2 cos th2 + C2M = m2 g r2 cos th2 + I2 th2''",
            "Eq. 32",
            np.abs(fore - moved).max(),
            lambda gap: gap < 1e-8,
            "N m",
            correction="the right side lacks m2 r2 l1 (cos(th1 - th2) th1'' - sin(th1 - th2) th1'^2), by which link 1 "
            "carries link 2 along; at rest, Eq. 33, it makes no difference",
            note=f"largest difference; {np.abs(fore).max():.4g} N m as printed",
        ),
    ]


def _inverse(model: mujoco.MjModel, q: Array, v: Array, a: Array) -> tuple[Array, Array]:
    """Joint torques (N, nv) of MuJoCo's inverse dynamics, and M a + bias from its mass matrix."""
    data = mujoco.MjData(model)
    mass = np.zeros((model.nv, model.nv))
    torques, sums = np.empty_like(q), np.empty_like(q)
    for i in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[i], v[i], a[i]
        mujoco.mj_inverse(model, data)
        torques[i] = data.qfrc_inverse
        mujoco.mj_fullM(model, data, mass)
        sums[i] = mass @ a[i] + data.qfrc_bias
    return torques, sums
