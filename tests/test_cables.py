"""What cable platforms can do: equilibria, closure, tensions, clearance, stiffness."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

import equipoise as eq
from equipoise.cables.clearance import segments
from equipoise.errors import InfeasibleError, InputError
from equipoise.reporting.scene import outline

S3 = 3**0.5
CORNERS = ((-0.5, -S3 / 6), (0.5, -S3 / 6), (0.0, S3 / 3))
SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
SMALL = ((-0.1, -0.05), (0.1, -0.05), (0.1, 0.05), (-0.1, 0.05))


def sampled(k):
    mechanism = eq.cable_platform(CORNERS)
    law = eq.Polynomial((0.0, 1.0), degree=k - 1)
    parts = [
        eq.Spring(f"s{i}", eq.Reel(c), law, like="s0" if i else None) for i, c in enumerate(mechanism.platform.cables)
    ]
    limit = eq.Force("s0", min=1.0, over=(0.0, 1.0), samples=10 * k)
    sweep = eq.Sweep.triangle(mechanism, CORNERS)
    return eq.balance(mechanism, parts, sweep, objective=eq.Aim(goal="wrench"), limits=[limit])


@pytest.fixture(scope="module")
def fifth():
    return sampled(5)


@pytest.mark.parametrize(
    ("k", "counts", "middle"),
    [
        (1, {"minimum": 1}, 2.59808),
        (2, {"minimum": 1}, 2.31309),
        (4, {"minimum": 4, "saddle": 3}, 1.16247),
        (5, {"minimum": 6, "saddle": 9, "maximum": 4}, -0.56015),
    ],
)
def test_equilibria_of_the_triangle(k, counts, middle):
    found = eq.equilibria(sampled(k))
    kinds = Counter(one.kind for one in found)
    assert kinds == counts
    assert kinds["minimum"] - kinds["saddle"] + kinds["maximum"] + kinds["corner sink"] == 1
    centre = min(found, key=lambda one: max(abs(v) for v in one.pose.values()))
    assert centre.stiffness == pytest.approx((middle, middle), abs=1e-5)


def test_corners_hold_where_their_own_cable_wins():
    """t(0) > sqrt(3) t(a) is what it takes in the equilateral triangle."""
    found = Counter(one.kind for one in eq.equilibria(sampled(3)))
    assert found["corner sink"] == 3
    assert found["minimum"] - found["saddle"] + found["maximum"] + found["corner sink"] == 1


def test_stiffness_is_the_slope_of_the_springs(fifth):
    """K = sum t' u u' + t / l (1 - u u') for a point."""
    pose = np.array([[0.1, 0.07]])
    K = eq.stiffness(fifth, pose)[0]
    plain = np.zeros((2, 2))
    law = fifth.balancers[0].law
    theta = np.array([fifth.values[f"s0.c{i}"] for i in range(5)])
    for corner in CORNERS:
        d = np.array(corner) - pose[0]
        length = np.linalg.norm(d)
        u = d / length
        t, slope = (float((basis(np.array([length]))[0] @ theta)[0]) for basis in (law.force_basis, law.slope_basis))
        plain += slope * np.outer(u, u) + t / length * (np.eye(2) - np.outer(u, u))
    np.testing.assert_allclose(K, plain, atol=1e-7)


def test_closure_is_the_triangle_itself():
    mechanism = eq.cable_platform(CORNERS, limits={"x": (-1.0, 1.0), "z": (-1.0, 1.0)})
    rng = np.random.default_rng(2)
    poses = rng.uniform(-0.8, 0.8, (200, 2))
    found = eq.closure(mechanism.states(eq.Sweep(poses, np.ones(200), "random")))
    a = np.array(CORNERS)
    side = [
        (a[(i + 1) % 3, 0] - a[i, 0]) * (poses[:, 1] - a[i, 1])
        - (a[(i + 1) % 3, 1] - a[i, 1]) * (poses[:, 0] - a[i, 0])
        for i in range(3)
    ]
    inside = np.all(np.array(side) > 0, axis=0)
    np.testing.assert_array_equal(found.margin > 0, inside)
    assert len(found.outside) == (~inside).sum()
    assert set(found.outside[0]) == {"x", "z"}


def test_feasibility_against_a_plain_linear_program():
    mechanism = eq.cable_platform(SQUARE, SMALL, mass=1.0, length=0.1)
    rng = np.random.default_rng(4)
    poses = np.array([0.1, 0.1, -0.5]) + rng.random((60, 3)) * np.array([0.8, 0.8, 1.0])
    states = mechanism.states(eq.Sweep(poses, np.ones(60), "random"))
    margin = eq.feasible(states, 2.0, 25.0).margin
    W, w, _ = eq.wrench_matrix(states)
    plain = [linprog(np.zeros(4), A_eq=W[i], b_eq=-w[i], bounds=[(2.0, 25.0)] * 4).status == 0 for i in range(60)]
    np.testing.assert_array_equal(margin > 0, plain)
    assert 0 < sum(plain) < 60
    with pytest.raises(InputError, match="above t_max"):
        eq.feasible(states, 9.0, 2.0)


def test_springs_take_tension_off_the_motors(fifth):
    turn = np.linspace(0, 2 * np.pi, 80)
    poses = 0.2 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    states = fifth.mechanism.states(eq.Sweep(poses, np.ones(80), "circle"))
    W, w, _ = eq.wrench_matrix(states)
    for least in ("norm", "peak"):
        alone = eq.distribute(states, 1.0, 50.0, least=least)
        helped = eq.distribute(states, 1.0, 50.0, design=fifth, least=least)
        for found in (alone, helped):
            assert found.total.min() >= 1 - 1e-6
            assert np.abs(np.einsum("nij,nj->ni", W, found.total) + w).max() < 1e-6
        assert helped.peak < 0.1 * alone.peak
        assert helped.work < 0.1 * alone.work
    norm, peak = (eq.distribute(states, 1.0, 50.0, design=fifth, least=least) for least in ("norm", "peak"))
    assert norm.rms <= peak.rms + 1e-7
    assert peak.peak <= norm.peak + 1e-7
    with pytest.raises(InfeasibleError, match="no tensions from"):
        eq.distribute(states, 1.0, 1.01)


def test_distances():
    a, b = np.array([[0.0, 0, 0]]), np.array([[1.0, 0, 0]])
    assert segments(a, b, np.array([[0.5, -1, 1]]), np.array([[0.5, 1, 1]])) == pytest.approx([1.0])
    assert segments(a, b, np.array([[2.0, 0, 0]]), np.array([[3.0, 0, 0]])) == pytest.approx([1.0])
    assert segments(a, b, np.array([[-1.0, 1, 0]]), np.array([[2.0, 1, 0]])) == pytest.approx([1.0])
    mechanism = eq.cable_platform(SQUARE, SMALL, mass=1.0)
    states = mechanism.states(eq.Sweep.of_poses(mechanism, [{"x": 0.5, "z": 0.5}]))
    found = eq.clearance(states)
    pair, near = found.closest
    assert near == pytest.approx(0.1)
    assert pair in found.pairs
    assert min(float(d.min()) for d in found.platform.values()) == pytest.approx(0.1, abs=0.02)


def test_sag():
    # 20 g/m over 4 m: 1 mm of sag needs mu g L^2 / 8 s.
    assert eq.sag_tension(0.02, 4.0, 1e-3) == pytest.approx(0.02 * 9.81 * 16 / 0.008)
    with pytest.raises(InputError, match="not flat"):
        eq.sag_tension(0.02, 1.0, 0.2)
    sag = eq.Sag(1e-3, 0.02)
    assert sag.tension(4.0) == eq.sag_tension(0.02, 4.0, 1e-3)
    assert eq.Sag(1e-3, 0.02, span=2.0).tension(4.0) == sag.tension(4.0) / 4
    square = eq.cable_platform(SQUARE, SMALL, mass=1.0, t_min=eq.Sag(1e-3, 1e-3), t_max=60.0)
    assert square.platform.t_min == pytest.approx((1e-3 * 9.81 * 2 / 8e-3,) * 4)
    assert eq.Force("s", min=sag, over=(0.0, 4.0)).min == sag.tension(4.0)
    with pytest.raises(InputError, match="needs a span"):
        eq.Force("s", min=sag)
    with pytest.raises(InputError, match="no tension is left"):
        eq.cable_platform(SQUARE, SMALL, mass=1.0, t_min=eq.Sag(1e-3, 1e-3), t_max=2.0)


def test_limits_of_each_cable():
    """Two cables above and two below: the lower ones may go slack, and one that may not pull much bounds the rest."""
    mechanism = eq.cable_platform(SQUARE, SMALL, mass=1.0, t_min=(0.0, 0.0, 1.0, 1.0), t_max=(50.0, 50.0, 50.0, 8.0))
    rng = np.random.default_rng(5)
    poses = np.array([0.3, 0.3, -0.2]) + rng.random((80, 3)) * np.array([0.4, 0.4, 0.4])
    states = mechanism.states(eq.Sweep(poses, np.ones(80), "random"))
    W, w, _ = eq.wrench_matrix(states)
    bounds = [(0.0, 50.0), (0.0, 50.0), (1.0, 50.0), (1.0, 8.0)]
    plain = [linprog(np.zeros(4), A_eq=W[i], b_eq=-w[i], bounds=bounds).status == 0 for i in range(80)]
    found = eq.feasible(states)
    np.testing.assert_array_equal(found.margin > 0, plain)
    assert 0 < sum(plain) < 80
    kept = states.take(np.flatnonzero(found.margin > 0))
    total = eq.distribute(kept).total
    assert (total > np.array([low for low, _ in bounds]) - 1e-7).all()
    assert (total < np.array([high for _, high in bounds]) + 1e-7).all()


def test_stiffness_of_held_cables_is_that_of_their_directions(fifth):
    """Motors that keep their tensions: sum t / l (1 - u u') of a point; with the springs theirs on top."""
    states = fifth.mechanism.states(eq.Sweep.of_poses(fifth.mechanism, [{"x": 0.1, "z": 0.07}]))
    motors = eq.distribute(states, 2.0, 50.0)
    plain = np.zeros((2, 2))
    for corner, tension in zip(CORNERS, motors.motors[0], strict=True):
        d = np.array(corner) - states.driven[0]
        u = d / np.linalg.norm(d)
        plain += tension / np.linalg.norm(d) * (np.eye(2) - np.outer(u, u))
    np.testing.assert_allclose(eq.held_stiffness(states, motors)[0], plain, atol=1e-6)
    helped = eq.distribute(states, 2.0, 50.0, design=fifth)
    rest = helped.motors[0] / motors.motors[0]
    assert not np.allclose(rest, 1.0)
    own = eq.held_stiffness(states, helped, fifth)[0] - eq.stiffness(fifth, states.driven)[0]
    plain = sum(
        tension / np.linalg.norm(d) * (np.eye(2) - np.outer(d, d) / (d @ d))
        for d, tension in zip(np.array(CORNERS) - states.driven[0], helped.motors[0], strict=True)
    )
    np.testing.assert_allclose(own, plain, atol=1e-6)


def test_survey_names_what_the_cables_cannot_hold():
    mechanism = eq.cable_platform(SQUARE, SMALL, mass=1.0, length=0.1, t_min=2.0, t_max=30.0)
    poses = [{"x": 0.5, "z": 0.5}, {"x": 0.05, "z": 0.95, "turn": 1.2}]
    found = eq.survey(mechanism.states(eq.Sweep.of_poses(mechanism, poses)))
    assert found.closure.margin[0] > 0 > found.feasible.margin[1] - 1e-12
    assert found.feasible.outside == [poses[1]]
    assert np.isnan(found.stiffness[1]).all()
    assert np.isfinite(found.stiffness[0]).all()
    head, table = found.table()
    assert table.shape == (2, len(head))
    assert found.json()["feasible"]["outside"] == [poses[1]]


def test_behaviour_with_springs_along_a_trajectory(fifth):
    motion = {"x": "0.2*cos(2*pi*t/T)", "z": "0.2*sin(2*pi*t/T)"}
    robot = eq.cable_platform(CORNERS, t_min=1.0)
    path = eq.Sweep.motion(robot, motion, duration=2.0, samples=81)
    found = eq.behaviour(replace(fifth, mechanism=robot), path)
    assert found.motors.saved("norm")["energy"] > 0.9 * found.motors.alone["norm"].work
    # Tensions by the springs of every cable, and the floor below them.
    length = np.linspace(0, 1, 4001)
    law = fifth.balancers[0].law.force_basis(length)[0] @ np.array([fifth.values[f"s0.c{i}"] for i in range(5)])
    assert max(found.peak.values()) == pytest.approx(law.max(), rel=1e-3)
    area = S3 / 4
    assert 0.5 * area * found.floor.value**2 == pytest.approx(0.01990344571, rel=2e-3)
    assert sum(one.kind == "minimum" for one in found.equilibria) == 6


def test_inertia_counts_in_a_motion():
    """A mass of 2 kg on a circle: the tensions sum to m (a - g)."""
    robot = eq.cable_platform(SQUARE, mass=2.0, t_min=1.0, t_max=500.0)
    motion = {"x": "0.5 + 0.2*cos(2*pi*t/T)", "z": "0.5 + 0.2*sin(2*pi*t/T)"}
    states = robot.states(eq.Sweep.motion(robot, motion, duration=0.5, samples=40))
    total = eq.distribute(states).total
    W, _, _ = eq.wrench_matrix(states)
    rate = 4 * np.pi
    a = -(rate**2) * (states.driven - 0.5)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", W, total), 2.0 * (a + np.array([0, 9.81])), atol=1e-5)


def test_outline_of_a_platform():
    """A box has twelve edges, a plate as many as corners, whatever the order of its points."""
    box = np.array([(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 3)], dtype=float)
    edges = outline(box)
    assert len(edges) == 12
    assert all((np.abs(box[a] - box[b]) > 0).sum() == 1 for a, b in edges)
    plate = np.array([(1.0, 0.0, 1.0), (-1.0, 0.0, -1.0), (-1.0, 0.0, 1.0), (1.0, 0.0, -1.0)])
    assert sorted(np.linalg.norm(plate[a] - plate[b]) for a, b in outline(plate)) == [2.0] * 4
    assert outline(plate[:1]) == []


def test_a_cap_that_cannot_be_kept_is_named():
    """At the foot of an altitude no tensions of 1 N leave less than 1 N: the cap conflicts with the limit."""
    mechanism = eq.cable_platform(CORNERS)
    law = eq.Polynomial((0.0, 1.0), degree=4)
    parts = [
        eq.Spring(f"s{i}", eq.Reel(c), law, like="s0" if i else None) for i, c in enumerate(mechanism.platform.cables)
    ]
    aims = [eq.Aim(goal="wrench"), eq.Aim(goal="wrench", norm="peak", cap=0.5)]
    with pytest.raises(InfeasibleError, match=r"force of s0 over .* and peak of resultant <= 0.5 conflict"):
        eq.balance(
            mechanism,
            parts,
            eq.Sweep.triangle(mechanism, CORNERS),
            objective=aims,
            limits=[eq.Force("s0", min=1.0, over=(0.0, 1.0))],
        )
