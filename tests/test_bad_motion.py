"""Bad input of dynamic problems through the command line: exit code, one clear message, no traceback."""

from __future__ import annotations

import pytest

from equipoise.cli import main

BAR = "mechanism:\n  four_bar: {ground: 140 mm, crank: 50 mm, coupler: 150 mm, rocker: 125 mm, masses: [1, 3, 2]}\n"
ROCKER = "mechanism:\n  four_bar: {ground: 40 cm, crank: 30 cm, coupler: 25 cm, rocker: 20 cm, masses: [1, 1, 1]}\n"
TURN = "sweep: {motion: {crank_joint: 2*pi*t/T}, duration: 0.12 s, samples: 61}\n"
TAIL = "balancers: [{counterweight: {name: tail, at: [crank, -50 mm, 0, 0]}}]\nobjective: {goal: force}\n"
PLATE = "balancers: [{counterweight: {name: tail, at: [crank], reach: 5 cm, shape: plate}}]\n"


def drive(text, more="duration: 1 s"):
    return f"sweep: {{motion: {{crank_joint: {text}}}, {more}}}\n"


RRR3 = (
    "mechanism:\n  rrr3:\n    bases: [[0, 0], [0.46, 0], [0.23, 0.4]]\n"
    "    platform: [[-0.05, -0.03], [0.05, -0.03], [0, 0.06]]\n    cranks: [0.18, 0.18, 0.18]\n"
    "    rods: [0.18, 0.18, 0.18]\n    pose: [0.23, 0.03, 0]\n    rod_masses: [0.5, 0.5, 0.5]\n"
)

WRONG = {
    "the loop opens on the way": (
        ROCKER + drive("0.8 + 3*t") + TAIL,
        ["line 3, sweep", "the motion stops at t = 0.190", "do not close", "the gap is", "mm", "singular value"],
    ),
    "the loop is open at the start": (
        ROCKER + drive("2.9 + 0*t") + TAIL,
        ["line 3, sweep", "the motion cannot start at t = 0 s", "the gap is 245 mm"],
    ),
    "no such function": (BAR + drive("2*t + foo(t)") + TAIL, ["there is no function 'foo'", "known: sin"]),
    "a call that would run": (BAR + drive("\"__import__('os').getcwd()\"") + TAIL, ["is outside the grammar"]),
    "an unknown name": (BAR + drive("omega*t") + TAIL, ["the expression names 'omega'"]),
    "an endless velocity": (BAR + drive("sqrt(t)") + TAIL, ["the velocity of 'sqrt(t)' is inf at t = 0 s"]),
    "no duration": (BAR + "sweep: {motion: {crank_joint: t}}\n" + TAIL, ["the motion has no duration"]),
    "times of a file that stand still": (
        BAR + "sweep: {motion: still.csv}\n" + TAIL,
        ["still.csv", "time does not increase: 0.1 s follows 0.1 s"],
    ),
    "a word in a file": (BAR + "sweep: {motion: word.csv}\n" + TAIL, ["word.csv, line 3, column crank_joint"]),
    "no file": (BAR + "sweep: {motion: none.csv}\n" + TAIL, ["none.csv", "cannot read the file: No such file"]),
    "times of a spline that go back": (
        BAR + drive("{spline: {times: [0, 1, 0.5], values: [0, 1, 2]}}") + TAIL,
        ["time does not increase: 0.5 s follows 1 s"],
    ),
    "a joint that loops determine": (
        BAR + "sweep: {motion: {rocker_joint: t}, duration: 1}\n" + TAIL,
        ["joint 'rocker_joint' is not driven"],
    ),
    "nothing keeps mass down": (
        BAR + TURN + PLATE + "objective: [{goal: moment}, {goal: force}]\n",
        ["nothing keeps the mass of tail down", "{goal: mass, cap: 2 kg}"],
    ),
    "a negative mass": (BAR.replace("3, 2", "-3, 2") + TURN + TAIL, ["four_bar.coupler: mass is -3 kg"]),
    "a negative inertia": (RRR3 + "    rod_inertias: [0.001, -0.001, 0.001]\n", ["rrr3.rod_2: inertia is -0.001"]),
    "an inertia that no body has": (
        "mechanism: {chain: {links: [{name: arm, length: 0.3, mass: 1, inertia: [0.001, 0.001, 0.01]}]}}\n",
        ["chain.arm: inertia (0.001, 0.001, 0.01) kg m^2 belongs to no body"],
    ),
    "a file with such a body": ("mechanism: {model: flat.xml}\n", ["flat.xml", "inertia must satisfy", "'arm'"]),
    "inertia without a motion": (
        BAR + "sweep: {grid: {crank_joint: [0, 1, 5]}}\n" + TAIL,
        ["inertia needs a motion, and the sweep is a set of poses"],
    ),
    "a leg out of reach": (RRR3.replace("[0.23, 0.03, 0]", "[0.6, 0.1, 0]"), ["leg 1 does not reach its pin"]),
    "a branch that is none": (BAR + "branch: up\n" + TURN + TAIL, ["there is no branch 'up'", "rocker_joint-"]),
}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "still.csv").write_text("time,crank_joint\n0,0\n0.1,0.2\n0.1,0.3\n")
    (tmp_path / "word.csv").write_text("time,crank_joint\n0,0\n0.1,x\n0.2,0.3\n")
    (tmp_path / "flat.xml").write_text(
        '<mujoco><worldbody><body name="arm"><joint name="a" axis="0 1 0"/>'
        '<inertial pos="0 0 0.1" mass="1" diaginertia="0.001 0.001 0.01"/></body></worldbody></mujoco>'
    )
    return tmp_path


def said(capsys, folder, text):
    file = folder / "p.yaml"
    file.write_text(text)
    code = main(["balance" if "balancers" in text else "analyze", str(file)])
    told = capsys.readouterr()
    assert not told.out
    assert "Traceback" not in told.err
    errors = [line for line in told.err.splitlines() if line.startswith(("error:", "internal error"))]
    assert len(errors) == 1
    return code, told.err


@pytest.mark.parametrize("name", WRONG)
def test_bad_input_ends_with_code_two_and_one_message(name, folder, capsys):
    text, words = WRONG[name]
    code, told = said(capsys, folder, text)
    assert code == 2
    assert "p.yaml, line" in told
    for word in words:
        assert word in told


@pytest.mark.parametrize(
    ("objective", "words"),
    [
        (
            "[{goal: drive}, {goal: force, cap: 1 N}, {goal: mass, cap: 2 kg}]",
            "rms of force <= 1 cannot be kept",
        ),
        ("{goal: force, target: 1 N}", "target missed: the rms is"),
    ],
)
def test_an_infeasible_balance_ends_with_code_one_and_the_reason(objective, words, folder, capsys):
    code, told = said(capsys, folder, BAR + TURN + PLATE + f"objective: {objective}\n")
    assert code == 1
    assert words in told


def test_caps_that_conflict_are_named_together(folder, capsys):
    """Each can be kept alone: little added mass leaves the force, little force needs mass."""
    weights = (
        "balancers:\n  - counterweight: {name: tail, at: [crank], reach: 5 cm, shape: plate}\n"
        "  - counterweight: {name: back, at: [rocker], reach: 6 cm, shape: plate}\n"
    )
    alone = "[{goal: moment}, {goal: force, cap: 100 N}, {goal: mass, cap: 20 kg}]"
    file = folder / "p.yaml"
    file.write_text(BAR + TURN + weights + f"objective: {alone}\n")
    assert main(["balance", str(file)]) == 0
    capsys.readouterr()
    code, told = said(capsys, folder, BAR + TURN + weights + f"objective: {alone.replace('20 kg', '0.1 kg')}\n")
    assert code == 1
    assert all(word in told for word in ("rms of force <= 100", "of mass <= 0.1"))
