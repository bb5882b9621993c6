"""The payload rule against brute force: settings found blindly by a search over motor torques."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares, minimize_scalar

import equipoise as eq
from equipoise.reporting.payload import adjustments

G = 9.8
RADIUS = 0.2
LOADS = [(10.0, (1.05, 0.12)), (3.5, (0.4, -0.3)), (25.0, (0.0, 0.0)), (8.0, (-0.9, 0.2)), (0.0, (1.0, 1.0))]


def arm(m1=100.0, c1=(0.6, 0.0), m2=40.0, c2=(0.5, 0.0), l1=1.2):
    links = [eq.Link("link1", l1, m1, com=c1), eq.Link("link2", 1.0, m2, com=c2)]
    return eq.chain(links, gravity=(0, 0, -G))


def carried(mass, place):
    return eq.Payload("link2", mass, (place[0], 0.0, place[1]))


def yokes(force1, force2, lead1=0.0, lead2=0.0):
    """Pulling constant forces on Scotch yokes, the second on link 2's absolute angle."""
    one = eq.ScotchYoke(eq.Angle("link1_joint"), RADIUS, phase=np.pi + lead1)
    two = eq.ScotchYoke(eq.Absolute("link2"), RADIUS, phase=np.pi + lead2)
    return eq.Spring("y1", one, eq.Constant(force1)), eq.Spring("y2", two, eq.Constant(force2))


def torques(robot, states, settings):
    """Motor torques (N, 2) that the yokes leave."""
    return states.holding + sum(spring.effort(states, "hold").b for spring in yokes(*settings))


@pytest.mark.parametrize(("mass", "place"), LOADS)
def test_the_rule_is_what_a_blind_search_finds(mass, place):
    robot, load = arm(), carried(mass, place)
    states = robot.states(eq.Sweep.sobol(robot, 64, payload=[load]))
    one, two = eq.payload_rule(robot, load)

    def left(x):
        return torques(robot, states, (x[0] * 1e3, x[1] * 1e3, x[2], x[3])).ravel()

    found = least_squares(left, [5.0, 1.0, 0.1, -0.1], xtol=1e-14, ftol=1e-14, gtol=1e-14).x
    assert np.abs(left(found)).max() < 1e-6
    assert 1e3 * found[:2] == pytest.approx([one.force(RADIUS), two.force(RADIUS)], rel=1e-8)
    assert found[2:] == pytest.approx([one.lead, two.lead], abs=1e-8)
    rule = (one.force(RADIUS), two.force(RADIUS), one.lead, two.lead)
    assert np.abs(torques(robot, states, rule)).max() < 1e-9


def test_the_numbers_of_a_payload_of_ten_kilograms():
    """gam = 2.2531 deg, S2' = 30.5236 kg m, F1 = 5880 N, F2 = 1495.66 N; what less than the rule leaves."""
    robot, load = arm(), carried(*LOADS[0])
    one, two = eq.payload_rule(robot, load)
    assert np.degrees(two.lead) == pytest.approx(2.2531, abs=5e-5)
    assert two.torque / G == pytest.approx(30.5236, abs=5e-5)
    assert one.force(RADIUS) == pytest.approx(5880, abs=1e-9)
    assert two.force(RADIUS) == pytest.approx(1495.66, abs=5e-3)
    assert one.lead == pytest.approx(0.0, abs=1e-12)
    states = robot.states(eq.Sweep.sobol(robot, 2048, payload=[load]))
    peaks = {
        name: np.abs(torques(robot, states, settings)).max(axis=0)
        for name, settings in {
            "none": (5292, 980, 0, 0),
            "angle": (5292, 980, 0, two.lead),
            "angle and link 1": (5880, 980, 0, two.lead),
            "rule": (5880, two.force(RADIUS), 0, two.lead),
        }.items()
    }
    assert peaks["none"][1] == pytest.approx(G * abs(10 * (1.05 + 0.12j)), rel=1e-3)
    assert peaks["angle"][1] == pytest.approx(G * (30.5236 - 20), rel=1e-3)
    assert peaks["angle and link 1"] == pytest.approx(G * (30.5236 - 20), rel=1e-3)
    assert peaks["rule"].max() < 1e-9


def test_the_crank_alone_has_its_best_angle_at_the_rule_and_still_leaves_the_rest():
    robot, load = arm(), carried(6.0, (0.7, 0.4))
    states = robot.states(eq.Sweep.grid(robot, {"link2_joint": (-np.pi, np.pi, 181)}, payload=[load]))
    _, two = eq.payload_rule(robot, load)

    def left(lead):
        return torques(robot, states, (0, 980, 0, lead))[:-1, 1]

    best = minimize_scalar(lambda x: (left(x) ** 2).mean(), bounds=(-0.5, 0.8), method="bounded")
    assert best.x == pytest.approx(two.lead, abs=1e-6)
    assert np.sqrt(best.fun) == pytest.approx((two.torque - 196.0) / np.sqrt(2), rel=1e-9)
    assert np.abs(left(two.lead)).mean() == pytest.approx(2 / np.pi * (two.torque - 196.0), rel=1e-3)


def test_centres_off_the_links_and_springs_of_zero_free_length():
    robot, load = arm(c1=(0.5, 0.15), c2=(0.4, -0.1)), carried(4.0, (0.9, 0.3))
    one, two = eq.payload_rule(robot, load)
    assert one.torque == pytest.approx(G * abs(100 * (0.5 + 0.15j) + 44 * 1.2), rel=1e-12)
    assert two.torque * np.exp(1j * two.lead) == pytest.approx(G * (40 * (0.4 - 0.1j) + 4 * (0.9 + 0.3j)), rel=1e-12)
    states = robot.states(eq.Sweep.sobol(robot, 64, payload=[load]))
    inputs = (eq.Angle("link1_joint"), eq.Absolute("link2"))
    springs = [
        eq.Spring(
            f"s{i}",
            eq.InvertedSliderCrank(angle, 0.2, 0.9, phase=rule.lead - np.pi / 2),
            eq.ZeroFreeLength(rule.rate(0.2, 0.9)),
        )
        for i, (angle, rule) in enumerate(zip(inputs, (one, two), strict=True))
    ]
    held = states.holding + sum(spring.effort(states, "hold").b for spring in springs)
    assert np.abs(held).max() < 1e-9


def test_structure_one_with_heavy_links_three_and_four():
    """S1 = m1 r1 + (m2 + mp) l1 + m4 l1/2 and z = m2 r2 + mp (x + i y) - m3 l3/2 - m4 l3."""
    coms = ((0.6, 0.0), (0.5, 0.0), None, None)
    box = ((-np.pi / 2, np.pi / 2), (-np.pi, 0.0))
    robot = eq.parallelogram_robot(1.2, 1.0, -0.4, masses=(100, 40, 3, 6), coms=coms, limits=box, gravity=(0, 0, -G))
    t1, phi = np.random.default_rng(3).uniform([-1.5, 0.4], [1.5, 2.7], (64, 2)).T
    over = eq.Sweep(np.stack([t1, t1 + phi - np.pi], axis=1), np.ones(64), "random")
    one, two = eq.payload_rule(robot, eq.Payload("forearm", 10.0, (1.05, 0.0, 0.12)), sweep=over)
    assert (one.body, two.body) == ("arm", "crank")
    assert one.torque / G == pytest.approx(123.6, rel=1e-12)
    assert one.lead == pytest.approx(0.0, abs=1e-12)
    z = 40 * 0.5 + 10 * (1.05 + 0.12j) - 3 * 0.2 - 6 * 0.4
    assert two.torque * np.exp(1j * two.lead) / G == pytest.approx(z, rel=1e-12)


def test_several_loads_and_a_tilted_gravity():
    links = [eq.Link("a", 0.4, 2.0), eq.Link("b", 0.3, 1.0), eq.Link("c", 0.2, 0.5, com=(0.1, 0.05))]
    robot = eq.chain(links, gravity=(1.0, 0, -9.0))
    loads = [eq.Payload("b", 1.0, (0.1, 0, 0.1)), eq.Payload("c", 2.0, (0.2, 0, 0.0))]
    rules = eq.payload_rule(robot, loads)
    states = robot.states(eq.Sweep.sobol(robot, 32, payload=loads))
    angles = [states.rotation(rule.body)[0] for rule in rules]
    along = [np.arctan2(R[:, 2, 0], R[:, 0, 0]) for R in angles]
    height = sum(rule.torque * np.sin(angle + rule.lead) for rule, angle in zip(rules, along, strict=True))
    assert np.ptp(states.potential - height) < 1e-9


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: eq.payload_rule(arm(), eq.Payload("link3", 1.0)), r"no body 'link3'(.|\n)*did you mean link"),
        (lambda: eq.payload_rule(arm(), eq.Payload("link2", (0.0, 1.0))), "a payload of 2 masses on link2"),
        (lambda: eq.payload_rule(arm(), bodies=["link1"]), "no sum over the angles of link1: .* J are left"),
        (lambda: eq.payload_rule(arm(), bodies=["link1", "link2", "link2"]), "do not turn independently"),
    ],
)
def test_nonsense_is_refused(build, words):
    with pytest.raises(eq.InputError, match=words):
        build()


def test_the_report_lists_the_settings_for_each_payload():
    robot = arm()
    over = eq.Sweep.grid(
        robot,
        {"link1_joint": (-1.5, 1.5, 9), "link2_joint": (-2.8, -0.3, 9)},
        payload=[carried(m, (1.05, 0.12)) for m in (0.0, 10.0)],
    )
    one, two = yokes(None, None)
    table = str(adjustments(eq.balance(robot, [one, two], over)))
    for words in ("980.0 N on 200 mm", "1496 N on 200 mm", "5880 N on 200 mm", "2.25 deg", "10 kg at link2"):
        assert words in table
    line = eq.Spring("s", eq.Line(eq.Point("world", (0, 0, 1.0)), eq.Point("link1", (0.5, 0, 0))), eq.ZeroFreeLength())
    assert adjustments(eq.balance(robot, [line], over)) == ""
