"""Every example runs from file to verified design and meets a number worked out here by other means."""

from __future__ import annotations

import math
from pathlib import Path

import mujoco
import numpy as np
import pytest

import equipoise as eq
from equipoise.problem import load_problem
from equipoise.verbs.balance import balance
from equipoise.verbs.shape import shape
from equipoise.verbs.verify import verify

EXAMPLES = Path(__file__).parent.parent / "examples"
G = 9.81


def run(name: str | Path, **options):
    problem = load_problem((EXAMPLES / name).with_suffix(".yaml"))
    problem.check()
    pieces = (problem.mechanism, problem.balancers, problem.sweep)
    same = {"objective": problem.objective, "limits": problem.limits}
    if problem.bounds:
        return shape(*pieces, problem.bounds, **same, starts=options.get("starts", 6), seed=problem.search.seed)
    return balance(*pieces, **same)


def plain_peak(model: mujoco.MjModel, joint: str, poses: np.ndarray) -> float:
    """Largest gravity torque of a joint by a plain MuJoCo loop, without any code of ours."""
    data = mujoco.MjData(model)
    dof = model.jnt_dofadr[mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, joint)]
    largest = 0.0
    for pose in poses:
        data.qpos[:] = pose
        mujoco.mj_forward(model, data)
        largest = max(largest, abs(float(data.qfrc_bias[dof])))
    return largest


def test_ur10_shoulder():
    design = run("ur10_shoulder")
    shoulder, elbow = "shoulder_lift_joint", "elbow_joint"
    assert design.before[shoulder].peak == pytest.approx(121.031, abs=1e-3)
    assert design.before[elbow].peak == pytest.approx(34.235, abs=1e-3)
    # The spring does not span the elbow, whose own torque is the floor of the objective.
    assert design.after[shoulder].peak <= design.before[elbow].peak * (1 + 1e-6)
    model = design.mechanism.model
    straight = np.zeros((1, model.nq))
    assert plain_peak(model, shoulder, straight) == pytest.approx(design.before[shoulder].peak, rel=0.01)
    part = design.parts()[0]
    assert part["stroke"] <= 0.6 + 1e-9
    assert not design.missed
    assert verify(design, poses=500).verification.max_abs_error < 1e-9


def test_so101_shoulder():
    design = run("so101_shoulder")
    assert design.before["shoulder_lift"].peak == pytest.approx(0.8642, abs=1e-3)
    assert design.after["shoulder_lift"].peak <= 0.4535
    assert design.after["shoulder_lift"].peak <= design.after["elbow_flex"].peak * (1 + 1e-6)
    box = design.mechanism.box
    poses = box[:, 0] + np.random.default_rng(1).random((3000, len(box))) * (box[:, 1] - box[:, 0])
    assert 0.9 * 0.4529 < plain_peak(design.mechanism.model, "elbow_flex", poses) <= 0.4529 + 1e-4
    assert not design.missed


def test_mass_table_arm():
    design = run("mass_table_arm", starts=4)
    m1, c1, l1, m2, c2, l2, load = 4.0, 0.18, 0.4, 2.2, 0.15, 0.35, 1.5
    reach = m1 * c1 + m2 * (l1 + c2) + load * (l1 + l2)
    assert design.before["upper_arm_joint"].peak == pytest.approx(reach * G, rel=1e-6)
    assert design.before["forearm_joint"].peak == pytest.approx((m2 * c2 + load * l2) * G, rel=1e-6)
    # No fixed weight does better at the elbow than half the load's own torque, either way.
    assert design.after["forearm_joint"].peak == pytest.approx(load * l2 * G / 2, rel=1e-4)
    assert design.values["tail.m"] == pytest.approx((m2 * c2 + load * l2 / 2) / 0.12, rel=1e-4)
    upper, fore = design.after["upper_arm_joint"], design.after["forearm_joint"]
    assert upper.sample_peak / 60 <= fore.sample_peak / 20 * (1 + 1e-6)
    # The grid is taken as it is: between its points the torque is higher by what its second differences allow.
    table = design.residual(design.states)[:, 0].reshape(2, 31, 31)
    bend = sum(np.abs(np.diff(table, 2, axis=axis)).max() / 8 for axis in (1, 2))
    assert bend < 0.01 * upper.sample_peak
    assert upper.sample_peak <= upper.peak <= upper.sample_peak + bend
    assert verify(design, poses=500).verification.agrees


def test_monitor_arm():
    design = run("monitor_arm")
    length, moment = 0.25, (0.8 / 2 + 0.5 / 2 + 0.3) * 0.25
    assert design.before["arm_joint"].peak == pytest.approx((moment + 8 * length) * G, rel=1e-6)
    # A spring straight above the pivot holds any one payload exactly: k a b = (moment + m l) g.
    assert design.values["lift.k"] == pytest.approx((moment + 5.5 * length) * G / (0.055 * 0.12), rel=1e-6)
    assert design.after["arm_joint"].peak == pytest.approx(2.5 * length * G, rel=1e-6)
    assert design.certificate.kind == "convex"
    angle = math.radians(60)
    longest = math.sqrt(0.12**2 + 0.055**2 + 2 * 0.12 * 0.055 * math.sin(angle))
    assert design.parts()[0]["length"][1] == pytest.approx(longest, rel=1e-9)
    assert verify(design, poses=500).verification.agrees


@pytest.mark.parametrize(("table", "total", "arm"), [("winter", 7.8225, 0.152578), ("de_leva_male", 8.62389, 0.129303)])
def test_leg_orthosis(table, total, arm, tmp_path):
    """k l_OB = (M + (m1 + m2) / 2) g frees the hip; a coil that pushes takes the knee's mean pull, and no more."""
    text = (EXAMPLES / "leg_orthosis.yaml").read_text(encoding="utf-8")
    (tmp_path / "leg_orthosis.yaml").write_text(
        text.replace("table: winter", f"table: {table}").replace("152.578 mm", f"{1e3 * arm} mm"), encoding="utf-8"
    )
    design = run(tmp_path / "leg_orthosis")
    k1, k2, height, thigh = design.geometry["s1.law.k"], 500.0, 0.15, {"winter": 0.245}.get(table, 0.2425) * 1.75

    def wire(k, n, length):
        return math.pi * 7800 * length * math.sqrt(0.04**3 * n * k / (2 * 81e9))

    assert k1 * height == pytest.approx((total + 0.5 * (wire(k1, 66, 8.6) + wire(k2, 62, 7.8))) * G, rel=2e-5)
    assert design.after["hip"].peak < 1e-4 * design.before["hip"].peak
    knee = np.radians(np.arange(0, 61))
    length = np.sqrt(thigh**2 + arm**2 + 2 * thigh * arm * np.cos(knee))

    def left(push):
        return np.abs(((k1 + k2) * length - push) * thigh * arm * np.sin(knee) / length).max()

    pushes = np.linspace(500, 700, 4001)
    assert design.after["knee"].sample_peak == pytest.approx(min(map(left, pushes)), rel=1e-3)
    assert design.parts()[1]["parameters"]["k_free_length"] == pytest.approx(
        pushes[np.argmin([*map(left, pushes)])], abs=0.1
    )
    assert verify(design, poses=500).verification.agrees


def test_crank_slider():
    """The peak by plain trigonometry, and no neighbour of the design does better."""
    began = load_problem(EXAMPLES / "crank_slider.yaml").balancers[0].path
    assert (began.crank, began.rod) == pytest.approx((0.131856, 0.526384), abs=5e-5)
    design = run("crank_slider")
    names = ("s.path.crank", "s.path.rod", "s.path.phase")
    best = np.array([design.geometry[name] for name in names])
    phi = np.radians(np.arange(30, 151))

    def peak(x):
        u = phi + x[2]
        along = np.sqrt(x[1] ** 2 - (x[0] * np.sin(u)) ** 2)
        slope = -x[0] * np.sin(u) * (1 + x[0] * np.cos(u) / along)
        push = 1000 * (x[0] * np.cos(u) + along - 1.0) + 0.45 * G
        return np.abs(7.6453 * G * 0.84 * np.sin(phi) - push * slope).max()

    assert design.before["arm_joint"].peak == pytest.approx(63.0, abs=1e-3)
    assert design.after["arm_joint"].sample_peak == pytest.approx(peak(best), rel=1e-9)
    assert peak(best) < 1.45
    steps = np.random.default_rng(3).normal(size=(500, 3)) * (1e-3, 1e-3, 2e-2)
    assert peak(best) <= min(peak(best + step * share) for step in steps for share in (1.0, 0.1)) + 1e-7
    assert verify(design, poses=500).verification.agrees


def test_quaglia_arm():
    design = run("quaglia_arm")
    g, radius = 9.8, 0.2
    # Each crank and yoke is a counterweight that goes down as its link rises.
    lift1 = ((100 * 0.6 + 40 * 1.2) * g - 4 * g * radius / 2) / radius - 12 * g
    lift2 = (40 * 0.5 * g - 2 * g * radius / 2) / radius - 5 * g
    assert design.values["lift1.force"] == pytest.approx(lift1, rel=1e-9)
    assert design.values["lift2.force"] == pytest.approx(lift2, rel=1e-9)
    assert design.certificate.kind == "exact"
    assert max(row.peak for row in design.after.values()) < 1e-9
    assert design.before["link1_joint"].peak == pytest.approx(abs(1058.4 + 196 * np.exp(0.1j * np.pi)), rel=1e-6)
    assert not design.missed
    assert verify(design, poses=500).verification.agrees


def test_quaglia_gas():
    design = run("quaglia_gas", starts=2)
    box = design.sweep.box
    q1, q2 = (axis.ravel() for axis in np.meshgrid(*(np.linspace(*span, 401) for span in box), indexing="ij"))
    swing = 10 * 9.8 * (1.2 * np.cos(q1) + np.real((1.05 + 0.12j) * np.exp(1j * (q1 + q2))))
    # Half the load's own torque is the floor; the gas springs' own errors hide below it.
    floor = np.abs(swing).max() / 2
    assert floor <= design.after["link1_joint"].peak * (1 + 1e-4)
    assert design.after["link1_joint"].peak <= 1.003 * floor
    assert design.after["link2_joint"].peak >= 5 * 9.8 * abs(1.05 + 0.12j) * (1 - 1e-3)
    assert not design.missed
    assert verify(design, poses=500).verification.agrees


def test_four_bar_balance():
    """The optimum that SciPy's SLSQP finds too."""
    design = run("four_bar_balance")
    reached = [design.reached(aim) for aim in design.objective]
    assert reached[:3] == pytest.approx([0.49182, 0.60044, 1.14985], abs=1e-5)
    assert sum(reached[:3]) == pytest.approx(2.24210952, abs=1e-8)
    assert reached[3] == pytest.approx(0.75, rel=1e-6)
    assert design.certificate.gap < 1e-8


def test_ur10_pick_and_place():
    """Heat by MuJoCo on a spline through the file; work of a closed cycle; springs in motion."""
    from scipy.interpolate import make_interp_spline

    design = run("ur10_pick_and_place")
    mechanism = design.mechanism
    table = np.genfromtxt(EXAMPLES / "ur10_pick_and_place.csv", delimiter=",", skip_header=1)
    path = make_interp_spline(table[:, 0], np.radians(table[:, 1:]), k=5)
    spec = mechanism.spec.copy()
    hand = spec.body("tool0").add_body(name="gripper", pos=[0.0, 0.0, 0.05])
    hand.mass, hand.inertia, hand.ipos, hand.explicitinertial = 2.0, [1e-12] * 3, [0.0, 0.0, 0.0], True
    model = spec.compile()
    data, torques = mujoco.MjData(model), np.zeros((len(table), model.nv))
    for row, t in enumerate(table[:, 0]):
        data.qpos[:], data.qvel[:], data.qacc[:] = path(t), path(t, 1), path(t, 2)
        mujoco.mj_inverse(model, data)
        torques[row] = data.qfrc_inverse
    weight = np.full(len(table), 1.0)
    weight[[0, -1]] = 0.5
    heat = np.sqrt(weight @ torques**2 / weight.sum())
    for joint, rms in zip(mechanism.driven, heat, strict=True):
        assert design.before[joint].rms == pytest.approx(rms, rel=1e-8)
    before, after = design.machine
    lift = "shoulder_lift_joint"
    assert after.drives[lift].effort.rms < 0.6 * before.drives[lift].effort.rms
    assert after.drives["elbow_joint"].effort.rms < 0.6 * before.drives["elbow_joint"].effort.rms
    # the price: what the springs weigh has to be moved
    for joint in ("shoulder_pan_joint", lift):
        assert after.drives[joint].parts["inertial"].rms > before.drives[joint].parts["inertial"].rms
    assert after.supply.positive < 0.85 * before.supply.positive
    assert abs(after.supply.net) < 1e-4 * after.supply.positive
    found = verify(design, poses=100).verification
    assert found.agrees
    assert max(error.relative for error in found.motion.errors.values()) < 1e-10


def test_delta_counterweights():
    """Three equal weights, the rms force by Newton's law on the centres of all bodies."""
    design = run("delta_counterweights")
    assert design.added_mass == pytest.approx(3.0, rel=1e-6)
    assert design.certificate.gap < 1e-6
    assert design.after["force"].rms < 0.55 * design.before["force"].rms
    places = [part["ends"][0]["at"] for part in design.parts()]
    assert places[1:] == [pytest.approx(places[0])] * 2
    assert 0.06 < np.linalg.norm(places[0]) <= 0.12 + 1e-9
    model, states = design.mechanism.model, design.states
    force = 0.3 * states.acceleration(eq.Point("platform"))
    for body in range(1, model.nbody):
        com = eq.Point(model.body(body).name, tuple(model.body_ipos[body]))
        force = force + model.body_mass[body] * states.acceleration(com)
    rms = np.sqrt((states.weight @ (force**2).sum(axis=1)) / states.weight.sum())
    assert design.before["force"].rms == pytest.approx(rms, rel=1e-9)
