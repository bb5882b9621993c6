"""Shaking force and moment, drive torque and their balancing: reference figures of a four-bar."""

from __future__ import annotations

import numpy as np
import pytest

import equipoise as eq
from equipoise.assemble import effort

T = 0.12  # 500 rpm
RATIO = "before"


@pytest.fixture(scope="module")
def bar():
    return eq.four_bar(0.14, 0.05, 0.15, 0.125, masses=(0.1, 0.3, 0.25), gravity=(0, 0, 0))


@pytest.fixture(scope="module")
def turn(bar):
    return eq.Sweep.motion(bar, {"crank_joint": "2*pi*t/T"}, duration=T)


# th2 deg: f3, f4, f3'', f4'', Fx, Fy, M, tau of uniform bars of 2 kg/m (Berkof-Lowen; computed independently)
TABLE = {
    0: (0.9828785, 1.6252677, -129.184, 1579.208, -80.0367, -31.9991, 1.42298, -3.27937),
    60: (0.5720475, 1.4817254, 962.035, 1252.562, -57.0445, -24.9577, 3.31423, 1.25112),
    120: (0.5345953, 1.8623390, 520.813, -81.8704, 21.0033, -38.2620, -2.91712, -0.169279),
    180: (0.7167460, 2.2335161, 414.902, -610.108, 47.9641, 7.75869, -1.60490, -0.708189),
    240: (1.0478846, 2.3756283, -150.409, -753.092, 31.6539, 42.4001, 0.0356137, 0.0556356),
    300: (1.2922751, 2.2019530, -1530.827, -1240.299, 28.0932, 38.8040, -0.691147, 1.72535),
}


@pytest.mark.parametrize("angle", TABLE)
def test_four_bar_reference_table(bar, turn, angle):
    states = bar.states(turn)
    row = 2 * angle
    q, qacc = states.kin.q[row], states.rates.acceleration[row]
    force, moment = (effort(bar, (), states, goal).b[row] for goal in ("force", "moment"))
    drive = effort(bar, (), states, "drive").b[row, 0]
    ours = (q[0] + q[1], q[2], qacc[0] + qacc[1], qacc[2], force[0], force[2], -moment[1], drive)
    np.testing.assert_allclose(np.mod(ours[:2], 2 * np.pi), TABLE[angle][:2], atol=6e-8)
    np.testing.assert_allclose(ours[2:], TABLE[angle][2:], rtol=4e-6)


def test_analysis_of_a_motion(bar, turn):
    rows = eq.analyze(bar, turn).rows
    assert rows["force"].rms == pytest.approx(58.9447, rel=1e-6)
    assert rows["moment"].rms == pytest.approx(3.21359, rel=1e-6)
    assert rows["crank_joint"].rms == pytest.approx(1.22396, rel=1e-6)
    assert rows["force"].sample_peak == pytest.approx(113.073, rel=1e-5)
    assert rows["force"].peak >= rows["force"].sample_peak


def plates():
    return [
        eq.Counterweight("c2", eq.Point("crank"), reach=0.05, shape=eq.Plate()),
        eq.Counterweight("c4", eq.Point("rocker"), reach=0.0625, shape=eq.Plate()),
    ]


@pytest.mark.parametrize(
    ("cap", "shares"),
    [
        (0.25, (0.64194, 0.98137, 1.00870)),
        (0.50, (0.54662, 0.77064, 1.09745)),
        (0.75, (0.49182, 0.60044, 1.14985)),
        (1.50, (0.43527, 0.35179, 1.16068)),
    ],
)
def test_partial_balance_under_a_mass_cap_is_the_global_optimum(bar, turn, cap, shares):
    aims = [eq.Aim(goal, divisor=RATIO) for goal in ("force", "moment", "drive")]
    design = eq.balance(bar, plates(), turn, objective=[*aims, eq.Aim("mass", cap=cap)])
    np.testing.assert_allclose([design.reached(aim) for aim in aims], shares, atol=1.5e-5)
    assert design.added_mass == pytest.approx(cap, rel=1e-6)
    assert design.certificate.kind == "convex"
    assert 0 <= design.certificate.gap < 1e-8
    if cap == 0.75:
        assert design.certificate.primal == pytest.approx(2.24210952, abs=1e-8)


def test_force_balance_is_exact_for_all_motions(bar):
    every = eq.Sweep.any_motion(bar, 64)
    weights = [
        eq.Counterweight("c2", eq.Point("crank"), mass=0.2, reach=0.2),
        eq.Counterweight("c4", eq.Point("rocker"), mass=0.55, reach=0.2),
    ]
    design = eq.balance(bar, weights, every, objective=eq.Aim("force"))
    assert design.certificate.kind == "exact"
    assert design.values["c2.mx"] == pytest.approx(-0.01, abs=1e-12)
    assert design.values["c4.mx"] == pytest.approx(-0.034375, abs=1e-12)
    assert design.after["force"].peak < 1e-10 * design.before["force"].peak


def balanced_weights():
    at = {"crank": ((-0.05, 0, 0), 0.2), "rocker": ((-0.0625, 0, 0), 0.55)}
    return [eq.Counterweight(f"w_{body}", eq.Point(body, place), mass=mass) for body, (place, mass) in at.items()]


def test_force_balance_costs_moment_and_torque(bar, turn):
    design = eq.balance(bar, balanced_weights(), turn, objective=eq.Aim("force"))
    assert design.after["force"].peak < 3e-13
    assert design.after["moment"].rms == pytest.approx(5.78867, rel=1e-6)
    assert design.after["crank_joint"].rms == pytest.approx(1.96081, rel=1e-5)


def test_counter_rotor_and_ring_balance_completely(bar, turn):
    """A ring on the coupler makes its inertia that of two point masses; the rocker's rotor takes the rest."""
    ring = eq.CounterRotor("ring", "coupler", ratio=-1.0)
    rotor = eq.CounterRotor("rotor", "rocker")
    design = eq.balance(bar, [*balanced_weights(), ring, rotor], turn, objective=eq.Aim("moment"))
    assert design.values["ring.J"] == pytest.approx(0.001125, rel=1e-9)
    assert design.values["rotor.J"] == pytest.approx(0.00579427, rel=1e-6)
    assert design.after["moment"].peak < 1e-10 * design.before["moment"].peak
    assert design.after["crank_joint"].rms == pytest.approx(4.044, abs=5e-4)
    assert design.certificate.kind == "exact"
    part = next(part for part in design.parts() if part["name"] == "rotor")
    assert part["torque_reversals"] >= 2
    assert part["preload"] > 0


def test_flywheel_takes_the_moment(bar, turn):
    wheel = eq.Flywheel("wheel", inertia=0.01)
    design = eq.balance(bar, [*balanced_weights(), wheel], turn, objective=eq.Aim("force"))
    assert design.after["moment"].peak < 1e-12
    law = design.flywheel_law(wheel)
    assert law is not None
    # the four-bar's K3 and K4 integrate in closed form
    states = bar.states(turn)
    inertias = -0.001125 * (states.kin.q[:, 0] + states.kin.q[:, 1]) + 0.00579427083 * states.kin.q[:, 2]
    speeds = -0.001125 * states.rates.velocity[:, :2].sum(axis=1) + 0.00579427083 * states.rates.velocity[:, 2]
    np.testing.assert_allclose(law.speed, -(speeds - speeds[0]) / 0.01, atol=2e-7)
    drift = law.angle + (inertias - inertias[0] - speeds[0] * law.time) / 0.01
    np.testing.assert_allclose(drift, 0.0, atol=1e-7)
    small = eq.Flywheel("wheel", speed=100.0, power=500.0)
    sized = eq.balance(bar, [*balanced_weights(), small], turn, objective=eq.Aim("force")).flywheel_law(small)
    assert sized is not None
    assert np.abs(sized.speed).max() <= 100 * (1 + 1e-12)
    assert np.abs(sized.power).max() <= 500 * (1 + 1e-12)
    assert sized.inertia == pytest.approx(max(sized.needs.values()))


def test_the_pole_matters_where_force_is_left(bar, turn):
    pole = (0.14, 0.0, 0.02)
    states = bar.states(turn)
    about, force, moment = (
        effort(bar, (), states, goal, pole if goal == "m" else (0, 0, 0)).b for goal in ("moment", "force", "moment")
    )
    moved = effort(bar, (), states, "moment", pole).b
    np.testing.assert_allclose(moved, moment - np.cross(pole, force), atol=1e-12)
    np.testing.assert_allclose(about, moment)


def test_unbounded_mass_is_refused(bar, turn):
    with pytest.raises(eq.InputError, match="nothing keeps the mass of c2 down"):
        eq.balance(bar, plates(), turn, objective=[eq.Aim("force"), eq.Aim("moment")])


def test_momentum_and_its_rate_agree(bar, turn):
    """F and M are the time derivatives of p and L, on a spline through them."""
    from scipy.interpolate import make_interp_spline

    states = bar.states(turn)
    time = turn.instants.time
    for goal in ("force", "moment"):
        stored, rate = effort(bar, (), states.momenta, goal).b, effort(bar, (), states, goal).b
        slope = make_interp_spline(time, stored, k=5)(time, 1)
        np.testing.assert_allclose(slope[20:-20], rate[20:-20], atol=1e-6 * np.abs(rate).max())
