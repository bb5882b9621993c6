"""Exact balancers from ordinary springs: found by `shape`, judged by trigonometry, by MuJoCo's bodies and by energy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

import equipoise as eq
from equipoise.problem import load_problem

EXAMPLES = Path(__file__).parents[1] / "examples"
G = 9.81


def found(name, tmp_path, mass=4.0, com=0.35, lean=0.0):
    """The example's design for another arm, which may lean: its centre off the axis by lean."""
    text = YAML(typ="safe").load((EXAMPLES / f"{name}.yaml").read_text(encoding="utf-8"))
    text["mechanism"]["chain"]["links"][0] |= {"mass": mass, "com": [com, 0, lean]}
    file = tmp_path / "problem.yaml"
    with file.open("w", encoding="utf-8") as stream:
        YAML().dump(text, stream)
    problem = load_problem(file)
    problem.check()
    return eq.shape(
        problem.mechanism, problem.balancers, problem.sweep, problem.bounds, objective=problem.objective,
        limits=problem.limits,
    )  # fmt: skip


CASES = [("exact_yoke", 4.0, 0.35), ("exact_rod", 2.7, 0.31), ("exact_cam", 3.1, 0.4)]


@pytest.mark.parametrize(("name", "mass", "com"), CASES)
def test_ordinary_springs_balance_exactly(name, mass, com, tmp_path):
    design = found(name, tmp_path, mass, com)
    load = mass * G * com
    assert design.certificate.kind == "exact"
    assert design.after["arm_joint"].peak < 1e-9 * load
    spring, part = design.balancers[0], design.parts()[0]
    assert spring.law.free_length > 0
    assert part["force"][1] <= 1e-6 * abs(part["force"][0])  # a compression spring
    limit = next(limit for limit in design.limits if type(limit).__name__ == "Stroke")
    assert part["stroke"] <= limit.max * (1 + 1e-9)
    low, high = np.array(part["room"])
    assert (high - low)[[0, 2]].min() > 0 or name == "exact_cam"
    assert str(design).count("room") == 1
    # Energy by hand, over angles that the design never saw.
    box = design.mechanism.box[0]
    q = np.random.default_rng(3).uniform(*np.where(np.isnan(box), [-np.pi, np.pi], box), 500)
    path, k, free = spring.path, design.values["s1.k"], spring.law.free_length
    w = path.phase + (0.5 * q if name == "exact_yoke" else q)
    if name == "exact_yoke":
        length = path.offset + path.radius * np.sin(w)
    elif name == "exact_rod":
        length = path.rod - np.sqrt(path.crank**2 + path.distance**2 - 2 * path.crank * path.distance * np.cos(w))
    else:
        length = path.offset - path.profile.base * np.sqrt(1 - path.profile.share * np.cos(w))
    energy = 0.5 * k * (length - free) ** 2 + load * np.cos(q)
    assert np.ptp(energy) < 1e-9 * load
    # Explicit cranks, yokes and rods in MuJoCo, the file read back.
    checked = eq.verify(design, poses=200).verification
    assert checked.agrees
    assert checked.max_abs_error < 1e-8 * load


def test_the_phase_follows_a_centre_off_the_axis(tmp_path):
    """The rod's pivot leans with the weight: the phase is the angle of the centre of mass."""
    design = found("exact_rod", tmp_path, 4.0, 0.35, 0.05)
    assert design.certificate.kind == "exact"
    assert abs(design.geometry["s1.path.phase"]) == pytest.approx(np.arctan2(0.05, 0.35), abs=1e-9)


def test_a_rod_too_short_and_a_pointed_cam_are_refused():
    arm = eq.chain([eq.Link("arm", length=0.6, mass=4.0)], datum="up")
    sweep = eq.Sweep.grid(arm, {"arm_joint": (0.0, 3.0, 31)})
    short = eq.Spring("s", eq.InvertedSliderCrank(eq.Angle("arm_joint"), 0.06, 0.1, rod=0.15), eq.Coil(0.2))
    with pytest.raises(eq.InputError, match=r"cannot close at an input angle of .* rod 150 mm, .* mm are missing"):
        eq.balance(arm, [short], sweep)
    with pytest.raises(eq.InputError, match="between 0 and 1"):
        eq.ConstantEnergy(0.05, 1.0)
