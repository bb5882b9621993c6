"""The cable examples run from file to verified design and meet numbers worked out by other means."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import equipoise as eq
from equipoise.cli import main

EXAMPLES = Path(__file__).parent.parent / "examples"


def run(name):
    problem = eq.load_problem(EXAMPLES / f"{name}.yaml")
    problem.check()
    pieces = (problem.mechanism, problem.balancers, problem.sweep)
    return problem, eq.balance(*pieces, objective=problem.objective, limits=problem.limits)


def test_triangle_cables(tmp_path):
    problem, design = run("triangle_cables")
    area = 3**0.5 / 4
    assert 0.5 * area * design.after["resultant"].rms ** 2 == pytest.approx(0.038931517152, rel=1e-8)
    assert design.certificate.quadrature < 1e-8
    assert eq.verify(design, poses=200).verification.max_abs_error < 1e-10
    part = problem.content.make[0].part(problem.mechanism, design)
    assert part.wrapped.error < 1e-3
    page = eq.report(design, tmp_path)
    assert "resultant" in page.read_text(encoding="utf-8")


def test_a_torsion_spring_behind_a_four_bar_on_every_reel():
    problem = eq.load_problem(EXAMPLES / "triangle_four_bar.yaml")
    problem.check()
    asked = {"objective": problem.objective, "limits": problem.limits, "starts": 1}
    design = eq.shape(problem.mechanism, problem.balancers, problem.sweep, problem.bounds, **asked)
    # Quartics leave 0.0389, cubics 0.0619, constant forces 0.0944 N^2 m^2.
    assert 0.5 * 3**0.5 / 4 * design.after["resultant"].rms ** 2 < 0.0487
    paths = [spring.path for spring in design.balancers]
    assert len({(path.crank, path.coupler, path.rocker, path.phase, path.input.radius) for path in paths}) == 1
    k, preload = design.values["s1.k"], design.values["s1.preload"]
    turn, rate = paths[0].along(np.linspace(0, 1, 20_001))
    assert ((preload + k * turn) * rate).min() >= 1 - 1e-8
    assert (preload + k * turn).max() / k <= 4 * np.pi
    mu = np.degrees(paths[0].transmission(np.linspace(0, 1, 1001) / paths[0].input.radius + paths[0].phase))
    assert 30 - 1e-6 <= mu.min() <= mu.max() <= 150 + 1e-6
    assert eq.verify(design, poses=200).verification.agrees


def test_planar_platform():
    _, design = run("planar_platform")
    # Springs of the same law on all reels cannot carry a weight in a symmetric frame; with laws of their own they
    # take more than half of it off. Constant forces leave 1/2 rms^2 = 11.43, quintics 10.23.
    assert design.before["resultant"].rms == pytest.approx(9.81)
    assert 10.1 < 0.5 * design.after["resultant"].rms ** 2 < 11.43
    for spring in design.balancers:
        length = np.linspace(*spring.law.interval, 5001)
        force = spring.law.force_basis(length)[0] @ np.array([design.values[u.name] for u in spring.unknowns])
        assert force.min() >= 1 - 1e-8
        assert force.max() <= 25 * (1 + 1e-8)
    assert eq.verify(design, poses=200).verification.agrees


def test_spatial_8_cables():
    _, design = run("spatial_8_cables")
    assert design.before["z"].rms == pytest.approx(2 * 9.81)
    assert design.after["resultant"].rms < 0.5 * design.before["resultant"].rms
    assert eq.verify(design, poses=100).verification.agrees
    # In the middle the four upper cables carry the weight and the pull of the lower ones.
    states = design.mechanism.states(eq.Sweep.of_poses(design.mechanism, [{"x": 0.5, "y": 0.5, "z": 0.5}]))
    assert np.abs(design.residual(states, "wrench")[0, [0, 1, 3, 4, 5]]).max() < 1e-9


def test_report_draws_the_platform_and_its_cam(tmp_path):
    """The map with its equilibria, tension curves, motors along the trajectory, the cam: pictures, words and files."""
    assert main(["design", str(EXAMPLES / "triangle_cables.yaml"), "--out", str(tmp_path)]) == 0
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    for title in ("Resultant over the workspace", "Tension over cable length", "What the motors still do", "s1"):
        assert f"{title}</h2>" in page
    assert page.count("<img ") == 5
    assert "6 minima, 9 saddles, 4 maxima" in page
    told = json.loads((tmp_path / "design.json").read_text(encoding="utf-8"))
    motors = told["cables"]["motors"]["norm"]
    assert motors["saved"]["energy"] == pytest.approx(motors["alone"]["energy"] - motors["helped"]["energy"])
    assert motors["helped"]["energy"] < 0.05 * motors["alone"]["energy"]
    assert told["cables"]["floor"]["value"] < told["certificate"]["primal"]
    assert told["made"][0]["wrap_error"] < 1e-3
    assert {path.name for path in tmp_path.iterdir()} >= {"s1.dxf", "s1.csv", "triangle_balanced.xml"}


def test_analyze_says_what_the_cables_can_do(tmp_path, capsys):
    assert main(["analyze", str(EXAMPLES / "planar_platform.yaml"), "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().err
    for label in ("closure", "feasible", "clearance", "stiffness"):
        assert f"\n{label} " in said
    told = json.loads((tmp_path / "analysis.json").read_text(encoding="utf-8"))["cables"]
    assert told["feasible"]["t_min"] == pytest.approx([1e-3 * 9.81 * 2 / 8e-3] * 4)
    assert 0 < told["feasible"]["share"] < 1
    assert len(told["feasible"]["outside"]) == round(400 * (1 - told["feasible"]["share"]))
    head = (tmp_path / "cables.csv").read_text(encoding="utf-8").splitlines()[0]
    assert head.startswith(
        "x [m],z [m],turn [rad],closure [1],feasible [N],least stiffness [N/m],cable_1 to cable_2 [m]"
    )
