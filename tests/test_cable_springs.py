"""Springs that keep cables taut: known optima of the equilateral triangle, and limits between the samples."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline as Spline

import equipoise as eq
from equipoise import chunks
from equipoise.assemble import effort
from equipoise.errors import InfeasibleError, InputError
from equipoise.limits import curve

S3 = 3**0.5
CORNERS = ((-0.5, -S3 / 6), (0.5, -S3 / 6), (0.0, S3 / 3))
SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
SMALL = ((-0.1, -0.05), (0.1, -0.05), (0.1, 0.05), (-0.1, 0.05))


def springs(mechanism, law, shared=True):
    cables = mechanism.platform.cables
    return [eq.Spring(f"s{i}", eq.Reel(c), law, like="s0" if shared and i else None) for i, c in enumerate(cables)]


def taut(law, samples=None, points=12, limits=(), t_min=1.0, norm="rms", shared=True):
    mechanism = eq.cable_platform(CORNERS)
    sweep = eq.Sweep.triangle(mechanism, CORNERS, points=points)
    names = ["s0"] if shared else ["s0", "s1", "s2"]
    least = [eq.Force(name, min=t_min, over=(0.0, 1.0), samples=samples) for name in names]
    aim = eq.Aim(goal="wrench", norm=norm)
    return eq.balance(mechanism, springs(mechanism, law, shared), sweep, objective=aim, limits=[*least, *limits])


def integral(design):
    """1/2 int |f_r|^2 dA."""
    return 0.5 * S3 / 4 * design.after["resultant"].rms ** 2


def least(design, over=(0.0, 1.0)):
    """The least tension over an interval, from the roots of its derivative."""
    spring = design.balancers[0]
    pieces = curve.Pieces.of(spring.law, over)
    return pieces.extremes(np.array([design.values[u.name] for u in spring.unknowns]))[1].min()


# Independent 50-digit solutions of both versions of the program.
SAMPLED = {
    1: 0.094411657999,
    2: 0.080279880092,
    4: 0.061774754192,
    5: 0.038920229911,
    8: 0.033474030899,
    10: 0.028469007344,
}
EXACT = {
    1: 0.094411657999,
    2: 0.080279880092,
    4: 0.061861076470,
    5: 0.038931517152,
    8: 0.033490915073,
    10: 0.028535919588,
}
BELOW = {4: 0.999234944, 5: 0.999269036, 8: 0.997846645, 10: 0.996116396}


@pytest.mark.parametrize("k", SAMPLED)
def test_the_triangle_with_10_k_samples(k):
    design = taut(eq.Polynomial((0.0, 1.0), degree=k - 1), samples=10 * k)
    assert integral(design) == pytest.approx(SAMPLED[k], rel=1e-8)
    if k in BELOW:
        assert least(design) == pytest.approx(BELOW[k], abs=1e-8)


@pytest.mark.parametrize("k", EXACT)
def test_the_triangle_at_every_length(k):
    design = taut(eq.Polynomial((0.0, 1.0), degree=k - 1))
    assert integral(design) == pytest.approx(EXACT[k], rel=1e-8)
    assert least(design) >= 1 - 2e-10
    assert design.certificate.kind == "convex"
    assert design.certificate.gap <= 1e-9 * design.certificate.primal
    assert design.certificate.quadrature < 1e-8


def test_coefficients_of_degree_four():
    design = taut(eq.Polynomial((0.0, 1.0), degree=4))
    found = [design.values[f"s0.c{i}"] for i in range(5)]
    assert found == pytest.approx([4.1809018, -0.46982355, -4.1390328, -0.14238365, 3.8140635], abs=2e-5)
    middle, powers = design.balancers[0].law.monomials({f"c{i}": v for i, v in enumerate(found)})
    shifted = np.polynomial.Polynomial(powers)(np.polynomial.Polynomial([-middle, 1.0])).coef
    printed = [4.46813974, -54.095323914, 322.70302657, -536.8165611, 266.98444404]
    assert shifted == pytest.approx(printed, rel=1e-5)


def test_forty_coefficients_solve_cleanly_and_the_quadrature_says_how_fine_it_is():
    design = taut(eq.Polynomial((0.0, 1.0), degree=39), points=40)
    assert integral(design) == pytest.approx(0.020315, abs=2e-6)
    assert design.certificate.gap <= 1e-9
    assert least(design) >= 1 - 2e-10
    assert taut(eq.Polynomial((0.0, 1.0), degree=39), points=12).certificate.quadrature > 1e-3


def test_splines_reach_the_floor_of_all_identical_springs():
    floor = 0.01990344571
    design = taut(eq.BSpline((0.0, 1.0), pieces=63, piece_degree=1), points=64)
    assert integral(design) == pytest.approx(floor, rel=1e-3)
    assert design.certificate.quadrature < 1e-3


def test_tension_scales_and_distinct_springs_do_not_help_in_a_symmetric_robot():
    law = eq.Polynomial((0.0, 1.0), degree=4)
    assert integral(taut(law, t_min=7.0)) == pytest.approx(49 * EXACT[5], rel=1e-8)
    assert integral(taut(law, shared=False)) == pytest.approx(EXACT[5], rel=1e-7)


def test_the_peak_over_the_closed_triangle_is_the_least_tension():
    """At the middle of an edge two cables are in line and the third is normal to them."""
    design = taut(eq.Polynomial((0.0, 1.0), degree=3), points=8, norm="peak")
    assert design.certificate.primal == pytest.approx(1.0, rel=1e-3)


def test_a_cap_on_the_resultant_is_kept():
    mechanism = eq.cable_platform(CORNERS)
    sweep = eq.Sweep.triangle(mechanism, CORNERS, points=8)
    aims = [eq.Aim(goal="wrench"), eq.Aim(goal="wrench", norm="peak", cap=1.4)]
    limits = [eq.Force("s0", min=1.0, over=(0.0, 1.0))]
    free, kept = (
        eq.balance(
            mechanism, springs(mechanism, eq.Polynomial((0.0, 1.0), degree=4)), sweep, objective=o, limits=limits
        )
        for o in (aims[0], aims)
    )
    assert free.after["resultant"].peak > 2.0
    assert kept.after["resultant"].peak <= 1.4 * (1 + 1e-7)
    assert kept.after["resultant"].rms > free.after["resultant"].rms
    assert kept.certificate.gap < 1e-6


LIMITS = {
    "most": (lambda: eq.Force("s0", max=4.0, over=(0.0, 1.0)), lambda v, s, b: v.max() <= 4 * (1 + 1e-8)),
    "rising": (lambda: eq.Slope("s0", (0.0, 1.0), min=0.0), lambda v, s, b: s.min() >= -1e-7),
    "bent": (lambda: eq.Curvature("s0", (0.0, 1.0), 60.0), lambda v, s, b: abs(b).max() <= 60 * (1 + 1e-7)),
    "cam": (lambda: eq.Convex("s0", (0.0, 1.0), radius=0.25), lambda v, s, b: (v + 0.0625 * b).min() >= -1e-7),
}


@pytest.mark.parametrize("kind", ["polynomial", "spline"])
@pytest.mark.parametrize("name", LIMITS)
def test_limits_hold_at_every_length(name, kind):
    law = eq.Polynomial((0.0, 1.0), degree=7) if kind == "polynomial" else eq.BSpline((0.0, 1.0), pieces=6)
    limit, kept = LIMITS[name]
    design = taut(law, points=8, limits=[limit()])
    theta = np.array([design.values[u.name] for u in design.balancers[0].unknowns])
    length = np.linspace(0, 1, 20_001)
    value, slope = (basis @ theta for basis in (law.force_basis(length)[0], law.slope_basis(length)[0]))
    bend = np.gradient(slope, length)[2:-2] if kind == "spline" else np.gradient(slope, length, edge_order=2)
    assert value.min() >= 1 - 1e-8
    inner = value[2:-2] if kind == "spline" else value
    assert kept(inner, slope, bend * (1 - 1e-4) if name == "bent" else bend + (1e-2 if name == "cam" else 0))
    assert integral(design) > integral(taut(law, points=8)) * (1 + 1e-6)


def test_regression_of_a_square_and_of_a_planar_body():
    square = eq.cable_platform(SQUARE)
    sweep = eq.Sweep.polygon(square, SQUARE, points=16)
    aim = eq.Aim(goal="wrench")
    for degree, value in ((1, 0.69664016), (4, 0.38128862), (9, 0.25930456)):
        law = eq.Polynomial((0.0, 2**0.5), degree=degree)
        limit = eq.Force("s0", min=1.0, over=law.interval)
        design = eq.balance(square, springs(square, law), sweep, objective=aim, limits=[limit])
        assert 0.5 * design.after["resultant"].rms ** 2 == pytest.approx(value, rel=3e-5)
        # Four springs on a rectangle can trade: some combinations do nothing, and the answer says so.
    design = eq.balance(
        square,
        springs(square, eq.Polynomial((0.0, 2**0.5), degree=1), shared=False),
        sweep,
        objective=aim,
        limits=[eq.Force(f"s{i}", min=1.0, over=(0.0, 2**0.5)) for i in range(4)],
    )
    assert 0.5 * design.after["resultant"].rms ** 2 == pytest.approx(0.69664016, rel=1e-6)
    assert len(design.certificate.flat) == 1


def test_a_planar_body_with_its_weight():
    planar = eq.cable_platform(SQUARE, SMALL, mass=1.0, length=0.1)
    sweep = eq.Sweep.quadrature(planar, {"x": (0.25, 0.75, 14), "z": (0.25, 0.75, 14), "turn": (-0.3, 0.3, 10)})
    for degree, distinct, shared in ((0, 11.42540144, 48.67529886), (2, 10.27743372, 48.62746185)):
        law = eq.Polynomial((0.1, 1.2), degree=degree)
        for same, value in ((False, distinct), (True, shared)):
            limits = [eq.Force(f"s{i}", min=1.0, over=law.interval) for i in range(1 if same else 4)]
            parts = springs(planar, law, same)
            design = eq.balance(planar, parts, sweep, objective=eq.Aim(goal="wrench"), limits=limits)
            assert 0.5 * design.after["resultant"].rms ** 2 == pytest.approx(value, rel=1e-4)


def test_the_model_with_tendons_and_actuators_pulls_the_same():
    design = taut(eq.Polynomial((0.0, 1.0), degree=4), points=8)
    found = eq.verify(design, poses=200).verification
    assert found.agrees
    assert found.max_abs_error < 1e-10


def test_chunks_sum_to_the_same_term():
    planar = eq.cable_platform(SQUARE, SMALL, mass=1.0, com=(0.01, 0.02), length=0.1)
    rng = np.random.default_rng(3)
    poses = np.array([0.3, 0.3, -0.3]) + rng.random((9000, 3)) * np.array([0.4, 0.4, 0.6])
    states = planar.states(eq.Sweep(poses, rng.random(9000), "random"))
    parts = [*springs(planar, eq.BSpline((0.1, 1.2), pieces=5)), eq.Counterweight("w", eq.Point("platform"), reach=0.1)]
    aim = eq.Aim(goal="wrench")
    whole = effort(planar, parts, states, "wrench")
    theta = rng.standard_normal(len(whole.unknowns))
    plain, summed = aim.term(planar, whole, states.weight), chunks.rms_term(planar, parts, states, aim)
    assert summed.value(theta) == pytest.approx(plain.value(theta), rel=1e-12)
    np.testing.assert_allclose(chunks.residual(planar, parts, states, "wrench", theta), whole.at(theta), atol=1e-10)


@pytest.mark.parametrize("degree", range(6))
def test_splines_are_those_of_scipy(degree):
    law = eq.BSpline((0.1, 1.2), pieces=7, piece_degree=degree)
    x = np.linspace(0.1, 1.2 - 1e-12, 101)
    c = np.random.default_rng(0).random(law.count)
    other = Spline(np.r_[[0.1] * (degree + 1), law.breaks, [1.2] * (degree + 1)], c, degree)
    np.testing.assert_allclose(law.force_basis(x)[0] @ c, other(x), atol=1e-13)
    np.testing.assert_allclose(law.energy_basis(x)[0] @ c, [other.integrate(0.1, v) for v in x], atol=1e-14)
    if degree:
        np.testing.assert_allclose(law.slope_basis(x)[0] @ c, other.derivative()(x), atol=1e-11)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: taut(eq.Constant(), limits=[eq.Force("s0", min=1.0, over=(1.0, 0.0))]), "empty"),
        (lambda: taut(eq.Constant(), limits=[eq.Force("s0", min=5.0, max=2.0, over=(0.0, 1.0))]), "above max"),
        (lambda: eq.Polynomial((0.0, 1.0), degree=-1), "0..60"),
        (lambda: eq.Polynomial((0.0, 1.0), degree=61), "0..60"),
        (lambda: eq.BSpline((0.0, 1.0), pieces=0), "pieces"),
        (lambda: eq.BSpline((0.0, 1.0), knots=(0.5, 0.4)), "increase"),
    ],
)
def test_bad_input_is_named(make, words):
    with pytest.raises(InputError, match=words):
        make()


def test_limits_that_conflict_are_named():
    both = [eq.Force("s0", max=0.9, over=(0.0, 1.0))]
    with pytest.raises(InfeasibleError, match=r"force of s0 over 0 m to 1 m <= 0.9 N and .* conflict"):
        taut(eq.Polynomial((0.0, 1.0), degree=3), points=6, limits=both)


def behind(cable, **changed):
    links = {"ground": 0.1, "crank": 0.14, "coupler": 0.11, "rocker": 0.14, "phase": 0.49} | changed
    return eq.FourBar(eq.Winding(cable, 0.25, 0.1), **links)


def near(mechanism, poses):
    return mechanism.states(eq.Sweep(poses, np.ones(len(poses)), "near"))


@pytest.mark.parametrize("path", [eq.Winding("cable_2", 0.25, 0.1), behind("cable_2"), eq.Reel("cable_2")])
def test_a_path_behind_a_reel_is_exact_in_its_angle_and_its_derivative(path):
    mechanism, h = eq.cable_platform(CORNERS), 1e-6
    poses = np.random.default_rng(1).uniform(-0.15, 0.15, (9, 2))
    length, rate = path.deform(near(mechanism, poses))
    for joint, step in enumerate(np.eye(2) * h):
        ahead, back = (path.deform(near(mechanism, poses + sign * step))[0] for sign in (1, -1))
        np.testing.assert_allclose(rate[:, joint], (ahead - back) / (2 * h), atol=1e-8)
    cable, pull = eq.Reel("cable_2").deform(near(mechanism, poses))
    along, slope = path.along(cable)
    np.testing.assert_allclose(along, length, atol=1e-14)
    np.testing.assert_allclose(slope[:, None] * pull, rate, atol=1e-13)


def test_a_rocker_turns_on_where_the_crank_does():
    whole = np.linspace(-7, 7, 5001)
    drag = behind("c", crank=0.14, ground=0.02, coupler=0.12, rocker=0.12)
    swing = behind("c", crank=0.02, ground=0.14, coupler=0.12, rocker=0.12)
    for path, turns in ((drag, 1.0), (swing, 0.0)):
        angle, slope = path.curve(whole)
        assert np.abs(np.diff(angle)).max() < 0.02
        np.testing.assert_allclose(np.gradient(angle, whole)[1:-1], slope[1:-1], atol=2e-4)
        assert path.curve(2 * np.pi)[0] - path.curve(0.0)[0] == pytest.approx(turns * 2 * np.pi, abs=1e-12)


@pytest.mark.parametrize(
    ("limit", "path", "law", "words"),
    [
        (eq.Tension("s", (0.0, 1.0), min=2.0, max=1.0), behind("cable_1"), eq.Torsion(), "is above max"),
        (eq.Tension("s", (0.5, 0.2), min=1.0), behind("cable_1"), eq.Torsion(), "no range of cable lengths"),
        (eq.Tension("s", (0.0, 1.0), min=1.0), eq.Line(eq.Point("world"), eq.Point("platform")), eq.Linear(), "cable"),
        (eq.Transmission("s"), eq.Reel("cable_1"), eq.Linear(), "no transmission angle"),
        (eq.WindUp("s", 1.0), eq.Reel("cable_1"), eq.Linear(), "not wound up"),
        (eq.WindUp("s", 0.0), behind("cable_1"), eq.Torsion(), "at most 0 rad"),
    ],
)
def test_limits_behind_a_reel_refuse_what_they_cannot_mean(limit, path, law, words):
    mechanism = eq.cable_platform(CORNERS)
    sweep = eq.Sweep.triangle(mechanism, CORNERS, points=3)
    with pytest.raises(InputError, match=words):
        eq.balance(mechanism, [eq.Spring("s", path, law)], sweep, objective=eq.Aim(goal="wrench"), limits=[limit])


def test_one_parameter_may_be_shared_but_not_freed_twice():
    mechanism = eq.cable_platform(CORNERS)
    sweep = eq.Sweep.triangle(mechanism, CORNERS, points=3)
    parts = [eq.Spring(f"s{i}", behind(f"cable_{i + 1}"), eq.Torsion(), like="s0" if i else None) for i in range(3)]
    free = {"s*.path.crank": (0.1, 0.2), "s1.path.crank": (0.1, 0.2)}
    with pytest.raises(InputError, match="free the same parameter"):
        eq.shape(mechanism, parts, sweep, free, objective=eq.Aim(goal="wrench"))
