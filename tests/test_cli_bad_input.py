"""Every kind of bad input: one clear message with place and next step, the right exit code, nothing written."""

from __future__ import annotations

import json

import pytest

from equipoise.cli import main

PROBLEM = """\
mechanism:
  chain:
    links:
      - {name: arm, length: 500 mm, mass: 2 kg, limits: [-90 deg, 90 deg], motor_limit: 20 N m}
sweep: {grid: {arm_joint: [-90 deg, 90 deg, 19]}}
balancers:
  - spring:
      name: s1
      path: {line: [[world, 0, 0, 0.2], [arm, 0.1, 0, 0]]}
      law: zero_free_length
limits: [{force: s1, max: 1 kN}]
objective: {goal: hold, norm: peak}
"""
URDF = """<robot name="bad"><link name="base"/><link name="tip">
<inertial><mass value="{mass}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="hinge" type="{kind}"><parent link="base"/><child link="tip"/><axis xyz="0 1 0"/>
<limit lower="{low}" upper="{high}" effort="1" velocity="1"/></joint></robot>"""


@pytest.fixture
def problem(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def write(old: str = "", new: str = ""):
        assert old in PROBLEM
        (tmp_path / "p.yaml").write_text(PROBLEM.replace(old, new, 1), encoding="utf-8")
        return "p.yaml"

    return write


def refused(capsys, tmp_path, *arguments: str, code: int = 2) -> str:
    before = sorted(tmp_path.rglob("*"))
    assert main([*arguments, "--json", "--out", "out/answer"]) == code
    out, err = capsys.readouterr()
    assert out == ""
    assert "Traceback" not in err
    assert "internal error" not in err
    assert "  -> " in err, "a message says what to try next"
    assert sorted(tmp_path.rglob("*")) == before, "nothing is half-written"
    return err


def test_the_problem_itself_is_good(problem, capsys):
    assert main(["design", problem(), "--json"]) == 0
    out, err = capsys.readouterr()
    found = json.loads(out)
    # k a b = m g l / 2 balances a uniform bar exactly with the hook straight above its joint.
    assert found["unknowns"]["s1.k"]["value"] == pytest.approx(2 * 9.81 * 0.25 / (0.2 * 0.1), rel=1e-6)
    assert found["certificate"]["kind"] == "exact"
    assert err.rstrip().splitlines()[-1].split() == ["report", "out/p/report.html"]


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("arm, 0.1", "arn, 0.1", 7, ["no body 'arn'", "did you mean arm?"]),
        ("arm_joint: [-", "arm_hinge: [-", 5, ["no joint 'arm_hinge'", "arm_joint"]),
        ("[-90 deg, 90 deg, 19]", "[90 deg, -90 deg, 19]", 5, ["reversed"]),
        ("limits: [-90 deg, 90 deg]", "limits: [90 deg, -90 deg]", 4, ["links[0].limits", "below"]),
        ("mass: 2 kg", "mass: -2 kg", 4, ["mass is -2 kg", "at least 0"]),
        ("mass: 2 kg", "mass: 2 m", 4, ["'2 m'", "[length]", "kg"]),
        ("length: 500 mm", "length: 500 mmm", 4, ["cannot read '500 mmm'"]),
        ("length: 500 mm", "length: 0", 4, ["length is 0 m", "above 0"]),
        ("length: 500 mm", "length: .nan", 4, ["not a finite number"]),
        ("[-90 deg, 90 deg, 19]", "[-90 mm, 90 mm, 19]", 5, ["hinge", "angle"]),
        ("[-90 deg, 90 deg, 19]", "[-90 deg, 90 deg, 0]", 5, ["not a number of points"]),
        ("{grid: {arm_joint: [-90 deg, 90 deg, 19]}}", "{sobol: 64, seed: -1}", 5, ["seed is -1", "at least 0"]),
        ("{grid: {arm_joint: [-90 deg, 90 deg, 19]}}", "{sobol: 99999999999}", 5, ["99999999999 rows", "fewer"]),
        ("{grid: {arm_joint: [-90 deg, 90 deg, 19]}}", "{grid: {}}", 5, ["names no joint"]),
        ("{grid: {arm_joint: [-90 deg, 90 deg, 19]}}", "{poses: []}", 5, ["no poses"]),
        ("{grid: {arm_joint: [-90 deg, 90 deg, 19]}}", "{poses: none.csv}", 5, ["none.csv"]),
        ("[arm, 0.1, 0, 0]", "[world, 0, 0, 0.2]", 7, ["length never changes", "two bodies"]),
        ("[world, 0, 0, 0.2], [arm, 0.1, 0, 0]", "[world, 0, 0, 0], [arm, 0, 0, 0]", 7, ["coincide"]),
        ("[world, 0, 0, 0.2], [arm, 0.1, 0, 0]", "[world, 0, 0, 0.2], [arm, 0, 0, 0]", 7, ["changes the length"]),
        ("law: zero", "lew: zero", 10, ["no field 'lew'", "did you mean law"]),
        ("zero_free_length", "zero_length", 10, ["no law 'zero_length'", "zero_free_length"]),
        ("zero_free_length", "{coil: {free_lenght: 1}}", 10, ["no field 'free_lenght'", "free_length"]),
        ("zero_free_length", "{coil: {free_length: 0.1, closed_length: 0.2}}", 10, ["closed length", "free"]),
        ("limits: [{force: s1, max: 1 kN}]", "limits: [{force: s2, max: 1 kN}]", 11, ["no spring called 's2'", "s1"]),
        ("limits: [{force: s1, max: 1 kN}]", "limits: [{forse: s1, max: 1 kN}]", 11, ["no limit 'forse'", "force"]),
        ("limits: [{force: s1, max: 1 kN}]", "limits: [{force: s1}]", 11, ["neither min nor max"]),
        ("max: 1 kN", "max: 1 kN, min: 2 kN", 11, ["min 2000 is above max 1000"]),
        ("max: 1 kN", "max: 1 m", 11, ["'1 m'", "expected a quantity in N"]),
        ("norm: peak", "norm: peek", 12, ["'peek'", "peak"]),
        ("norm: peak", "norm: peak, joints: [elbow]", 12, ["joint 'elbow'"]),
        ("norm: peak", "norm: peak, target: 3 mm", 12, ["'3 mm'"]),
        ("norm: peak", "norm: peak, target: 3 N", 12, ["target is in N", "N m"]),
        ("norm: peak", "norm: peak, weight: -1", 12, ["weight is -1"]),
        ("objective", "shape: {s1.path.line.1.x: [30 cm, 10 cm]}\nobjective", 12, ["reversed"]),
        ("objective", "shape: {s1.path.line.1.w: [10 cm, 30 cm]}\nobjective", 12, ["'w' leads nowhere"]),
        ("objective", "shape: {s2.path.line.1.x: [10 cm, 30 cm]}\nobjective", 12, ["no balancer 's2'", "s1"]),
        ("objective", "shape: {s1.path.line.1.x: [10 deg, 30 cm]}\nobjective", 12, ["'10 deg'", "in m"]),
        ("objective: {", "objectives: {", 12, ["no field 'objectives'", "objective"]),
        ("      law", "       law", 10, ["not valid YAML"]),
        ("      name: s1\n", "      name: s1\n      name: s1\n", 9, ["'name' is given twice", "line 8"]),
        ("norm: peak", "norm: !!python/object:os.system peak", 12, ["tag", "not allowed"]),
        ("name: s1", "name: 1", 8, ["expected text"]),
        ("name: s1", "mass: 0", 7, ["'name' is missing"]),
        ("chain:\n", "chian:\n", 2, ["no mechanism 'chian'", "chain"]),
    ],
)
def test_faults_of_a_problem_file(problem, tmp_path, capsys, old, new, line, words):
    err = refused(capsys, tmp_path, "design", problem(old, new))
    assert f"p.yaml, line {line}" in err
    for word in words:
        assert word in err


@pytest.mark.parametrize(
    ("text", "words"),
    [("", ["empty"]), ("- 1\n", ["not a list of fields"]), ("mechanism: &a [*a]\n", ["line 1", "aliases"])],
)
def test_files_that_are_no_problem(tmp_path, monkeypatch, capsys, text, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.yaml").write_text(text)
    err = refused(capsys, tmp_path, "balance", "p.yaml")
    for word in words:
        assert word in err


def test_a_file_that_is_not_there(problem, tmp_path, capsys):
    problem()
    assert "did you mean p.yaml?" in refused(capsys, tmp_path, "balance", "q.yaml")
    assert "no folder" in refused(capsys, tmp_path, "balance", "nowhere/q.yaml")


def test_missing_and_malformed_models(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.urdf").write_text("this is not XML")
    assert "arm.urdf" in refused(capsys, tmp_path, "analyze", "arn.urdf")
    assert "arm.urdf" in refused(capsys, tmp_path, "analyze", "arm.urdf")
    (tmp_path / "arm.urdf").write_text('<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/hostname">]><robot name="&x;"/>')
    assert "arm.urdf" in refused(capsys, tmp_path, "analyze", "arm.urdf")
    (tmp_path / "p.yaml").write_text("mechanism: {model: robots/arm.urdf}\n")
    err = refused(capsys, tmp_path, "analyze", "p.yaml")
    assert "p.yaml, line 1, mechanism" in err
    assert "robots" in err


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"kind": "fixed"}, ["nothing is driven"]),
        ({"low": 1, "high": -1}, ["hinge"]),
        ({"mass": -1}, ["tip"]),
        ({"mass": "nan"}, ["tip"]),
    ],
)
def test_models_that_no_statics_can_be_done_with(tmp_path, monkeypatch, capsys, fields, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.urdf").write_text(URDF.format(**{"kind": "revolute", "low": -1, "high": 1, "mass": 1} | fields))
    err = refused(capsys, tmp_path, "analyze", "bad.urdf")
    for word in words:
        assert word in err


@pytest.mark.parametrize("mass", [0, 2120])
def test_the_audit_speaks_of_absurd_masses(tmp_path, monkeypatch, capsys, mass):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "odd.urdf").write_text(URDF.format(kind="revolute", low=-1, high=1, mass=mass))
    assert main(["analyze", "odd.urdf"]) == 0
    assert ("2,120 kg" if mass else "no weight") in capsys.readouterr().err


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("arm_joint\n0.1\nnan\n", ["line 3", "finite"]),
        ("arm_joint\n0.1\nfive\n", ["line 3", "'five'"]),
        ("arm_hinge\n0.1\n", ["line 1", "arm_joint"]),
        ("arm_joint\n", ["no poses"]),
    ],
)
def test_faults_of_a_pose_table(problem, tmp_path, capsys, table, words):
    (tmp_path / "poses.csv").write_text(table)
    name = problem("{grid: {arm_joint: [-90 deg, 90 deg, 19]}}", "{poses: poses.csv}")
    err = refused(capsys, tmp_path, "design", name)
    assert "p.yaml, line 5, sweep" in err
    for word in words:
        assert word in err


def test_limits_that_cannot_be_kept_together_are_named(problem, tmp_path, capsys):
    name = problem("[{force: s1, max: 1 kN}]", "[{force: s1, max: 10 N}, {stiffness: s1, min: 100}]")
    err = refused(capsys, tmp_path, "design", name, code=1)
    assert "force of s1 <= 10 N" in err
    assert "stiffness of s1 >= 100 N/m" in err


def test_a_missed_target_is_said_and_the_design_written(problem, tmp_path, capsys):
    name = problem("norm: peak}", "norm: peak, target: 1 N m}").replace("1 kN", "100 N")
    (tmp_path / name).write_text((tmp_path / name).read_text().replace("max: 1 kN", "max: 40 N"))
    assert main(["balance", name, "--out", "answer"]) == 1
    assert "target missed: the peak is" in capsys.readouterr().err
    assert (tmp_path / "answer/design.json").exists()


def test_a_bare_robot_gets_a_problem_file_to_start_from(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.urdf").write_text(URDF.format(kind="revolute", low=-1, high=1, mass=1).replace(
        "<mass", '<origin xyz="0.3 0 0"/><mass'))  # fmt: skip
    err = refused(capsys, tmp_path, "design", "arm.urdf")
    text = err[err.index("mechanism:") : err.index("  -> ")]
    (tmp_path / "arm.yaml").write_text(text)
    assert main(["shape", "arm.yaml", "--starts", "2"]) == 0


def test_nothing_to_shape_or_to_add(problem, tmp_path, capsys):
    assert "no geometry is free" in refused(capsys, tmp_path, "shape", problem())
    (tmp_path / "p.yaml").write_text(PROBLEM[: PROBLEM.index("sweep")])
    assert "nothing is added" in refused(capsys, tmp_path, "design", "p.yaml")


def test_an_answer_that_cannot_be_written(problem, tmp_path, capsys):
    (tmp_path / "out").write_text("a file where a folder should be")
    assert "out" in refused(capsys, tmp_path, "balance", problem())


def test_designs_that_cannot_be_rebuilt(problem, tmp_path, capsys):
    problem()
    for text, word in [("{", "line 1"), ("[]", "not a design"), ('{"unknowns": {}}', "problem")]:
        (tmp_path / "design.json").write_text(text)
        assert word in refused(capsys, tmp_path, "verify", "design.json")
