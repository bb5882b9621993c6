"""The five-bar and the delta robot against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import equipoise as eq
from equipoise.assemble import effort
from equipoise.kinematics import kinematics
from equipoise.loops import close_loops

RNG = np.random.default_rng(3)


def five(**options):
    return eq.five_bar(
        0.2,
        (0.15, 0.17),
        (0.25, 0.23),
        crank_masses=(0.4, 0.5),
        crank_coms=((0.06, 0.01), (0.07, -0.01)),
        coupler_masses=(0.25, 0.2),
        coupler_coms=((0.12, 0.02), (0.1, -0.015)),
        coupler_inertias=(0.002, 0.0015),
        **options,
    )


def robot(**options):
    given = {"arm_mass": 0.6, "arm_com": (0.1, 0.01, 0.02), "arm_inertia": 0.004, "forearm_mass": 0.2}
    given |= {"forearm_com": (0.22, 0.0, 0.01), "platform_mass": 0.5, "platform_com": (0.01, 0.02, -0.03)}
    return eq.delta(0.2, 0.25, 0.5, 0.05, **(given | options))


def test_the_pin_of_a_five_bar_is_where_two_circles_meet():
    arm = five()
    home = arm.reference[arm.model.jnt_qposadr[arm.driven_ids]]
    driven = home + RNG.uniform(-0.4, 0.4, (50, 2))
    q, _ = close_loops(arm, driven)
    pin = kinematics(arm, q)
    end = pin.xpos[:, arm.body_id("coupler_1")] + pin.xmat[:, arm.body_id("coupler_1")] @ [0.25, 0, 0]
    first = 0.15 * np.stack([np.cos(driven[:, 0]), np.sin(driven[:, 0])], axis=1)
    second = [0.2, 0.0] + 0.17 * np.stack([np.cos(driven[:, 1]), np.sin(driven[:, 1])], axis=1)
    apart = second - first
    d = np.linalg.norm(apart, axis=1)
    along = (d**2 + 0.25**2 - 0.23**2) / (2 * d)
    up = np.sqrt(0.25**2 - along**2)
    expected = (
        first + (along[:, None] * apart + up[:, None] * np.stack([-apart[:, 1], apart[:, 0]], axis=1)) / d[:, None]
    )
    np.testing.assert_allclose(end[:, [0, 2]], expected, atol=1e-12)


def test_the_default_pose_of_a_five_bar_stretches_both_legs_alike():
    arm = five()
    q, _ = close_loops(arm, arm.reference[arm.model.jnt_qposadr[arm.driven_ids]][None])
    kin = kinematics(arm, q)
    end = (kin.xpos[0, arm.body_id("coupler_1")] + kin.xmat[0, arm.body_id("coupler_1")] @ [0.25, 0, 0])[[0, 2]]
    assert np.linalg.norm(end) == pytest.approx(0.75 * 0.4, abs=1e-12)
    assert np.linalg.norm(end - [0.2, 0]) == pytest.approx(0.75 * 0.4, abs=1e-12)


def test_every_forearm_of_a_delta_keeps_its_length():
    arm = robot()
    driven = RNG.uniform(-0.6, 0.5, (60, 3))
    q, _ = close_loops(arm, driven)
    place = q[:, [arm.model.joint(f"platform_{x}").qposadr[0] for x in "xyz"]]
    for i, azimuth in enumerate((0.0, 2 * np.pi / 3, 4 * np.pi / 3)):
        out = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        knee = (0.2 + 0.25 * np.cos(driven[:, i, None])) * out + 0.25 * np.sin(driven[:, i, None]) * [0, 0, 1]
        np.testing.assert_allclose(np.linalg.norm(place + 0.05 * out - knee, axis=1), 0.5, atol=1e-13)
    assert (place[:, 2] < 0).all()


def test_a_delta_holds_its_weight_as_virtual_work_says():
    """Two rods at their middles and a platform: heights of all centres, differenced over the arms."""
    arm = robot(arm_com=(0.1, 0.0, 0.02), forearm_com=None, platform_com=(0, 0, 0))
    place = RNG.uniform(-0.4, 0.3, (1, 3))

    def energy(driven):
        q, _ = close_loops(arm, driven[None])
        z = q[0, arm.model.joint("platform_z").qposadr[0]]
        knees = 0.25 * np.sin(driven)
        upper = 0.6 * (0.1 * np.sin(driven) + 0.02 * np.cos(driven))
        return 9.81 * (0.5 * z + upper.sum() + 0.2 * 0.5 * (knees + z).sum())

    held = effort(arm, (), arm.states(eq.Sweep.of_poses(arm, [dict(zip(arm.driven, place[0], strict=True))]))).b[0]
    step = 1e-6 * np.eye(3)
    slope = [(energy(place[0] + h) - energy(place[0] - h)) / 2e-6 for h in step]
    np.testing.assert_allclose(held, slope, rtol=1e-7)


def test_the_energy_of_a_moving_delta_is_what_its_motors_supply():
    arm = robot(gravity=(0, 0, 0))
    drivers = {f"arm_{i}_joint": f"{0.1 * i} + 0.3*sin(2*pi*t/T + {i})" for i in (1, 2, 3)}
    sweep = eq.Sweep.motion(arm, drivers, duration=0.4, samples=401)
    found = eq.machine(arm, sweep)
    states = arm.states(sweep)
    power = (effort(arm, (), states, "drive").b * states.rates.driven_velocity).sum(axis=1)
    momentum = effort(arm, (), states.momenta, "drive").b
    kinetic = 0.5 * (momentum * states.rates.driven_velocity).sum(axis=1)
    from scipy.interpolate import make_interp_spline

    slope = make_interp_spline(sweep.instants.time, kinetic, k=5)(sweep.instants.time, 1)
    np.testing.assert_allclose(slope[10:-10], power[10:-10], atol=1e-6 * np.abs(power).max())
    assert abs(found.supply.net) < 1e-6 * found.supply.positive
    base = [bearing for bearing in found.bearings if bearing.on_base]
    assert [bearing.name for bearing in base] == ["arm_1_joint", "arm_2_joint", "arm_3_joint"]
    assert not any(bearing.indeterminate for bearing in found.bearings)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: five(pose=(0.1, 0.6)), "leg 1 does not reach its pin: the distance is 0.608"),
        (lambda: eq.five_bar(1.0, (0.1, 0.1), (0.2, 0.2)), "the legs do not meet above the base"),
        (lambda: five(elbows=("left", "up")), "elbows is 'up', it must be left or right"),
        (lambda: robot(pose=(0, 0, -0.9)), "leg 1 does not reach its pin"),
        (lambda: robot(pose=(0, 0.6, -0.1)), "leg 1 does not reach its pin: it lies 0.6 m aside"),
        (lambda: eq.delta(0.5, 0.3, 0.4, 0.05), "with horizontal arms the forearm"),
        (lambda: robot(platform_mass=-1), "platform_mass is -1 kg"),
        (lambda: robot(arm_mass=-0.1), "mass is -0.1 kg"),
    ],
)
def test_what_cannot_be_built_is_refused(make, words):
    with pytest.raises(eq.InputError, match=words):
        make()


def test_both_are_reached_from_a_problem_file(tmp_path):
    file = tmp_path / "p.yaml"
    file.write_text("mechanism: {five_bar: {ground: 20 cm, cranks: [15 cm, 15 cm], couplers: [0.25, 0.25]}}\n")
    assert eq.load_problem(file).mechanism.driven == ("crank_1_joint", "crank_2_joint")
    file.write_text(
        "mechanism: {delta: {base_radius: 20 cm, arm: 0.25, forearm: 0.5, platform_radius: 5 cm, "
        "pose: [0, 10 mm, -40 cm], arm_com: [10 cm, 0, 1 cm], arm_mass: 500 g}}\n"
    )
    mechanism = eq.load_problem(file).mechanism
    assert mechanism.driven == ("arm_1_joint", "arm_2_joint", "arm_3_joint")
    assert mechanism.reference[-3:] == pytest.approx([0, 0.01, -0.4])
