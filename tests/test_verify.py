"""Verification: MuJoCo's own efforts after save and reload, energies, bounds between the samples."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import equipoise as eq
from equipoise.errors import DisagreementError, ModelError
from equipoise.reporting import phrases
from equipoise.verbs.analyze import table
from equipoise.verbs.verify import insist, verify
from equipoise.verification.continuum import bounds
from equipoise.verification.energy import energy_errors
from equipoise.verification.field import Field
from equipoise.verification.findings import Bound
from equipoise.verification.saved import save
from equipoise.verification.waves import Axes, corner_values, point_values

UR10 = "package://example-robot-data/robots/ur_description/urdf/ur10_robot.urdf"
WORLD = "world"


@pytest.fixture(scope="module")
def ur10():
    return eq.Mechanism.load(UR10)


@pytest.fixture(scope="module")
def shoulder(ur10):
    line = eq.Line(ur10.at("shoulder_link", 0, 0.22, 0.15), ur10.at("upper_arm_link", 0, 0, 0.2))
    spring = eq.Spring("s1", line, eq.ZeroFreeLength())
    return eq.balance(ur10, [spring], eq.Sweep.sobol(ur10, 512), norm="peak")


def arm(**last):
    return eq.chain([eq.Link("a", 0.5, 4.0, limits=(-2.5, 2.5)), eq.Link("b", 0.4, 2.0, **last)])


def given_spring(name, law, body="a", mass=0.0):
    return eq.Spring(name, eq.Line(eq.Point(WORLD, (0.03, 0, 0.3)), eq.Point(body, (0.2, 0.01, 0.02))), law, mass=mass)


def test_ur10_agrees_after_save_and_reload(shoulder, tmp_path):
    found = verify(shoulder, out=tmp_path).verification
    assert found.poses == 10_000
    assert found.agrees
    assert found.max_abs_error < 1e-9
    assert found.unit == "N m"
    assert found.energy["s1"] < 1e-9
    assert found.model == tmp_path / "ur10_balanced.xml"
    told = json.loads(json.dumps(found.json()))
    assert {"engine", "poses", "max_abs_error", "unit", "agrees", "bounds", "model"} <= told.keys()
    assert told["engine"].startswith("MuJoCo 4.0")
    assert told["model"] == "ur10_balanced.xml"


def test_saved_zero_free_length_is_explicit(shoulder, tmp_path):
    root = ET.parse(save(shoulder, tmp_path)).getroot()
    (tendon,) = root.iter("spatial")
    assert [float(value) for value in tendon.get("springlength").split()] == [0.0] * len(
        tendon.get("springlength").split()
    )
    assert float(tendon.get("stiffness")) == shoulder.values["s1.k"]
    assert not list(root.iter("general"))


def test_nothing_is_left_where_the_user_stands(shoulder, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    found = verify(shoulder, poses=50).verification
    assert found.model is None
    assert not list(tmp_path.iterdir())
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "law",
    [
        eq.Coil(0.1),
        eq.Coil(0.05, initial_tension=None),
        eq.Coil(None, k=300.0),
        eq.Linear(k=200.0, preload=30.0),
        eq.Linear(preload=-5.0),
        eq.Constant(),
        eq.ZeroFreeLength(),
    ],
    ids=repr,
)
def test_every_law_agrees(law):
    mechanism = arm()
    over = eq.Sweep.sobol(mechanism, 128, payload=[eq.Payload("b", (0.0, 1.5), (0.4, 0, 0))])
    design = eq.balance(
        mechanism,
        [given_spring("s", law, mass=0.3), given_spring("t", eq.ZeroFreeLength(), body="b")],
        over,
        norm="rms",
    )
    found = verify(design, poses=500).verification
    assert found.scenarios == 2
    assert found.agrees
    assert found.max_abs_error < 1e-11
    assert max(found.energy.values()) < 1e-8
    for joint, bound in found.bounds.items():
        row = design.after[joint]
        assert bound.rigorous
        assert bound.upper >= bound.polished >= row.peak >= row.sample_peak


def test_counterweights_agree():
    mechanism = arm(joint="slide", stroke=(-0.1, 0.3))
    weights = [
        eq.Counterweight("fixed", eq.Point("a", (-0.2, 0, 0.05))),
        eq.Counterweight("free", eq.Point("b", (0, 0, 0)), reach=0.3),
        eq.Counterweight("known", eq.Point("b", (0.1, 0, 0)), mass=0.7),
    ]
    design = eq.balance(mechanism, weights, eq.Sweep.sobol(mechanism, 128), norm="rms")
    found = verify(design, poses=300).verification
    assert found.agrees
    assert found.errors["b_joint"].unit == "N"


@pytest.mark.parametrize("name", ["four_bar", "parallelogram"])
def test_closed_loops_agree(name):
    if name == "four_bar":
        mechanism = eq.four_bar(1.0, 0.3, 0.9, 0.8, masses=(1.0, 2.0, 1.5))
        spring = eq.Spring(
            "s", eq.Line(eq.Point(WORLD, (0.3, 0, 0.8)), eq.Point("rocker", (0.4, 0, 0.1))), eq.Coil(0.2), 0.2
        )
        over = eq.Sweep.grid(mechanism, {"crank_joint": (0, 2 * np.pi, 91)})
    else:
        mechanism = eq.parallelogram_arm(0.5, masses=(1.0, 0.5, 0.5))
        spring = eq.Spring(
            "s", eq.Line(eq.Point(WORLD, (0, 0, 0.3)), eq.Point("arm", (0.4, 0, 0))), eq.ZeroFreeLength()
        )
        over = eq.Sweep.grid(mechanism, {"arm_joint": (-1, 1, 61)}, payload=[eq.Payload("payload", (1.0, 4.0))])
    design = eq.balance(mechanism, [spring], over, norm="peak")
    found = verify(design, poses=1000).verification
    assert found.agrees
    assert found.max_abs_error < 1e-12
    ((joint, bound),) = found.bounds.items()
    assert not bound.rigorous
    assert bound.method.startswith("estimated")
    assert bound.upper >= bound.polished >= design.after[joint].peak * (1 - 1e-9)


MJCF = """<mujoco model="robot"><compiler meshdir="parts" angle="degree"/>
<asset><mesh name="cube" file="cube.obj"/></asset>
<worldbody><body name="a" pos="0.1 0 0.33333333333333331"><joint name="j1" axis="0 1 0" stiffness="3" springref="20"
 range="-100 120" actuatorfrcrange="-5 5"/><geom type="mesh" mesh="cube"/>
<body name="b" pos="0.3 0 0"><joint name="j2" axis="0 1 0" range="-90 90"/><geom type="capsule" size=".02"
 fromto="0 0 0 .2 0 0.01"/><site name="s2" pos="0 0.1 .3"/></body></body><site name="w" pos="1 0 1"/></worldbody>
<tendon><spatial name="t" stiffness="50" springlength="0.1 0.4"><site site="w"/><site site="s2"/></spatial></tendon>
<actuator><position name="p" joint="j1" kp="100"/><motor joint="j2"/></actuator>
<keyframe><key name="home" qpos="0.1 0.2" ctrl="0.3 1"/></keyframe></mujoco>"""

CUBE = "".join(f"v {x} {y} {z}\n" for x in (0, 0.1) for y in (0, 0.1) for z in (0, 0.1)) + (
    "f 1 2 4\nf 1 4 3\nf 5 8 6\nf 5 7 8\nf 1 6 2\nf 1 5 6\nf 3 4 8\nf 3 8 7\nf 1 3 7\nf 1 7 5\nf 2 6 8\nf 2 8 4\n"
)


def write_robot(folder):
    (folder / "parts").mkdir()
    (folder / "parts" / "cube.obj").write_text(CUBE)
    (folder / "robot.xml").write_text(MJCF)
    return folder / "robot.xml"


def test_mjcf_with_meshes_springs_and_motors_of_its_own(tmp_path, monkeypatch):
    mechanism = eq.Mechanism.load(write_robot(tmp_path))
    over = eq.Sweep.sobol(mechanism, 64)
    constant = eq.Spring("s1", eq.Line(eq.Point(WORLD, (0, 0, 0.9)), eq.Point("b", (0.1, 0.1, 0))), eq.Constant())
    design = eq.balance(mechanism, [constant], over, norm="rms")
    monkeypatch.chdir("/")
    found = verify(design, out=tmp_path / "out", poses=300).verification
    assert found.agrees
    assert found.max_abs_error < 1e-12
    assert any("s1_force is an actuator" in note for note in found.notes)
    moved = (tmp_path / "out").rename(tmp_path / "elsewhere")
    (tmp_path / "parts" / "cube.obj").unlink()
    model = mujoco.MjModel.from_xml_path(str(moved / "robot_balanced.xml"))
    assert model.body_mass.sum() == pytest.approx(mechanism.mass, rel=1e-12)


def test_a_broken_part_is_caught(tmp_path):
    mechanism = arm()
    design = eq.balance(mechanism, [given_spring("s", eq.Coil(0.1))], eq.Sweep.sobol(mechanism, 64), norm="rms")
    path = save(design, tmp_path)
    tree = ET.parse(path)
    (site,) = (site for site in tree.iter("site") if site.get("name") == "s_b")
    site.set("pos", "0.2 0.01 0.0201")
    tree.write(path)
    judged = verify(design, model=path, poses=200)
    assert not judged.verification.agrees
    with pytest.raises(DisagreementError, match=r"a_joint.*the design says .* N m, MuJoCo .* N m"):
        insist(judged)
    insist(verify(design, poses=200))


def test_a_broken_model_is_refused(tmp_path):
    mechanism = arm()
    design = eq.balance(mechanism, [given_spring("s", eq.Coil(0.1))], eq.Sweep.sobol(mechanism, 64), norm="rms")
    (tmp_path / "broken.xml").write_text("<mujoco><worldbody><body/></worldbody></mujoco>")
    with pytest.raises(ModelError, match="no joint 'a_joint'"):
        verify(design, model=tmp_path / "broken.xml")
    namesake = replace(design, balancers=(eq.Counterweight("b", eq.Point("b", (0, 0, 0)), mass=1.0),))
    with pytest.raises(ModelError, match="rename the part"):
        save(namesake, tmp_path)


def test_wrong_energy_is_caught():
    class Leaky(eq.ZeroFreeLength):
        def energy_basis(self, length):
            wide, constant = super().energy_basis(length)
            return 1.001 * wide, constant

    mechanism = arm()
    design = eq.balance(mechanism, [given_spring("s", Leaky())], eq.Sweep.sobol(mechanism, 64), norm="rms")
    errors = energy_errors(design)
    assert errors["gravity"] < 1e-9
    assert errors["s"] == pytest.approx(1e-3, rel=1e-3)
    with pytest.raises(DisagreementError, match="s is not the derivative"):
        insist(verify(design, poses=50))


def test_a_list_of_poses_is_verified_nearby():
    mechanism = arm()
    over = eq.Sweep.of_poses(mechanism, [{"a_joint": 0.1}, {"a_joint": 1.0, "b_joint": 0.3}])
    found = verify(eq.balance(mechanism, [given_spring("s", eq.Coil(0.1))], over), poses=100).verification
    assert found.agrees
    assert "near the sweep's" in found.where
    assert not found.bounds


# Between the samples.


def test_ur10_unbalanced_bound(ur10):
    found = eq.analyze(ur10)
    between = bounds(ur10, (), {}, found.sweep, found.rows)
    assert between["shoulder_lift_joint"].polished == pytest.approx(121.031, abs=1e-3)
    assert 121.030 < between["shoulder_lift_joint"].upper < 1.011 * 121.031
    assert 34.2348 < between["elbow_joint"].upper < 1.011 * 34.235
    assert all(bound.rigorous and bound.complete for bound in between.values())
    assert between["shoulder_pan_joint"].upper < 1e-10


def test_ur10_balanced_bound(shoulder):
    between = bounds(shoulder.mechanism, shoulder.balancers, shoulder.values, shoulder.sweep, shoulder.after)
    bound = between["shoulder_lift_joint"]
    assert 34.2348 < bound.upper < 34.60
    assert bound.complete


def test_a_pendulum_is_bounded_in_closed_form():
    pendulum = eq.chain([eq.Link("a", 1.0, 2.0, com=0.4)])
    over = eq.Sweep.sobol(pendulum, 16)
    rows = eq.analyze(pendulum, over).rows
    bound = bounds(pendulum, (), {}, over, rows)["a_joint"]
    exact = 2.0 * 9.81 * 0.4
    assert exact <= bound.upper <= 1.01 * exact
    spring = eq.Spring("s", eq.Line(eq.Point(WORLD, (0, 0, 0.3)), eq.Point("a", (0.4, 0, 0))), eq.ZeroFreeLength())
    design = eq.balance(pendulum, [spring], over, norm="peak")
    bound = bounds(pendulum, [spring], design.values, over, design.after)["a_joint"]
    assert bound.upper < 1e-12 * exact


def test_payloads_between_their_extremes_are_covered():
    mechanism = arm()
    over = eq.Sweep.sobol(mechanism, 64, payload=[eq.Payload("b", (0.0, 1.0, 3.0), (0.4, 0, 0)), eq.Payload("a", 0.5)])
    design = eq.balance(mechanism, [given_spring("s", eq.ZeroFreeLength())], over, norm="peak")
    between = bounds(mechanism, design.balancers, design.values, over, design.after)
    for joint, bound in between.items():
        assert design.after[joint].peak <= bound.upper <= 1.011 * bound.polished


def test_a_spring_that_may_vanish_has_no_bound():
    mechanism = eq.chain([eq.Link("a", 0.5, 4.0)])
    touching = eq.Spring(
        "s", eq.Line(eq.Point(WORLD, (0, 0, 0.3)), eq.Point("a", (0.3, 0, 0))), eq.Constant(force=10.0)
    )
    over = eq.Sweep.grid(mechanism, {"a_joint": (0, np.pi, 41)})
    design = eq.balance(mechanism, [touching], over)
    bound = bounds(mechanism, design.balancers, design.values, over, design.after, budget=2000)["a_joint"]
    assert bound.upper == np.inf
    assert bound.method.startswith("no bound")
    assert bound.json()["upper"] is None


def test_corners_enclose_waves():
    rng = np.random.default_rng(3)
    axes = Axes(np.array([True, True, False]), np.array([[-3, 3], [-1, 2], [-0.2, 0.5]]))
    waves = rng.standard_normal((4, 27))
    assert axes.fit(point_values(waves, axes.basis(axes.nodes())).T) == pytest.approx(waves, abs=1e-12)
    centre = axes.box[:, 0] + rng.random((50, 3)) * np.ptp(axes.box, axis=1)
    half = rng.random((50, 3)) * np.array([3.1, 1.0, 0.3])
    corners = corner_values(waves, axes.triangles(centre, half))
    for _ in range(200):
        inside = point_values(waves, axes.basis(centre + half * rng.uniform(-1, 1, half.shape)))
        assert (inside <= corners.max(axis=2) + 1e-12).all()
        assert (inside >= corners.min(axis=2) - 1e-12).all()


place = st.floats(-0.4, 0.4)


@settings(max_examples=15)
@given(
    st.tuples(place, place),
    st.tuples(place, place),
    st.sampled_from(["zero", "coil", "linear"]),
    st.sampled_from(["a", "b"]),
    st.floats(10, 500),
)
def test_bounds_hold_on_a_dense_grid(base, tip, law, body, k):
    mechanism = arm(limits=(-2.0, 2.0))
    laws = {
        "zero": eq.ZeroFreeLength(k=k),
        "coil": eq.Coil(free_length=0.2, k=k),
        "linear": eq.Linear(k=k, preload=20.0),
    }
    # Off the plane by 5 cm, so that the spring never shrinks to nothing.
    line = eq.Line(eq.Point(WORLD, (base[0], 0.05, base[1])), eq.Point(body, (tip[0], 0, tip[1])))
    spring = eq.Spring("s", line, laws[law])
    over = eq.Sweep.sobol(mechanism, 64)
    dense = mechanism.states(eq.Sweep.grid(mechanism, {"a_joint": (-2.5, 2.5, 121), "b_joint": (-2.0, 2.0, 121)}))

    def residual(states):
        return states.holding + spring.effort(states, "hold").b

    states = mechanism.states(over)
    rows = table(mechanism, over, states, lambda other: (mechanism.driven_blocks, residual(other)))
    between = bounds(mechanism, [spring], {}, over, rows, budget=4000)
    peak = np.abs(residual(dense)).max(axis=0)
    for i, (joint, bound) in enumerate(between.items()):
        assert bound.rigorous
        assert bound.upper >= bound.polished >= rows[joint].sample_peak
        assert bound.upper >= peak[i]
        assert bound.upper <= 1.02 * bound.polished or not bound.complete


@pytest.mark.parametrize("carrier", [WORLD, "a"])
@pytest.mark.parametrize("law", [eq.Coil(0.1, k=900.0), eq.ZeroFreeLength(k=200.0)])
def test_a_coil_behind_a_cable_is_bounded_with_its_own_weight(carrier, law):
    """The coil's weight moves along its body as the cable's distance does, in the base or on a link that turns."""
    mechanism = arm()
    through = (
        eq.Point(carrier, (0.25, 0, 0.05)),
        eq.Pulley(carrier, (0.0, 0.05, 0.2), 0.0),
        eq.Point("a" if carrier == WORLD else "b", (0.2, 0, 0)),
    )
    spring = eq.Spring("s", eq.Cable(through, 0.5, -0.02), law, mass=1.5)
    design = eq.balance(mechanism, [spring], eq.Sweep.sobol(mechanism, 64))
    between = verify(design, poses=200).verification.bounds
    dense = mechanism.states(eq.Sweep.sobol(mechanism, 20_000, seed=5))
    peak = np.abs(dense.holding + spring.effort(dense, "hold").b).max(axis=0)
    for joint, most in zip(mechanism.driven, peak, strict=True):
        bound = between[joint]
        assert bound.rigorous
        assert bound.complete
        assert max(most, bound.polished) * (1 - 1e-12) <= bound.upper <= 1.01 * most


def test_an_estimate_that_was_cut_short_far_above_what_was_met_is_no_bound():
    sure = {"unit": "N m", "method": "", "rigorous": False, "cells": 9}
    assert Bound(1.0, 1.1, 3.0, complete=False, **sure).vague
    assert not Bound(1.0, 1.1, 1.15, complete=False, **sure).vague
    assert not Bound(1.0, 1.1, 3.0, complete=True, **sure).vague
    assert not Bound(1.0, 1.1, 3.0, complete=False, **sure | {"rigorous": True}).vague
    weight = eq.Counterweight("w", eq.Point("a", (-0.1, 0, 0)), mass=0.5)
    design = eq.balance(arm(), [weight], eq.Sweep.sobol(arm(), 16))
    found = verify(design, poses=50).verification
    vague = replace(found, bounds={"a_joint": Bound(1.0, 1.1, 3.0, complete=False, **sure)})
    told = phrases.between_words(replace(design, verification=vague), "a_joint")
    assert told == "between the samples 1.100 N m was met at a_joint, which is no bound"


def test_a_spring_that_is_wound_is_looked_at_over_every_turn():
    """What a torsion spring does differs by the turn, what a line between two points does not."""
    mechanism = eq.chain([eq.Link("a", length=0.4, mass=1.0, limits=(-2 * np.pi, 2 * np.pi))])
    over = eq.Sweep.sobol(mechanism, 32)
    line = eq.Line(eq.Point(WORLD, (0, 0, 0.2)), eq.Point("a", (0.1, 0, 0)))
    wound = eq.Spring("t", eq.Angle("a_joint"), eq.Torsion(k=0.5, rest=0.0))
    for spring, reach in ((wound, 2 * np.pi), (eq.Spring("s", line, eq.ZeroFreeLength(k=50.0)), np.pi)):
        field = Field(mechanism, [spring], {}, over)
        np.testing.assert_allclose(field.coordinates(0).box, [[-reach, reach]], atol=1e-12)
