"""Arakelian & Smith 2008: independent digits of its claims; point masses with other data."""

from __future__ import annotations

import functools
import json

import numpy as np
import pytest

import equipoise as eq
from equipoise.cli import main
from equipoise.papers import paper
from equipoise.papers.arakelian_smith_2008 import model
from test_rrr3 import PINS, manipulator


@functools.cache
def rows():
    return {claim.claim: claim for claim in paper("arakelian-smith-2008").claims()}


@pytest.mark.parametrize(
    ("claim", "ours", "verdict"),
    [
        ("platform's inertia m R^2 / 2", 0.010086, "reproduced"),
        ("X_O3", 0.23, "not reproduced"),
        ("Y_O3", 0.3983717, "reproduced"),
        ("r_1 from the listed corners", 0.0577350, "reproduced with correction"),
        ("l_33 = |A_3 P_3| from the listed points", 0.181067, "reproduced"),
        ("r_2S by Eq. 14", 0.09, "reproduced with correction"),
        ("r_3S by Eq. 13", 0.0692308, "reproduced with correction"),
        ("Table 1 lists a manipulator that assembles at the start of the motion", 6.02, "not reproduced"),
        ("a = (1/3, 4/3, 10/3), b = (1/6, -1/6, 1/12) moves the manipulator", 0.628, "reproduced with correction"),
        ("after force balancing the moment on the frame can be significant", 94.08, "reproduced"),
    ],
)
def test_claims(claim, ours, verdict):
    found = rows()[claim]
    assert found.verdict == verdict
    assert found.ours == pytest.approx(ours, rel=1e-3)


@pytest.mark.parametrize(
    ("claim", "words"),
    [
        ("Eq. 22 gives the flywheel's acceleration", "947.45 rad/s^2, as printed -9.0"),
        ("I_4 by Eq. 18", "0.06214 without it"),
        ("the bearing forces along X add up to nothing", "bare links 66"),
        ("a flywheel is constructively more efficient", "533 W"),
        ("angular accelerations of the links", "-20.1960, 27.0380, -60.7389; 78.7933, 12.0236, 36.3327"),
        ("speed and angle follow by integration", "9.46175 rad"),
    ],
)
def test_notes_give_our_numbers(claim, words):
    assert words in rows()[claim].note


# Largest force, moment and input torques of the mass data (computed independently, 601 samples; ours are 301).
CASES = {
    "SLENDER": (70.298, 10.691, (5.90, 7.72, 7.16)),
    "LITERAL": (243.96, 48.49, (16.9, 18.6, 15.2)),
    "TABLE": (0.33664, 10.095, (18.3, 19.2, 9.1)),
    "EXACT": (0.0, 10.058, (18.2, 19.2, 9.1)),
    "AS_PRINTED": (0.33664, 0.08528, (38.0, 40.1, 19.0)),
    "COUNTER_ROTATED": (0.0, 0.0, (37.9, 40.0, 19.0)),
    "WHEEL": (0.0, 9.978, (18.0, 19.6, 9.1)),
}


@pytest.mark.parametrize("case", CASES)
def test_mass_data(case):
    force, moment, torques = CASES[case]
    masses = getattr(model, case)
    found = model.base(masses)
    assert model.largest(found[0]) == pytest.approx(force, rel=3e-4, abs=1e-12)
    assert model.largest(found[1]) == pytest.approx(moment, rel=3e-4, abs=1e-12)
    np.testing.assert_allclose(np.abs(model.torques(masses)).max(axis=0), torques, atol=0.11)


def test_the_flywheel_keeps_its_motor():
    moment, spin = model.base(model.WHEEL)[1], model.held(model.WHEEL)[1]
    both = np.outer(moment, model.NORMAL), np.outer(spin, model.NORMAL)
    law = model.law()
    for limits in ({"speed": 100.0}, {"power": 300.0}, {"speed": 50.0, "power": 300.0}):
        found = eq.Flywheel("w", **limits).law(model.time(), *both)
        assert np.abs(found.speed).max() <= limits.get("speed", np.inf) * (1 + 1e-12)
        assert np.abs(found.power).max() <= limits.get("power", np.inf) * (1 + 1e-12)
        reached = [
            np.abs(found.speed).max() / limits.get("speed", np.inf),
            np.abs(found.power).max() / limits.get("power", np.inf),
        ]
        assert max(reached) == pytest.approx(1.0, rel=1e-3)
    assert model.largest(law.power) == pytest.approx(533.4, abs=0.1)


@pytest.mark.parametrize("points", [3, 4, 5, 7])
def test_point_masses_in_the_plane(points):
    rng = np.random.default_rng(points)
    angle = np.linspace(0, 2 * np.pi, points, endpoint=False) + rng.uniform(-0.2, 0.2, points)
    r = np.column_stack([np.cos(angle), np.sin(angle)]) * rng.uniform(0.05, 0.08, points)[:, None]
    true = rng.uniform(0.5, 1.5, points)
    com = true @ r / true.sum()
    polar = float(true @ ((r - com) ** 2).sum(axis=1))
    found = eq.point_masses(true.sum(), r, com=com, inertia=polar)
    assert (found.masses >= 0).all()
    assert found.masses.sum() == pytest.approx(true.sum())
    np.testing.assert_allclose(found.masses @ r, true @ r, atol=1e-12)
    assert found.masses @ ((r - com) ** 2).sum(axis=1) == pytest.approx(polar)


def test_point_masses_in_space():
    rng = np.random.default_rng(2)
    r, true = rng.uniform(-0.1, 0.1, (12, 3)), rng.uniform(0.2, 1.0, 12)
    com = true @ r / true.sum()
    S = np.einsum("n,ni,nj->ij", true, r - com, r - com)
    found = eq.point_masses(true.sum(), r, com=com, inertia=np.trace(S) * np.eye(3) - S)
    np.testing.assert_allclose(np.einsum("n,ni,nj->ij", found.masses, r - com, r - com), S, atol=1e-12)
    assert (found.masses >= 0).all()


def test_a_body_is_substituted_on_the_command_line(capsys, tmp_path):
    """The links and a plate of a four-bar: masses on stdout, exit code 1 with what would mend it, 2 for bad input."""
    (tmp_path / "bar.yaml").write_text(
        "mechanism: {four_bar: {ground: 300 mm, crank: 80 mm, coupler: 320 mm, rocker: 200 mm, masses: [1, 2, 3]}}\n"
        "limits: [{mass: nothing, max: 1}]\n"  # what else stands in the file need not fit
    )
    name = str(tmp_path / "bar.yaml")
    assert main(["substitute", name, "coupler", "--kind", "static", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["masses"] == pytest.approx([1.0, 1.0])
    assert found["left"] == pytest.approx(2 * 0.32**2 / 12 - 2 * 0.16**2)
    # a rod is 1/6, 4/6, 1/6 of its mass at its ends and middle
    points = [arg for at in ("0", "160 mm", "0.32") for arg in ("--point", f"{at}, 0, 0")]
    assert main(["substitute", name, "coupler", "--json", *points]) == 0
    assert json.loads(capsys.readouterr().out)["masses"] == pytest.approx([1 / 3, 4 / 3, 1 / 3])
    assert main(["substitute", name, "coupler"]) == 1
    assert "or add a ring of" in capsys.readouterr().err
    for extra, words in (
        (["--kind", "some"], "there is no substitution 'some'"),
        (["--point", "1, 2"], "a point has three coordinates"),
        (["--point", "1 kg, 0, 0"], "expected a quantity in m"),
    ):
        assert main(["substitute", name, "coupler", *extra]) == 2
        assert words in capsys.readouterr().err


def test_a_platform_is_substituted_at_its_pins():
    found = eq.substitute(manipulator(), "platform")
    np.testing.assert_allclose(found.masses, 1.0, rtol=1e-9)
    lacking = eq.substitute(manipulator(platform_inertia=0.015), "platform", "static")
    assert lacking.left == pytest.approx(0.005, rel=1e-6)


@pytest.mark.parametrize(
    ("inertia", "com", "words"),
    [
        (0.015, (0, 0), r"1.225 times their distance from the centre \(70.71 mm\), or let a counter-rotor"),
        (0.005, (0, 0), r"0.7071 times their distance .* \(40.82 mm\), or add a ring of 0.005 kg m\^2"),
        (0.01, (0.06, 0.06), "53.09 mm outside the points"),
    ],
)
def test_what_would_mend_an_impossible_substitution(inertia, com, words):
    with pytest.raises(eq.InfeasibleError, match=words):
        eq.point_masses(3.0, PINS, com=com, inertia=inertia)
    with pytest.raises(eq.InputError):
        eq.point_masses(-1.0, PINS)
