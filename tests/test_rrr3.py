"""The planar 3-RRR: reference series, what balances it, and drivers that cannot work."""

from __future__ import annotations

import math

import numpy as np
import pytest

import equipoise as eq
from equipoise.assemble import effort

L, SIDE = 0.18, 0.1
HEIGHT = SIDE * math.sqrt(3) / 2
BASES = ((0.0, 0.0), (0.46, 0.0), (0.23, 0.23 * math.sqrt(3)))
PINS = ((-SIDE / 2, -HEIGHT / 3), (SIDE / 2, -HEIGHT / 3), (0.0, 2 * HEIGHT / 3))
START = (0.23, HEIGHT / 3, 0.0)
T = 0.3


def manipulator(mass=0.5, com=0.09, inertia=0.00135, rod=None, **options):
    rod = rod or (mass, com, inertia)
    return eq.rrr3(
        BASES,
        PINS,
        (L,) * 3,
        (L,) * 3,
        pose=START,
        crank_masses=(mass,) * 3,
        crank_coms=((com, 0.0),) * 3,
        crank_inertias=(inertia,) * 3,
        rod_masses=(rod[0],) * 3,
        rod_coms=((rod[1], 0.0),) * 3,
        rod_inertias=(rod[2],) * 3,
        platform_mass=3.0,
        platform_inertia=options.get("platform_inertia", 0.01),
        gravity=(0, 0, 0),
    )


def motion(mechanism, a=(1 / 3, 4 / 3, 5 / 3), b=(1 / 6, -1 / 6, -1 / 12), **options):
    drivers = {
        f"crank_{i + 1}_joint": f"{a[i]!r}*pi + {b[i]!r}*(2*pi*t/T - sin(2*pi*t/T))" for i in range(3)
    }  # fmt: skip
    return eq.Sweep.motion(mechanism, drivers, duration=T, **{"samples": 601, **options})


# t: psi_1..3, x, y, phi, phi', phi'', F_x, F_y, M, tau_1..3 of uniform links of 0.5 kg (computed independently)
SERIES = {
    0.05: (-1.0612422, 2.1090855, -2.1243384, 0.22303959, 0.03029092, 0.0005181, 0.062397, 6.29633,
           -63.7550, 17.6527, 6.50327, 5.82881, -4.66480, -7.08064),
    0.15: (-0.9906115, 2.2172344, -2.5598007, 0.14018876, 0.06957608, 0.2447072, 5.93073, 16.7019,
           31.9480, 4.72839, 0.0746410, -2.36454, -2.14283, 4.60772),
    0.25: (-0.5518154, 2.3705425, -2.8342177, 0.09339145, 0.11603534, 0.5924208, 0.679281, -30.1728,
           29.6605, -21.8788, -7.69057, -1.43637, 3.35405, 0.466787),
}  # fmt: skip


@pytest.fixture(scope="module")
def bare():
    mechanism = manipulator()
    return mechanism, mechanism.states(motion(mechanism))


@pytest.mark.parametrize("instant", SERIES)
def test_reference_series(bare, instant):
    mechanism, states = bare
    row = round(instant / T * 600)
    q = dict(zip(mechanism.joints, states.kin.q[row], strict=True))
    turn = mechanism.joint_id("platform_turn")
    psi = [q[f"crank_{i}_joint"] + q[f"rod_{i}_joint"] for i in (1, 2, 3)]
    want = SERIES[instant]
    wrapped = np.angle(np.exp(1j * (np.array(psi) - want[:3])))
    np.testing.assert_allclose(wrapped, 0.0, atol=6e-8)
    np.testing.assert_allclose([q["platform_x"], q["platform_z"], q["platform_turn"]], want[3:6], atol=6e-8)
    rates = states.rates
    np.testing.assert_allclose([rates.velocity[row, turn], rates.acceleration[row, turn]], want[6:8], rtol=3e-5)
    force, moment = (effort(mechanism, (), states, goal).b[row] for goal in ("force", "moment"))
    drive = effort(mechanism, (), states, "drive").b[row]
    np.testing.assert_allclose([force[0], force[2], -moment[1], *drive], want[8:], rtol=2e-5)


def test_platform_measure_of_the_regular_drivers(bare):
    _, states = bare
    assert eq.platform_measure(states).min() == pytest.approx(0.628, abs=1e-3)


def test_rows_over_the_motion(bare):
    mechanism, _ = bare
    rows = eq.analyze(mechanism, motion(mechanism)).rows
    assert rows["force"].peak == pytest.approx(70.298, abs=2e-3)
    assert rows["moment"].peak == pytest.approx(10.691, abs=1e-3)
    assert rows["force"].rms == pytest.approx(43.76, abs=0.01)
    assert rows["moment"].rms == pytest.approx(7.141, abs=1e-3)


def test_printed_drivers_start_singular_or_open():
    """With a3 = 10/3 the third leg and the second line up at t = 0; with b3 > 0 the loop opens later."""
    mechanism = manipulator()
    with pytest.raises(eq.LoopError, match=r"t = 0 s"):
        mechanism.states(motion(mechanism, a=(1 / 3, 4 / 3, 10 / 3), b=(1 / 6, -1 / 6, 1 / 12)))
    with pytest.raises(eq.LoopError, match=r"the motion stops at t = 0\.20"):
        mechanism.states(motion(mechanism, b=(1 / 6, -1 / 6, 1 / 12)))


EXACT_ROD = (2.6, -0.18 / 2.6, 0.017)


def test_counter_rotations_make_it_reactionless():
    mechanism = manipulator(7.2, -0.09, 0.02, rod=EXACT_ROD)
    rotors = []
    for leg in (1, 2, 3):
        rotors.append(
            eq.CounterRotor(f"g4_{leg}", f"rod_{leg}", gear_inertia=0.00586, like="g4_1" if leg > 1 else None)
        )
        rotors.append(
            eq.CounterRotor(f"g5_{leg}", f"crank_{leg}", gear_inertia=0.00504, like="g5_1" if leg > 1 else None)
        )
    design = eq.balance(mechanism, rotors, motion(mechanism), objective=eq.Aim("moment"))
    assert design.values["g4_1.J"] == pytest.approx(0.06772154, rel=1e-6)
    assert design.values["g5_1.J"] == pytest.approx(0.2, rel=1e-6)
    assert design.after["force"].peak < 1e-10
    assert design.after["moment"].peak < 1e-10
    assert design.certificate.kind == "exact"
    torques = [design.after[f"crank_{i}_joint"].peak for i in (1, 2, 3)]
    np.testing.assert_allclose(torques, [37.9, 40.0, 19.0], atol=0.06)


def test_flywheel_law_of_the_force_balanced_manipulator():
    mechanism = manipulator(7.2, -0.09, 0.02, rod=EXACT_ROD, platform_inertia=0.015)
    wheel = eq.Flywheel("wheel", inertia=0.01)
    sweep = motion(mechanism, samples=2401)
    design = eq.balance(mechanism, [wheel], sweep, objective=eq.Aim("force"))
    law = design.flywheel_law(wheel)
    rows = [round(t / T * 2400) for t in SERIES]
    np.testing.assert_allclose(law.acceleration[rows], [947.447, -794.918, -147.665], rtol=4e-6)
    np.testing.assert_allclose(law.speed[rows], [27.1453, 65.5787, 2.75121], rtol=3e-6)
    np.testing.assert_allclose(law.angle[rows], [0.475325, 6.75080, 9.42138], rtol=2e-6)
    assert law.angle[-1] == pytest.approx(9.46175, abs=5e-6)
    # the momentum is a total derivative, so the angle follows from the postures alone
    change = dict(zip(mechanism.joints, design.states.kin.q[-1] - design.states.kin.q[0], strict=True))
    cranks = sum(change[f"crank_{i}_joint"] for i in (1, 2, 3))
    rods = cranks + sum(change[f"rod_{i}_joint"] for i in (1, 2, 3))
    closed = 0.19496 * cranks + (0.017 + 0.18**2 / 2.6 + 0.18**2) * rods + 0.005 * change["platform_turn"]
    assert law.angle[-1] == pytest.approx(-closed / 0.01, abs=1e-10)
    assert np.abs(law.speed).max() == pytest.approx(78.0389, abs=1e-3)


def test_a_pose_out_of_reach_is_named():
    with pytest.raises(eq.InputError, match="leg 1 does not reach its pin"):
        eq.rrr3(BASES, PINS, (L,) * 3, (L,) * 3, pose=(0.6, 0.1, 0.0))
