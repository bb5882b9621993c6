"""The orthosis done right: the exact passive pair found by `discover`, real springs, a walking cycle."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from ruamel.yaml import YAML

import equipoise as eq
from equipoise.cli import main
from equipoise.problem import load_problem
from equipoise.verbs.discover import discover

EXAMPLES = Path(__file__).parents[1] / "examples"
G = 9.81


def found(name, tmp_path, change=lambda data: None):
    data = YAML(typ="safe").load((EXAMPLES / f"{name}.yaml").read_text(encoding="utf-8"))
    change(data)
    file = tmp_path / f"{name}.yaml"
    with file.open("w", encoding="utf-8") as stream:
        YAML().dump(data, stream)
    problem = load_problem(file)
    problem.check()
    front = discover(
        problem.mechanism, problem.sweep, problem.content.discover, objective=problem.objective, limits=problem.limits
    )
    return front.designs[-1]


def energy(design, poses):
    """V of weights and springs from MuJoCo's own kinematics: bodies' centres, and both ends of every line."""
    model = design.mechanism.model
    data, total = mujoco.MjData(model), []
    for pose in poses:
        data.qpos[:] = pose
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        value = -float(model.body_mass @ (data.xipos @ model.opt.gravity))
        for spring in design.balancers:
            ends = []
            for point in (spring.path.a, spring.path.b):
                body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, point.body)
                ends.append(data.xpos[body] + data.xmat[body].reshape(3, 3) @ point.at)
            rate = design.values.get(f"{spring.name}.k", spring.law.k)
            assert rate > 0  # springs that one can buy
            value += 0.5 * rate * float(((ends[0] - ends[1]) ** 2).sum())
        total.append(value)
    return np.array(total)


@pytest.mark.parametrize(("mass", "height"), [(75, 1.75), (58, 1.62)])
def test_discover_finds_the_exact_pair_of_the_leg(tmp_path, mass, height):
    def change(data):
        data["mechanism"]["human_leg"] |= {"mass": mass, "height": height}

    design = found("orthosis_discover", tmp_path, change)
    assert len(design.balancers) == 2
    assert design.certificate.kind == "exact"
    rng = np.random.default_rng(1)
    poses = np.stack([rng.uniform(-np.pi, np.pi, 1000), rng.uniform(-2.0, 0.0, 1000)], axis=1)
    assert np.ptp(energy(design, poses)) < 1e-9
    assert eq.verify(design, poses=100).verification.agrees


def test_discover_finds_the_exact_pair_of_the_arm(tmp_path):
    design = found("arm_pair", tmp_path)
    assert design.certificate.kind == "exact"
    rng = np.random.default_rng(2)
    spread = np.ptp(energy(design, rng.uniform(-np.pi, np.pi, (1000, 2))))
    assert spread < 1e-9 * (100 * 0.6 + 40 * 1.2 + 40 * 0.5) * 9.8
    # The hook on link 2 lies where the weight acts on both: l1 m2 r2 / (m1 r1 + m2 l1).
    base = next(spring for spring in design.balancers if "world" in (spring.path.a.body, spring.path.b.body))
    hook = next(point for point in (base.path.a, base.path.b) if point.body == "link2")
    assert hook.at[0] == pytest.approx(1.2 * 20 / (60 + 48), abs=1e-8)


def test_real_springs_and_their_mass():
    problem = load_problem(EXAMPLES / "orthosis_springs.yaml")
    problem.check()
    design = eq.shape(
        problem.mechanism, problem.balancers, problem.sweep, problem.bounds, objective=problem.objective, starts=4
    )
    before = np.hypot(design.before["hip"].rms, design.before["knee"].rms)
    after = np.hypot(design.after["hip"].rms, design.after["knee"].rms)
    assert after < 0.005 * before
    assert not design.missed
    assert all(part["force"][0] > 0 for part in design.parts())  # extension springs that never go slack
    assert eq.verify(design, poses=100).verification.agrees


def test_a_walking_cycle_static_and_with_inertia():
    problem = load_problem(EXAMPLES / "orthosis_walking.yaml")
    problem.check()
    design = eq.shape(
        problem.mechanism, problem.balancers, problem.sweep, problem.bounds, objective=problem.objective, starts=2
    )
    assert design.certificate.kind == "exact"
    assert design.after["hip"].peak < 1e-9 * design.before["hip"].peak
    # With inertia by MuJoCo's inverse dynamics of the bare leg, weight switched off: that is all the motors supply.
    states = design.states
    drive = sum(part.effort(states, "drive").at(np.array([design.values[u.name] for u in part.unknowns]))
                for part in design.balancers) + problem.mechanism.effort(states, "drive").b  # fmt: skip
    model = mujoco.MjModel.from_xml_string(problem.mechanism.spec.to_xml())
    model.opt.gravity[:] = 0
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    data = mujoco.MjData(model)
    for row in range(0, len(states), 15):
        data.qpos[:], data.qvel[:] = states.kin.q[row], states.moving.velocity[row]
        data.qacc[:] = states.moving.acceleration[row]
        mujoco.mj_inverse(model, data)
        np.testing.assert_allclose(drive[row], data.qfrc_inverse, atol=1e-8)
    assert np.abs(drive).max() > 10


def test_the_walking_cycle_is_the_sources():
    """A few of the 51 points as the source prints them: hip flexion less pelvic tilt, knee flexion; one stride."""
    rows = np.loadtxt(EXAMPLES / "walking.csv", delimiter=",", skiprows=1)
    assert rows.shape == (51, 3)
    assert rows[-1, 0] == pytest.approx(1 / 0.851, abs=1e-5)
    for row, hip, tilt, knee in ((0, 33.546, 10.891, 0.384), (28, -9.751, 10.891, 9.780), (38, 21.746, 8.478, 63.994)):
        assert rows[row, 1] == pytest.approx(-90 + hip - tilt, abs=1e-3)
        assert rows[row, 2] == pytest.approx(-knee, abs=1e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda lines: lines[:20] + lines[27:], "the recording has a gap"),
        (lambda lines: [*lines[:9], lines[9].rsplit(",", 1)[0] + ",", *lines[10:]], "the value is missing"),
        (lambda lines: [*lines[:9], lines[9].rsplit(",", 1)[0] + ",nan", *lines[10:]], "not a finite number"),
        (lambda lines: [*lines[:9], lines[9].rsplit(",", 1)[0], *lines[10:]], "2 values for 3 columns"),
    ],
)
def test_a_gait_with_gaps_is_refused(change, message, tmp_path, capsys):
    lines = (EXAMPLES / "walking.csv").read_text(encoding="utf-8").splitlines()
    (tmp_path / "walking.csv").write_text("\n".join(change(lines)) + "\n", encoding="utf-8")
    file = tmp_path / "walk.yaml"
    file.write_text((EXAMPLES / "orthosis_walking.yaml").read_text(encoding="utf-8"), encoding="utf-8")
    assert main(["balance", str(file)]) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert message in said
    assert "line 10" in said or "line 21" in said
