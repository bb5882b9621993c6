"""Motion along a path that leaves nothing at the base: orientations known independently, and why there is none."""

from __future__ import annotations

import numpy as np
import pytest

import equipoise as eq
from equipoise.assemble import effort
from equipoise.problem import problem_of
from equipoise.yamlfile import Document
from test_rrr3 import EXACT_ROD, START, manipulator

RISE = "(10*(t/T)**3 - 15*(t/T)**4 + 6*(t/T)**5)"


def balanced(platform=0.015, rod=EXACT_ROD):
    return manipulator(7.2, -0.09, 0.02, rod=rod, platform_inertia=platform)


def path(x, z, detour=0.0):
    return {
        "platform_x": f"{START[0]!r} + ({x - START[0]!r})*{RISE} + {detour!r}*sin(pi*t/T)**3",
        "platform_z": f"{START[1]!r} + ({z - START[1]!r})*{RISE}",
    }


def turn(mechanism, sweep):
    return mechanism.states(sweep).kin.q[:, mechanism.joint_id("platform_turn")]


@pytest.mark.parametrize(
    ("platform", "place", "orientation"),
    [
        (0.01, (0.0906779, 0.1180252), 0.2454225),
        (0.015, (0.0906779, 0.1180252), 0.2502537),
        (0.015, (0.20, 0.08), 0.0813590),
        (0.015, (0.23, 0.10), 0.1412984),
        (0.015, (0.20, 0.03), -0.1347347),
    ],
)
def test_orientation_that_keeps_momentum_zero(platform, place, orientation):
    mechanism = balanced(platform)
    found = eq.reactionless_motion(mechanism, path(*place), duration=0.3)
    sweep = found.sweep(201)
    assert turn(mechanism, sweep)[-1] == pytest.approx(orientation, abs=6e-8)
    states = mechanism.states(sweep)
    for goal, scale in (("force", 70.0), ("moment", 10.0)):
        assert np.abs(effort(mechanism, (), states, goal).b).max() < 1e-9 * scale
    assert found.holonomic


def test_the_way_does_not_matter_where_momentum_is_a_sum_of_rotations():
    mechanism = balanced()
    ends = [turn(mechanism, eq.reactionless_motion(mechanism, path(0.2, 0.08, d), duration=0.3).sweep(3))[-1]
            for d in (0.0, 0.02, -0.015)]  # fmt: skip
    np.testing.assert_allclose(ends, ends[0], atol=1e-11)
    form = eq.spin_form(mechanism, (), {})
    assert form is not None
    assert form["crank_2"] == pytest.approx(0.19496)
    assert form["rod_3"] == pytest.approx(0.017 + 0.18**2 / 2.6 + 0.18**2)
    assert form["platform"] == pytest.approx(0.005)


def test_weights_off_the_lines_make_the_way_matter():
    """Force balance with first moments across the links: momentum is no longer a sum of rotations."""
    mechanism = manipulator()
    weights = [
        eq.Counterweight(f"{kind}_{leg}", eq.Point(f"{kind}_{leg}"), reach=0.11, shape=eq.Plate())
        for kind in ("crank", "rod")
        for leg in (1, 2, 3)
    ]
    sweep = eq.Sweep.motion(mechanism, {"crank_1_joint": "pi/3 + 0.1*t"}, duration=1.0, samples=11)
    aims = [eq.Aim("moment"), eq.Aim("mass", cap=30.0)]
    design = eq.balance(mechanism, weights, sweep, objective=aims, limits=[eq.Balanced("force")])
    given = {"balancers": design.balancers, "values": design.values, "duration": 0.3}
    found = [eq.reactionless_motion(mechanism, path(0.2, 0.08, d), **given) for d in (0.0, 0.02)]
    ends = [turn(mechanism, one.sweep(3))[-1] for one in found]
    assert not found[0].holonomic
    assert abs(ends[0] - ends[1]) > 1e-6
    states = mechanism.states(found[1].sweep(101))
    for goal in ("force", "moment"):
        total = effort(mechanism, design.balancers, states, goal)
        left = total.at(np.array([design.values[u.name] for u in total.unknowns]))
        assert np.abs(left).max() < 1e-8 * np.abs(total.b).max()


def problem(**changes):
    rods = {"rod_masses": [2.6] * 3, "rod_coms": [[-0.18 / 2.6, 0]] * 3, "rod_inertias": [0.017] * 3}
    builder = {
        "bases": [[0, 0], [0.46, 0], [0.23, 0.3983717]],
        "platform": [[-0.05, -0.0288675], [0.05, -0.0288675], [0, 0.0577350]],
        "cranks": [0.18] * 3, "rods": [0.18] * 3, "pose": [0.23, 0.05, 0],
        "crank_masses": [7.2] * 3, "crank_coms": [[-0.09, 0]] * 3, "crank_inertias": [0.02] * 3,
        "platform_mass": 3, "platform_inertia": 0.015, "gravity": [0, 0, 0], **rods,
    }  # fmt: skip
    sweep = {
        "reactionless": {"platform_x": "0.23 - 0.02*(1 - cos(2*pi*t/T))", "platform_z": "0.05"} | changes,
        "duration": "0.5 s",
        "samples": 41,
    }
    return problem_of(Document("", {"mechanism": {"rrr3": builder}, "sweep": sweep}), None)


def test_a_problem_file_asks_for_it():
    asked = problem()
    states = asked.mechanism.states(asked.sweep)
    assert np.abs(effort(asked.mechanism, (), states, "moment").b).max() < 1e-8
    with pytest.raises(eq.InputError, match=r"begins at platform_x = 0\.22"):
        _ = problem(platform_x="0.22 + 0*t").sweep


def with_weights(**changes):
    """The same manipulator with light links and the rest of their masses as balancers of the problem."""
    asked = dict(problem().raw)
    builder = dict(asked["mechanism"]["rrr3"])
    builder |= {"crank_masses": [0.5] * 3, "crank_coms": [[0.09, 0]] * 3, "crank_inertias": [0.00135] * 3}
    mass = 7.2 - 0.5
    place = (7.2 * -0.09 - 0.5 * 0.09) / mass
    weights = [
        {"counterweight": {"name": f"w{i}", "at": [f"crank_{i}", place, 0, 0], "mass": mass} | changes}
        for i in (1, 2, 3)
    ]
    return problem_of(Document("", asked | {"mechanism": {"rrr3": builder}, "balancers": weights}), None)


def test_the_balancers_of_a_problem_file_count():
    """Without its counterweights the force is not balanced; with them the motion leaves no moment."""
    asked = with_weights()
    states = asked.mechanism.states(asked.sweep)
    for goal in ("force", "moment"):
        total, bare = effort(asked.mechanism, asked.balancers, states, goal), asked.mechanism.effort(states, goal)
        assert np.abs(total.b).max() < 1e-8 * np.abs(bare.b).max()
    path = {"platform_x": "0.23 - 0.02*(1 - cos(2*pi*t/T))", "platform_z": "0.05"}
    with pytest.raises(eq.InfeasibleError, match="the force is not balanced"):
        eq.Sweep.reactionless(asked.mechanism, path, duration=0.5)
    with pytest.raises(eq.InputError, match=r"the motion depends on w1\.m, which is still to be found"):
        _ = with_weights(mass=None).sweep


def test_springs_without_mass_change_no_motion():
    links = [
        eq.Link("arm", length=0.3, mass=2.0, com=-0.15),
        eq.Link("wheel", length=0.2, mass=1.0, com=0, inertia=0.02),
    ]
    arm = eq.chain(links, gravity=(0, 0, 0))
    spring = eq.Spring("s", eq.Line(eq.Point("world", (0, 0, 0.2)), eq.Point("arm", (0.1, 0, 0))), eq.ZeroFreeLength())
    found = [
        eq.Sweep.reactionless(arm, {"arm_joint": "0.4*(1 - cos(2*t))"}, duration=1.0, samples=9, balancers=added)
        for added in ((), (spring,))
    ]
    np.testing.assert_array_equal(found[0].poses, found[1].poses)


def test_why_there_is_none():
    bar = eq.four_bar(0.14, 0.05, 0.15, 0.125, masses=(0.1, 0.3, 0.25), gravity=(0, 0, 0))
    with pytest.raises(eq.InfeasibleError, match="the force is not balanced"):
        eq.reactionless_motion(bar, {}, duration=1.0)
    weights = {"c2": ("crank", (-0.05, 0, 0), 0.2), "c4": ("rocker", (-0.0625, 0, 0), 0.55)}
    added = [eq.Counterweight(name, eq.Point(body, at), mass=mass) for name, (body, at, mass) in weights.items()]
    with pytest.raises(eq.InfeasibleError, match="1 drive, and zero angular momentum takes 1"):
        eq.reactionless_motion(bar, {}, duration=1.0, balancers=added)
    with pytest.raises(eq.InfeasibleError, match="the force is not balanced: moving crank"):
        eq.reactionless_motion(balanced(rod=(2.6, -0.06, 0.017)), path(0.2, 0.08), duration=0.3)
    with pytest.raises(eq.InputError, match="3 drives less 1 for the momentum leave 2"):
        eq.reactionless_motion(balanced(), {"platform_x": "0.23"}, duration=0.3)
    with pytest.raises(eq.LoopError):
        eq.reactionless_motion(balanced(), path(0.9, 0.08), duration=0.3)
    # the second link turns without momentum of its own, so nothing can turn against the first
    links = [eq.Link("arm", length=0.3, mass=2.0, com=-0.15), eq.Link("wheel", length=0.2, mass=1.0, com=0, inertia=0)]
    arm = eq.chain(links, gravity=(0, 0, 0))
    with pytest.raises(eq.InfeasibleError, match="can only be followed by turning the base"):
        eq.reactionless_motion(arm, {"arm_joint": "0.3*t"}, duration=0.3)


def test_a_wheel_on_an_arm_turns_against_it():
    """K1 theta1 + K2 (theta1 + theta2) = const by hand."""
    links = [
        eq.Link("arm", length=0.3, mass=2.0, com=-0.15, inertia=0.02),
        eq.Link("wheel", length=0.2, mass=1.0, com=0.0, inertia=0.05),
    ]
    arm = eq.chain(links, gravity=(0, 0, 0))
    found = eq.reactionless_motion(arm, {"arm_joint": "0.4*(1 - cos(2*t))"}, duration=1.0)
    q = arm.states(found.sweep(11)).kin.q
    K1, K2 = 0.02 + 2 * 0.15**2 + 0.3**2, 0.05
    np.testing.assert_allclose(K1 * q[:, 0] + K2 * (q[:, 0] + q[:, 1]), 0.0, atol=1e-12)
