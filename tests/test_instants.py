"""Motions of many instants: closed by relays, moved by one pass of kinematics, peaks found between them."""

from __future__ import annotations

import numpy as np
import pytest

import equipoise as eq
from equipoise.instants import between
from equipoise.kinematics import in_motion, kinematics
from equipoise.loops import loop_report

UR10 = "package://example-robot-data/robots/ur_description/urdf/ur10_robot.urdf"


def machines():
    bar = eq.four_bar(0.3, 0.08, 0.32, 0.2, masses=(0.5, 2.0, 1.0))
    yield bar, {"crank_joint": "2*pi*t/T"}, 0.4
    delta = eq.delta(0.2, 0.05, 0.2, 0.4, arm_mass=0.3, forearm_mass=0.2, platform_mass=0.1)
    yield delta, {f"arm_{i}_joint": f"0.3*sin(2*pi*t/T + {i})" for i in (1, 2, 3)}, 0.3


@pytest.mark.parametrize(("mechanism", "drivers", "duration"), list(machines()))
def test_many_instants_are_the_few_ones_again(mechanism, drivers, duration):
    """Instants closed from the knots and 3,000 closed by relays: the same postures, slopes and accelerations."""
    many = eq.Sweep.motion(mechanism, drivers, duration=duration, samples=3000)
    some = np.array([0, 1, 7, 8, 513, 1511, 2998, 2999])
    few = many.at(many.coordinates[some])
    all_of_them, alone = mechanism.states(many), mechanism.states(few)
    gap, _ = loop_report(mechanism, all_of_them.kin.q)
    assert gap.max() < 1e-14
    np.testing.assert_allclose(all_of_them.kin.q[some], alone.kin.q, atol=1e-13)
    np.testing.assert_allclose(all_of_them.D[some], alone.D, rtol=0, atol=1e-12)
    fast = np.abs(alone.moving.acceleration).max()
    np.testing.assert_allclose(all_of_them.moving.acceleration[some], alone.moving.acceleration, atol=1e-12 * fast)


def test_uneven_instants_are_closed_too():
    """Relays that stand close together here and far apart there still lead to closed loops."""
    (mechanism, drivers, duration), *_ = machines()
    even = eq.Sweep.motion(mechanism, drivers, duration=duration, samples=3)
    time = np.sort(np.r_[np.linspace(0.0, 0.01, 600), np.linspace(0.3, 0.4, 30)])
    states = mechanism.states(even.at(time[:, None]))
    assert loop_report(mechanism, states.kin.q)[0].max() < 1e-13
    np.testing.assert_allclose(states.driven[:, 0], 2 * np.pi * time / duration)


def test_weights_in_motion_are_the_bias_at_rest():
    """One pass at speed tells the gravity that a pass at rest tells, of a tree and of a loop."""
    arm = eq.Mechanism.load(UR10)
    random = np.random.default_rng(1)
    q = random.uniform(-1.0, 1.0, (20, 6))
    v, a = random.normal(size=(2, 20, 6))
    kin, moving = in_motion(arm, q, np.eye(6)[None], (v, a))
    np.testing.assert_allclose(kin.bias, kinematics(arm, q).bias, atol=1e-12)
    np.testing.assert_array_equal(moving.acceleration, a)


def test_peaks_between_coarse_instants():
    """Ten instants of a pendulum's swing: the peaks of force and torque are those of a thousand times as many."""
    rod = eq.chain([eq.Link("rod", length=0.5, mass=1.0)])
    drivers = {"rod_joint": "0.4 + 0.7*sin(2*pi*t/T) + 0.1*cos(6*pi*t/T)"}
    coarse, fine = (eq.Sweep.motion(rod, drivers, duration=1.0, samples=n) for n in (24, 40_001))
    tables = [eq.analyze(rod, sweep).rows for sweep in (coarse, fine)]
    for name, row in tables[0].items():
        assert row.peak == pytest.approx(tables[1][name].peak, rel=1e-9), name
        assert row.peak >= row.sample_peak


def test_only_hills_that_may_be_the_highest_are_searched():
    """Of 1,000 instants with forty equal hills a few states are computed, and the peak is found."""
    rod = eq.chain([eq.Link("rod", length=0.5, mass=1.0)])
    sweep = eq.Sweep.motion(rod, {"rod_joint": "t"}, duration=1.0, samples=1000)
    seen = []

    def account(states):
        seen.append(len(states))
        t = states.driven[:, 0]
        return np.stack([np.abs(np.sin(40 * np.pi * t)) * (1 + 1e-3 * t), 1.0 + 0.0 * t], axis=1)

    peaks = between(rod, sweep, account(rod.states(sweep)), account)
    assert peaks[0] == pytest.approx(1 + 1e-3 * (39.5 / 40), abs=1e-9)
    assert peaks[1] == 1.0
    assert len(seen) == 4
    assert max(seen[1:]) <= 12 * 9


def test_a_payload_counts_in_the_wrench_of_its_body():
    """A kilogram at the end of a turning rod asks for m omega^2 l beside what the rod asks for."""
    rod = eq.chain([eq.Link("rod", length=0.5, mass=1.0)], gravity=(0, 0, 0))
    payload = [eq.Payload("rod", 2.0, at=(0.5, 0.0, 0.0))]
    laden = eq.Sweep.motion(rod, {"rod_joint": "3*t"}, duration=1.0, samples=9, payload=payload)
    force = rod.effort(rod.states(laden), "force").b
    np.testing.assert_allclose(np.linalg.norm(force, axis=1), 9.0 * (0.25 + 2.0 * 0.5), rtol=1e-12)
