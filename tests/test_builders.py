"""The parametric builders against hand-written mechanics and Pinocchio."""

from __future__ import annotations

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from equipoise.errors import InputError
from equipoise.kinematics import kinematics
from equipoise.loops import close_loops
from equipoise.models.chain import Link, chain
from equipoise.models.four_bar import crank_range, four_bar
from equipoise.models.human_leg import human_leg
from equipoise.models.parallelogram_arm import parallelogram_arm
from equipoise.models.parallelogram_robot import parallelogram_robot
from equipoise.models.slider_crank import slider_crank

G = 9.81
RNG = np.random.default_rng(7)


def hold(arm, driven):
    """Holding torque (N, nd), energy (N,) and kinematics."""
    q, D = close_loops(arm, driven)
    kin = kinematics(arm, q)
    return np.squeeze(kin.bias[:, None] @ D, axis=1), kin.energy, kin


def two_links(datum):
    links = [
        Link("upper", 0.4, 2.0, com=(0.25, 0.03), limits=(-2.0, 2.0), motor_limit=40.0),
        Link("fore", 0.3, 1.5, com=0.1),
    ]
    return chain(links, datum=datum)


def test_two_link_arm_counted_from_the_right():
    arm = two_links("right")
    q = RNG.uniform(-3, 3, (50, 2))
    torque, energy, kin = hold(arm, q)
    first, both = q[:, 0], q[:, 0] + q[:, 1]
    fore = 1.5 * G * 0.1 * np.cos(both)
    upper = 2.0 * G * (0.25 * np.cos(first) - 0.03 * np.sin(first)) + 1.5 * G * 0.4 * np.cos(first)
    assert torque[:, 1] == pytest.approx(fore, abs=1e-10)
    assert torque[:, 0] == pytest.approx(upper + fore, abs=1e-10)
    height = 2.0 * (0.25 * np.sin(first) + 0.03 * np.cos(first)) + 1.5 * (0.4 * np.sin(first) + 0.1 * np.sin(both))
    assert energy == pytest.approx(G * height, abs=1e-10)
    elbow = kin.xpos[:, arm.body_id("fore")]
    assert elbow == pytest.approx(0.4 * np.stack([np.cos(first), 0 * first, np.sin(first)], axis=1), abs=1e-15)
    assert arm.motor_limits == pytest.approx([40.0, np.inf])
    assert arm.box == pytest.approx(np.array([[-2.0, 2.0], [-np.pi, np.pi]]))
    assert arm.driven == ("upper_joint", "fore_joint")


def test_two_link_arm_counted_from_above():
    arm = two_links("up")
    q = RNG.uniform(-3, 3, (50, 2))
    torque, _, kin = hold(arm, q)
    first, both = q[:, 0], q[:, 0] + q[:, 1]
    fore = -1.5 * G * 0.1 * np.sin(both)
    # z of the link is counter-clockwise from x: pointing up, it points to -x
    upper = -2.0 * G * (0.25 * np.sin(first) - 0.03 * np.cos(first)) - 1.5 * G * 0.4 * np.sin(first)
    assert torque[:, 1] == pytest.approx(fore, abs=1e-10)
    assert torque[:, 0] == pytest.approx(upper + fore, abs=1e-10)
    elbow = kin.xpos[:, arm.body_id("fore")]
    assert elbow == pytest.approx(0.4 * np.stack([np.sin(first), 0 * first, np.cos(first)], axis=1), abs=1e-15)
    axes = kin.xmat[:, arm.body_id("upper")]
    assert axes[:, :, 2] == pytest.approx(np.stack([-np.cos(first), 0 * first, np.sin(first)], axis=1), abs=1e-15)


def test_sliding_link_and_massless_links():
    links = [Link("swing", 0.2), Link("boom", 0.5, 3.0, joint="slide", at=0.1, stroke=(0.0, 0.3), motor_force=80.0)]
    arm = chain(links, base=(1.0, 0.0, 2.0))
    q = np.stack([RNG.uniform(-3, 3, 30), RNG.uniform(0, 0.3, 30)], axis=1)
    torque, energy, _ = hold(arm, q)
    out = 0.1 + q[:, 1] + 0.25
    assert torque[:, 0] == pytest.approx(3.0 * G * out * np.cos(q[:, 0]), abs=1e-10)
    assert torque[:, 1] == pytest.approx(3.0 * G * np.sin(q[:, 0]), abs=1e-10)
    assert energy == pytest.approx(3.0 * G * (2.0 + out * np.sin(q[:, 0])), abs=1e-10)
    assert arm.driven_units == ("N m", "N")
    assert arm.box[1] == pytest.approx([0.0, 0.3])
    assert arm.motor_limits == pytest.approx([np.inf, 80.0])


SPATIAL_LINKS = (
    Link("waist", 0.1, 4.0, com=(0.0, 0.02, 0.1), axis=(0, 0, 1), inertia=(0.02, 0.03, 0.025)),
    Link("upper", 0.4, 3.0, at=(0.05, 0.1, 0.3), com=(0.2, 0.01, 0.0)),
    Link("fore", 0.35, 2.0, axis=(1, 2, 2), inertia=0.01),
    Link("quill", 0.2, 1.0, joint="slide", axis=(0, 0, 1)),
)


def pinocchio_chain(links):
    model = pin.Model()
    parent, place = 0, np.zeros(3)
    for link in links:
        place = place if link.at is None else np.array(link.at, dtype=float)
        axis = np.array(link.axis or (0, -1, 0), dtype=float)
        axis /= np.linalg.norm(axis)
        kind = pin.JointModelPrismaticUnaligned if link.joint == "slide" else pin.JointModelRevoluteUnaligned
        parent = model.addJoint(parent, kind(axis), pin.SE3(np.eye(3), place), link.name)
        about = link.mass * link.length**2 / 12 if link.inertia is None else link.inertia
        about = np.array(about if np.ndim(about) else (1e-6 * about, about, about))
        com = np.array(link.com or (link.length / 2, 0.0, 0.0))
        model.appendBodyToJoint(parent, pin.Inertia(link.mass, com, np.diag(about)), pin.SE3.Identity())
        place = np.array([link.length, 0.0, 0.0])
    return model


def test_spatial_chain_agrees_with_pinocchio():
    arm, model = chain(SPATIAL_LINKS), pinocchio_chain(SPATIAL_LINKS)
    data, mine = model.createData(), mujoco.MjData(arm.model)
    for q in RNG.uniform(-2, 2, (20, 4)):
        torque, energy, kin = hold(arm, q[None])
        assert torque[0] == pytest.approx(pin.computeGeneralizedGravity(model, data, q), abs=1e-11)
        assert energy[0] == pytest.approx(pin.computePotentialEnergy(model, data, q), abs=1e-11)
        pin.forwardKinematics(model, data, q)
        for index in range(1, 5):
            assert kin.xpos[0, index] == pytest.approx(data.oMi[index].translation, abs=1e-14)
            assert kin.xmat[0, index] == pytest.approx(data.oMi[index].rotation, abs=1e-14)
        mine.qpos[:] = q
        mujoco.mj_forward(arm.model, mine)
        M = np.zeros((4, 4))
        mujoco.mj_fullM(arm.model, mine, M)
        upper = np.triu(pin.crba(model, data, q))
        assert np.triu(M) == pytest.approx(upper, abs=1e-12)


def test_gravity_is_configurable():
    flat = chain([Link("arm", 1.0, 2.0)], gravity=(0, 0, 0))
    assert hold(flat, np.array([[0.3]]))[0] == pytest.approx(0.0, abs=1e-15)
    tilted = chain([Link("arm", 1.0, 2.0)], gravity=(-G, 0, 0))
    assert hold(tilted, np.array([[0.3]]))[0] == pytest.approx(-2.0 * G * 0.5 * np.sin(0.3))


@pytest.mark.parametrize("post", [(0.0, 0.1), (0.03, 0.12)])
def test_parallelogram_head_stays_parallel(post):
    arm = parallelogram_arm(0.5, post, payload=(0.2, 0.05), masses=(1.0, 0.5, 2.0), coms=(None, None, (0.1, 0.04)))
    theta = np.linspace(*arm.box[0], 201)
    torque, energy, kin = hold(arm, theta[:, None])
    head = arm.body_id("head")
    assert kin.xmat[:, head] == pytest.approx(np.tile(np.eye(3), (201, 1, 1)), abs=1e-12)
    reach = 0.5 * np.stack([np.cos(theta), 0 * theta, np.sin(theta)], axis=1)
    assert kin.xpos[:, head] == pytest.approx(reach, abs=1e-14)
    assert kin.xpos[:, arm.body_id("payload")] == pytest.approx(reach + np.array([0.2, 0.0, 0.05]), abs=1e-12)
    assert torque[:, 0] == pytest.approx(G * (0.5 * 1.5 + 2.0) * 0.5 * np.cos(theta), abs=1e-10)
    height = (0.5 * 1.5 + 2.0) * 0.5 * np.sin(theta) + 0.5 * post[1] + 2.0 * 0.04
    assert energy == pytest.approx(G * height, abs=1e-10)


@pytest.mark.parametrize("crank", [-0.4, 0.25])
def test_the_torques_of_a_parallelogram_robot_do_not_mix(crank):
    """S1 g cos t1 and S2 g cos t2, with crank and rod of any mass; a crank behind is a partial counterweight."""
    box = np.radians([(-90, 90), (-252, 72)])
    masses, coms = (100.0, 40.0, 3.0, 6.0), ((0.6, 0.0), (0.5, 0.0), None, (0.7, 0.0))
    arm = parallelogram_robot(1.2, 1.0, crank, masses=masses, coms=coms, limits=box)
    t1, elbow = RNG.uniform(*box[0], 200), np.radians(RNG.uniform(18, 162, 200))
    t2 = t1 + elbow - np.pi
    torque, _, kin = hold(arm, np.stack([t1, t2], axis=1))
    S1, S2 = 100 * 0.6 + 40 * 1.2 + 6 * 0.7, 40 * 0.5 + 3 * crank / 2 + 6 * crank
    assert torque == pytest.approx(G * np.stack([S1 * np.cos(t1), S2 * np.cos(t2)], axis=1), abs=1e-9)
    along = np.stack([np.cos(t2), 0 * t2, np.sin(t2)], axis=1)
    assert kin.xmat[:, arm.body_id("forearm"), :, 0] == pytest.approx(along, abs=1e-12)
    assert arm.driven == ("arm_joint", "crank_joint")


def test_four_bar_energy_with_a_coupler_off_the_line():
    arm = four_bar(1.0, 0.3, 0.9, 0.8, masses=(1, 2, 3), coms=(None, (0.4, 0.25), (0.5, -0.1)), inertias=(0, 0.1, None))
    q, _ = close_loops(arm, np.linspace(-2, 2, 30)[:, None])
    kin = kinematics(arm, q)
    coupler, rocker = q[:, 0] + q[:, 1], q[:, 2]
    height = 0.15 * np.sin(q[:, 0])
    height += 2 * (0.3 * np.sin(q[:, 0]) + 0.4 * np.sin(coupler) + 0.25 * np.cos(coupler))
    height += 3 * (0.5 * np.sin(rocker) - 0.1 * np.cos(rocker))
    assert kin.energy == pytest.approx(G * height, abs=1e-11)
    inertia = arm.model.body("coupler").inertia
    assert sorted(inertia)[1:] == pytest.approx([0.1, 0.1])


def test_reference_is_a_keyframe_that_names_the_branch():
    for branch in ("open", "crossed"):
        arm = four_bar(1.0, 0.3, 0.9, 0.8, branch=branch)
        assert arm.model.key(branch).qpos == pytest.approx(arm.reference)
    assert four_bar(1.0, 0.3, 0.9, 0.8).reference[2] != four_bar(1.0, 0.3, 0.9, 0.8, branch="crossed").reference[2]


def test_saved_model_is_the_same(tmp_path):
    arm = slider_crank(0.2, 0.5, offset=0.03, direction=0.4, masses=(1, 2, 3))
    file = tmp_path / "arm.xml"
    file.write_text(arm.spec.to_xml())
    again = arm.with_model(mujoco.MjSpec.from_file(str(file)))
    q, _ = close_loops(arm, np.array([[0.3], [1.0]]))
    assert kinematics(again, q).energy == pytest.approx(kinematics(arm, q).energy, abs=1e-9)


def test_crank_range_ends_where_the_linkage_is_flat():
    low, high = crank_range(1.0, 0.8, 0.4, 0.7)
    assert abs(1 - 0.8 * np.exp(1j * high)) == pytest.approx(1.1)
    assert abs(1 - 0.8 * np.exp(1j * low)) == pytest.approx(0.3)
    assert crank_range(1.0, 0.3, 0.9, 0.8) == pytest.approx((0.0, np.pi))


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: four_bar(3.0, 1.0, 0.9, 0.8), r"ground \(3 m\) must be shorter.*2.7 m\); it is 0.3 m too long"),
        (lambda: four_bar(1.0, 0.0, 0.9, 0.8), "crank is 0 m, it must be above 0"),
        (lambda: four_bar(1.0, 0.3, 0.9, float("nan")), "rocker is nan, a finite number"),
        (lambda: four_bar(1.0, 0.3, 0.9, 0.8, masses=(1, -2, 0)), "coupler: mass is -2 kg, it must be at least 0"),
        (lambda: four_bar(1.0, 0.3, 0.9, 0.8, branch="up"), "branch is 'up', it must be open or crossed"),
        (lambda: slider_crank(0.2, 0.3, offset=0.6), r"\|offset\| \(0.6 m\) must be less than.*0.1 m too large"),
        (lambda: parallelogram_arm(-1.0), "length is -1 m"),
        (lambda: parallelogram_arm(1.0, (0.0, 0.0)), "distance of the pivots is 0 m"),
        (lambda: parallelogram_robot(1.2, 1.0, 0.0), "length of the crank is 0 m"),
        (
            lambda: parallelogram_robot(1, 1, 0.2, limits=((-1, 1), (-1, 1))),
            "at 0 and 0 deg: the parallelogram is flat",
        ),
        (lambda: chain([]), "links is empty"),
        (lambda: chain([Link("a", 1.0), Link("a", 1.0)]), "link name 'a' is empty, reserved or used twice"),
        (lambda: chain([Link("a", 1.0, mass=float("inf"))]), r"chain\.a: mass is inf, a finite number"),
        (lambda: chain([Link("a", 1.0, stroke=(0, 1))]), r"stroke does not belong to a hinge(.|\n)*use limits"),
        (lambda: chain([Link("a", 1.0, inertia=(1, 1, 3))]), "belongs to no body"),
        (lambda: chain([Link("a", 1.0, axis=(0, 0, 0))]), "length of axis is 0"),
        (lambda: chain([Link("a", 1.0, limits=(1, -1))]), "limits runs from 1 to -1"),
        (lambda: chain([Link("a", 1.0, com=(1, 2, 3, 4))]), "com is .* 3 numbers are needed"),
        (lambda: chain([Link("a", 1.0)], datum="left"), "datum is 'left', it must be right or up"),
        (lambda: chain([Link("a", 1.0)], gravity=(0, -9.81)), "gravity is .* 3 numbers are needed"),
        (lambda: chain([Link("a", 1.0, motor_limit=0)]), "motor_limit is 0 N m, it must be above 0"),
    ],
)
def test_nonsense_is_refused_with_field_value_and_what_is_allowed(build, words):
    with pytest.raises(InputError, match=words):
        build()


@pytest.mark.parametrize("table", ["winter", "de_leva_male"])
@pytest.mark.parametrize(("mass", "height"), [(55.0, 1.6), (75.0, 1.75), (110.0, 1.95)])
def test_a_leg_by_body_mass_and_stature(table, mass, height):
    shares = {
        "winter": (0.1, 0.245, 0.433, 0.061, 0.606 * 0.246),
        "de_leva_male": (0.1416, 0.2425, 0.4095, 0.057, (0.0433 * 0.4459 * 0.2493 + 0.0137 * 0.2688) / 0.057),
    }
    a, l1, c1, b, c2 = shares[table]
    leg = human_leg(mass, height, table)
    q = RNG.uniform((-2, -2), (-0.6, 0), (30, 2))
    torque, _, _ = hold(leg, q)
    both = q.sum(axis=1)
    knee = b * mass * G * c2 * height * np.cos(both)
    thigh = (a * c1 + b) * l1 * mass * height * G * np.cos(q[:, 0])
    assert torque == pytest.approx(np.stack([thigh + knee, knee], axis=1), abs=1e-9)
    assert leg.mass == pytest.approx((a + b) * mass, rel=1e-9)


def test_winters_foot_and_leg_are_the_sum_of_foot_and_leg():
    """0.0465 at 0.433 and 0.0145 under the ankle make 0.061 at 0.606: the foot's centre lies 0.04 H below the ankle."""
    below = (0.061 * 0.606 - 0.0465 * 0.433) / 0.0145 - 1
    assert 0.246 * below == pytest.approx(0.039, abs=0.001)


def test_a_leg_refuses_what_is_no_person():
    for wrong in ((0.0, 1.7), (70.0, -1.0), (float("nan"), 1.7)):
        with pytest.raises(InputError):
            human_leg(*wrong)
    with pytest.raises(InputError, match="table"):
        human_leg(70.0, 1.7, "gray")
