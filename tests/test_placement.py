"""Equal places of a spring: nothing changes as it is turned or swapped; what is in the way decides."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

import equipoise as eq
from equipoise.cli import main
from equipoise.placement import turned
from equipoise.problem import load_problem
from equipoise.targets import target_of

EXAMPLES = Path(__file__).parents[1] / "examples"


def leg():
    links = [
        eq.Link("a", length=0.6, mass=5.0, limits=(-1.5, 1.5)),
        eq.Link("b", length=0.5, mass=3.0, limits=(0.2, 2)),
    ]
    mech = eq.chain(links, base=(0.1, 0.0, 0.3))
    return mech, mech.states(eq.Sweep.sobol(mech, 64))


PATHS = {
    "line": lambda m: eq.Line(eq.Point("world", (0.15, 0.02, 0.55)), eq.Point("a", (0.2, -0.01, 0.04))),
    "line on the second link": lambda m: eq.Line(eq.Point("b", (0.2, 0.0, 0.05)), eq.Point("a", (0.45, 0.0, 0.1))),
    "inverted": lambda m: eq.InvertedSliderCrank(eq.Angle("a_joint"), 0.15, 0.5, phase=0.3),
    "rod": lambda m: eq.InvertedSliderCrank(eq.Absolute("b"), 0.15, 0.5, phase=0.3, rod=0.8),
    "yoke": lambda m: eq.ScotchYoke(eq.Angle("b_joint"), 0.15, phase=0.3),
    "slider": lambda m: eq.SliderCrank(eq.Angle("b_joint"), 0.15, 0.5, phase=0.3),
}


@pytest.mark.parametrize("name", PATHS)
def test_turns_and_swaps_change_nothing(name):
    mech, states = leg()
    spring = eq.Spring("s", PATHS[name](mech), eq.Coil(0.2, k=800.0, initial_tension=5.0))
    before = spring.effort(states, "hold").b
    length = spring.path.deform(states)[0]
    size = np.abs(before).max()
    for angle, swapped in ((0.7, False), (-2.9, False), (0.0, True), (1.3, True)):
        other = turned(spring, states, angle, swapped)
        if swapped and name in ("yoke", "slider"):
            assert other is None
            continue
        np.testing.assert_allclose(other.path.deform(states)[0], length, atol=1e-14)
        assert np.abs(other.effort(states, "hold").b - before).max() < 1e-12 * size
        other.check(mech)
    heavy = dataclasses.replace(spring, mass=0.3)
    assert name in ("yoke", "slider") or turned(heavy, states, 0.5) is None


def test_a_line_over_two_joints_stays_where_it_is():
    _, states = leg()
    spring = eq.Spring(
        "s", eq.Line(eq.Point("world", (0, 0, 0.5)), eq.Point("b", (0.2, 0, 0))), eq.ZeroFreeLength(100.0)
    )
    assert turned(spring, states, 0.4) is None


def placed(zones, **changed):
    problem = load_problem(EXAMPLES / "placement.yaml")
    problem.check()
    design = eq.balance(problem.mechanism, problem.balancers, problem.sweep, objective=problem.objective)
    placing = dataclasses.replace(problem.content.placement, zones=zones, **changed)
    return design, eq.place(design, placing)


def test_the_cabinet_stays_free():
    zone = load_problem(EXAMPLES / "placement.yaml").content.placement.zones[0]
    design, moved = placed((zone,))
    where = moved.places["s1"]
    assert abs(where.turn) > 1.0
    assert moved.after["link1_joint"].peak < 1e-12 * moved.before["link1_joint"].peak
    # By hand: pin and pivot at every angle, the cabinet grown by half the width.
    path = moved.balancers[0].path
    q = np.radians(np.linspace(-90, 90, 721))
    e = np.array(path.mount.direction)[[0, 2]]
    f = np.array([-e[1], e[0]])
    w = (q + path.phase)[:, None]
    pin = path.crank * (np.cos(w) * e + np.sin(w) * f)
    pivot = path.distance * e
    for share in np.linspace(0, 1, 41):
        for points in (share * pin, pin + share * (pivot - pin)):
            x, z = points.T
            inside = (x > -0.5 - 0.03) & (x < 0.6 + 0.03) & (z > 0.3 - 0.03)
            assert not inside.any()
    # Its own place would have hit.
    original = design.balancers[0].path
    assert original.distance * original.mount.direction[2] > 0.3
    checked = eq.verify(moved, poses=50).verification
    assert checked.agrees
    assert "turned about the joint" in str(moved)
    assert where.json()["area"] > 0


def test_the_links_own_sweep_decides_where_nothing_is_forbidden():
    """A half turn of the link in front: the spring goes behind."""
    _, moved = placed(())
    assert moved.places["s1"].share < 0.05
    pivot = moved.balancers[0].path.mount.direction
    assert pivot[0] < 0.1
    # Wider links lose more of their workspace to the same spring.
    _, wide = placed((), link_width=0.4)
    assert wide.places["s1"].lost > moved.places["s1"].lost


def test_no_room_names_part_zone_pose_and_depth(tmp_path, capsys):
    text = (EXAMPLES / "placement.yaml").read_text(encoding="utf-8")
    text = text.replace("low: [-500 mm, -1 m, 300 mm], high: [600 mm, 1 m, 2 m]", "low: [-1, -1, -1], high: [1, 1, 1]")
    file = tmp_path / "p.yaml"
    file.write_text(text, encoding="utf-8")
    assert main(["balance", str(file)]) == 1
    said = " ".join(capsys.readouterr().err.split())
    for words in ("of s1 reaches", "into zone cabinet at link1_joint =", "none of its 144 equal places is free"):
        assert words in said
    assert main(["balance", str(bad(tmp_path, text, "width: 60 mm", "width: -1 mm"))]) == 2
    assert main(["balance", str(bad(tmp_path, text, "low: [-1, -1, -1]", "low: [2, -1, -1]"))]) == 2
    assert main(["balance", str(bad(tmp_path, text, "width: 60 mm", "springs: [s9]"))]) == 2


def bad(tmp_path, text, old, new):
    file = tmp_path / "bad.yaml"
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    return file


def test_a_placed_design_reads_back(tmp_path, capsys):
    text = (EXAMPLES / "placement.yaml").read_text(encoding="utf-8").replace("91]", "13]")
    file = tmp_path / "p.yaml"
    file.write_text(text, encoding="utf-8")
    assert main(["balance", str(file), "--json", "--out", str(tmp_path / "out")]) == 0
    data = json.loads(capsys.readouterr().out)
    again = target_of(str(tmp_path / "out" / "design.json"))
    assert not again.remarks
    assert again.design.places["s1"].turn == data["places"]["s1"]["turn"]
    np.testing.assert_allclose(again.design.parts()[0]["room"], data["parts"][0]["room"], atol=1e-12)
