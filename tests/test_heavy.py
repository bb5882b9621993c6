"""Springs with mass: closed forms against `shape`, the printed numbers and other ways to lump the mass."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import equipoise as eq
from equipoise.balancers.heavy import heavy

SHORT = eq.WireMass(diameter=0.04, coils=80, wire_length=8.0)
LONG = eq.WireMass(diameter=0.04, coils=80, wire_length=10.38)
ORTHOSIS = (eq.WireMass(0.04, 66, 8.6), eq.WireMass(0.04, 62, 7.8))
LEG = 4.08 + 7.39 * 0.41


@pytest.fixture(scope="module")
def arm():
    return eq.chain([eq.Link("link", length=0.3, mass=8.0, com=0.183)], datum="up")


def spring(law, **changed):
    return eq.Spring("s", eq.Line(eq.Point("world", (0, 0, 0.16)), eq.Point("link", (0.3, 0, 0))), law, **changed)


def degrees(arm, count=61):
    return eq.Sweep.grid(arm, {"link_joint": (np.radians(120), np.radians(180), count)})


def test_zero_free_length_has_a_quadratic(arm):
    k = eq.exact_rate_zero_free_length(8 * 0.183 / 0.3, 0.16, LONG)
    assert k == pytest.approx(324.164, abs=1e-3)
    assert LONG.of(k) == pytest.approx(0.814144, abs=1e-6)
    assert eq.exact_rate(arm, [spring(eq.ZeroFreeLength(), mass=LONG)], degrees(arm)) == pytest.approx(k, rel=1e-12)
    held = eq.balance(arm, [spring(eq.ZeroFreeLength(k), mass=LONG)], degrees(arm))
    assert held.after["link_joint"].peak < 1e-12


def test_both_springs_of_the_orthosis_share_the_quadratic():
    assert eq.exact_rate_zero_free_length(LEG, 0.147345, ORTHOSIS) == pytest.approx(522.0, abs=2e-3)
    assert eq.exact_rate_zero_free_length(LEG, 0.15, ORTHOSIS) == pytest.approx(512.314, abs=1e-3)
    light = [replace(wire, density=0.0) for wire in ORTHOSIS]
    assert eq.exact_rate_zero_free_length(LEG, 0.133617, light) == pytest.approx(522.0, abs=2e-3)


@pytest.mark.parametrize(("count", "k"), [(13, 1131.07), (61, 1119.14), (6001, 1116.17)])
def test_other_free_lengths_have_the_corrected_cubic(arm, count, k):
    coil = spring(eq.Coil(free_length=0.3), mass=SHORT)
    rows = heavy(arm, [coil], degrees(arm, count))
    found = eq.exact_rate(arm, [coil], degrees(arm, count))
    assert found == pytest.approx(k, abs=6e-3)
    assert rows.rms(found) < min(rows.rms(found * (1 + s)) for s in (-1e-4, 1e-4))
    if count == 13:
        assert rows.cubic() == pytest.approx((-5.41106, -1003.69, 1836.43), rel=1e-5)


def test_the_cubic_agrees_with_shape_where_several_joints_count():
    arm = eq.chain([eq.Link("upper", length=0.4, mass=3.0), eq.Link("fore", length=0.3, mass=2.0)])
    over = eq.Sweep.grid(arm, {"upper_joint": (-0.5, 1.0, 9), "fore_joint": (0.1, 1.5, 7)})
    path = eq.Line(eq.Point("world", (-0.1, 0, 0.3)), eq.Point("upper", (0.25, 0, 0.02)))
    heavy_coil = eq.Spring("s", path, eq.Coil(free_length=0.15), mass=SHORT, mass_at=0.4)
    k = eq.exact_rate(arm, [heavy_coil], over)
    given = replace(heavy_coil, law=replace(heavy_coil.law, k=500.0))
    design = eq.shape(arm, [given], over, {"s.law.k": (50.0, 5000.0)}, norm="rms", starts=2)
    assert design.geometry["s.law.k"] == pytest.approx(k, rel=1e-6)


def test_turns_reach_the_exact_rate_only_where_nothing_is_left(arm):
    free, coil = spring(eq.ZeroFreeLength(), mass=LONG), spring(eq.Coil(free_length=0.3), mass=SHORT)
    turns = eq.iterated_rates(arm, [free], degrees(arm))
    assert turns[0] == pytest.approx(299.205, abs=1e-3)
    assert turns[-1] == pytest.approx(324.164, abs=1e-3)
    turns, exact = eq.iterated_rates(arm, [coil], degrees(arm)), eq.exact_rate(arm, [coil], degrees(arm))
    assert turns[0] == pytest.approx(1000.097, abs=1e-3)
    rows = heavy(arm, [coil], degrees(arm))
    assert turns[-1] == pytest.approx(1119.588, abs=1e-3)
    assert rows.rms(exact) < rows.rms(turns[-1])


@pytest.mark.parametrize("mass_at", [0.0, 0.3, 0.5, 1.0])
def test_the_centre_of_mass_may_lie_anywhere_on_the_spring(arm, mass_at):
    """The weight of a straight rod of that centre: potential energy m g (p_a + f (p_b - p_a))."""
    states = arm.states(degrees(arm))
    lumped = spring(eq.Constant(0.0), mass=1.3, mass_at=mass_at)
    energy = lumped.effort(states, "energy").b[:, 0]
    high = 0.16 + mass_at * (0.3 * np.cos(states.driven[:, 0]) - 0.16)
    np.testing.assert_allclose(energy, 1.3 * 9.81 * high, rtol=1e-12)
    design = eq.verify(eq.balance(arm, [replace(lumped, law=eq.Linear())], degrees(arm)), poses=200)
    assert design.verification.agrees


def test_a_spring_that_pushes_weighs_as_much(arm):
    assert SHORT.of(-500.0) == SHORT.of(500.0)
    pair = [spring(eq.ZeroFreeLength(), mass=LONG), replace(spring(eq.ZeroFreeLength(-1.0), mass=LONG), name="t")]
    rows = heavy(arm, pair, degrees(arm))
    np.testing.assert_allclose(rows.pull, 0.0, atol=1e-15)
    assert np.abs(rows.sag).max() > 0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda arm: eq.exact_rate(arm, [spring(eq.Coil(0.3), mass=1.0)], degrees(arm)), "no rate with a wire mass"),
        (lambda arm: eq.exact_rate(arm, [spring(eq.Constant(), mass=SHORT)], degrees(arm)), "no rate with a wire mass"),
        (lambda arm: eq.exact_rate(arm, [spring(eq.Linear(), mass=SHORT)], degrees(arm)), "s.preload must be given"),
        (lambda arm: eq.exact_rate_zero_free_length(0.0, 0.16, SHORT), "the mass is 0"),
        (lambda arm: eq.exact_rate_zero_free_length(5.0, -0.16, SHORT), "the height is -0.16"),
        (lambda arm: eq.balance(arm, [spring(eq.Linear(), mass=1.0, mass_at=1.2)], degrees(arm)), "mass_at is 1.2"),
    ],
)
def test_refusals(arm, make, message):
    with pytest.raises(eq.InputError, match=message):
        make(arm)
