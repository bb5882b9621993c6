"""Adjusters: one value per payload, patient or tilt, everything else shared; each case judged by other means."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

import equipoise as eq
from equipoise.cli import main
from equipoise.problem import load_problem
from equipoise.targets import target_of

EXAMPLES = Path(__file__).parents[1] / "examples"
G = 9.81


def changed(name, tmp_path, change):
    """An example with other numbers."""
    data = YAML(typ="safe").load((EXAMPLES / f"{name}.yaml").read_text(encoding="utf-8"))
    change(data)
    file = tmp_path / f"{name}.yaml"
    with file.open("w", encoding="utf-8") as stream:
        YAML().dump(data, stream)
    return str(file)


def served(file):
    problem = load_problem(file)
    problem.check()
    return eq.adjust(
        problem.cases, problem.balancers, problem.adjusters, problem.bounds, objective=problem.objective,
        limits=problem.limits, starts=4,
    )  # fmt: skip


def insist_exact(found, bound=1e-9):
    """Nothing is left in any case, and explicit bodies in MuJoCo agree."""
    for design in found.designs:
        load = max(row.peak for row in design.before.values())
        assert max(row.peak for row in design.after.values()) < bound * load
        assert design.certificate.kind == "exact"
        checked = eq.verify(design, poses=60).verification
        assert checked.agrees
        assert checked.max_abs_error < 1e-8 * load


def test_the_hook_of_a_monitor_arm(tmp_path):
    def change(data):
        data["sweep"] = {
            "grid": {"arm_joint": ["-60 deg", "60 deg", 25]},
            "payload": [{"body": "payload", "mass": [2.5, 4.0, 7.0]}],
        }

    found = served(changed("monitor_arm_adjust", tmp_path, change))
    insist_exact(found)
    (adjuster,) = found.adjusters
    k = found.designs[0].values["lift.k"]
    moment = (0.8 / 2 + 0.5 / 2 + 0.3) * 0.25
    heights = [(moment + m * 0.25) * G / (k * 0.12) for m in (2.5, 4.0, 7.0)]
    assert adjuster.values == pytest.approx(heights, rel=1e-9)
    assert adjuster.travel == pytest.approx(heights[2] - heights[0], rel=1e-9)
    # Work by hand: k (|p - h2|^2 - |p - h1|^2) / 2 over the poses.
    q = np.radians(np.linspace(-60, 60, 25))
    h1, h3 = heights[0], heights[2]
    work = 0.5 * k * ((h3**2 - h1**2) - 2 * 0.12 * np.sin(q) * (h3 - h1))
    assert adjuster.work[2] == pytest.approx((work.min(), work.max()), rel=1e-8)
    assert "7 kg" in str(found)
    assert "work to turn it" in str(found)


def test_quaglias_rule(tmp_path):
    """beta = atan2(m y, m2 r2 + m x), F2 b2 = g S2', (P1 - Pa) A b1 = g (m1 r1 + (m2 + m) l1)."""

    def change(data):
        data["sweep"]["payload"] = [{"body": "link2", "mass": [3.0, 12.0], "at": [0.9, 0, -0.2]}]
        data["sweep"]["grid"] = {"link1_joint": [-1.5, 1.5, 9], "link2_joint": [-2.8, -0.3, 9]}

    found = served(changed("quaglia_adjust", tmp_path, change))
    insist_exact(found)
    by_name = {adjuster.name: adjuster.values for adjuster in found.adjusters}
    for i, mass in enumerate((3.0, 12.0)):
        z = 40 * 0.5 + mass * (0.9 - 0.2j)
        assert by_name["y2.path.phase"][i] == pytest.approx(np.angle(z), abs=1e-9)
        assert by_name["y2.force"][i] == pytest.approx(9.8 * abs(z) / 0.2, rel=1e-9)
        assert by_name["y1.pressure"][i] == pytest.approx(9.8 * (60 + (40 + mass) * 1.2) / 0.2 / 7854e-6, rel=1e-9)


def test_an_orthosis_for_patients(tmp_path):
    def change(data):
        data["mechanism"]["human_leg"]["height"] = "1.8 m"
        data["cases"] = [{"mass": 50}, {"mass": 72}, {"mass": 100}]

    found = served(changed("orthosis_patients", tmp_path, change))
    insist_exact(found)
    heights = np.array(found.adjusters[0].values)
    assert heights / heights[0] == pytest.approx([1, 1.44, 2], rel=1e-9)
    assert found.labels == ("mass 50", "mass 72", "mass 100")
    # The second spring is the same for all: k2 e s2 = k1 l1 s1, e beyond the knee, s the ends on the shank.
    assert found.designs[0].values["s2.k"] == found.designs[2].values["s2.k"]
    thigh = 0.245 * 1.8
    pull = 600 * thigh * found.designs[0].geometry["s1.path.line.1.x"]
    assert found.designs[0].values["s2.k"] * (0.62875 - thigh) * 0.152578 == pytest.approx(pull, rel=1e-9)
    # V constant over random postures, masses and springs by hand.
    design = found.designs[1]
    rng = np.random.default_rng(0)
    poses = np.stack([rng.uniform(-np.pi, np.pi, 1000), rng.uniform(-2.0, 0.0, 1000)], axis=1)
    states = design.mechanism.states(eq.Sweep(poses, np.ones(1000), "random"))
    energy = states.potential.copy()
    for spring in design.balancers:
        a, b = (states.point(end)[0] for end in (spring.path.a, spring.path.b))
        rate = design.values.get(f"{spring.name}.k", spring.law.k)
        energy += 0.5 * rate * ((a - b) ** 2).sum(axis=1)
    assert np.ptp(energy) < 1e-9 * np.ptp(states.potential)


def test_a_tilted_base_counts_its_worst_lean():
    """One spring for a base that leans 20 degrees: the residual of the lean is what no vertical spring takes."""
    arm = eq.chain([eq.Link("arm", length=0.5, mass=3.0)])
    sweep = eq.Sweep.grid(arm, {"arm_joint": (-np.pi, np.pi, 181)})
    spring = eq.Spring("s", eq.Line(eq.Point("world", (0, 0, 0.2)), arm.at("arm", 0.2)), eq.ZeroFreeLength())
    lean = np.radians(20)
    cases = [eq.Case(label, mech, sweep) for label, mech in eq.Tilt(lean, axis=(0, 1, 0)).apply(arm).items()]
    found = eq.adjust(cases, [spring], {}, norm="peak")
    load = 3.0 * G * 0.25
    # Torque of the lean: load cos(q -+ lean); the spring holds a cos q. Worst of three phasors is least at a.
    share = np.linspace(0, 1.2, 4001)
    worst = np.maximum(np.abs(1 - share), np.abs(np.exp(1j * lean) - share)) * load
    assert found.designs[0].certificate.primal == pytest.approx(worst.min(), rel=1e-3)
    peaks = [design.after["arm_joint"].peak for design in found.designs]
    assert max(peaks) == pytest.approx(worst.min(), rel=1e-3)
    for design in found.designs:
        assert eq.verify(design, poses=60).verification.agrees
    # The cone has `directions` leans; with the anchor adjusted, every lean about the axis is exact.
    assert len(eq.Tilt(lean, 6).apply(arm)) == 7
    screws = {"s.path.line.0.x": (-0.2, 0.2), "s.path.line.0.z": (0.1, 0.3)}
    turned = eq.adjust(cases, [spring], screws, norm="rms")
    assert turned.designs[0].certificate.kind == "exact"
    x, z = (np.array(adjuster.values) for adjuster in turned.adjusters)
    assert np.abs(np.arctan2(x, z)) == pytest.approx([0, lean, lean], abs=1e-8)


def test_the_command_writes_every_case(tmp_path, capsys):
    def change(data):
        data["cases"] = [{"case": "light", "mass": "50 kg"}, {"case": "heavy", "mass": "100 kg"}]
        data["sweep"] = {"grid": {"hip": [-2.0, -0.6, 5], "knee": [-1.5, 0.0, 5]}}

    file, out = changed("orthosis_patients", tmp_path, change), tmp_path / "out"
    assert main(["design", file, "--json", "--out", str(out)]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["settings"]["case"] == "heavy"
    assert [case["case"] for case in data["cases"]] == ["light", "heavy"]
    assert "Settings from case to case" in (out / "report.html").read_text(encoding="utf-8")
    for place in (out, out / "case_1"):
        problem = json.loads((place / "design.json").read_text(encoding="utf-8"))["problem"]
        assert (place / problem["folder"] / problem["file"]).samefile(file)
    # A case's design reads back as what it was.
    again = target_of(str(out / "case_1" / "design.json"))
    assert not again.remarks
    assert again.design.mechanism.mass == pytest.approx(50 * (0.1 + 0.061), rel=1e-6)
    assert main(["verify", str(out / "case_2" / "design.json"), "--poses", "50"]) == 0


@pytest.mark.parametrize(
    ("adjust", "message"),
    [
        ({"lift.path.line.0.y": ["0 mm", "50 mm"]}, "nothing depends on lift.path.line.0.y"),
        ({"lift.path.line.0.w": [0, 1]}, "leads nowhere"),
        ({"lift.path.line.0.z": None}, "needs a range"),
        ({"lift.path.line.0.z": [0.2, 0.1]}, "reversed"),
        ({"lift.k": ["1 kg", "2 kg"]}, "expected a quantity in N/m"),
    ],
)
def test_adjusters_that_are_none(adjust, message, tmp_path, capsys):
    file = changed("monitor_arm_adjust", tmp_path, lambda data: data.update(adjust=adjust))
    assert main(["balance", file]) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert message in said
    assert "Traceback" not in said


def test_one_payload_needs_no_adjuster(tmp_path, capsys):
    def change(data):
        data["sweep"]["payload"][0]["mass"] = "5 kg"

    assert main(["shape", changed("monitor_arm_adjust", tmp_path, change)]) == 2
    assert "nothing to adjust to" in capsys.readouterr().err
    with pytest.raises(eq.InputError, match="lies between"):
        eq.Tilt(2.0)
    with pytest.raises(eq.InputError, match="along gravity"):
        eq.Tilt(0.1, axis=(0, 0, 1)).apply(eq.chain([eq.Link("arm", length=0.5, mass=3.0)]))
