"""Loop closure against closed forms, MuJoCo's own constraint rows, finite differences and Pinocchio."""

from __future__ import annotations

import time

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from equipoise.errors import InputError, LoopError
from equipoise.kinematics import kinematics
from equipoise.loops import close_loops, loop_report
from equipoise.loops.constraints import equalities, residual
from equipoise.loops.posture import Evaluator, integrate
from equipoise.mechanism import Mechanism
from equipoise.models.four_bar import crank_range, four_bar
from equipoise.models.parallelogram_arm import parallelogram_arm
from equipoise.models.slider_crank import slider_crank
from equipoise.sweep import Sweep

BODIES = """
<mujoco><worldbody>
<body name="a" pos="0 0 1"><freejoint name="fa"/><geom size=".1" pos=".02 .1 0"/>
  <site name="s" pos=".1 .2 .3" quat=".5 .2 .7 .1"/>
  <body name="a2" pos=".3 0 0"><joint name="ha" axis="0 1 1"/><geom size=".1"/></body></body>
<body name="b" pos="1 0 0"><joint name="bb" type="ball" pos=".1 0 0"/><geom size=".1" pos=".3 .1 0"/>
  <site name="t" pos="-.1 .2 .3"/>
  <body name="b2" pos="0 .4 0"><joint name="sb" type="slide" axis="1 1 0"/>
    <joint name="hb" axis="0 0 1" ref=".3"/><geom size=".1"/><site name="u" pos="0 0 .1"/>
    <body name="b3" pos="0 .4 0"><joint name="hb3" axis="1 0 1"/><geom size=".1"/><site name="w" pos="0 0 .1"/></body>
  </body></body>
<body name="c" pos="2 0 0"><joint name="h" ref=".2"/>
  <joint name="h2" axis="0 1 0"/><geom size=".1" pos=".1 0 0"/></body>
</worldbody>
<tendon><spatial name="x"><site site="s"/><site site="t"/></spatial>
  <spatial name="y"><site site="u"/><site site="w"/></spatial>
  <fixed name="f"><joint joint="h" coef="2"/><joint joint="hb" coef="-3"/></fixed></tendon>
<equality>%s</equality></mujoco>"""
EQUALITIES = {
    "connect bodies": '<connect body1="a" body2="b" anchor="0 .1 1"/>',
    "connect in one tree": '<connect body1="b3" body2="b" anchor="0 .1 1"/>',
    "connect to the world": '<connect body1="b3" anchor="0 .1 1"/>',
    "connect sites": '<connect site1="s" site2="w"/>',
    "weld bodies": '<weld body1="a2" body2="b2" anchor=".1 .2 .3"/>',
    "weld relpose": '<weld body1="b2" body2="a2" anchor=".1 .2 .3" relpose=".3 .1 .2 .5 .5 .1 .2" torquescale="3"/>',
    "weld to the world": '<weld body1="b3" torquescale=".7"/>',
    "weld sites": '<weld site1="w" site2="s" torquescale="2"/>',
    "joint": '<joint joint1="h" polycoef=".1 1 2 3 4"/>',
    "two joints": '<joint joint1="sb" joint2="h2" polycoef=".1 .2 .3 .4 .5"/>',
    "tendon": '<tendon tendon1="x" polycoef=".1 1 2"/>',
    "two tendons": '<tendon tendon1="x" tendon2="f" polycoef=".1 .5 .02"/>',
    "tendon in one tree": '<tendon tendon1="f" tendon2="y" polycoef=".1 1 2 3 4"/>',
}
EQUALITIES["all, one inactive"] = "".join(EQUALITIES.values()) + '<connect site1="u" site2="t" active="false"/>'


@pytest.mark.parametrize("kind", EQUALITIES)
def test_rows_are_those_of_mujoco(kind):
    model = mujoco.MjModel.from_xml_string(BODIES % EQUALITIES[kind])
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    rng = np.random.default_rng(0)
    q = integrate(model, np.tile(model.qpos0, (7, 1)), rng.normal(size=(7, model.nv)))
    error, jacobian = residual(equalities(model), Evaluator(model)(q))
    data = mujoco.MjData(model)
    for row in range(len(q)):
        data.qpos[:] = q[row]
        mujoco.mj_forward(model, data)
        expected = np.zeros((data.nefc, model.nv))
        if mujoco.mj_isSparse(model):
            sparse = data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind
            mujoco.mju_sparse2dense(expected, *sparse)
        else:
            expected[:] = data.efc_J.reshape(-1, model.nv)
        assert np.allclose(error[row], data.efc_pos, rtol=1e-13, atol=1e-13)
        assert np.allclose(jacobian[row], expected, rtol=1e-12, atol=1e-12)


def test_steps_are_those_of_mujoco():
    model = mujoco.MjModel.from_xml_string(BODIES % "")
    rng = np.random.default_rng(1)
    q = integrate(model, np.tile(model.qpos0, (9, 1)), rng.normal(size=(9, model.nv)))
    step = rng.normal(size=(9, model.nv))
    step[0] = 0.0
    moved = integrate(model, q, step)
    for row in range(9):
        mujoco.mj_integratePos(model, q[row], step[row], 1.0)
    assert np.allclose(moved, q, rtol=0, atol=1e-14)


def wrapped(angle):
    return np.angle(np.exp(1j * angle))


def four_bar_angles(lengths, theta, sign):
    """Coupler and rocker angles by Freudenstein's equation; sign +1 is the open branch."""
    g, a, b, c = lengths
    k1, k2, k3 = g / a, g / c, (a**2 - b**2 + c**2 + g**2) / (2 * a * c)
    # k1 cos(psi) - k2 cos(theta) + k3 = cos(theta - psi), ground along +x
    along, across = k1 - np.cos(theta), -np.sin(theta)
    psi = np.arctan2(across, along) + sign * np.arccos((k2 * np.cos(theta) - k3) / np.hypot(along, across))
    x = g + c * np.cos(psi) - a * np.cos(theta)
    z = c * np.sin(psi) - a * np.sin(theta)
    return np.arctan2(z, x), psi


GRASHOF, TRIPLE_ROCKER = (1.0, 0.3, 0.9, 0.8), (1.0, 0.8, 0.4, 0.7)


@pytest.mark.parametrize("branch", ["open", "crossed"])
@pytest.mark.parametrize("lengths", [GRASHOF, TRIPLE_ROCKER, (0.3, 1.0, 0.9, 0.8), (1.0, 0.6, 0.7, 0.35)])
def test_four_bar_closes_as_freudenstein_says(lengths, branch):
    arm = four_bar(*lengths, branch=branch)
    low, high = crank_range(*lengths)
    full = low == 0.0 and high == pytest.approx(np.pi)
    theta = np.linspace(-3.0, 3.0, 301) if full else np.linspace(low + 0.02, high - 0.02, 301)
    q, D = close_loops(arm, theta[:, None])
    coupler, rocker = four_bar_angles(lengths, theta, 1.0 if branch == "open" else -1.0)
    assert np.abs(wrapped(q[:, 0] + q[:, 1] - coupler)).max() < 1e-12
    assert np.abs(wrapped(q[:, 2] - rocker)).max() < 1e-12
    assert np.abs(np.diff(q, axis=0)).max() < 0.5
    gap, singular = loop_report(arm, q)
    assert gap.max() < 1e-14
    assert singular.min() > arm.singularity
    # velocity ratios of the four-bar: sines of the differences of the links' angles
    _, a, b, c = lengths
    assert D[:, 0, 0] == pytest.approx(1.0)
    assert D[:, 1, 0] + 1 == pytest.approx(-a * np.sin(rocker - theta) / (b * np.sin(rocker - coupler)), rel=1e-9)
    assert D[:, 2, 0] == pytest.approx(
        a * np.sin(theta - coupler) / (c * np.sin(rocker - coupler)), rel=1e-9, abs=1e-12
    )


@given(
    lengths=st.tuples(*[st.floats(0.2, 2.0)] * 4),
    branch=st.sampled_from(["open", "crossed"]),
    shares=st.lists(st.floats(0.03, 0.97), min_size=1, max_size=8),
)
@settings(max_examples=40)
def test_any_four_bar_stays_on_its_branch(lengths, branch, shares):
    if max(lengths) > 0.95 * (sum(lengths) - max(lengths)):
        return
    arm = four_bar(*lengths, branch=branch)
    low, high = crank_range(*lengths)
    theta = low + np.array(shares) * (high - low)
    try:
        q, _ = close_loops(arm, theta[:, None])
    except LoopError:  # refused next to a flat linkage, which the property of the branch does not concern
        return
    coupler, rocker = four_bar_angles(lengths, theta, 1.0 if branch == "open" else -1.0)
    assert np.abs(wrapped(q[:, 0] + q[:, 1] - coupler)).max() < 1e-7
    assert np.abs(wrapped(q[:, 2] - rocker)).max() < 1e-7


def slider(lengths, theta, sign, offset, direction):
    a, b = lengths
    across = a * np.sin(theta - direction) - offset
    return a * np.cos(theta - direction) + sign * np.sqrt(b**2 - across**2)


@pytest.mark.parametrize("branch", ["forward", "backward"])
@pytest.mark.parametrize(("rod", "offset", "direction"), [(0.5, 0.0, 0.0), (0.45, 0.1, 0.7), (0.25, -0.12, np.pi / 2)])
def test_slider_crank_moves_as_the_closed_form_says(branch, rod, offset, direction):
    arm = slider_crank(0.2, rod, offset=offset, direction=direction, branch=branch, masses=(1, 2, 3))
    theta = np.linspace(-1.2, 1.2, 200) if rod < 0.4 else np.linspace(-9.0, 9.0, 500)
    theta = theta if rod > 0.4 else arm.reference[0] + theta
    sign = 1.0 if branch == "forward" else -1.0
    if rod < 0.4:
        theta = theta[np.abs(0.2 * np.sin(theta - direction) - offset) < 0.98 * rod]
    q, D = close_loops(arm, theta[:, None])
    assert q[:, 2] == pytest.approx(slider((0.2, rod), theta, sign, offset, direction), abs=1e-13)
    step = 1e-200
    slope = slider((0.2, rod), theta + 1j * step, sign, offset, direction).imag / step
    assert D[:, 2, 0] == pytest.approx(slope, rel=1e-9, abs=1e-12)


def difference(mechanism, driven, step=1e-5):
    """Central differences of the postures, fourth order, where all joints are hinges or slides."""
    columns = []
    for joint in range(driven.shape[1]):
        shift = step * np.eye(driven.shape[1])[joint]
        f = {k: close_loops(mechanism, driven + k * shift)[0] for k in (-2, -1, 1, 2)}
        columns.append((8 * (f[1] - f[-1]) - (f[2] - f[-2])) / (12 * step))
    return np.stack(columns, axis=-1)


def loaded(xml, driven, reference=None):
    spec = mujoco.MjSpec.from_string(xml)
    model = spec.compile()
    start = model.qpos0.copy() if reference is None else np.array(reference, dtype=float)
    return Mechanism(spec, model, tuple(driven), start, "test")


FIVE_BAR = """
<mujoco><worldbody>
<body name="a1"><joint name="left" axis="0 -1 0"/><geom size=".02" mass="1" pos=".2 0 0"/>
  <body name="a2" pos=".4 0 0"><joint name="left_elbow" axis="0 -1 0"/><geom size=".02" mass="1"/>
    <site name="p" pos=".6 0 0"/></body></body>
<body name="b1" pos=".5 0 0"><joint name="right" axis="0 -1 0"/><geom size=".02" mass="1" pos=".2 0 0"/>
  <body name="b2" pos=".4 0 0"><joint name="right_elbow" axis="0 -1 0"/><geom size=".02" mass="1"/>
    <site name="q" pos=".6 0 0"/></body></body>
</worldbody><equality><connect site1="p" site2="q"/></equality></mujoco>"""


def five_bar():
    return loaded(FIVE_BAR, ("left", "right"), (2.3, -1.2, 0.8, 1.2))


def test_five_bar_over_a_grid():
    arm = five_bar()
    left, right = np.meshgrid(np.linspace(1.7, 2.4, 40), np.linspace(0.8, 1.4, 40))
    driven = np.stack([left.ravel(), right.ravel()], axis=1)
    q, D = close_loops(arm, driven)
    assert loop_report(arm, q)[0].max() < 1e-14
    tip = 0.4 * np.exp(1j * q[:, 0]) + 0.6 * np.exp(1j * (q[:, 0] + q[:, 1]))
    other = 0.5 + 0.4 * np.exp(1j * q[:, 2]) + 0.6 * np.exp(1j * (q[:, 2] + q[:, 3]))
    assert np.abs(tip - other).max() < 1e-14
    # the branch: the tip stays above the line between the elbows
    elbows = 0.4 * np.exp(1j * q[:, 0]), 0.5 + 0.4 * np.exp(1j * q[:, 2])
    assert (((elbows[1] - elbows[0]).conj() * (tip - elbows[0])).imag > 0).all()
    rows = slice(0, None, 97)
    assert difference(arm, driven[rows]) == pytest.approx(D[rows], rel=1e-8, abs=1e-9)
    # a start posture names the branch, and gives the same postures
    again, _ = close_loops(arm, driven[:50], start=q[800])
    assert again == pytest.approx(q[:50], abs=1e-13)


def test_transmission_is_pinocchios_constrained_velocity():
    arm = five_bar()
    model = pin.Model()
    for base, names in ((0.0, ("left", "left_elbow")), (0.5, ("right", "right_elbow"))):
        first = model.addJoint(
            0, pin.JointModelRevoluteUnaligned(0, -1, 0), pin.SE3(np.eye(3), np.array([base, 0, 0])), names[0]
        )
        model.addJoint(
            first, pin.JointModelRevoluteUnaligned(0, -1, 0), pin.SE3(np.eye(3), np.array([0.4, 0, 0])), names[1]
        )
    data = model.createData()
    q, D = close_loops(arm, np.array([[2.0, 0.9], [2.5, 1.3]]))
    tip = pin.SE3(np.eye(3), np.array([0.6, 0, 0]))
    for row in range(2):
        pin.computeJointJacobians(model, data, q[row])
        frames = [pin.getJointJacobian(model, data, i, pin.LOCAL) for i in (2, 4)]
        points = [(data.oMi[i] * tip) for i in (2, 4)]
        gap = points[0].translation - points[1].translation
        assert np.abs(gap).max() < 1e-15
        lin = [data.oMi[i].rotation @ tip.toActionMatrixInverse()[:3] @ J for i, J in zip((2, 4), frames, strict=True)]
        assert np.abs((lin[0] - lin[1]) @ D[row]).max() < 1e-14


def test_gravity_torque_is_the_slope_of_the_energy():
    for arm, low, high in (
        (four_bar(*GRASHOF, masses=(1, 2, 3), coms=((0.1, 0.05), (0.5, 0.2), None)), -3.0, 3.0),
        (slider_crank(0.2, 0.5, offset=0.05, direction=1.0, masses=(1, 2, 3)), -3.0, 3.0),
        (parallelogram_arm(0.4, (0.02, 0.1), masses=(1, 2, 3)), -1.2, 0.8),
    ):
        theta = np.linspace(low, high, 60)[:, None]
        q, D = close_loops(arm, theta)
        torque = np.einsum("ni,nij->nj", kinematics(arm, q).bias, D)[:, 0]
        h = 1e-4
        V = {k: kinematics(arm, close_loops(arm, theta + k * h)[0]).energy for k in (-2, -1, 1, 2)}
        slope = (8 * (V[1] - V[-1]) - (V[2] - V[-2])) / (12 * h)
        assert torque == pytest.approx(slope, rel=1e-8, abs=1e-9)
        assert np.abs(torque).max() > 1.0


def test_crank_beyond_its_limit_names_pose_gap_and_singular_value():
    arm = four_bar(*TRIPLE_ROCKER)
    low, high = crank_range(*TRIPLE_ROCKER)
    inside = np.linspace(low + 0.01, high - 0.01, 50)
    close_loops(arm, inside[:, None])
    beyond = high + np.radians(5)
    with pytest.raises(LoopError) as caught:
        close_loops(arm, np.append(inside, beyond)[:, None])
    text = str(caught.value)
    # the linkage is stretched: what is missing is the diagonal minus coupler and rocker
    missing = abs(1.0 - 0.8 * np.exp(1j * beyond)) - 1.1
    assert f"crank_joint = {np.degrees(beyond):.4g} deg" in text
    assert float(text.split("the gap is ")[1].split(" mm", maxsplit=1)[0]) == pytest.approx(missing * 1e3, rel=1e-2)
    assert "singular value" in text
    assert "branch" in text
    near = float(text.split("ends near crank_joint = ")[1].split(" deg", maxsplit=1)[0])
    assert near == pytest.approx(np.degrees(high), abs=0.1)


def test_pose_within_the_margin_is_refused_and_a_lower_margin_lets_it_pass():
    from dataclasses import replace

    arm = four_bar(*TRIPLE_ROCKER)
    theta = np.array([[crank_range(*TRIPLE_ROCKER)[1] - 1e-8]])
    with pytest.raises(LoopError, match="singular value"):
        close_loops(arm, theta)
    q, _ = close_loops(replace(arm, singularity=1e-7), theta)
    gap, singular = loop_report(arm, q)
    assert gap[0] < 1e-11
    assert 1e-7 < singular[0] < 1e-3


@pytest.mark.parametrize("theta", [[0.5, -0.5], [-0.5], [0.0]])
def test_change_point_is_not_passed(theta):
    arm = four_bar(1.0, 0.5, 1.0, 0.5)
    with pytest.raises(LoopError, match="singular value") as caught:
        close_loops(arm, np.array(theta)[:, None])
    assert "reduce the range of crank_joint" in str(caught.value)
    q, _ = close_loops(arm, np.linspace(0.05, 3.0, 40)[:, None])
    assert q[:, 2] == pytest.approx(q[:, 0], abs=1e-13)


COUPLERS = """
<mujoco><worldbody>
<body name="a"><joint name="j1" axis="0 -1 0"/><geom size=".02" mass="1" pos=".2 0 0"/>
  <body name="bar" pos=".4 0 0"><joint name="jb" axis="0 -1 0"/><geom size=".02" mass="1"/></body></body>
<body name="b" pos="0 0 .2"><joint name="j2" axis="0 -1 0"/><geom size=".02" mass="1" pos=".2 0 0"/></body>
<body name="c" pos="0 0 .5"><joint name="j3" axis="0 -1 0"/><geom size=".02" mass="1" pos=".2 0 0"/></body>
</worldbody><equality>
<connect body1="b" body2="bar" anchor=".4 0 0"/><connect body1="c" body2="bar" anchor=".4 0 0"/>
</equality></mujoco>"""


def test_redundant_couplers_close():
    arm = loaded(COUPLERS, ("j1",))
    q, D = close_loops(arm, np.linspace(-1.3, 1.3, 77)[:, None])
    assert q == pytest.approx(q[:, :1] * np.array([1.0, -1.0, 1.0, 1.0]), abs=1e-13)
    assert D[:, :, 0] == pytest.approx(np.tile([1.0, -1.0, 1.0, 1.0], (77, 1)), abs=1e-12)


def test_driven_joints_that_do_not_determine_or_contradict():
    with pytest.raises(InputError, match=r"do not determine(.|\n)*drive 1 more of"):
        close_loops(loaded(FIVE_BAR, ("left",), (2.3, -1.2, 0.8, 1.2)), np.array([[2.3]]))
    arm = four_bar(*GRASHOF)
    both = Mechanism(arm.spec, arm.model, ("crank_joint", "rocker_joint"), arm.reference, "both")
    with pytest.raises(InputError, match=r"contradict(.|\n)*drive 1 fewer of crank_joint, rocker_joint"):
        close_loops(both, np.array([[1.0, 2.0]]))
    far = loaded(FIVE_BAR.replace('pos=".5 0 0"', 'pos="2.5 0 0"'), ("left", "right"))
    with pytest.raises(LoopError, match="do not close at the reference"):
        close_loops(far, np.array([[2.3, 0.8]]))
    with pytest.raises(InputError, match="position of crank_joint in pose 2 is nan"):
        close_loops(four_bar(*GRASHOF), np.array([[1.0], [np.nan]]))
    with pytest.raises(InputError, match="2 driven joints are needed"):
        close_loops(five_bar(), np.array([[1.0]]))


SPATIAL = """
<mujoco><worldbody>
<body name="carrier" pos="0 0 .3"><joint name="yaw" axis="0 0 1"/><geom size=".05" mass="1"/>
<body name="crank"><joint name="crank" axis="1 0 0"/><geom size=".02" mass="1" pos="0 0 .1"/>
  <body name="rod" pos="0 0 .2"><joint name="ball" type="ball"/><geom size=".02" mass="1" pos=".3 .1 0"/></body></body>
<body name="rocker" pos=".5 .3 0"><joint name="rocker" axis="0 1 0"/><geom size=".02" mass="1" pos="0 0 .3"/>
  <body name="knuckle" pos="0 0 .4"><joint name="k1" axis="0 1 0"/><joint name="k2" axis="1 0 0"/>
    <geom size=".02" mass="1"/></body></body>
</body>
<body name="gear" pos="0 1 0"><joint name="mimic" axis="0 1 0"/><geom size=".02" mass="1" pos=".1 0 0"/></body>
<body name="loose" pos="0 2 0"><freejoint name="free"/><geom size=".02" mass="1"/></body>
<body name="idle" pos="0 3 0"><joint name="idle"/><geom size=".02" mass="1" pos=".1 0 0"/></body>
</worldbody><equality>
<weld body1="rod" body2="knuckle"/><joint joint1="mimic" joint2="yaw" polycoef="0 -2 0.5"/>
<weld body1="loose" body2="gear"/>
</equality></mujoco>"""


def test_ball_and_free_joints_on_a_carrier():
    """An RSUR loop (the rod's ball, a universal knuckle welded to the rod) on a driven carrier."""
    arm = loaded(SPATIAL, ("yaw", "crank"))
    rng = np.random.default_rng(3)
    driven = rng.uniform((-3.0, -0.7), (3.0, 0.15), (200, 2))
    q, D = close_loops(arm, driven)
    gap, _ = loop_report(arm, q)
    assert gap.max() < 1e-13
    model = arm.model
    idle = model.joint("idle")
    assert (q[:, idle.qposadr] == 0.0).all()
    assert (D[:, idle.dofadr] == 0.0).all()
    assert q[:, model.joint("mimic").qposadr[0]] == pytest.approx(
        -2 * driven[:, 0] + 0.5 * driven[:, 0] ** 2, abs=1e-13
    )
    # D against differences on the manifold
    h = 1e-5
    for joint in range(2):
        shift = h * np.eye(2)[joint]
        ahead, back = close_loops(arm, driven[:20] + shift)[0], close_loops(arm, driven[:20] - shift)[0]
        for row in range(20):
            speed = np.zeros(model.nv)
            mujoco.mj_differentiatePos(model, speed, 2 * h, back[row], ahead[row])
            assert speed == pytest.approx(D[row, :, joint], rel=1e-6, abs=1e-7)


def test_relays_of_a_motion_with_ball_and_free_joints():
    """1,000 instants closed by relays are those closed one by one, quaternions of length one included."""
    arm = loaded(SPATIAL, ("yaw", "crank"))
    drivers = {"yaw": "2*sin(2*pi*t/T)", "crank": "-0.3 + 0.3*cos(2*pi*t/T)"}
    many = Sweep.motion(arm, drivers, duration=1.0, samples=1000)
    some = np.array([3, 444, 700, 999])
    together, alone = arm.states(many), arm.states(many.at(many.coordinates[some]))
    assert loop_report(arm, together.kin.q)[0].max() < 1e-13
    assert together.kin.q[some] == pytest.approx(alone.kin.q, abs=1e-12)
    assert together.moving.acceleration[some] == pytest.approx(alone.moving.acceleration, rel=1e-9, abs=1e-9)


CABLED = """
<mujoco><worldbody><site name="o" pos="-.1 .1 .4"/><site name="p" pos=".2 .3 .5"/>
<body name="a"><joint name="drive" axis="0 1 0"/><geom size=".02" mass="1" pos=".2 0 0"/>
<site name="s" pos=".3 0 .02"/></body>
<body name="b" pos=".7 0 0"><joint name="b1" axis="0 1 0"/><joint name="b2" axis="1 0 0"/>
<geom size=".02" mass="1" pos="0 0 .2"/><site name="t" pos="0 .05 .3"/><site name="u" pos=".05 0 .2"/></body>
<body name="c" pos="0 1 0"><joint name="c"/><geom size=".02" mass="1" pos=".1 0 0"/>
<site name="v" pos=".2 .1 0"/></body>
</worldbody><tendon><spatial name="x"><site site="s"/><site site="t"/></spatial>
<spatial name="y"><site site="o"/><site site="s"/><pulley divisor="2"/><site site="p"/><site site="u"/></spatial>
<spatial name="z"><site site="s"/><site site="u"/></spatial>
<spatial name="w"><site site="p"/><site site="v"/></spatial>
</tendon><equality><tendon tendon1="x" polycoef="0"/><tendon tendon1="y" polycoef="0"/>
<tendon tendon1="w" tendon2="z" polycoef="0 .5 .8"/></equality></mujoco>"""


def test_cables_that_close_loops_have_accelerations():
    """Cables of constant length, over a pulley, and coupled by a law: as velocities change from instant to instant."""
    arm = loaded(CABLED, ("drive",))
    sweep = Sweep.motion(arm, {"drive": "0.05*sin(2*pi*t/T)"}, duration=1.0, samples=3)
    h, time = 1e-4, np.linspace(0.05, 0.95, 13)
    found = arm.states(sweep.at(time[:, None])).moving.acceleration
    ahead, behind = (arm.states(sweep.at((time + step)[:, None])).moving.velocity for step in (h, -h))
    far, near = (arm.states(sweep.at((time + 2 * step)[:, None])).moving.velocity for step in (h, -h))
    slope = (8 * (ahead - behind) - (far - near)) / (12 * h)
    assert np.abs(found[:, 1:]).max() > 1.0
    assert found == pytest.approx(slope, rel=1e-7, abs=1e-7)


COUPLED = """
<mujoco><compiler angle="radian"/><worldbody>
<body name="a"><joint name="drive"/><geom size=".02"/>
  <body name="b" pos=".1 0 0"><joint name="gear" ref=".1"/><geom size=".02"/>
    <body name="c" pos=".1 0 0"><joint name="rack" type="slide"/><geom size=".02"/>
      <body name="d" pos=".1 0 0"><joint name="wrist"/><geom size=".02"/></body></body></body></body>
</worldbody><equality>
<joint joint1="gear" joint2="drive" polycoef=".2 -30"/><joint joint1="rack" joint2="gear" polycoef="0 .01 .001"/>
</equality></mujoco>"""


def test_joints_coupled_by_a_law_need_no_walk():
    arm = loaded(COUPLED, ("wrist", "drive"))
    driven = np.random.default_rng(0).uniform(-3, 3, (500, 2))
    q, D = close_loops(arm, driven)
    turn = 0.2 - 30 * driven[:, 1]
    assert q[:, 1] == pytest.approx(0.1 + turn, abs=1e-12)
    assert q[:, 2] == pytest.approx(0.01 * turn + 0.001 * turn**2, abs=1e-12)
    assert D[:, 1] == pytest.approx(np.tile([0.0, -30.0], (500, 1)), abs=1e-12)
    assert D[:, 2, 1] == pytest.approx(-30 * (0.01 + 0.002 * turn), abs=1e-12)


def test_without_loops_the_transmission_is_a_selection():
    arm = loaded(SPATIAL.split("<equality>", maxsplit=1)[0] + "</mujoco>", ("crank", "yaw"))
    q, D = close_loops(arm, np.array([[0.1, 0.2], [0.3, 0.4]]))
    assert D.shape == (1, arm.model.nv, 2)
    assert D.sum() == 2.0
    assert q[:, arm.model.joint("yaw").qposadr[0]] == pytest.approx([0.2, 0.4])
    gap, singular = loop_report(arm, q)
    assert (gap == 0).all()
    assert np.isinf(singular).all()


def test_ten_thousand_samples_are_quick():
    arm = four_bar(*GRASHOF)
    theta = np.linspace(-np.pi, np.pi, 10_000)[:, None]
    close_loops(arm, theta[:3])
    times = []
    for _ in range(3):
        begin = time.perf_counter()
        close_loops(arm, theta)
        times.append(time.perf_counter() - begin)
    assert min(times) < 2.0
