"""Branch and bound: a bound that no geometry beats, checked by brute force and on functions with known answers."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

import equipoise as eq
from equipoise.cli import main
from equipoise.problem import load_problem
from equipoise.solve.jets import Jet

EXAMPLES = Path(__file__).parents[1] / "examples"
G = 9.81
PHI = np.radians(np.linspace(120, 180, 13))


def link_rms(k, x, z, r, phi=PHI, norm="rms"):
    """The spring-mass link by hand: weight, half the spring's own, and the coil of 300 mm."""
    k, x, z, r = (np.asarray(v, dtype=float)[..., None] for v in (k, x, z, r))
    mass = np.pi * 7800 * 8.0 * np.sqrt(0.04**3 * 80 * k / (2 * 81e9))
    length = np.hypot(r * np.sin(phi) - x, r * np.cos(phi) - z)
    slope = (x * -np.cos(phi) + z * np.sin(phi)) * r / length
    left = -(8 * 0.183 + 0.5 * mass * r) * G * np.sin(phi) + k * (length - 0.3) * slope
    left = np.where((length >= 0.3).all(axis=-1, keepdims=True), left, np.inf)
    return np.sqrt((left**2).mean(axis=-1)) if norm == "rms" else np.abs(left).max(axis=-1)


def problem(names):
    found = load_problem(EXAMPLES / "bracket_link.yaml")
    free = {name: bounds for name, bounds in found.bounds.items() if name in names}
    return found, free


K, X, Z, R = "s.law.k", "s.path.line.0.x", "s.path.line.0.z", "s.path.line.1.x"


def test_the_spring_mass_link_over_all_four():
    found, free = problem((K, X, Z, R))
    design = eq.shape(found.mechanism, found.balancers, found.sweep, free, norm="rms", starts=4)
    value = design.certificate.primal
    at = [design.geometry[name] for name in (K, X, Z, R)]
    assert link_rms(*at) == pytest.approx(value, rel=1e-9)
    seen = []
    certified, bracket = eq.certify(design, progress=lambda *state: seen.append(state))
    assert certified.certificate.kind == "bracketed"
    assert not bracket.stopped
    assert 0.989 * value <= certified.certificate.dual <= value
    # The bound rises and holds all the way, so it may be stopped at any time.
    lows = [low for _, low, _ in seen]
    assert all(low <= value for low in lows)
    assert lows == sorted(lows)
    # Nothing of 200 000 random geometries is below it.
    rng = np.random.default_rng(4)
    low, high = np.array([free[name] for name in (K, X, Z, R)]).T
    many = low + rng.random((200_000, 4)) * (high - low)
    assert link_rms(*many.T).min() > certified.certificate.dual
    near = np.clip(np.array(at) * (1 + 0.02 * rng.standard_normal((50_000, 4))), low, high)
    assert link_rms(*near.T).min() > certified.certificate.dual
    assert "no geometry within the bounds leaves less than" in str(certified)


@pytest.mark.parametrize("norm", ["rms", "peak", "mean"])
def test_two_parameters_against_a_fine_grid(norm):
    found, free = problem((K, X))
    design = eq.shape(found.mechanism, found.balancers, found.sweep, free, norm=norm, starts=3)
    certified, bracket = eq.certify(design, share=0.02)
    assert bracket.gap <= 0.02 + 1e-9
    if norm != "mean":
        k, x = np.meshgrid(np.linspace(100, 3000, 600), np.linspace(-0.15, 0.15, 400))
        best = link_rms(k, x, np.full_like(k, 0.16), np.full_like(k, 0.3), norm=norm).min()
        assert certified.certificate.dual <= best * (1 + 1e-12)
        assert best <= certified.certificate.primal * 1.05


def test_an_unknown_rate_is_bounded_too():
    """theta is no geometry: k of a weightless coil is found by the program, its hook is free."""
    found, free = problem((X, Z))
    law = dataclasses.replace(found.balancers[0].law, k=None)
    spring = dataclasses.replace(found.balancers[0], law=law, mass=0.0)
    design = eq.shape(found.mechanism, [spring], found.sweep, free, norm="rms", starts=3)
    certified, bracket = eq.certify(design)
    assert bracket.gap <= 0.01 + 1e-9
    x, z = np.meshgrid(np.linspace(-0.15, 0.15, 200), np.linspace(0.05, 0.3, 200))
    r = 0.3
    length = np.hypot(r * np.sin(PHI) - x[..., None], r * np.cos(PHI) - z[..., None])
    lever = (length - 0.3) * (-x[..., None] * np.cos(PHI) + z[..., None] * np.sin(PHI)) * r / length
    load = -8 * 0.183 * G * np.sin(PHI)
    k = np.maximum(-(lever * load).sum(-1) / (lever**2).sum(-1), 0.0)[..., None]
    best = np.sqrt(((load + k * lever) ** 2).mean(-1)).min()
    assert certified.certificate.dual <= best
    assert best <= certified.certificate.primal * 1.01


def test_a_search_cut_short_still_bounds():
    found, free = problem((K, X, Z))
    design = eq.shape(found.mechanism, found.balancers, found.sweep, free, norm="rms", starts=3)
    certified, _ = eq.certify(design, most=900)
    assert 0.0 <= certified.certificate.dual <= certified.certificate.primal

    def stop(boxes, low, high):
        raise KeyboardInterrupt

    stopped, cut = eq.certify(design, progress=stop)
    assert cut.stopped
    assert 0.0 <= stopped.certificate.dual <= certified.certificate.dual + 1e-12


def test_yokes_and_rods_are_bounded():
    arm = eq.chain([eq.Link("arm", length=0.5, mass=3.0)], datum="up")
    sweep = eq.Sweep.grid(arm, {"arm_joint": (0.3, 2.6, 15)})
    rod = eq.Spring("s", eq.InvertedSliderCrank(eq.Angle("arm_joint"), 0.06, 0.15, rod=0.3), eq.Coil(0.25))
    free = {"s.path.crank": (0.04, 0.09), "s.path.phase": (-0.3, 0.3)}
    design = eq.shape(arm, [rod], sweep, free, norm="rms", starts=3)
    certified, bracket = eq.certify(design, share=0.02)
    assert certified.certificate.kind == "bracketed"
    assert bracket.gap <= 0.02 + 1e-9
    yoke = eq.Spring("s", eq.ScotchYoke(eq.Angle("arm_joint"), -0.06, phase=1.3), eq.Linear(k=300.0))
    design = eq.shape(arm, [yoke], sweep, {"s.path.phase": (0.5, 1.4)}, norm="peak", starts=3)
    assert eq.certify(design, share=0.02)[1].gap <= 0.02 + 1e-9


def test_jets_enclose_values_and_slopes():
    """Random expressions over random boxes: values and derivatives lie within."""
    rng = np.random.default_rng(0)
    low = rng.uniform(0.2, 1.0, (40, 2))
    high = low + rng.uniform(0.0, 0.5, (40, 2))
    a, b = (Jet.variable(i, low[:, i], high[:, i], 2) for i in range(2))
    numbers = rng.uniform(-2, 2, 3)
    cases = {
        "product": (a * b - b * 0.5, lambda x, y: x * y - y * 0.5),
        "root": ((a.square() + b * numbers**2).sqrt(), lambda x, y: np.sqrt(x * x + y * numbers**2)),
        "waves": ((a + numbers).sin() * b.cos(), lambda x, y: np.sin(x + numbers) * np.cos(y)),
        "quotient": ((1.0 - a) / (b + 1.0), lambda x, y: (1 - x) / (y + 1)),
    }
    for name, (jet, plain) in cases.items():
        for _ in range(20):
            x, y = (low[:, i] + rng.random(40) * (high[:, i] - low[:, i]) for i in range(2))
            x, y = x[:, None], y[:, None]
            value = np.broadcast_to(plain(x, y), (40, jet.low.shape[-1]))
            slopes = (plain(x + 1e-30j, y).imag / 1e-30, plain(x, y + 1e-30j).imag / 1e-30)
            for bound, what in zip((0, 1, 2), (value, *slopes), strict=True):
                assert (jet.low[bound] <= what + 1e-12).all(), name
                assert (what <= jet.high[bound] + 1e-12).all(), name


def test_the_command(tmp_path, capsys):
    text = (EXAMPLES / "bracket_link.yaml").read_text(encoding="utf-8")
    text = text.replace("  s.path.line.0.z: [50 mm, 300 mm]\n  s.path.line.1.x: [100 mm, 350 mm]\n", "")
    file = tmp_path / "link.yaml"
    file.write_text(text, encoding="utf-8")
    assert main(["shape", str(file), "--certify", "--json", "--starts", "3"]) == 0
    data = json.loads(capsys.readouterr().out)["certificate"]
    assert data["kind"] == "bracketed"
    assert data["boxes"] > 1
    assert 0.985 * data["primal"] < data["dual"] <= data["primal"]
    more = "".join(f"  s.path.line.{place}: [0.1, 0.2]\n" for place in ("0.z", "1.x", "1.y"))
    five = text.replace("shape:\n", f"shape:\n{more}")
    file.write_text(five, encoding="utf-8")
    assert main(["shape", str(file), "--certify", "--starts", "1"]) == 2
    assert "5 geometry parameters are free" in capsys.readouterr().err


def test_what_has_no_bound_says_so():
    arm = eq.chain([eq.Link("arm", length=0.5, mass=3.0)], datum="up")
    sweep = eq.Sweep.grid(arm, {"arm_joint": (0.3, 2.6, 15)})
    spring = eq.Spring("s", eq.SliderCrank(eq.Angle("arm_joint"), 0.1, 0.4), eq.Coil(0.5))
    design = eq.shape(arm, [spring], sweep, {"s.path.crank": (0.05, 0.15)}, norm="rms", starts=2)
    with pytest.raises(eq.InputError, match="no bound over geometry for path slider_crank"):
        eq.certify(design)
