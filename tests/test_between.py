"""Limits on geometry alone at poses that are found between the samples."""

from __future__ import annotations

import numpy as np
import pytest

import equipoise as eq


@pytest.fixture(scope="module")
def arm():
    return eq.chain([eq.Link("arm", length=0.5, mass=3.0)])


@pytest.fixture(scope="module")
def over(arm):
    # The gravity torque is largest where the range ends, which a Sobol sequence does not reach.
    return eq.Sweep.sobol(arm, 16, ranges={"arm_joint": (-1.2, 0.0)})


@pytest.fixture(scope="module")
def spring(arm):
    return eq.Spring("s1", eq.Line(arm.at("world", 0, 0, 0.2), arm.at("arm", 0.2, 0, 0)), eq.ZeroFreeLength())


WEAK = eq.Force("s1", max=20.0)
"""Keeps the spring from balancing the arm exactly, which would leave nothing to look for between the samples."""


def test_a_limit_that_breaks_between_the_samples_is_the_verdict_of_balance(arm, over, spring):
    lengths, _ = spring.deform(arm.states(over))
    kept = eq.Length("s1", min=float(lengths.min()) - 1e-3)
    with pytest.raises(eq.InfeasibleError, match=r"length of s1 .* exceeds it by .* at poses between the samples"):
        eq.balance(arm, [spring], over, norm="peak", limits=[WEAK, kept])


def test_shape_goes_on_to_a_geometry_that_keeps_it(arm, over, spring):
    kept = eq.Stroke("s1", max=0.12)
    free = {"s1.path.line.0.z": (0.05, 0.4)}
    found = eq.shape(arm, [spring], over, free, norm="peak", limits=[WEAK, kept], starts=3)
    lengths, _ = found.balancers[0].deform(found.states)
    assert found.refined
    assert np.ptp(lengths) <= 0.12 * (1 + 1e-6)
    assert found.after["arm_joint"].peak == pytest.approx(found.after["arm_joint"].sample_peak, rel=1e-6)


def test_what_is_let_be_is_said(arm, over, spring):
    lengths, _ = spring.deform(arm.states(over))
    kept = eq.Length("s1", max=float(lengths.max()) * (1 - 4e-7))
    found = eq.balance(arm, [spring], over, norm="rms", limits=[WEAK, kept])
    assert found.certificate.violation == pytest.approx(4e-7, rel=1e-3)
