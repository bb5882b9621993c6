"""The commands: what they print where, exit codes, files that can be read again, Ctrl-C."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from equipoise import cli
from equipoise.cli import main
from equipoise.errors import DisagreementError

PROBLEM = """\
mechanism:
  chain:
    links:
      - {name: arm, length: 500 mm, mass: 2 kg, limits: [-90 deg, 90 deg], motor_limit: 20 N m}
sweep: {grid: {arm_joint: [-90 deg, 90 deg, 37]}, payload: [{body: arm, mass: [0, 1 kg], at: [500 mm, 0, 0]}]}
balancers:
  - spring:
      name: s1
      path: {line: [[world, 0, 0, 0.2], [arm, 0.1, 0, 0]]}
      law: {coil: {free_length: 80 mm}}
shape: {s1.path.line.0.z: [10 cm, 30 cm], s1.path.line.1.x: [8 cm, 25 cm]}
search: {starts: 3, seed: 4}
limits: [{force: s1, max: 600 N}, {slack: s1}]
objective: {goal: hold, norm: peak}
"""
MASS = 2 * 9.81 * 0.25


@pytest.fixture
def problem(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("p.yaml").write_text(PROBLEM, encoding="utf-8")
    return "p.yaml"


def run(capsys, *arguments: str, code: int = 0):
    assert main(arguments) == code
    out, err = capsys.readouterr()
    assert "Traceback" not in err
    return out, err


def test_help_lists_the_verbs_and_loads_nothing_heavy():
    began = time.perf_counter()
    code = (
        "import sys; from equipoise.cli import main; main(['--help']);"
        "print([n for n in ('numpy', 'mujoco', 'scipy', 'matplotlib', 'pint', 'pydantic') if n in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert time.perf_counter() - began < 10  # one second alone; the machine may be busy
    assert done.stdout.rstrip().endswith("[]")
    verbs = "analyze balance shape discover design pick survey verify report compare reproduce schema"
    for verb in verbs.split():
        assert f" {verb} " in done.stdout
    assert " studio " not in done.stdout


def test_version_and_usage(capsys):
    assert run(capsys, "--version")[0].startswith("equipoise 0.")
    assert "design" in run(capsys, "desing", "x", code=2)[1]
    assert "FILE" in run(capsys, "analyze", code=2)[1]


def test_schema_is_on_stdout(capsys):
    out, err = run(capsys, "schema")
    assert json.loads(out)["$schema"].endswith("2020-12/schema")
    assert err == ""


def test_analyze(problem, capsys):
    out, err = run(capsys, "analyze", problem, "--json", "--out", "out")
    found = json.loads(out)
    assert found["rows"]["arm_joint"]["peak"] == pytest.approx(MASS + 9.81 * 0.5, rel=1e-6)
    assert found["rows"]["arm_joint"]["worth_a_spring"]
    assert json.loads(Path("out/analysis.json").read_text()) == found
    assert "arm_joint" in err


def test_without_json_stdout_is_empty(problem, capsys):
    out, err = run(capsys, "balance", problem)
    assert out == ""
    assert "spring s1" in err
    assert not Path("out").exists()


def test_balance_answers_the_contract(problem, capsys):
    found = json.loads(run(capsys, "balance", problem, "--json", "--out", "deep/er")[0])
    for key in ("equipoise", "problem", "seed", "unknowns", "geometry", "norm", "before", "after", "certificate",
                "verification", "parts", "cite"):  # fmt: skip
        assert key in found
    assert found["unknowns"]["s1.k"]["unit"] == "N/m"
    assert found["geometry"] == {}
    assert found["certificate"]["kind"] == "convex"
    assert json.loads(Path("deep/er/design.json").read_text()) == found


def test_design_from_file_to_report_and_back(problem, capsys, monkeypatch):
    out, err = run(capsys, "design", problem, "--json", "--out", "out/arm")
    found = json.loads(out)
    assert [line.split()[-1] for line in err.splitlines()[-3:]] == [
        "out/arm/chain_balanced.xml", "out/arm/design.json", "out/arm/report.html",
    ]  # fmt: skip
    assert sorted(path.name for path in Path("out/arm").iterdir()) == [
        "chain_balanced.xml", "design.json", "report.html", "residuals.csv",
    ]  # fmt: skip
    assert found["seed"] == 4
    assert found["verification"]["agrees"]
    assert found["after"]["arm_joint"]["peak"] >= 9.81 * 0.25  # half the payload's own torque

    def solved(*_, **__):
        raise AssertionError("a design that is there must not be solved again")

    monkeypatch.setattr("equipoise.verbs.shape.shape", solved)
    monkeypatch.setattr("equipoise.verbs.balance.balance", solved)
    os.chdir("out")
    again = json.loads(run(capsys, "verify", "arm/design.json", "--json", "--out", "other", "--poses", "50")[0])
    assert again["unknowns"] == found["unknowns"]
    assert again["geometry"] == found["geometry"]
    assert again["certificate"] == found["certificate"]
    assert again["after"]["arm_joint"]["peak"] == pytest.approx(found["after"]["arm_joint"]["peak"], rel=1e-9)
    assert again["problem"]["file"] == "p.yaml"
    assert again["problem"]["folder"] == "../.."
    assert again["verification"]["poses"] == 50
    run(capsys, "report", "other/design.json", "--out", "third")
    assert Path("third/report.html").exists()


def test_a_design_changed_by_hand_is_noticed(problem, capsys):
    run(capsys, "balance", problem, "--out", "out")
    file = Path("out/design.json")
    data = json.loads(file.read_text())
    data["unknowns"]["s1.k"]["value"] *= 1.1
    file.write_text(json.dumps(data))
    assert "the file says a peak of" in run(capsys, "verify", str(file), "--poses", "20")[1]


def test_relative_models_resolve_from_the_design(tmp_path, monkeypatch, capsys):
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots/arm.xml").write_text(
        "<mujoco><worldbody><body name='arm'><joint name='hinge' axis='0 1 0' limited='true' range='-90 90'/>"
        "<geom type='box' size='.2 .02 .02' pos='.2 0 0' mass='1'/></body></worldbody></mujoco>"
    )
    (tmp_path / "p.yaml").write_text(
        "mechanism: {model: robots/arm.xml}\nsweep: {grid: {hinge: [-1, 1, 9]}}\n"
        "balancers: [{spring: {name: s, path: {line: [[world, 0, 0, 0.2], [arm, 0.1]]}, law: zero_free_length}}]\n"
    )
    monkeypatch.chdir(tmp_path / "robots")
    run(capsys, "balance", "../p.yaml", "--out", "../deep/out")
    monkeypatch.chdir("/")
    found = run(capsys, "verify", str(tmp_path / "deep/out/design.json"), "--poses", "20", "--json")[0]
    assert json.loads(found)["verification"]["agrees"]


def test_the_seed_makes_a_search_repeatable(problem, capsys):
    first, second = (
        json.loads(run(capsys, "shape", problem, "--json", "--seed", "9", "--starts", "2")[0]) for _ in range(2)
    )
    assert first == second
    assert first["seed"] == 9


def test_a_map_over_two_parameters(problem, capsys, monkeypatch):
    monkeypatch.setattr("equipoise.verbs.geometry_map.POINTS", 5)
    names = ("s1.path.line.0.z", "s1.path.line.1.x")
    run(capsys, "shape", problem, "--starts", "2", "--map", *names, "--norm", "rms", "--out", "out")
    table = Path("out/map.csv").read_text().splitlines()
    assert table[0] == "s1.path.line.0.z [m],s1.path.line.1.x [m],rms [N m]"
    assert Path("out/map.svg").read_text().lstrip().startswith("<?xml")
    assert "did you mean" in run(capsys, "shape", problem, "--map", names[0], "s1.path.line.1.y", code=2)[1]


def test_ctrl_c_in_the_search_keeps_the_best_so_far(problem, capsys, monkeypatch):
    import signal

    from equipoise.tasks import starts

    handler = signal.getsignal(signal.SIGINT)
    plain = starts.descend
    calls = []

    def descend(*args, **options):
        calls.append(None)
        if len(calls) == 2:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(1)
        return plain(*args, **options)

    monkeypatch.setattr(starts, "descend", descend)
    _, err = run(capsys, "design", problem, "--out", "out", code=130)
    assert "stopping" in err
    assert Path("out/report.html").exists()
    assert signal.getsignal(signal.SIGINT) is handler


def test_ctrl_c_before_and_after_the_search(problem, capsys, monkeypatch):
    def stop(*_, **__):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("equipoise.verbs.verify.verify", stop)
        run(capsys, "design", problem, "--out", "out", code=130)
        assert [path.name for path in Path("out").iterdir()] == ["design.json"]
    monkeypatch.setattr("equipoise.verbs.shape.shape", stop)
    assert "nothing was written" in run(capsys, "design", problem, "--out", "none", code=130)[1]
    assert not Path("none").exists()


def test_a_verification_that_disagrees(problem, capsys, monkeypatch):
    def insist(_):
        raise DisagreementError("the saved model differs by 1 N m", where="chain")

    monkeypatch.setattr("equipoise.verbs.verify.insist", insist)
    assert "differs by 1 N m" in run(capsys, "verify", problem, "--poses", "20", code=1)[1]


def test_a_bug_is_one_line_and_a_traceback_on_demand(problem, capsys, monkeypatch):
    def broken(*_):
        raise ZeroDivisionError("no\nreason")

    monkeypatch.setattr("equipoise.targets.target_of", broken)
    assert "internal error: ZeroDivisionError: no reason" in run(capsys, "analyze", problem, code=70)[1]
    monkeypatch.setenv("EQUIPOISE_DEBUG", "1")
    assert main(["analyze", problem]) == 70
    assert "Traceback" in capsys.readouterr().err


def test_progress_shows_only_on_a_terminal(monkeypatch, capsys):
    from equipoise.console import progress_bar

    with progress_bar("shape", "starts", "N m") as quiet:
        assert quiet is None
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with progress_bar("shape", "starts", "N m") as show:
        assert show is not None
        show(1, 2, 3.0)
    assert capsys.readouterr().out == ""


def test_every_command_is_in_the_help():
    assert {command.name or command.callback.__name__ for command in cli.app.registered_commands} == {
        "analyze", "conditions", "side_by_side", "balance", "shape", "discover", "design", "verify", "make",
        "report", "compare", "reproduce", "schema", "front", "pick", "survey", "substitute",
    }  # fmt: skip
