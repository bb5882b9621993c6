"""Robot files: what loads, what is repaired and said, what is refused and how, and what Pinocchio makes of the same."""

from __future__ import annotations

import contextlib
import os
import random
import re
import subprocess
import sys
import warnings
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import equipoise as eq
from equipoise.errors import EquipoiseError, InputError, ModelError
from equipoise.models.packages import resolve

ROBOTS = "package://example-robot-data/robots/"
FOLDER = resolve(ROBOTS + "ur_description/urdf/ur10_robot.urdf").parents[2]
SOLID = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
MASS = '<inertial pos=".1 0 0" mass="1" diaginertia=".1 .1 .1"/>'

URDF = f"""<?xml version="1.0"?>
<robot name="small">
  <link name="base"><inertial><mass value="3"/>{SOLID}</inertial></link>
  <link name="a"><inertial><origin xyz="0 0 .1" rpy="0 .1 0"/><mass value="1.5"/>{SOLID}</inertial>
    <visual><geometry><mesh filename="package://nowhere/a.stl"/></geometry></visual></link>
  <link name="b"><inertial><mass value="1"/>{SOLID}</inertial></link>
  <link name="c"><inertial><mass value="0.5"/>{SOLID}</inertial></link>
  <link name="tool"/>
  <joint name="j1" type="revolute"><origin xyz="0 0 .3" rpy="0 0 1"/><parent link="base"/><child link="a"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="3" velocity="1"/></joint>
  <joint name="j2" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/>
    <limit lower="-.2" upper=".3" effort="0" velocity="1"/></joint>
  <joint name="j3" type="continuous"><parent link="b"/><child link="c"/><axis xyz="0 1 0"/></joint>
  <joint name="fixed" type="fixed"><origin xyz="0 0 .1"/><parent link="c"/><child link="tool"/></joint>
  <gazebo><plugin name="p" filename="libp.so"/></gazebo>
</robot>
"""

FIVE_BAR = f"""<mujoco model="five bar"><worldbody>
  <body name="L1"><joint name="l1" axis="0 -1 0"/>{MASS}
    <body name="L2" pos="0 0 .3"><joint name="l2" axis="0 -1 0"/>{MASS}<site name="a" pos=".15 0 .3"/></body></body>
  <body name="R1" pos=".3 0 0"><joint name="r1" axis="0 -1 0"/>{MASS}
    <body name="R2" pos="0 0 .3"><joint name="r2" axis="0 -1 0"/>{MASS}<site name="b" pos="-.15 0 .3"/></body></body>
  </worldbody><equality><connect site1="a" site2="b"/></equality>
  <keyframe><key name="low" qpos=".1 .2 -.1 -.2"/></keyframe><actuator/></mujoco>
"""


def one_body(inside: str = MASS, before: str = "", after: str = "") -> str:
    return f'<mujoco>{before}<worldbody><body name="a"><joint name="j"/>{inside}</body></worldbody>{after}</mujoco>'


@pytest.fixture
def load(tmp_path):
    def do(text: str | bytes, suffix: str = "", **options) -> eq.Mechanism:
        data = text if isinstance(text, bytes) else text.encode()
        kind = suffix or (".urdf" if b"<robot" in data else ".xml")
        path = tmp_path / f"model{kind}"
        path.write_bytes(data)
        return eq.Mechanism.load(path, **options)

    return do


def said(mechanism: eq.Mechanism, *words: str) -> bool:
    return any(all(word in remark for word in words) for remark in mechanism.remarks)


# --- all example robots, and Pinocchio ---------------------------------------------------------------------------

REFUSED = {
    "alex_psyonic_hands.urdf": "mimics the unknown joint 'index_q1'",
    "double_pendulum.urdf": "the limits are equal: joint1, joint2",
    "double_pendulum_simple.urdf": "the limits are equal: joint1, joint2",
    "quadrotor_base.urdf": "no hinge and no slide",
    "iris_simple.urdf": "no hinge and no slide",
    "ur3.urdf": "has no link",
}


def test_all_example_robots_load_or_say_why(capfd):
    paths = sorted(FOLDER.rglob("*.urdf"))
    assert len(paths) == 69
    for path in paths:
        if path.name in REFUSED:
            with pytest.raises(ModelError, match=re.escape(REFUSED[path.name])):
                eq.Mechanism.load(path)
            continue
        mechanism = eq.Mechanism.load(path)
        theirs = pin.buildModelFromUrdf(str(path))
        total = sum(inertia.mass for inertia in theirs.inertias)
        assert mechanism.mass == pytest.approx(total, rel=1e-9), path.name
        assert mechanism.driven
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "file",
    [
        "ur_description/urdf/ur10_robot.urdf",
        "panda_description/urdf/panda.urdf",
        "so_arm_description/urdf/so101.urdf",
        "talos_data/robots/talos_left_arm.urdf",
        "tiago_description/robots/tiago.urdf",
        "human_description/robots/human.urdf",
    ],
)
def test_gravity_and_frames_agree_with_pinocchio(file):
    ours = eq.Mechanism.load(ROBOTS + file).model
    data = mujoco.MjData(ours)
    theirs = pin.buildModelFromUrdf(str(FOLDER / file))
    their_data = theirs.createData()
    random_state = np.random.default_rng(4)
    for _ in range(5):
        q = pin.neutral(theirs)
        pairs = []
        for name, joint in zip(list(theirs.names)[1:], list(theirs.joints)[1:], strict=True):
            mine = mujoco.mj_name2id(ours, mujoco.mjtObj.mjOBJ_JOINT, name)
            if mine < 0:  # one that we fix at zero
                continue
            value = random_state.uniform(-2.0, 2.0)
            q[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else [np.cos(value), np.sin(value)]
            data.qpos[ours.jnt_qposadr[mine]] = value
            pairs.append((ours.jnt_dofadr[mine], joint.idx_v))
        mujoco.mj_forward(ours, data)
        gravity = pin.computeGeneralizedGravity(theirs, their_data, q)
        dofs, velocities = np.array(pairs).T
        np.testing.assert_allclose(data.qfrc_bias[dofs], gravity[velocities], rtol=0, atol=1e-9 * np.abs(gravity).max())
        pin.framesForwardKinematics(theirs, their_data, q)
        for body in range(1, ours.nbody):
            frame = their_data.oMf[theirs.getFrameId(ours.body(body).name, pin.BODY)]
            np.testing.assert_allclose(data.xpos[body], frame.translation, atol=1e-12)
            np.testing.assert_allclose(data.xmat[body], frame.rotation.ravel(), atol=1e-12)


def test_ur10_torque_limits_and_address():
    arm = eq.Mechanism.load("package://example-robot-data/robots/ur_description/urdf/ur10_robot.urdf")
    assert arm.driven[1] == "shoulder_lift_joint"
    assert arm.motor_limits.tolist() == [330.0, 330.0, 150.0, 54.0, 54.0, 54.0]
    assert arm.mass == pytest.approx(32.7, abs=0.05)
    assert arm.spec.compiler.savecompiled == 0


def test_mimic_joints_follow_and_may_be_held():
    hand = eq.Mechanism.load(ROBOTS + "panda_description/urdf/panda.urdf")
    assert hand.driven[-1] == "panda_finger_joint1"
    assert said(hand, "determined", "panda_finger_joint2")
    arm = eq.Mechanism.load(
        ROBOTS + "panda_description/urdf/panda.urdf", driven=[f"panda_joint{i}" for i in range(7, 0, -1)]
    )
    assert arm.driven == tuple(f"panda_joint{i}" for i in range(1, 8))
    assert said(arm, "held", "panda_finger_joint1")
    states = arm.states(eq.Sweep.sobol(arm, 8))
    assert np.ptp(states.kin.q[:, 7:]) == 0.0


# --- URDF ----------------------------------------------------------------------------------------------------------


def test_urdf_keeps_frames_masses_and_limits(load):
    robot = load(URDF)
    assert robot.name == "small"
    assert robot.bodies == ("world", "base", "a", "b", "c", "tool")
    assert robot.driven == ("j1", "j2", "j3")
    assert robot.driven_units == ("N m", "N", "N m")
    assert robot.motor_limits.tolist() == [3.0, np.inf, np.inf]
    assert robot.box.tolist() == [[-1.0, 1.0], [-0.2, 0.3], [-np.pi, np.pi]]
    assert robot.mass == 6.0
    assert robot.remarks == ()


def edited(old: str, new: str) -> str:
    assert old in URDF
    return URDF.replace(old, new, 1)


J1 = '<axis xyz="0 1 0"/><limit lower="-1" upper="1"'


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (edited('<mass value="1.5"/>', '<mass value="-1.5"/>'), "link 'a' has a negative mass"),
        (edited('<mass value="1.5"/>', '<mass value="nan"/>'), "mass of link 'a' is 'nan'"),
        (edited('<mass value="1.5"/>', ""), "link 'a' has an inertial without a mass"),
        (edited('xyz="0 0 .1"', 'xyz="0 inf .1"'), "inertial origin of link 'a': xyz is 'inf'"),
        (edited('xyz="0 0 .3"', 'xyz="0 0 1e400"'), "origin of joint 'j1': xyz is 1e400, beyond"),
        (edited('xyz="0 0 .3"', 'xyz="0 0"'), "origin of joint 'j1': xyz needs 3 numbers"),
        (edited('rpy="0 0 1"', 'rpy="0 0 ${pi}"'), "xacro"),
        (edited('ixx="1"', 'ixx="1_0"'), "ixx of link 'base'"),
        (edited(J1, J1.replace("0 1 0", "0 nan 0")), "axis of joint 'j1'"),
        (edited(J1, J1.replace("0 1 0", "0 0 0")), "axis of joint 'j1' is zero"),
        (edited('lower="-1"', 'lower="2"'), "joint 'j1' has its limits reversed: lower 2 is above upper 1"),
        (edited('lower="-1"', 'lower="NaN"'), "limit lower of joint 'j1'"),
        (edited('effort="3"', 'effort="x"'), "limit effort of joint 'j1'"),
        (edited('type="revolute"', 'type="revolut"'), "did you mean revolute"),
        (edited('<child link="a"/>', '<child link="aa"/>'), "joint 'j1' joins the unknown link 'aa'"),
        (edited('<child link="a"/>', ""), "joint 'j1' names no child link"),
        (edited('<child link="b"/>', '<child link="a"/>'), "link 'a' hangs on two joints"),
        (edited('<parent link="base"/>', '<parent link="tool"/>'), "loop of links"),
        (edited('<link name="tool"/>', '<link name="tool"/><link name="lost"/>'), "links base, lost are joined"),
        (edited('<link name="tool"/>', '<link name="tool"/><link name="b"/>'), "two links are named 'b'"),
        (edited('name="j2"', 'name="j1"'), "two joints are named 'j1'"),
        (edited('<link name="tool"/>', '<link name=""/>'), "a link has no name"),
        (URDF.replace('"tool"', '"world"'), "named 'world'"),
        (edited("<gazebo>", '<mujoco><extension><plugin plugin="x"/></extension></mujoco><gazebo>'), "plugins"),
        (edited("<gazebo>", '<xacro:macro xmlns:xacro="http://x/xacro"/><gazebo>'), "xacro"),
        (edited('<axis xyz="0 1 0"/></joint>', '<axis xyz="0 1 0"/><mimic joint="j9"/></joint>'), "unknown joint 'j9'"),
        (edited('<axis xyz="0 1 0"/></joint>', '<axis xyz="0 1 0"/><mimic joint="j3"/></joint>'), "in a circle: j3"),
        ("<robot name='r'/>", "has no link"),
        ("<robot name='r'><link name='l'/></robot>", "no hinge and no slide"),
        ("<!DOCTYPE robot [<!ENTITY a 'b'>]><robot name='&a;'/>", "declares DOCTYPE"),
        (URDF.replace("<robot", "<!-- <!ENTITY --><robot"), "line 2 declares ENTITY"),
        (URDF.replace('"1.0"?', '"1.0" encoding="utf-7"?'), "encoding"),
        (URDF.replace("</robot>", ""), "not well-formed XML"),
        ("", "empty"),
        (" \n ", "empty"),
        ("no xml", "not well-formed"),
        ("<html/>", "neither URDF nor MJCF"),
        (b"\x7fELF\0\1\2", "UTF-8"),
        (URDF.encode("utf-16"), "UTF-8"),
        ("<a>" * 500 + "</a>" * 500, "nested"),
    ],
)
def test_faults_are_named(load, text, words):
    with pytest.raises(ModelError) as caught:
        load(text)
    assert words in str(caught.value)
    assert str(caught.value).startswith("model.")


def test_entities_are_never_resolved(load, tmp_path):
    secret = tmp_path / "secret.txt"
    secret.write_text("in-confidence")
    bomb = f'<!DOCTYPE r [<!ENTITY e SYSTEM "file://{secret}">]><robot name="&e;"><link name="&e;"/></robot>'
    with pytest.raises(ModelError) as caught:
        load(bomb)
    assert "in-confidence" not in str(caught.value)


def test_stuck_joints_become_fixed_where_they_are_stuck(load):
    turned = load(edited('lower="-1" upper="1"', 'lower="0.7" upper="0.7"'))
    free = load(URDF)
    assert turned.driven == ("j2", "j3")
    assert said(turned, "fixed, because the limits are equal: j1")
    stuck, loose = mujoco.MjData(turned.model), mujoco.MjData(free.model)
    loose.qpos[0] = 0.7
    mujoco.mj_kinematics(turned.model, stuck)
    mujoco.mj_kinematics(free.model, loose)
    np.testing.assert_allclose(stuck.xpos, loose.xpos, atol=1e-15)
    np.testing.assert_allclose(stuck.xmat, loose.xmat, atol=1e-15)
    slid = load(edited('lower="-.2" upper=".3"', 'lower="0.1" upper="0.1"'))
    data = mujoco.MjData(slid.model)
    mujoco.mj_kinematics(slid.model, data)
    across = data.body("b").xpos - data.body("a").xpos
    np.testing.assert_allclose(across, 0.1 * data.body("a").xmat.reshape(3, 3)[:, 1], atol=1e-15)


def test_followers_of_stuck_joints_stop_with_them(load):
    text = edited('lower="-1" upper="1"', 'lower="0.5" upper="0.5"')
    text = text.replace('<axis xyz="0 1 0"/></joint>', '<axis xyz="0 1 0"/><mimic joint="j1" multiplier="2"/></joint>')
    robot = load(text)
    assert robot.driven == ("j2",)
    assert said(robot, "because the joint it follows is: j3")
    np.testing.assert_allclose(robot.model.body("c").quat, [np.cos(0.5), 0, np.sin(0.5), 0], atol=1e-15)


def test_planar_and_floating_joints_are_held(load):
    planar = load(edited('name="j3" type="continuous"', 'name="j3" type="planar"'))
    assert planar.driven == ("j1", "j2")
    assert said(planar, "planar or floating", "j3")
    floating = load(edited('name="j3" type="continuous"', 'name="j3" type="floating"'))
    assert said(floating, "planar or floating", "j3")
    base = URDF.replace('"base"', '"world"').replace('name="j1" type="revolute"', 'name="j1" type="floating"')
    flying = load(base)
    assert flying.driven == ("j2", "j3")
    assert said(flying, "held at the reference posture: j1")


def test_limits_that_are_missing_are_no_limits(load):
    robot = load(edited('<limit lower="-1" upper="1" effort="3" velocity="1"/>', '<limit effort="3" velocity="1"/>'))
    assert robot.box[0].tolist() == [-np.pi, np.pi]
    assert robot.motor_limits[0] == 3.0
    assert said(robot, "without limits", "j1")
    wide = load(edited('lower="-.2" upper=".3"', 'lower="-1e16" upper="1e16"'))
    assert said(wide, "slides without limits: j2", "sweep")
    assert not said(wide, "MuJoCo")


@pytest.mark.parametrize(
    ("inertia", "reason"),
    [
        ('ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"', "not physical (A + B < C)"),
        ('ixx="1" iyy="1" izz="-1" ixy="0" ixz="0" iyz="0"', "not positive"),
        ('ixx="1" iyy="1" izz="1" ixy="5" ixz="0" iyz="0"', "not positive"),
        ('ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"', "zero (a point mass)"),
        ("", "zero (a point mass)"),
    ],
)
def test_repaired_inertias_keep_mass_and_centre(load, inertia, reason):
    whole = load(URDF)
    repaired = load(edited(f'<mass value="1.5"/>{SOLID}', f'<mass value="1.5"/><inertia {inertia}/>'))
    assert said(repaired, "inertia of link a was", reason, "dynamics must not trust it")
    np.testing.assert_array_equal(repaired.model.body_mass, whole.model.body_mass)
    np.testing.assert_array_equal(repaired.model.body_ipos, whole.model.body_ipos)


def test_valid_inertias_are_kept_exactly(load):
    plate = 'ixx="1" iyy="1" izz="2" ixy="0" ixz="0" iyz="0"'
    robot = load(edited(f'<mass value="1.5"/>{SOLID}', f'<mass value="1.5"/><inertia {plate}/>'))
    assert robot.remarks == ()
    np.testing.assert_allclose(sorted(robot.model.body("a").inertia), [1, 1, 2], rtol=1e-9)


def test_massless_moving_links_get_a_token(load):
    robot = load(edited(f'<link name="b"><inertial><mass value="1"/>{SOLID}</inertial></link>', '<link name="b"/>'))
    assert robot.model.body("b").mass[0] == 1e-12
    assert said(robot, "moving link b has no mass", "1e-12 kg")
    assert robot.mass == pytest.approx(5.0, abs=1e-9)
    human = eq.Mechanism.load(ROBOTS + "human_description/robots/human.urdf")
    assert said(human, "and 14 more")


# --- MJCF ----------------------------------------------------------------------------------------------------------


def test_loops_drive_base_joints_unless_the_file_has_motors(load):
    assert load(FIVE_BAR).driven == ("l1", "r1")
    motors = (
        '<actuator><motor joint="l2" gear="10" ctrlrange="-2 2"/><position joint="l1" forcerange="-7 7"/></actuator>'
    )
    five = load(FIVE_BAR.replace("<actuator/>", motors))
    assert five.driven == ("l1", "l2")
    assert five.motor_limits.tolist() == [7.0, 20.0]
    assert said(five, "determined", "r1, r2")


def test_chosen_joints_are_driven_in_model_order(load):
    five = load(FIVE_BAR, driven=["r2", "l1"])
    assert five.driven == ("l1", "r2")
    four = load(FIVE_BAR, driven=["r2"])
    assert said(four, "held", "l1")
    q = four.states(eq.Sweep.grid(four, {"r2": (-0.1, 0.1, 5)})).kin.q
    assert np.abs(q[:, 0]).max() < 1e-10
    assert np.ptp(q[:, 2]) > 0.01
    with pytest.raises(InputError, match="cannot be driven as well"):
        load(FIVE_BAR, driven=["l1", "r1", "r2"])


def test_slider_crank_and_singular_parallelogram(load):
    slider = f"""<mujoco><worldbody><body><joint name="crank" axis="0 -1 0"/>{MASS}<body pos=".2 0 0">
      <joint name="rod" axis="0 -1 0"/>{MASS}<site name="end" pos=".5 0 0"/></body></body>
      <body pos=".7 0 0"><joint name="slider" type="slide" axis="1 0 0"/>{MASS}<site name="pin"/></body></worldbody>
      <equality><connect site1="end" site2="pin"/></equality></mujoco>"""
    assert load(slider).driven == ("crank",)
    # three parallel cranks lying flat: overconstrained, and at a change point
    flat = f"""<mujoco><worldbody><body><joint name="a" axis="0 -1 0"/>{MASS}<body pos=".3 0 0">
      <joint name="c" axis="0 -1 0"/>{MASS}<site name="p" pos=".3 0 0"/><site name="m" pos=".15 0 0"/></body></body>
      <body pos=".3 0 0"><joint name="b" axis="0 -1 0"/>{MASS}<site name="q" pos=".3 0 0"/></body>
      <body pos=".15 0 0"><joint name="d" axis="0 -1 0"/>{MASS}<site name="n" pos=".3 0 0"/></body></worldbody>
      <equality><connect site1="p" site2="q"/><connect site1="m" site2="n"/></equality></mujoco>"""
    assert load(flat).driven == ("a",)


def test_branch_is_a_keyframe(load):
    assert load(FIVE_BAR, branch="low").reference.tolist() == [0.1, 0.2, -0.1, -0.2]
    assert load(FIVE_BAR).reference.tolist() == [0.0] * 4
    with pytest.raises(InputError, match="did you mean low"):
        load(FIVE_BAR, branch="lo")


@pytest.mark.parametrize(
    ("driven", "words"),
    [
        (["l3"], "did you mean"),
        (["l1", "l1"], "twice"),
        ([], "empty"),
        ("l1", "give a list"),
    ],
)
def test_wrong_driven_joints(load, driven, words):
    with pytest.raises(InputError, match=words):
        load(FIVE_BAR, driven=driven)


def test_free_and_ball_joints_are_held_and_names_made_up(load):
    robot = load(f"""<mujoco><worldbody><body name="trunk"><freejoint/>{MASS}<body name="leg"><joint/>{MASS}</body>
      <body><joint type="ball" name="body3"/>{MASS}</body></body></worldbody></mujoco>""")
    assert robot.driven == ("joint2",)
    assert robot.bodies == ("world", "trunk", "leg", "body3")
    assert said(robot, "held at the reference posture: joint1, body3")
    assert said(robot, "joints without a name", "joint1, joint2")
    with pytest.raises(InputError, match="is a free joint"):
        load(f"<mujoco><worldbody><body><freejoint name='f'/>{MASS}</body></worldbody></mujoco>", driven=["f"])


def test_gravity_is_replaced(load):
    lunar = load(URDF, gravity=(0.0, 0.0, -1.62))
    assert lunar.gravity.tolist() == [0.0, 0.0, -1.62]
    assert said(load(one_body(before='<option gravity="0 0 0"/>')), "gravity is zero")
    for wrong in ((0.0, 1.0), (0.0, 0.0, np.nan), ("a", 0, 0)):
        with pytest.raises(InputError, match="three numbers"):
            load(URDF, gravity=wrong)


def test_audit_says_what_cannot_be(load):
    heavy = one_body('<inertial pos="0 0 0" mass="120" diaginertia="1 1 1"/>').replace(
        "</worldbody>", '<body name="cart"><geom size="1" mass="2000"/></body></worldbody>'
    )
    assert said(load(heavy), "2,120 kg", "cart", "2,000 kg")
    assert said(load(one_body().replace('name="a"', 'name="a" gravcomp="1"')), "gravcomp is ignored", "a")
    assert said(load(one_body().replace('name="j"', 'name="j" stiffness="2"')), "springs of the file", "j")


def test_includes_are_followed_and_looked_through(load, tmp_path):
    (tmp_path / "arm.xml").write_text(f'<mujocoinclude><body name="b"><joint name="in"/>{MASS}</body></mujocoinclude>')
    main = '<mujoco><worldbody><include file="arm.xml"/></worldbody></mujoco>'
    assert load(main).driven == ("in",)
    (tmp_path / "arm.xml").write_text('<mujocoinclude><plugin plugin="x"/></mujocoinclude>')
    with pytest.raises(ModelError, match=r"included arm\.xml: plugins in a file are refused"):
        load(main)
    (tmp_path / "arm.xml").write_text("<!DOCTYPE a><mujocoinclude/>")
    with pytest.raises(ModelError, match=r"included arm\.xml: line 1 declares DOCTYPE"):
        load(main)
    with pytest.raises(ModelError, match=r"none\.xml"):
        load(main.replace("arm", "none"))
    with pytest.raises(ModelError, match="already included"):
        load(main.replace("arm", "model"))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (one_body(before='<extension><plugin plugin="mujoco.pid"/></extension>'), "plugins"),
        (one_body(before='<asset><mesh name="m" file="none.stl"/></asset>').replace(
            MASS, '<geom type="mesh" mesh="m"/>'), "none.stl"),
        (one_body(before='<asset><texture name="t" type="2d" file="none.png"/></asset>'), "none.png"),
        (one_body(before='<asset><hfield name="t" file="none.png" size="1 1 1 1"/></asset>'), "none.png"),
        (one_body('<geom size="1" colour="1"/>'), "unrecognized attribute: 'colour'"),
        (one_body('<geom size="1" mass="-1"/>'), "negative"),
        (one_body('<inertial pos="0 nan 0" mass="1" diaginertia="1 1 1"/>'), "pos of <inertial> is not finite"),
        (one_body('<inertial pos="0 1e200 0" mass="1" diaginertia="1 1 1"/>'), "body 'a' has a position"),
        (one_body(before='<custom><numeric name="n" size="2000000000"/></custom>'), "beyond 10,000"),
        (one_body().replace("<body", '<replicate count="5000"><replicate count="5000"><body').replace(
            "</body>", "</body></replicate></replicate>"), "beyond 10,000"),
        (one_body(after='<keyframe><key name="k" qpos="1 2 3"/></keyframe>'), "qpos"),
        ("<mujoco/>", "no hinge and no slide"),
    ],
)  # fmt: skip
def test_mjcf_faults_are_named(load, text, words):
    with pytest.raises(ModelError) as caught:
        load(text)
    assert words in str(caught.value)


def test_mjcf_is_read_from_xml_files_only(load):
    with pytest.raises(ModelError, match=r"end in \.xml"):
        load(one_body(), ".mjcf")


def test_warnings_become_remarks_and_no_log_is_written(load, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    twin = one_body(after='<actuator><muscle joint="j"/></actuator>').replace("<joint", '<joint armature="-1"')
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        robot = load(twin.replace("-1", "-0.10999999999999999"))
    assert said(robot, "MuJoCo: Inertia matrix is too close to singular")
    assert said(robot, "muscles")
    assert not (tmp_path / "MUJOCO_LOG.TXT").exists()
    assert capfd.readouterr() == ("", "")


# --- addresses -----------------------------------------------------------------------------------------------------


def test_packages_are_found_in_the_stated_order(tmp_path, monkeypatch):
    for place in ("given", "ros", "ament/share"):
        (tmp_path / place / "my_arm").mkdir(parents=True)
        (tmp_path / place / "my_arm" / "arm.urdf").write_text(URDF)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ros"))
    monkeypatch.setenv("AMENT_PREFIX_PATH", os.pathsep.join(["/nowhere", str(tmp_path / "ament")]))
    address = "package://my_arm/arm.urdf"
    assert resolve(address, (tmp_path / "given",)) == tmp_path / "given/my_arm/arm.urdf"
    assert resolve(address, (tmp_path / "given/my_arm",)) == tmp_path / "given/my_arm/arm.urdf"
    assert resolve(address) == tmp_path / "ros/my_arm/arm.urdf"
    monkeypatch.delenv("ROS_PACKAGE_PATH")
    assert resolve(address) == tmp_path / "ament/share/my_arm/arm.urdf"
    assert resolve("package://my_arm") == tmp_path / "ament/share/my_arm/arm.urdf"
    assert resolve(Path(address)) == tmp_path / "ament/share/my_arm/arm.urdf"
    assert eq.Mechanism.load(address, search=[tmp_path / "given"]).name == "small"


def test_python_packages_are_not_imported(tmp_path, monkeypatch):
    package = tmp_path / "booby_trap"
    package.mkdir()
    (package / "__init__.py").write_text("raise SystemExit('imported')")
    (package / "arm.urdf").write_text(URDF)
    monkeypatch.syspath_prepend(tmp_path)
    assert resolve("package://booby-trap/arm.urdf") == package / "arm.urdf"


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("package://nowhere_at_all/x.urdf", "looked in"),
        ("package://example-robot-data/../../secret.urdf", "leaves the package"),
        ("package://../secret.urdf", "names no package"),
        ("package://", "names no package"),
        ("package://example-robot-data", "this is a folder"),
        (ROBOTS + "ur_description/urdf/ur11_robot.urdf", "did you mean ur10_robot.urdf"),
        (ROBOTS + "no_description/urdf/x.urdf", "there is no folder"),
        ("a" * 5000, "there is no"),
        ("", "not a file name"),
        ("a\0b", "not a file name"),
        (str(FOLDER), "this is a folder"),
    ],
)
def test_addresses_that_mean_nothing(address, words):
    with pytest.raises(InputError) as caught:
        resolve(address)
    assert words in str(caught.value)


def test_missing_example_data_says_how_to_get_it(monkeypatch):
    monkeypatch.setattr("equipoise.models.packages._shares", lambda: iter(()))
    with pytest.raises(ModelError, match=re.escape("pip install 'equipoise[robots]'")):
        resolve(ROBOTS + "ur_description/urdf/ur10_robot.urdf")


# --- hostile files -------------------------------------------------------------------------------------------------

WORDS = ["nan", "inf", "-1", "0", "1e308", "-1e308", "1e-308", "2147483648", "", "1 2 3", "world", "a", "../", "é", '"']


def mutated(text: str, seed: int) -> bytes:
    """A copy with one to four bytes, values, tags or numbers spoilt, cut or doubled."""
    source = random.Random(seed)
    for _ in range(source.choice([1, 1, 2, 4])):
        patterns = {"value": r'"([^"]*)"', "tag": r"(<[^<>]*>)", "number": r"([-+]?\d[\d.]*)"}
        kind = source.choice(["byte", "cut", "double", *patterns, "value", "number"])
        place = source.randrange(len(text))
        if kind == "byte":
            text = text[:place] + chr(source.randrange(1, 256)) + text[place + 1 :]
        elif kind == "cut" and place:
            text = text[:place]
        elif kind == "double":
            text = text[:place] + text[source.randrange(place + 1) :]
        elif kind in patterns and (found := list(re.finditer(patterns[kind], text))):
            match = source.choice(found)
            spoilt = source.choice([*WORDS, "", match[1] * 2]) if kind != "tag" else source.choice(["", match[1] * 2])
            text = text[: match.start(1)] + spoilt + text[match.end(1) :]
        text = text or " "
    return text.encode("utf-8", "replace")


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from([URDF, FIVE_BAR, one_body(MASS, '<option gravity="0 0 -9.81"/>')]), st.integers(0, 10**9))
def test_spoilt_files_load_or_are_refused(tmp_path, text, seed):
    path = tmp_path / ("spoilt.urdf" if text is URDF else "spoilt.xml")
    path.write_bytes(mutated(text, seed))
    with contextlib.suppress(EquipoiseError):
        mechanism = eq.Mechanism.load(path)
        assert mechanism.driven
        assert np.isfinite(mechanism.mass)


def test_builders_leave_no_log_where_the_user_stands(tmp_path):
    """MuJoCo writes MUJOCO_LOG.TXT for warnings that nobody hears; a session of builders hears them too."""
    code = (
        "import equipoise as eq, mujoco\n"
        "arm = eq.chain([eq.Link('a', length=0.5, mass=1.0)])\n"
        "data = mujoco.MjData(arm.model)\n"
        "data.qpos[0] = float('nan')\n"
        "mujoco.mj_step(arm.model, data)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=True, cwd=tmp_path
    )
    assert "QPOS" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_what_mujoco_raises_while_it_computes_is_a_message(monkeypatch):
    arm = eq.chain([eq.Link("a", length=0.5, mass=1.0)])

    def fail(*_, **__):
        raise mujoco.FatalError("mj_stackAlloc: out of memory")

    monkeypatch.setattr("mujoco.batch.Batch.forward", fail)
    with pytest.raises(ModelError, match="out of memory") as caught:
        eq.analyze(arm)
    assert caught.value.where == arm.name
