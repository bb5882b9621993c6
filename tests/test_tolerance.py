"""What scatter makes of a design: slopes against the real thing, bands against what is known exactly."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from statistics import NormalDist

import numpy as np
import pytest

import equipoise as eq
from equipoise.assemble import effort
from equipoise.cli import main
from equipoise.reporting.tolerance import tolerance_words
from equipoise.scattering.band import _Specimen
from equipoise.scattering.sources import sources

NOTHING = dict.fromkeys(vars(eq.Scatter()), 0.0)


def arm(mass: float = 3.0, gravity: tuple[float, float, float] = (0, 0, -9.81)) -> eq.Mechanism:
    return eq.chain([eq.Link("upper", length=0.4, mass=mass), eq.Link("fore", length=0.35, mass=2.0)], gravity=gravity)


def sweep(mechanism: eq.Mechanism, payload: float = 1.5) -> eq.Sweep:
    ranges = {"upper_joint": (-1.0, 1.2), "fore_joint": (-2.0, 2.0)}
    load = eq.Payload("fore", (payload,), (0.35, 0, 0))
    return eq.Sweep.sobol(mechanism, 64, ranges=ranges, payload=[load])


def parts(rest: float = 0.05, x: float = -0.03) -> tuple:
    coil = eq.Coil(free_length=rest, k=900.0, initial_tension=4.0)
    gas = eq.Gas(area=3e-4, volume=4e-4, length=0.2, pressure=20e5, action="pull")
    return (
        eq.Spring("coil", eq.Line(eq.Point("world", (x, 0, 0.15)), eq.Point("upper", (0.2, 0, 0.02))), coil, mass=0.3),
        eq.Spring("gas", eq.Line(eq.Point("upper", (0, 0, 0.1)), eq.Point("fore", (0.15, 0, 0))), gas),
        eq.Counterweight("tail", eq.Point("upper", (-0.1, 0, 0)), mass=1.2),
    )


def residual(mechanism, balancers, over) -> np.ndarray:
    total = effort(mechanism, balancers, mechanism.states(over))
    assert not total.unknowns
    return total.b


@pytest.fixture(scope="module")
def found():
    mechanism = arm()
    over = sweep(mechanism)
    listed = sources(mechanism, parts(), over, mechanism.states(over), "hold", {}, eq.Scatter())
    return {source.name: source for source in listed}


STEP = 1e-5


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("coil's rest length", lambda h: (arm(), parts(rest=0.05 + h), 1.5)),
        ("coil.path.line.0.x", lambda h: (arm(), parts(x=-0.03 + h), 1.5)),
        ("mass of upper", lambda h: (arm(mass=3.0 * (1 + h)), parts(), 1.5)),
        ("payload", lambda h: (arm(), parts(), 1.5 * (1 + h))),
        ("tilt of the base", lambda h: (arm(gravity=(9.81 * np.sin(h), 0, -9.81 * np.cos(h))), parts(), 1.5)),
    ],
)
def test_slopes_are_those_of_the_real_thing(found, name, change):
    def at(step: float) -> np.ndarray:
        mechanism, balancers, load = change(step)
        return residual(mechanism, balancers, sweep(mechanism, load))

    slope = (at(STEP) - at(-STEP)) / (2 * STEP)
    both = [found[name].slope] if "tilt" not in name else [s.slope for n, s in found.items() if n.startswith("tilt")]
    error = min(np.abs(sign * one - slope).max() for one in both for sign in (1, -1))
    assert error < 1e-6 * np.abs(slope).max()


def test_a_rate_scales_what_the_spring_pulls_and_warmth_adds_up(found):
    mechanism = arm()
    over = sweep(mechanism)
    states = mechanism.states(over)
    coil, gas, tail = parts()
    bare = residual(mechanism, [], over)
    weightless = residual(mechanism, [replace(coil, mass=0.0)], over) - bare
    np.testing.assert_allclose(found["coil's rate"].slope, weightless, atol=1e-12)
    np.testing.assert_allclose(found["tail's mass"].slope, residual(mechanism, [tail], over) - bare, atol=1e-12)
    length, rate = gas.path.deform(states)
    # Gay-Lussac at constant volume: dP/dT = P/T.
    pressure = gas.law.pressures(length, {})
    warmer = pressure / gas.law.temperature * gas.law.area
    expected = warmer[:, None] * rate - 2.5e-4 * weightless
    np.testing.assert_allclose(found["temperature"].slope, expected, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("norm", ["rms", "peak", "mean"])
def test_one_error_of_an_exact_balance_is_known_exactly(norm):
    """r = e F: the 95 % value of |e| is that of a half-normal, and the rate takes all of it back."""
    mechanism = eq.chain([eq.Link("arm", length=0.5, mass=2.0)])
    over = eq.Sweep.grid(mechanism, {"arm_joint": (-1.5, 1.5, 31)})
    spring = eq.Spring("s", eq.Line(eq.Point("world", (0, 0, 0.2)), eq.Point("arm", (0.1, 0, 0))), eq.ZeroFreeLength())
    design = eq.balance(mechanism, [spring], over, norm=norm)
    scatter = eq.Scatter(**NOTHING | {"rate": 0.06})
    answer = eq.tolerance(design, scatter, samples=100_000)
    before = design.before["arm_joint"]
    whole = {"rms": before.rms, "peak": before.sample_peak, "mean": before.mean}[norm]
    for level, value in ((0.05, answer.band.low), (0.5, answer.band.median), (0.95, answer.band.high)):
        assert value == pytest.approx(NormalDist().inv_cdf((1 + level) / 2) * 0.03 * whole, rel=0.04)
    assert answer.worst.name == "s's rate"
    assert answer.worst.high == pytest.approx(answer.band.high, rel=0.05)
    assert answer.adjuster.band.high < 1e-6 * whole
    assert answer == eq.tolerance(design, scatter, samples=100_000)
    assert answer != eq.tolerance(design, scatter, samples=100_000, seed=1)


@pytest.mark.parametrize("norm", ["rms", "peak"])
def test_fewer_rows_have_the_same_norms(norm):
    mechanism = arm()
    spring = eq.Spring("s", parts()[0].path, eq.ZeroFreeLength())
    design = eq.balance(mechanism, [spring], sweep(mechanism), norm=norm)
    aim, states = design.objective[0], design.states
    listed = sources(mechanism, design.balancers, design.sweep, states, "hold", dict(design.values), eq.Scatter())
    whole = _Specimen.of(design, aim, states, listed)
    errors = np.random.default_rng(3).standard_normal((500, len(listed)))
    fewer = whole.fewer()
    assert fewer.nominal.size < whole.nominal.size
    np.testing.assert_allclose(fewer.values(errors), whole.values(errors), rtol=1e-10)
    assert eq.tolerance(design, eq.Scatter(**NOTHING)).band.high == pytest.approx(design.certificate.primal, rel=1e-6)


def test_design_reports_it_and_the_file_sets_it(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.yaml").write_text(
        "mechanism: {chain: {links: [{name: arm, length: 0.5, mass: 2}]}}\n"
        "sweep: {grid: {arm_joint: [-90 deg, 90 deg, 19]}}\n"
        "balancers:\n"
        "  - spring: {name: s, path: {line: [[world, 0, 0, 0.2], [arm, 0.1, 0, 0]]}, law: zero_free_length}\n"
        "tolerances: {rate: 10 %, tilt: 0, temperature: 0}\n"
        "objective: {norm: peak}\n"
    )
    assert main(["design", "p.yaml", "--json", "--out", "out"]) == 0
    out, err = capsys.readouterr()
    found = json.loads(out)["tolerance"]
    assert found["scatter"]["rate"] == 0.1
    assert found["samples"] == 100_000
    assert {one["name"] for one in found["alone"]}.isdisjoint({"temperature", "tilt of the base"})
    assert "most by s's rate (± 10 %)" in err
    assert "When parts are as they come" in (tmp_path / "out/report.html").read_text()
    (tmp_path / "p.yaml").write_text((tmp_path / "p.yaml").read_text().replace("tilt: 0,", "tilt: -1 deg,"))
    assert main(["design", "p.yaml"]) == 2
    assert "line 5" in capsys.readouterr().err


def test_what_cannot_be_followed_is_said():
    with pytest.raises(eq.InputError, match="no tolerance any more"):
        eq.Scatter(temperature=293.0)
    mechanism = arm()
    design = eq.balance(mechanism, [eq.Spring("s", parts()[0].path, eq.ZeroFreeLength())], sweep(mechanism))
    with pytest.raises(eq.InputError, match="0 samples"):
        eq.tolerance(design, samples=0)


def judged(norm: str, **more) -> eq.Aim:
    return eq.Aim(norm=norm, judged="band", **more)


def test_a_target_is_measured_by_the_band_where_asked(tmp_path, capsys, monkeypatch):
    """An exact spring meets 0.3 N m as drawn, and not when its rate is 10 % off: 1.96 x 5 % of 9.81 N m."""
    monkeypatch.chdir(tmp_path)
    text = (
        "mechanism: {chain: {links: [{name: arm, length: 0.5, mass: 2, com: 0.5}]}}\n"
        "sweep: {grid: {arm_joint: [-90 deg, 90 deg, 19]}}\n"
        "balancers:\n"
        "  - spring: {name: s, path: {line: [[world, 0, 0, 0.2], [arm, 0.1, 0, 0]]}, law: zero_free_length}\n"
        "tolerances: {rate: 10 %, tilt: 0, temperature: 0, mass: 0, anchor: 0, rest_length: 0}\n"
        "objective: {norm: peak, target: 0.3 N m}\n"
    )
    (tmp_path / "p.yaml").write_text(text)
    assert main(["balance", "p.yaml"]) == 0
    (tmp_path / "b.yaml").write_text(text.replace("0.3 N m", "0.3 N m, judged: band"))
    for verb in ("balance", "design", "verify"):
        assert main([verb, "b.yaml", *(["--out", "out"] if verb != "verify" else ["--poses", "50"])]) == 1
        assert "the 95 % value of the peak is 0.96" in capsys.readouterr().err
    assert main(["verify", "out/design.json", "--poses", "50"]) == 1
    (tmp_path / "b.yaml").write_text(text.replace("0.3 N m", "1 N m, judged: band"))
    assert main(["balance", "b.yaml"]) == 0


def test_only_what_has_a_band_is_judged_by_it():
    with pytest.raises(eq.InputError, match="goal force has no tolerance band"):
        judged("rms", goal="force")
    with pytest.raises(eq.InputError, match="a cap has no tolerance band"):
        judged("rms", cap=1.0)
    with pytest.raises(eq.InputError, match="judge"):
        eq.Aim(judged="worst")
    mechanism = arm()
    spring = eq.Spring("s", parts()[0].path, eq.ZeroFreeLength())
    with pytest.raises(eq.InputError, match="first aim"):
        eq.balance(mechanism, [spring], sweep(mechanism), objective=(eq.Aim(), judged("peak")))


K, H, A, M = 2 * 9.81 * 0.3 / (0.2 * 0.1), 0.2, 0.1, 2 * 9.81 * 0.3
Q = np.linspace(-1.2, 1.2, 41)
LENGTH = np.sqrt(H**2 + A**2 - 2 * H * A * np.sin(Q))
BY_HAND = {
    "mass": (0.02, 0.01 * M * np.cos(Q)),
    "rate": (0.05, 0.025 * M * np.cos(Q)),
    "rest_length": (1e-3, 0.5e-3 * K * H * A * np.cos(Q) / LENGTH),
    "tilt": (np.radians(0.5), np.radians(0.25) * M * np.sin(Q)),
}


@pytest.mark.parametrize("norm", ["peak", "rms"])
@pytest.mark.parametrize("source", BY_HAND)
def test_quantiles_of_one_source_by_hand(source, norm):
    """A balanced arm whose residual is the error alone: its norm is that of a half-normal times one deviation."""
    rod = eq.chain([eq.Link("arm", length=0.5, mass=2.0, com=0.3)])
    over = eq.Sweep.grid(rod, {"arm_joint": (-1.2, 1.2, 41)})
    spring = eq.Spring("s", eq.Line(eq.Point("world", (0, 0, H)), eq.Point("arm", (A, 0, 0))), eq.ZeroFreeLength())
    design = eq.balance(rod, [spring], over, norm=norm)
    assert design.values["s.k"] == pytest.approx(K, rel=1e-9)
    tolerance, one = BY_HAND[source]
    band = eq.tolerance(design, eq.Scatter(**NOTHING | {source: tolerance}), samples=100_000).band
    size = np.abs(one).max() if norm == "peak" else np.sqrt((one**2).mean())
    wanted = [NormalDist().inv_cdf((1 + level) / 2) * size for level in (0.05, 0.5, 0.95)]
    assert [band.low, band.median, band.high] == pytest.approx(wanted, rel=0.04)


def test_an_adjuster_goes_no_further_than_a_screw():
    mechanism = arm()
    spring = eq.Spring("s", parts()[0].path, eq.ZeroFreeLength())
    design = eq.balance(mechanism, [spring], sweep(mechanism), norm="peak")
    aim, states = design.objective[0], design.states
    listed = sources(mechanism, design.balancers, design.sweep, states, "hold", dict(design.values), eq.Scatter())
    whole = _Specimen.of(design, aim, states, listed)
    errors = np.random.default_rng(3).standard_normal((200, len(listed)))
    (index, *_) = [number for number, source in enumerate(listed) if source.tunable]
    free = whole.retuned(index, errors, np.inf)
    held = whole.retuned(index, errors, free.travel / 4)
    assert 0 < held.travel / 2 <= free.travel / 4 * (1 + 1e-9)
    assert held.band.high > free.band.high
    shown = eq.tolerance(design, samples=2000).adjuster
    assert shown.travel / 2 <= {"m": 0.05 * mechanism.size}.get(shown.unit, 0.25) * (1 + 1e-9)


def test_half_of_an_adjusters_travel_goes_to_either_side():
    """Rates off by 5 % (two standard deviations) need 4.9 % to either side in 95 of 100 specimens."""
    mechanism = eq.chain([eq.Link("arm", length=0.5, mass=2.0)])
    over = eq.Sweep.grid(mechanism, {"arm_joint": (-1.5, 1.5, 31)})
    spring = eq.Spring("s", eq.Line(eq.Point("world", (0, 0, 0.2)), eq.Point("arm", (0.1, 0, 0))), eq.ZeroFreeLength())
    design = eq.balance(mechanism, [spring], over)
    design = replace(design, tolerance=eq.tolerance(design, eq.Scatter(**NOTHING | {"rate": 0.05}), samples=2000))
    assert design.tolerance.adjuster.travel == pytest.approx(2 * 0.049, rel=0.1)
    told = dict(tolerance_words(design))[""]
    share = float(re.search(r"by ± ([\d.]+) %", told)[1])
    assert share == pytest.approx(100 * design.tolerance.adjuster.travel / 2, rel=0.01)
