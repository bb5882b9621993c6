"""Assemblies by name: where a motion starts singular, or on another branch than the reference's."""

from __future__ import annotations

import math

import numpy as np
import pytest

import equipoise as eq
from equipoise.cli import main
from equipoise.loops import assemblies, loop_report

ROOT3 = math.sqrt(3)
PRINTED = f"""
mechanism:
  rrr3:
    bases: [[0, 0], [0.46, 0], [0.23, {0.23 * ROOT3!r}]]
    platform: [[-0.05, {-0.05 / ROOT3!r}], [0.05, {-0.05 / ROOT3!r}], [0, {0.1 / ROOT3!r}]]
    cranks: [0.18, 0.18, 0.18]
    rods: [0.18, 0.18, 0.18]
    pose: [0.23, {0.05 / ROOT3!r}, 0]
    elbows: [left, left, right]
    crank_masses: [0.5, 0.5, 0.5]
    rod_masses: [0.5, 0.5, 0.5]
    platform_mass: 3
    platform_inertia: 0.01
    gravity: [0, 0, 0]
sweep:
  motion:
    crank_1_joint: pi/3 + (2*pi*t/T - sin(2*pi*t/T))/6
    crank_2_joint: 4*pi/3 - (2*pi*t/T - sin(2*pi*t/T))/6
    crank_3_joint: 10*pi/3 + (2*pi*t/T - sin(2*pi*t/T))/12
  duration: 0.3 s
  samples: 201
"""


def test_a_four_bar_has_two_assemblies():
    bar = eq.four_bar(0.14, 0.05, 0.15, 0.125)
    found = assemblies(bar, np.array([0.3]))
    assert set(found) == {"rocker_joint-", "rocker_joint+"}
    gaps, sizes = loop_report(bar, np.stack(list(found.values())))
    assert gaps.max() < 1e-12
    assert sizes.min() > bar.singularity
    open_, crossed = (eq.four_bar(0.14, 0.05, 0.15, 0.125, branch=branch) for branch in ("open", "crossed"))
    for mechanism in (open_, crossed):
        q = mechanism.states(eq.Sweep.of_poses(mechanism, [{"crank_joint": 0.3}])).kin.q[0]
        assert any(np.allclose(np.mod(q, 2 * np.pi), np.mod(one, 2 * np.pi), atol=1e-9) for one in found.values())
    other = open_.on_branch("rocker_joint+", {"crank_joint": 0.3})
    turned = other.states(eq.Sweep.of_poses(other, [{"crank_joint": 1.0}])).kin.q[0]
    direct = crossed.states(eq.Sweep.of_poses(crossed, [{"crank_joint": 1.0}])).kin.q[0]
    assert np.mod(turned, 2 * np.pi) == pytest.approx(np.mod(direct, 2 * np.pi), abs=1e-9)
    with pytest.raises(eq.LoopError, match=r"there is no branch 'up'(.|\n)*choose rocker_joint- or rocker_joint\+"):
        open_.on_branch("up", {"crank_joint": 0.3})


def test_a_singular_start_names_its_branches(tmp_path, capsys):
    file = tmp_path / "printed.yaml"
    file.write_text(PRINTED)
    assert main(["analyze", str(file)]) == 2
    said = capsys.readouterr().err
    assert "the motion cannot start at t = 0 s" in said
    assert "`start: 0.009 s`" in said
    assert "`branch: rod_3_joint-` or `branch: rod_3_joint+`" in said
    file.write_text(PRINTED + "  start: 9 ms\nbranch: sideways\n")
    assert main(["analyze", str(file)]) == 2
    assert "choose rod_3_joint- or rod_3_joint+" in capsys.readouterr().err


@pytest.mark.parametrize("side", ["-", "+"])
def test_a_named_branch_leaves_the_singularity_as_the_expansion_says(tmp_path, side):
    """The platform leaves as t^1.5 to either side; torques of legs 2 and 3 grow as 1/t^2 towards the start."""
    file = tmp_path / "printed.yaml"
    file.write_text(PRINTED + f"  start: 9 ms\nbranch: rod_3_joint{side}\n")
    problem = eq.load_problem(file)
    states = problem.mechanism.states(problem.sweep)
    place = states.kin.q[0, [states.mechanism.model.joint(f"platform_{x}").qposadr[0] for x in "xz"]]
    away = (place - [0.23, 0.05 / ROOT3]) @ [ROOT3 / 2, 0.5]
    sign = 1.0 if side == "+" else -1.0
    assert away == pytest.approx(sign * 3.2773 * 0.009**1.5, rel=0.05)
    drive = problem.mechanism.effort(states, "drive").b[0]
    assert np.abs(drive[1:]) * 0.009**2 == pytest.approx([0.0368] * 2, rel=0.15)


def test_a_design_on_a_named_branch_is_verified(tmp_path):
    file = tmp_path / "bar.yaml"
    file.write_text(
        "mechanism: {four_bar: {ground: 140 mm, crank: 50 mm, coupler: 150 mm, rocker: 125 mm, masses: [1, 3, 2]}}\n"
        "branch: rocker_joint+\n"
        "sweep: {motion: {crank_joint: 0.3 + 2*pi*t/T}, duration: 0.12 s, samples: 121}\n"
        "balancers: [{counterweight: {name: tail, at: [crank, -50 mm, 0, 0]}}]\nobjective: {goal: force}\n"
    )
    problem = eq.load_problem(file)
    design = eq.balance(problem.mechanism, problem.balancers, problem.sweep, objective=problem.objective)
    crossed = eq.four_bar(0.14, 0.05, 0.15, 0.125, masses=(1, 3, 2), branch="crossed")
    sweep = eq.Sweep.motion(crossed, {"crank_joint": "0.3 + 2*pi*t/T"}, duration=0.12, samples=121)
    other = eq.balance(crossed, problem.balancers, sweep, objective=problem.objective)
    assert design.after["force"].rms == pytest.approx(other.after["force"].rms, rel=1e-9)
    found = eq.verify(design, poses=50).verification
    assert found.agrees
    assert found.motion is not None
