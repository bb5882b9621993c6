"""Cable platforms: wrenches against plain vector algebra, quadrature that is right at the corners, bad input."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import equipoise as eq
from equipoise import workspace
from equipoise.assemble import effort
from equipoise.errors import InputError

S3 = 3**0.5
CORNERS = ((-0.5, -S3 / 6), (0.5, -S3 / 6), (0.0, S3 / 3))
SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
SMALL = ((-0.1, -0.05), (0.1, -0.05), (0.1, 0.05), (-0.1, 0.05))
BOX = tuple(itertools.product((0.0, 1.0), repeat=3))
LITTLE = tuple((0.1 * (2 * x - 1), 0.08 * (2 * y - 1), 0.06 * (2 * z - 1)) for x, y, z in BOX)


def springs(mechanism, law, shared=True):
    cables = mechanism.platform.cables
    return [eq.Spring(f"s{i}", eq.Reel(c), law, like="s0" if shared and i else None) for i, c in enumerate(cables)]


PLATFORMS = {
    "point": lambda: eq.cable_platform(CORNERS, mass=1.3),
    "planar": lambda: eq.cable_platform(SQUARE, SMALL, mass=2.0, com=(0.02, 0.03), length=0.1),
    "spatial point": lambda: eq.cable_platform(BOX, mass=1.0),
    "spatial": lambda: eq.cable_platform(BOX, LITTLE, mass=3.0, com=(0.01, 0.02, -0.03), inertia=(0.1, 0.1, 0.1)),
}


def plain(mechanism, states):
    """The columns u_i, (R b_i) x u_i / l, and the weight, from anchors and rotations by vector algebra."""
    platform = mechanism.platform
    ends = [mechanism.cable(cable) for cable in platform.cables]
    a, b = (np.array([pair[k].at for pair in ends]) for k in (0, 1))
    R, p = states.kin.xmat[:, 1], states.kin.xpos[:, 1]
    arm = np.einsum("nij,kj->nki", R, b)
    d = a - p[:, None] - arm
    u = d / np.linalg.norm(d, axis=2, keepdims=True)
    whole = np.concatenate([u, np.cross(arm, u) / platform.length], axis=2)
    com = R @ mechanism.model.body_ipos[1]
    force = np.broadcast_to(mechanism.mass * mechanism.gravity, com.shape)
    weight = np.concatenate([force, np.cross(com, force) / platform.length], axis=1)
    rows = np.array(platform.rows)
    return np.einsum("rk,nik->nri", rows, whole), weight @ rows.T


@pytest.mark.parametrize("name", PLATFORMS)
def test_resultant_is_the_wrench_matrix(name):
    mechanism = PLATFORMS[name]()
    rng = np.random.default_rng(1)
    box = np.array([(-0.3, 0.3) if np.ptp(row) > 3 else row.mean() + 0.4 * (row - row.mean()) for row in mechanism.box])
    poses = box[:, 0] + rng.random((40, len(box))) * (box[:, 1] - box[:, 0])
    states = mechanism.states(eq.Sweep(poses, np.ones(40), "random"))
    found = effort(mechanism, springs(mechanism, eq.Constant(), shared=False), states, "wrench")
    matrix, weight = plain(mechanism, states)
    np.testing.assert_allclose(found.A, matrix, atol=1e-12)
    np.testing.assert_allclose(found.b, weight, atol=1e-10)
    assert [block.name for block in found.blocks] == ["resultant"]


def test_singular_angles_are_refused():
    mechanism = PLATFORMS["spatial"]()
    sweep = eq.Sweep.of_poses(mechanism, [{"pitch": np.pi / 2}])
    with pytest.raises(InputError, match="singular"):
        effort(mechanism, [], mechanism.states(sweep), "wrench")


def test_constant_tension_over_the_triangle():
    """f = 1/2 int |sum u_i|^2 dA over the unit triangle, to the digits of an independent 50-digit quadrature."""
    mechanism = eq.cable_platform(CORNERS)
    sweep = eq.Sweep.triangle(mechanism, CORNERS)
    states = mechanism.states(sweep)
    r = effort(mechanism, springs(mechanism, eq.Constant()), states, "wrench").at(np.ones(1))
    assert sweep.weight.sum() == pytest.approx(S3 / 4, rel=1e-14)
    assert 0.5 * states.weight @ (r**2).sum(1) == pytest.approx(0.094411657999, abs=1e-12)
    # On the edges two cables are in line and the third is normal to them, or nearly so.
    assert np.linalg.norm(r, axis=1).max() == pytest.approx(1.0, abs=1e-9)


def test_square_by_box_and_by_polygon():
    mechanism = eq.cable_platform(SQUARE)
    values = []
    for sweep in (
        eq.Sweep.polygon(mechanism, SQUARE, points=16),
        eq.Sweep.region(mechanism, {"x": (0, 1), "z": (0, 1)}, points=16),
    ):
        states = mechanism.states(sweep)
        r = effort(mechanism, springs(mechanism, eq.Constant()), states, "wrench").at(np.ones(1))
        values.append(0.5 * states.weight @ (r**2).sum(1))
        assert sweep.weight.sum() == pytest.approx(1.0, rel=1e-13)
        finer = sweep.finer()
        assert len(finer.poses) > len(sweep.poses)
    assert values == pytest.approx([0.69664016, 0.69664016], abs=1e-8)


def test_rules_integrate_polynomials_and_split_at_points_inside():
    corner = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 0.4), (0.0, 1.0)])  # not convex
    points, weight = workspace.polygon_rule(corner, np.array([(0.5, 0.2), (1.0, 0.0)]), 6)
    assert weight.sum() == pytest.approx(1.4)
    # int x^2 over the polygon by Green's theorem, edge by edge
    x, y = corner.T
    xn, yn = np.roll(x, -1), np.roll(y, -1)
    green = ((yn - y) * (x**3 + x**2 * xn + x * xn**2 + xn**3)).sum() / 12
    assert weight @ points[:, 0] ** 2 == pytest.approx(green)
    points, weight = workspace.box_rule(np.zeros(3), np.array([1.0, 2.0, 3.0]), 4)
    assert weight @ (points[:, 0] ** 2 * points[:, 2]) == pytest.approx(2 * 9 / 2 / 3)


def test_turns_are_an_axis_of_their_own():
    mechanism = PLATFORMS["planar"]()
    inner = ((0.25, 0.25), (0.75, 0.25), (0.75, 0.75), (0.25, 0.75))
    sweep = eq.Sweep.polygon(mechanism, inner, points=4, axes={"turn": (-0.3, 0.3, 3)})
    assert sweep.weight.sum() == pytest.approx(0.25 * 0.6)
    assert set(np.unique(np.round(sweep.poses[sweep.weight > 0, 2], 6))) == {-0.232379, 0.0, 0.232379}


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: eq.cable_platform(CORNERS[:2]), "2 cables cannot hold"),
        (lambda: eq.cable_platform(SQUARE[:3], SMALL[:3]), "at least 4"),
        (lambda: eq.cable_platform((*CORNERS, CORNERS[0])), "coincide"),
        (lambda: eq.cable_platform(SQUARE, SMALL[:3]), "3 attachments for 4 anchors"),
        (lambda: eq.cable_platform(SQUARE, limits={"turm": (0, 1)}), "no joint 'turm'"),
        (lambda: eq.cable_platform(((0, 0, 0, 0),) * 4), "must be"),
        (lambda: eq.cable_platform(SQUARE, cables=("a", "a", "b", "c")), "same name"),
        (lambda: eq.Sweep.triangle(eq.cable_platform(CORNERS), ((0, 0), (3, 0), (0, 0.1))), "reaches x = 3"),
        (lambda: eq.Sweep.triangle(eq.cable_platform(CORNERS), ((0, 0), (0.1, 0), (0.2, 0))), "no area"),
        (lambda: eq.Sweep.polygon(eq.cable_platform(SQUARE), ((0, 0), (1, 1), (1, 0), (0, 1))), "crosses|no area"),
        (lambda: eq.cable_platform(SQUARE).cable("cable_9"), "no cable"),
        (lambda: eq.Aim(goal="wrench").term(eq.chain([eq.Link("a", 0.1, 1.0)]), None, None), "no platform"),
    ],
)
def test_bad_input_is_named(make, words):
    with pytest.raises(InputError, match=words):
        make()


def test_problem_file(tmp_path):
    file = tmp_path / "triangle.yaml"
    file.write_text(
        """
mechanism: {cable_platform: {anchors: [[-500 mm, 0], [500 mm, 0], [0, 0.9]]}}
sweep: {triangle: [[-0.5, 0], [0.5, 0], [0, 0.9]], points: 6}
balancers:
  - spring: {name: s1, path: {reel: [cable_1]}, law: constant}
  - spring: {name: s2, path: {reel: [cable_2]}, law: constant, like: s1}
  - spring: {name: s3, path: {reel: [cable_3]}, law: constant, like: s1}
limits: [{force: s1, min: 2 N}]
objective: {goal: wrench}
"""
    )
    problem = eq.load_problem(file)
    problem.check()
    design = eq.balance(
        problem.mechanism, problem.balancers, problem.sweep, objective=problem.objective, limits=problem.limits
    )
    assert design.values["s1.force"] == pytest.approx(2.0)
    assert design.after["resultant"].peak == pytest.approx(2.0, rel=0.02)
    assert eq.verify(design, poses=50).verification.agrees
