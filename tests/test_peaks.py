"""Peaks between the samples: the true one is found where the worst samples lie on a lower hill."""

from __future__ import annotations

import numpy as np
import pytest

import equipoise as eq
from equipoise.affine import Block
from equipoise.assemble import effort
from equipoise.peaks import _step, polish
from equipoise.steepness import steepness
from equipoise.verbs.analyze import table

ROBOTS = "package://example-robot-data/robots/"


def two_hills(centres, heights, widths):
    """The probe of a sum of bell curves (H, n) of given heights and widths (H,)."""

    def probe(poses, rows):
        offset = poses[:, None] - centres
        bell = heights * np.exp(-(offset**2).sum(axis=2) / (2 * widths**2))
        slope = (-offset / widths[:, None] ** 2 * bell[..., None]).sum(axis=1)
        return bell.sum(axis=1), slope

    return probe


def test_the_higher_hill_is_found_although_the_worst_samples_lie_on_the_lower_one():
    # A broad hill of height 1 catches all of the worst samples, a narrow one beside it is 3 % higher.
    centres = np.array([[0.3, 0.3, 0.5], [0.8, 0.75, 0.5]])
    probe = two_hills(centres, np.array([1.0, 1.03]), np.array([0.25, 0.06]))
    box = np.tile([0.0, 1.0], (3, 1))
    poses = np.random.default_rng(3).random((400, 3))
    magnitude = probe(poses, np.zeros(400, dtype=int))[0][:, None]
    worst = poses[np.argsort(-magnitude[:, 0])[:24]]
    assert np.linalg.norm(worst - centres[0], axis=1).max() < 0.3, "the naive choice sees the lower hill only"
    found = polish(probe, poses, magnitude, box)
    # The slope of the broad hill's foot shifts the summit a little.
    fine = centres[1] + 0.02 * (np.random.default_rng(0).random((20_000, 3)) - 0.5)
    top = probe(fine, np.zeros(len(fine), dtype=int))[0].max()
    assert found.value[0] >= top > 1.03 > found.sample[0]
    np.testing.assert_allclose(found.pose[0], centres[1], atol=0.01)


def test_a_peak_at_the_edge_of_the_box_and_off_a_saddle():
    def probe(poses, rows):
        x, y = poses.T
        return 1 + x + y**2, np.stack([np.ones_like(x), 2 * y], axis=1)

    box = np.array([[-1.0, 1.0], [-2.0, 2.0]])
    # Both samples have y = 0, where the slope along y vanishes.
    poses = np.array([[0.0, 0.0], [0.5, 0.0]])
    found = polish(probe, poses, probe(poses, None)[0][:, None], box)
    assert found.value[0] == pytest.approx(6.0, rel=1e-12)
    np.testing.assert_allclose(np.abs(found.pose[0]), [1.0, 2.0])


def test_without_a_box_or_a_load_the_samples_stand():
    probe = two_hills(np.zeros((1, 2)), np.ones(1), np.ones(1))
    poses = np.ones((3, 2))
    assert polish(probe, poses, np.ones((3, 1)), None).value == pytest.approx([1.0])
    assert polish(probe, poses, np.zeros((3, 1)), np.array([[0.0, 1.0]] * 2)).value == pytest.approx([0.0])


@pytest.mark.parametrize("payload", [(), (eq.Payload("fore", (0.0, 3.0), (0.4, 0.0, 0.0)),)])
def test_both_kinds_of_slope_are_that_of_the_magnitude(payload):
    arm = eq.chain([eq.Link("upper", length=0.5, mass=3.0), eq.Link("fore", length=0.4, mass=2.0)])
    sweep = eq.Sweep.sobol(arm, 64, payload=payload)
    spring = eq.Spring("s", eq.Line(arm.at("world", 0.1, 0, 0.4), arm.at("fore", 0.1, 0, 0.05)), eq.Coil(0.1, k=500.0))

    def told(blocks):
        return blocks, lambda states: (blocks, effort(arm, [spring], states).at(np.zeros(0)))

    rows = np.arange(64) % 2
    by_symmetry = steepness(arm, sweep, *told(arm.driven_blocks))(sweep.poses, rows)
    by_differences = steepness(arm, sweep, *told([Block("one", ""), Block("two", "")]))(sweep.poses, rows)
    for one, other in zip(by_symmetry, by_differences, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize(
    ("model", "ends", "ranges"),
    [
        ("ur_description/urdf/ur10_robot.urdf", ("shoulder_link", "forearm_link"),
         {"shoulder_lift_joint": 61, "elbow_joint": 61, "wrist_1_joint": 25}),
        ("so_arm_description/urdf/so101.urdf", ("shoulder_link", "lower_arm_link"),
         {"shoulder_lift": 61, "elbow_flex": 61, "wrist_flex": 25}),
        ("z1_description/urdf/z1.urdf", ("link01", "link03"), {"joint2": 61, "joint3": 61, "joint4": 25}),
    ],
)  # fmt: skip
def test_no_dense_grid_finds_more(model, ends, ranges):
    """The polished peaks of few samples against a grid of 93,025 poses, with a stiff spring that bends the field."""
    arm = eq.Mechanism.load(ROBOTS + model)
    reach = 0.4 * np.linalg.norm(arm.model.body(ends[1]).pos) + 0.05
    load = eq.analyze(arm, eq.Sweep.sobol(arm, 64)).rows
    k = 3 * max(row.sample_peak for row in load.values()) / reach**2
    spring = eq.Spring("s", eq.Line(arm.at(ends[0], reach, 0.3 * reach, -reach), arm.at(ends[1], 0, 0, reach)),
                       eq.Coil(free_length=reach, k=k))  # fmt: skip

    def told(states):
        return arm.driven_blocks, effort(arm, [spring], states).at(np.zeros(0))

    box = dict(zip(arm.driven, arm.box, strict=True))
    dense = eq.Sweep.grid(arm, {joint: (*box[joint], count) for joint, count in ranges.items()})
    top = np.abs(told(arm.states(dense))[1]).max(axis=0)
    few = eq.Sweep.grid(arm, {joint: (*box[joint], 5) for joint in ranges})
    found = table(arm, few, arm.states(few), told)
    for joint, value in zip(arm.driven, top, strict=True):
        assert value <= found[joint].peak * (1 + 1e-9) + 1e-9 * top.max()
        assert found[joint].peak <= value * 1.01 + 1e-9 * top.max()


def test_a_step_over_ground_without_curvature_is_finite():
    """At rounding level a direction may have none: the step is long, and the ascent shortens it."""
    bend = np.array([[[1e-11, 1e-11], [1e-11, 1e-11]], [[0.0, 0.0], [0.0, 0.0]]])
    step = _step(np.full((2, 2), 1e-12), bend, np.ones((2, 2), dtype=bool))
    assert np.isfinite(step).all()
