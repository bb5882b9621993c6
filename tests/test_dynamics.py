"""Shaking force and moment, drive torque and their balancing: reference figures of a four-bar."""

from __future__ import annotations

import mujoco
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


def robots():
    links = [
        eq.Link("turret", length=0.2, mass=2.0, axis=(0, 0, 1)),
        eq.Link("boom", length=0.5, mass=3.0, com=(0.2, 0.03, 0.05)),
        eq.Link("slide", length=0.3, mass=1.0, joint="slide", axis=(1, 0, 0), at=(0.3, 0.0, 0.0), stroke=(0.0, 0.3)),
        eq.Link("hand", length=0.2, mass=0.7, axis=(0, 0.6, 0.8)),
    ]
    spatial = eq.chain(links, name="spatial")
    drivers = {
        "turret_joint": "0.4*sin(9*t)",
        "boom_joint": eq.Cycloidal(-0.3, 0.8),
        "slide_joint": eq.TimeSpline((0.0, 0.3, 0.7), (0.05, 0.2, 0.1)),
        "hand_joint": eq.TimePolynomial((0.1, 0.0, 0.8, -0.3)),
    }
    bar = eq.four_bar(0.4, 0.15, 0.35, 0.3, masses=(1.0, 2.0, 1.5), coms=(0.07, (0.2, 0.05), 0.15))
    return {"spatial": (spatial, drivers, 0.7), "four_bar": (bar, {"crank_joint": "3*t + sin(2*t)**2"}, 1.5)}


def parts(name):
    body = {"spatial": "hand", "four_bar": "coupler"}[name]
    found = [
        eq.Counterweight("point", eq.Point(body, (0.03, 0.02, 0.05)), mass=0.4),
        eq.Counterweight("disc", eq.Point(body, (-0.1, 0.0, 0.02)), mass=0.8, shape=eq.Disc(0.05, thickness=0.02)),
        eq.Spring(
            "s", eq.Line(eq.Point("world", (0.1, 0.2, 0.6)), eq.Point(body, (0.1, 0, 0))), eq.ZeroFreeLength(k=90)
        ),
    ]
    if name == "four_bar":
        found.append(eq.CounterRotor("rotor", "rocker", ratio=2.0, inertia=0.004, mass=0.3, at=eq.Point("world")))
        found.append(eq.CounterRotor("belt", "coupler", ratio=-1.5, inertia=0.002, mass=0.2, at=eq.Point("crank")))
    return found


@pytest.mark.parametrize("name", ["spatial", "four_bar"])
def test_mujoco_inverse_dynamics_of_the_model_with_its_parts_agrees(name):
    """MuJoCo's recursive Newton-Euler on a model with the parts in it, at our postures, velocities, accelerations."""
    mechanism, drivers, duration = robots()[name]
    states = mechanism.states(eq.Sweep.motion(mechanism, drivers, duration=duration, samples=40))
    added = parts(name)
    spec = mechanism.spec.copy()
    for part in added:
        part.install(spec, {}, states)
    model = spec.compile()
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    ours = {goal: effort(mechanism, added, states, goal).b for goal in ("drive", "force", "moment")}
    scale = {goal: np.abs(rows).max() for goal, rows in ours.items()}
    weight = model.body_mass.sum() * model.opt.gravity
    for row in range(0, 40, 3):
        data = mujoco.MjData(model)
        slope = np.zeros((model.nv, len(mechanism.driven)))
        for index in range(mechanism.model.njnt):
            joint = model.joint(mechanism.model.joint(index).name)
            data.qpos[joint.qposadr[0]] = states.kin.q[row, mechanism.model.jnt_qposadr[index]]
            dof = mechanism.model.jnt_dofadr[index]
            data.qvel[joint.dofadr[0]] = states.rates.velocity[row, dof]
            data.qacc[joint.dofadr[0]] = states.rates.acceleration[row, dof]
            slope[joint.dofadr[0]] = states.D[row % len(states.D), dof]
        if name == "four_bar":
            _turn_rotors(model, data, slope)
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        result = np.zeros(model.nv)
        mujoco.mj_rne(model, data, 1, result)
        np.testing.assert_allclose(
            slope.T @ (result - data.qfrc_spring), ours["drive"][row], atol=1e-9 * scale["drive"]
        )
        stiffness = model.tendon_stiffness.copy()
        model.tendon_stiffness[:] = 0.0  # what a spring pulls at the base it gives back at its other end
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_rnePostConstraint(model, data)
        model.tendon_stiffness[:] = stiffness
        base = np.zeros(6)
        for body in np.flatnonzero(model.body_parentid == 0)[1:]:
            moment, force = data.cfrc_int[body, :3], data.cfrc_int[body, 3:]
            base += np.r_[force, moment + np.cross(data.subtree_com[model.body_rootid[body]], force)]
        pull = np.cross(data.subtree_com[0], weight)
        np.testing.assert_allclose(base[:3] + weight, ours["force"][row], atol=1e-9 * scale["force"])
        np.testing.assert_allclose(base[3:] + pull, ours["moment"][row], atol=1e-9 * scale["moment"])


def _turn_rotors(model, data, slope):
    """The rotors' joints follow rocker and coupler: -2 rocker; 1.5 times the coupler relative to the crank."""
    for rotor, ratio, joint in (("rotor_joint", -2.0, "rocker_joint"), ("belt_joint", 1.5, "coupler_joint")):
        mine, other = model.joint(rotor), model.joint(joint)
        data.qpos[mine.qposadr[0]] = ratio * data.qpos[other.qposadr[0]]
        for array in (data.qvel, data.qacc, slope):
            array[mine.dofadr[0]] = ratio * array[other.dofadr[0]]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("__import__('os')", "there is no function"),
        ("(lambda: t)()", "outside the grammar"),
        ("t.real", "outside the grammar"),
        ("x + 1", "no variable"),
        ("sin t", "cannot read"),
        ("foo(t)", "there is no function"),
        ("log(t - 1)", "is nan at t = 0"),
        ("sqrt(t)", "velocity of"),
        ("[t]", "outside the grammar"),
        ("t if t else 1", "outside the grammar"),
        ("True", "outside the grammar"),
    ],
)
def test_expressions_outside_the_grammar_are_refused(bar, text, words):
    with pytest.raises(eq.InputError, match=words):
        eq.Sweep.motion(bar, {"crank_joint": text}, duration=1.0)


def test_expressions_are_differentiated_exactly(bar):
    text = "exp(-t)*sin(3*t)**2/(1 + t**2) + atan(2*t) - cosh(t/T)**1.5 + 2**t"
    motion = eq.Sweep.motion(bar, {"crank_joint": text}, duration=2.0).instants.motion
    t = np.linspace(0.3, 1.7, 9)
    _, velocity, acceleration = motion.at(t)
    h = 1e-4
    (ahead, dv, _), (behind, wv, _) = motion.at(t + h), motion.at(t - h)
    np.testing.assert_allclose(velocity, (ahead - behind) / (2 * h), atol=1e-5)
    np.testing.assert_allclose(acceleration, (dv - wv) / (2 * h), atol=1e-5)


def test_a_recorded_motion(bar, tmp_path):
    file = tmp_path / "turn.csv"
    time = np.linspace(0.0, T, 241)
    rows = "\n".join(f"{1e3 * t!r},{360 * t / T!r}" for t in time.tolist())
    file.write_text(f"time [ms],crank_joint [deg]\n{rows}\n")
    design = eq.analyze(bar, eq.Sweep.motion(bar, file))
    assert design.rows["force"].rms == pytest.approx(58.9447, rel=1e-5)
    file.write_text("time,crank_joint\n0,0\n0.1,0.2\n0.1,0.3\n")
    with pytest.raises(eq.InputError, match="time does not increase"):
        eq.Sweep.motion(bar, file)


def test_a_motion_that_meets_a_singularity_says_when():
    rocker = eq.four_bar(0.4, 0.3, 0.25, 0.2, masses=(1.0, 1.0, 1.0))
    sweep = eq.Sweep.motion(rocker, {"crank_joint": "0.8 + 3*t"}, duration=1.0)
    with pytest.raises(eq.LoopError, match=r"the motion stops at t = 0\.\d+ s"):
        rocker.states(sweep)
