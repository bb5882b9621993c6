"""Cams and drums against energy, against reference profiles, and by a wrapped cord."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from ezdxf import bbox

import equipoise as eq
from equipoise.cli import main
from equipoise.errors import InputError
from equipoise.make import simulate, wind

EXAMPLES = Path(__file__).parent.parent / "examples"
FIVE = eq.Polynomial((0.0, 1.0), degree=4, coefficients=(4.1809018, -0.46982355, -4.1390328, -0.14238365, 3.8140635))


@pytest.fixture(scope="module")
def curve():
    return eq.law_curve(FIVE, {}, (0.0, 1.0), 20_001)


def test_the_cam_of_degree_four(curve):
    """Reference profile of an independent synthesis: drum 180 mm, 200 N/m, a quarter of the energy, guide at 600 mm."""
    assert curve.energy[-1] == pytest.approx(4.1809018, rel=1e-7)
    cam = eq.CamWithSpring(0.18, 200.0, 0.25 * curve.energy[-1])
    profile = wind(cam.winding(curve), 0.6)
    rows = [0, 4000, 8000, 12000, 16000, 18000, 20000]
    assert 1e3 * cam.travel(curve)[rows] == pytest.approx(
        [102.236, 123.282, 158.125, 199.571, 221.607, 224.806, 228.607], abs=6e-4
    )
    arms = [39.3337, 19.6367, 39.5063, 30.8139, 9.0508, 4.0075, 12.7702]
    assert 1e3 * profile.winding.arm[rows] == pytest.approx(arms, abs=6e-5)
    assert 1e3 * profile.curvature[rows] == pytest.approx(
        [562.240, 37.674, 12.267, 18.400, 28.226, 48.183, 75.925], abs=6e-4
    )
    assert 1e3 * profile.points[rows[:2]].ravel() == pytest.approx([-118.4402, 47.1997, 26.6562, -11.1729], abs=6e-5)
    assert profile.turns == pytest.approx(0.884, abs=5e-4)
    assert profile.helical
    assert 0.3 < profile.crosses < 0.4


def test_closed_form_bounds(curve):
    quarter = 0.25 * curve.energy[-1]
    assert eq.CamWithSpring(0.1, 50.0, quarter).largest_radius(curve) == pytest.approx(0.2087, abs=5e-5)
    assert eq.ConstantForceCam(0.1, 50.0).largest_radius(curve) == pytest.approx(0.2163, abs=5e-5)
    assert eq.DrumWithTorsion(1e-4, quarter).largest_rate(curve) == pytest.approx(2.920e-4, abs=5e-8)
    at, beyond = (eq.DrumWithTorsion(k, quarter).winding(curve) for k in (2.9198e-4, 2.93e-4))
    wind(at)
    with pytest.raises(InputError, match="radius of curvature is -"):
        wind(beyond)


@pytest.mark.parametrize("guide", [0.6, 2.0])
@pytest.mark.parametrize("kind", ["cam", "drum", "constant"])
def test_the_wrapped_cord_pulls_as_asked(curve, kind, guide):
    quarter = 0.25 * curve.energy[-1]
    part = {
        "cam": eq.CamWithSpring(0.16, 300.0, quarter),
        "drum": eq.DrumWithTorsion(2.4e-4, quarter),
        "constant": eq.ConstantForceCam(0.15, 60.0),
    }[kind]
    profile = wind(part.winding(curve), guide)
    wrapped = simulate(part, curve, profile)
    assert wrapped.error < 1e-4
    assert np.ptp(wrapped.wanted) > 4
    # A profile that is 1 % too large is found out.
    spoilt = type(profile)(profile.winding, 1.01 * profile.points, profile.curvature, profile.free, guide, 0.0)
    assert simulate(part, curve, spoilt).error > 1e-2


def test_energy_is_kept(curve):
    for part in (eq.CamWithSpring(0.16, 300.0, 1.0), eq.DrumWithTorsion(2.4e-4, 1.0)):
        travel = part.travel(curve)
        stored = np.concatenate(
            [[0], np.cumsum(np.diff(travel) * (part.pull(travel)[1:] + part.pull(travel)[:-1]) / 2)]
        )
        assert stored == pytest.approx(curve.energy, abs=1e-8)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda c: wind(eq.CamWithSpring(0.22, 200.0, 1.0).winding(c)), "drum radius can be at most"),
        (lambda c: wind(eq.CamWithSpring(0.18, 200.0, 1.0).winding(c), 0.03), "guide is at 30 mm"),
        (lambda c: eq.CamWithSpring(0.18, 200.0, 0.0).winding(c), "preload energy is 0"),
        (lambda c: eq.CamWithSpring(-0.18, 200.0, 1.0).winding(c), "drum radius is -0.18"),
        (lambda c: simulate(eq.ConstantForceCam(0.1, 9.0), c, wind(eq.ConstantForceCam(0.1, 9.0).winding(c))), "guide"),
        (
            lambda c: eq.law_curve(eq.Polynomial((0, 1), degree=1, coefficients=(0.0, 1.0)), {}, (0.0, 1.0)),
            "can only pull",
        ),
    ],
)
def test_bad_input_says_which_knob(curve, make, words):
    with pytest.raises(InputError) as caught:
        make(curve)
    assert words in str(caught.value)


def test_files_open_and_have_the_right_size(curve, tmp_path):
    part = eq.make_part(curve, eq.CamWithSpring(0.16, 300.0, 1.2), guide=0.6, name="s0")
    dxf, table = part.write(tmp_path)
    drawing = ezdxf.readfile(dxf)
    assert not drawing.audit().errors
    line = drawing.modelspace().query("LWPOLYLINE").first
    box = bbox.extents([line])
    low, high = 1e3 * part.profile.points.min(0), 1e3 * part.profile.points.max(0)
    assert [box.extmin.x, box.extmin.y, box.extmax.x, box.extmax.y] == pytest.approx([*low, *high], abs=0.05)
    assert drawing.modelspace().query("CIRCLE").first.dxf.radius == pytest.approx(160.0)
    with table.open() as stream:
        rows = list(csv.reader(stream))
    assert len(rows) == len(curve.c) + 1
    assert float(rows[-1][0]) == 1.0


def test_an_arm_on_its_cam_has_nothing_left_to_hold(tmp_path):
    """Torque of the cam by its own arm and spring against plain statics."""
    code = main(["make", str(EXAMPLES / "arm_cam.yaml"), "--out", str(tmp_path)])
    assert code == 0
    assert (tmp_path / "arm_joint_cam.dxf").exists()
    arm = eq.chain([eq.Link("arm", length=0.4, mass=2.5, com=0.22)], datum="up")
    load = (eq.Payload("arm", 0.5, (0.4, 0.0, 0.0)),)
    over = (np.radians(10), np.radians(170))
    part = eq.arm_cam(arm, "arm_joint", over, rate=1500.0, preload=15.0, ratio=2.0, guide=0.3, payload=load)
    stretch = part.kind.travel(part.curve)
    torque = part.kind.pull(stretch) * part.profile.winding.arm * 2.0
    q = over[0] + part.curve.c
    plain = (2.5 * 0.22 + 0.5 * 0.4) * 9.81 * np.sin(q)
    assert torque == pytest.approx(plain, abs=1e-9) or torque == pytest.approx(plain[::-1], abs=1e-9)
    assert part.wrapped.error < 1e-4
    # What the spring gives back is what gravity takes.
    gain = 0.5 * 1500 * (stretch[-1] ** 2 - stretch[0] ** 2)
    assert gain == pytest.approx((2.5 * 0.22 + 0.5 * 0.4) * 9.81 * (np.cos(over[0]) - np.cos(over[1])), rel=1e-9)
    with pytest.raises(InputError, match="vanishes at"):
        eq.arm_cam(arm, "arm_joint", (-0.5, 0.5), rate=1500.0, preload=15.0)


def test_make_from_a_problem_file(tmp_path, capsys):
    file = tmp_path / "p.yaml"
    file.write_text(
        """
mechanism: {cable_platform: {anchors: [[-0.5, -0.28867513], [0.5, -0.28867513], [0, 0.57735027]]}}
sweep: {triangle: [[-0.5, -0.28867513], [0.5, -0.28867513], [0, 0.57735027]], points: 8}
balancers:
  - spring: {name: s1, path: {reel: [cable_1]}, law: {polynomial: {interval: [0, 1], degree: 4}}}
  - spring: {name: s2, path: {reel: [cable_2]}, law: {polynomial: {interval: [0, 1], degree: 4}}, like: s1}
  - spring: {name: s3, path: {reel: [cable_3]}, law: {polynomial: {interval: [0, 1], degree: 4}}, like: s1}
limits: [{force: s1, min: 1 N, over: [0, 1]}]
objective: {goal: wrench}
make: [{cam: {spring: s1, radius: 160 mm, rate: 200 N/m, preload: 1.1 J, guide: 600 mm}}]
"""
    )
    assert main(["make", str(file), "--out", str(tmp_path / "out"), "--json"]) == 0
    (part,) = json.loads(capsys.readouterr().out)["parts"]
    assert part["wrap_error"] < 1e-3
    assert (tmp_path / "out" / "s1.dxf").exists()
    file.write_text(file.read_text().replace("160 mm", "260 mm"))
    assert main(["make", str(file), "--out", str(tmp_path / "out2")]) == 2
    assert "drum radius can be at most" in capsys.readouterr().err
