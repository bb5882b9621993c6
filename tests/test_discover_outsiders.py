"""discover on small machines as somebody else would write them: what it answers, refuses, and says."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

import equipoise as eq
from equipoise.cli import main
from equipoise.discovery.ask import asked
from equipoise.parameters import unit_of
from equipoise.scattering.sources import sources
from equipoise.targets import target_of

LINK = '<link name="{}"><inertial><origin xyz="{}"/><mass value="{}"/>\
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
JOINT = '<joint name="{}" type="{}"><parent link="{}"/><child link="{}"/><origin xyz="{}"/><axis xyz="{}"/>\
<limit lower="{}" upper="{}" effort="50" velocity="2"/>{}</joint>'
BASE = ("base", "0 0 0", 1)

MACHINES = {
    "plate": ([BASE, ("plate", "0.1 0 0", 2)], [("f", "fixed", "base", "plate", "0 0 0.1", "0 0 1", 0, 0, "")]),
    "alone": ([BASE], []),
    "turntables": (
        [BASE, ("a", "0.2 0 0", 3), ("b", "0.15 0 0", 2)],
        [
            ("j1", "revolute", "base", "a", "0 0 0.5", "0 0 1", -2, 2, ""),
            ("j2", "revolute", "a", "b", "0.4 0 0", "0 0 1", -2, 2, ""),
        ],
    ),
    "lift": ([BASE, ("car", "0 0 0", 5)], [("z", "prismatic", "base", "car", "0 0 0.1", "0 0 1", 0, 0.6, "")]),
    "scara": (
        [BASE, ("a", "0.2 0 0", 3), ("quill", "0 0 0", 1)],
        [
            ("j1", "revolute", "base", "a", "0 0 0.5", "0 0 1", -2, 2, ""),
            ("j3", "prismatic", "a", "quill", "0.3 0 0", "0 0 1", -0.2, 0, ""),
        ],
    ),
    "gantry": (
        [BASE, ("car", "0 0 0", 5), ("arm", "0.25 0 0", 3)],
        [
            ("z", "prismatic", "base", "car", "0 0 0.1", "0 0 1", 0, 0.6, ""),
            ("swing", "revolute", "car", "arm", "0.1 0 0", "0 -1 0", -1, 1, ""),
        ],
    ),
    "gripper": (
        [BASE, ("arm", "0.25 0 0", 3), ("finger", "0 0 0", 0.1)],
        [
            ("swing", "revolute", "base", "arm", "0 0 0.5", "0 -1 0", -1, 1, ""),
            ("grip", "prismatic", "arm", "finger", "0.5 0 0", "0 1 0", 0, 0.04, ""),
        ],
    ),
    "mimic": (
        [BASE, ("upper", "0.25 0 0", 3), ("fore", "0.2 0 0", 2)],
        [
            ("shoulder", "revolute", "base", "upper", "0 0 0.4", "0 -1 0", -1, 1.5, ""),
            ("elbow", "revolute", "upper", "fore", "0.5 0 0", "0 -1 0", -2, 2,
             '<mimic joint="shoulder" multiplier="-1"/>'),
        ],
    ),
}  # fmt: skip

FOUR_BAR = """<mujoco model="fourbar"><worldbody>
<body name="crank" pos="0 0 0.5"><joint name="q1" axis="0 -1 0" range="0 80"/>
  <inertial pos="0.1 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
  <body name="coupler" pos="0.2 0 0"><joint name="q2" axis="0 -1 0"/>
    <inertial pos="0 0 0.2" mass="2" diaginertia="0.02 0.02 0.02"/><site name="ce" pos="0 0 0.4"/></body></body>
<body name="rocker" pos="0 0 0.9"><joint name="q3" axis="0 -1 0"/>
  <inertial pos="0.1 0 0" mass="1" diaginertia="0.01 0.01 0.01"/><site name="re" pos="0.2 0 0"/></body>
</worldbody><equality><connect site1="ce" site2="re"/></equality><actuator><motor joint="q1"/></actuator></mujoco>"""


@pytest.fixture
def ask(tmp_path, monkeypatch, capsys):
    """A machine and a `discover` block in, exit code and what was said out."""
    monkeypatch.chdir(tmp_path)

    def run(name, block="{springs: 1, candidates: 400, contenders: 1}", sweep="{sobol: 64}"):
        file = f"{name}.urdf"
        if name == "fourbar":
            file = "fourbar.xml"
            (tmp_path / file).write_text(FOUR_BAR)
        else:
            links, joints = MACHINES[name]
            body = "".join([*(LINK.format(*link) for link in links), *(JOINT.format(*joint) for joint in joints)])
            (tmp_path / file).write_text(f'<robot name="{name}">{body}</robot>')
        (tmp_path / "p.yaml").write_text(
            f"mechanism: {{model: {file}}}\nsweep: {sweep}\ndiscover: {block}\nobjective: {{norm: peak}}\n"
        )
        code = main(["discover", "p.yaml", "--json"])
        out, err = capsys.readouterr()
        return code, json.loads(out) if out else None, err

    return run


@pytest.mark.parametrize("name", ["plate", "alone"])
def test_a_robot_with_one_usable_body_is_bad_input(ask, name):
    code, data, said = ask(name)
    assert (code, data) == (2, None)
    assert "nothing is driven" in said


def test_axes_that_gravity_does_not_load_are_said(ask):
    code, _, said = ask("turntables")
    assert code == 2
    assert "gravity loads no joint enough" in said


def test_points_outside_any_link_are_bad_input(ask):
    code, _, said = ask("mimic", "{springs: 1, pairs: [[base, upper]], points: {upper: [[0.2, 0, 3]]}}")
    assert code == 2
    assert "point 1, (0.2, 0, 3) m, lies" in said
    assert "p.yaml, line 3, discover" in said


def test_filters_that_leave_nothing_say_how_many_each_removed(ask):
    block = "{springs: 1, candidates: 400, keep_out: [{body: base, low: [-9, -9, -9], high: [9, 9, 9]}]}"
    code, _, said = ask("mimic", block)
    assert code == 1
    assert "no candidate is left" in said
    assert "by 'keep out'" in said


def test_places_are_obeyed_whatever_body_of_a_rigid_group_names_them(ask):
    """`base` is fixed to the world, which the pairs are named by."""
    points = "points: {base: [[0.02, 0, 0.42], [-0.02, 0, 0.41]], upper: [[0.1, 0, 0.01]]}"
    code, data, said = ask("mimic", f"{{springs: 1, contenders: 1, {points}}}")
    assert code == 0, said
    assert data["dictionary"]["candidates"] == 2
    code, _, said = ask("mimic", "{springs: 1, keep_out: [{body: bse, low: [0, 0, 0], high: [1, 1, 1]}]}")
    assert code == 2
    assert "bse" in said


def test_a_line_whose_ends_meet_has_no_direction():
    """A hook in the way of the other end at some pose: such candidates of constant force are left out."""
    axis = eq.chain([eq.Link("car", length=0.1, mass=5.0, joint="slide", axis=(0, 0, 1), stroke=(0.0, 0.6))])
    over = eq.Sweep.grid(axis, {"car_joint": (0.0, 0.6, 41)})
    points = {"world": ((0.0, 0.0, 0.3), (0.0, 0.0, 1.0)), "car": ((0.0, 0.0, 0.0),)}
    request = eq.Discover(1, kinds=(eq.ConstantForce(),), points=points, margin=1.0, pairs=(("world", "car"),))
    front = eq.discover(axis, over, request)
    assert front.refused["its ends meet"] == 1
    assert front.values[0] == pytest.approx(0.0, abs=1e-9)


def test_a_lift_needs_room_above_it(ask):
    """From below an ideal spring can only pull a lift down; with room above constant force carries it exactly."""
    code, _, said = ask("lift")
    assert code == 1
    assert "no subset of the candidates gains anything" in said
    assert "try other `kinds`, widen `margin`" in said
    assert "nan" not in said
    code, data, said = ask("lift", "{springs: 1, kinds: [constant], margin: 1 m, candidates: 400, contenders: 1}")
    assert code == 0
    part = data["front"][0]["parts"][0]
    assert data["values"][0] == pytest.approx(0.0, abs=1e-6)
    assert part["force"][1] == pytest.approx(5 * 9.81, rel=1e-6)


def test_a_slide_on_a_turntable_gets_a_spring_of_its_own(ask):
    code, data, said = ask("scara", "{springs: 1, candidates: 400, contenders: 1, margin: 300 mm}")
    assert code == 0, said
    assert data["before"] == pytest.approx(9.81)
    assert data["values"][0] < 0.35 * data["before"]
    assert data["front"][0]["verification"]["agrees"]


def test_hinges_and_slides_are_no_amounts_of_one_thing(ask, tmp_path):
    """A file that counts both alike is told so; a robot alone counts by its motors, or the one kind that is loaded."""
    code, data, said = ask("gantry", "{springs: 1, margin: 1 m, candidates: 400, contenders: 1}")
    assert code == 0, said
    assert any("1 N at a slide counts as 1 N m at a hinge" in note for note in data["notes"])
    bare = asked(target_of("gantry.urdf"), None, None, 1, None, None)
    (aim,) = bare.objective
    assert aim.divisor == "motor"
    assert aim.joints == ("z", "swing")
    ask("gripper", "{springs: 0}")
    (aim,) = asked(target_of("gripper.urdf"), None, None, 1, None, None).objective
    assert aim.divisor is None
    assert aim.joints == ("swing",)
    # Without motor limits nothing weighs one against the other.
    text = (tmp_path / "gantry.urdf").read_text()
    (tmp_path / "gantry.urdf").write_text(re.sub('effort="[0-9.]+"', 'effort="0"', text))
    (aim,) = asked(target_of("gantry.urdf"), None, None, 1, None, None).objective
    assert aim.divisor is None
    assert aim.joints is None


@pytest.mark.parametrize("name", ["mimic", "fourbar"])
def test_dependent_joints_count_through_the_driven_one(ask, name):
    code, data, said = ask(name)
    assert code == 0, said
    assert data["values"][0] < 0.05 * data["before"]
    assert data["front"][0]["verification"]["agrees"]


def test_torsion_springs_are_wound_so_far_and_no_farther(ask):
    """A rest angle without end would be a constant torque."""
    code, data, said = ask("mimic", "{springs: 1, kinds: [{torsion: {turns: 2}}], contenders: 1}")
    assert code == 0, said
    part = data["front"][0]["parts"][0]
    wound = np.abs(np.array(part["length"]) - part["parameters"]["rest"])
    assert wound.max() <= 4 * np.pi * (1 + 1e-6)
    assert part["parameters"]["k"] > 0


def test_twist_keeps_rates_and_rests_that_are_given():
    arm = eq.chain([eq.Link("arm", 0.5, 2.0)])
    over = eq.Sweep.grid(arm, {"arm_joint": (-1.0, 1.0, 21)})
    path, limit = eq.Angle("arm_joint"), [eq.Extension("s", 1.5)]
    given = eq.balance(arm, [eq.Spring("s", path, eq.Torsion(k=2.0, rest=None))], over, limits=limit)
    assert abs(given.parts()[0]["parameters"]["k_rest"]) <= 2.0 * 0.5 + 1e-9
    with pytest.raises(eq.InfeasibleError):
        eq.balance(arm, [eq.Spring("s", path, eq.Torsion(rest=0.6))], over, limits=limit)
    eq.balance(arm, [eq.Spring("s", path, eq.Torsion(rest=0.4))], over, limits=limit)


def test_an_angles_offset_is_an_angle():
    """Its bounds read in degrees, and it is off by what angles are off by."""
    arm = eq.chain([eq.Link("arm", 0.5, 2.0)])
    over = eq.Sweep.grid(arm, {"arm_joint": (-1.0, 1.0, 21)})
    spring = eq.Spring("s", eq.Angle("arm_joint", offset=0.2), eq.Torsion(k=3.0, rest=-1.0))
    assert unit_of([spring], "s.path.offset") == "rad"
    found = sources(arm, [spring], over, arm.states(over), "hold", {}, eq.Scatter())
    offset = next(source for source in found if source.name == "s.path.offset")
    assert (offset.unit, offset.tolerance) == ("rad", eq.Scatter().angle)
