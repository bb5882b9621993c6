"""compare: every family has a working member; its numbers by other means; the docs' table is the program's own."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

import equipoise as eq
from equipoise.cli import main
from equipoise.comparing import Comparing
from equipoise.discovery.ask import design_problem
from equipoise.families.judge import Chance
from equipoise.problem import load_problem
from equipoise.reporting.comparison_page import chart, page
from equipoise.scattering import Scatter

ROOT = Path(__file__).parents[1]
G = 9.81
MASS, COM = 4.0, 0.35


@pytest.fixture(scope="module")
def found():
    problem = load_problem(ROOT / "examples" / "compare_arm.yaml")
    problem.check()
    return eq.compare(problem.mechanism, problem.sweep, problem.content.compare, norm="rms")


def entry(found, name):
    return next(entry for entry in found.entries if name in entry.family.name)


EXACT = (
    "counterweight",
    "zero-free-length",
    "cable and eye",
    "constant-force spring on",
    "rod through",
    "cam",
    "2:1 gear",
)


def test_every_group_of_table_1_and_every_family_works(found):
    assert {entry.family.code for entry in found.entries} == {"", "A", "B", "C I", "C II", "C III"}
    assert len(found.entries) == 16
    load = MASS * COM * G
    for one in found.entries:
        assert one.design is not None, one.reason
        assert one.facts.rms < 0.5 * load
        assert one.family.code == "" or one.json()["scheme"] == "underspecified"
    exact = [entry(found, name) for name in EXACT]
    assert max(one.facts.peak for one in exact) < 1e-9 * load
    assert all(one.design.certificate.kind == "exact" for one in exact)
    assert [one.rank for one in found.entries] == list(range(1, 17))
    assert not entry(found, "zero-free-length").realisable
    assert found.entries[-1].realisable is False


@pytest.mark.parametrize("number", range(16))
def test_members_hold_in_mujoco_too(found, number):
    one = found.entries[number]
    checked = eq.verify(one.design, poses=30).verification
    assert checked.agrees, one.family.name


def test_the_numbers_by_hand(found):
    load, room = MASS * COM * G, 0.15
    weight = entry(found, "counterweight")
    assert weight.facts.mass == pytest.approx(MASS * COM / room, rel=1e-9)
    assert weight.facts.inertia == pytest.approx(MASS * COM * room, rel=1e-9)
    assert weight.facts.pin == pytest.approx(MASS * COM / room * G, rel=1e-9)
    ideal = entry(found, "zero-free-length")
    rate = load / (room * 0.6 * room)
    assert ideal.facts.rate == pytest.approx(rate, rel=1e-9)
    q = np.radians(np.linspace(10, 170, 41))
    longest = np.sqrt(room**2 + (0.6 * room) ** 2 - 2 * 0.6 * room**2 * np.cos(q)).max()
    assert ideal.facts.energy == pytest.approx(0.5 * rate * longest**2, rel=1e-9)
    assert ideal.facts.mass == pytest.approx(4 * 81e9 * 7800 / 700e6**2 * ideal.facts.energy, rel=1e-9)
    assert ideal.facts.pin == pytest.approx(rate * longest, rel=1e-9)
    cable = entry(found, "cable and eye")
    assert cable.facts.rate == pytest.approx(rate, rel=1e-9)
    yoke = entry(found, "constant-force spring on")
    assert yoke.facts.pin == pytest.approx(load / (0.6 * room), rel=1e-9)
    gear = entry(found, "2:1 gear")
    assert gear.facts.rate == pytest.approx(4 * load / (0.6 * room) ** 2, rel=1e-9)


def test_motors_by_hand(found):
    """Cycloidal from 10 to 170 degrees in 2 s: a thin rod of 4 kg about its end, weight or no weight left."""
    inertia = MASS * 0.6**2 / 12 + MASS * COM**2
    t = np.linspace(0, 1, 181)
    a, span = np.radians(10), np.radians(160)
    q = a + span * (t - np.sin(2 * np.pi * t) / (2 * np.pi))
    speedup = span * 2 * np.pi * np.sin(2 * np.pi * t) / 4
    share = np.ones(181)
    share[[0, -1]] = 0.5

    def rms(torque):
        return np.sqrt((share * torque**2).sum() / share.sum())

    assert found.torque == pytest.approx(rms(inertia * speedup - MASS * COM * G * np.sin(q)), rel=1e-6)
    weight = entry(found, "counterweight").facts
    assert weight.torque == pytest.approx(rms((inertia + MASS * COM * 0.15) * speedup), rel=1e-6)
    yoke = entry(found, "constant-force spring on").facts
    assert yoke.torque == pytest.approx(rms((inertia + yoke.inertia) * speedup), rel=1e-6)


def test_the_docs_show_the_programs_own_table(found):
    from equipoise.reporting.comparison import markdown

    page = (ROOT / "docs" / "choosing.md").read_text(encoding="utf-8")
    shown = re.search(r"<!-- compare_arm -->\n(.*?)<!-- end -->", page, re.DOTALL)[1]
    printed = [line for line in shown.splitlines() if line.startswith("|")]
    for ours, theirs in zip(markdown(found).splitlines(), printed, strict=True):
        for a, b in zip(ours.split(" | "), theirs.split(" | "), strict=True):
            numbers = [re.findall(r"-?[\d.]+(?:e-?\d+)?", cell) for cell in (a, b)]
            assert re.sub(r"[\d.e-]+", "#", a) == re.sub(r"[\d.e-]+", "#", b)
            np.testing.assert_allclose([float(n) for n in numbers[0]], [float(n) for n in numbers[1]], rtol=0.02)


def test_every_member_is_a_problem_file(found):
    """Read back and balanced, each leaves what the table says."""
    problem = load_problem(ROOT / "examples" / "compare_arm.yaml")
    for one in found.entries:
        again = design_problem(one.design, problem)
        again.check()
        design = eq.balance(
            again.mechanism, again.balancers, again.sweep, objective=again.objective, limits=again.limits
        )
        assert design.after["arm_joint"].rms == pytest.approx(one.facts.rms, rel=1e-6, abs=1e-9)


def test_the_page_draws_what_is_left(found):
    """A panel for each family that leaves something, with the design's own numbers; the others are named."""
    html = page(found)
    left = [one for one in found.entries if one.facts.peak > 1e-6]
    assert html.count("<details>") == len(found.entries)
    drawn = chart(found, left)
    panels = [ax for ax in drawn.axes if ax.lines]
    assert len(panels) == len(left)
    for ax, one in zip(panels, left, strict=True):
        assert np.abs(ax.lines[-1].get_ydata()).max() == pytest.approx(one.facts.peak, rel=1e-2)
    exact = [one.family.name for one in found.entries if one not in left]
    assert f"Nothing is left by: {', '.join(exact)}." in html
    assert "no spring has zero free length" in html
    assert "http" not in re.sub(r"https?://(doi|www.w3)\.org", "", html)


def test_friction_of_two_pins_by_hand(found):
    """mu r f at each pin, times how fast it turns: the line against the base, and the arm against the line."""
    ideal = entry(found, "zero-free-length")
    states, spring = ideal.design.states, ideal.design.balancers[0]
    q = states.driven[:, 0]
    ends = [states.point(end)[0] for end in (spring.path.a, spring.path.b)]
    along = ends[1] - ends[0]
    force = ideal.facts.rate * np.linalg.norm(along, axis=1)
    turned = np.unwrap(np.arctan2(along[:, 0], along[:, 2]))
    slope = np.gradient(turned, q, edge_order=2)
    by_hand = 0.1 * 0.005 * force * (np.abs(slope) + np.abs(1 - slope))
    assert ideal.facts.friction == pytest.approx(by_hand.max(), rel=5e-3)
    assert entry(found, "counterweight").facts.friction is None


def test_rows_ranked_by_the_upper_end_of_the_band(found):
    """The 95 % value decides, and errors that are off for the same reason are off alike in every family."""
    mechanism, sweep = found.site.mechanism, found.sweep
    asked = Comparing(room=0.15, families=("counterweight", "cable and eye", "torsion", "C II"))
    banded = eq.compare(mechanism, sweep, asked, judged="band")
    highs = [one.facts.high for one in banded.entries]
    assert highs == sorted(highs)
    assert banded.json()["judged"] == "band"
    assert "95 % value of the rms" in str(banded)
    assert all(one.facts.high > one.facts.rms for one in found.entries)
    # Mass 2 %, tilt, and the weight's own 5 %: independent, so their squares add to first order.
    weight, load = entry(found, "counterweight").facts, found.before.rms
    calm = Chance(Scatter(rate=0.05, anchor=0, angle=0, mass=0, tilt=0, temperature=0))
    alone = eq.compare(mechanism, sweep, Comparing(room=0.15, families=("counterweight",)), chance=calm)
    assert alone.entries[0].facts.high == pytest.approx(0.025 * 1.959964 * load, rel=0.02)
    assert weight.high > alone.entries[0].facts.high


def test_a_slide_is_compared_in_newtons():
    axis = eq.chain([eq.Link("lift", length=0.2, mass=7.0, joint="slide", axis=(0, 0, 1), stroke=(0.0, 0.5))])
    sweep = eq.Sweep.grid(axis, {"lift_joint": (0.0, 0.5, 11)})
    found = eq.compare(axis, sweep)
    load = 7.0 * G
    assert found.before.unit == "N"
    assert found.before.peak == pytest.approx(load)
    exact = {one.family.name for one in found.entries if one.facts.peak < 1e-9 * load}
    assert exact == {
        "counterweight over a pulley", "constant-force spring", "coil spring on a fusee (cam) behind a pinion"
    }  # fmt: skip
    pulley = next(one for one in found.entries if "pulley" in one.family.name)
    assert pulley.facts.inertia == pytest.approx(7.0)
    for one in found.entries:
        assert eq.verify(one.design, poses=20).verification.agrees


def test_arrangements_for_a_planar_arm_lead(tmp_path, capsys):
    file = tmp_path / "arm.yaml"
    file.write_text(
        "mechanism: {chain: {links: [{name: a, length: 0.6, mass: 9, limits: [-1.5, 1.5]},"
        " {name: b, length: 0.5, mass: 4, limits: [-2.5, -0.5]}]}}\n"
        "sweep: {grid: {a_joint: [-1.5, 1.5, 7], b_joint: [-2.5, -0.5, 7]}}\n"
        "compare: {joint: a_joint, families: [structure, torsion]}\n",
        encoding="utf-8",
    )
    assert main(["compare", str(file), "--json", "--out", str(tmp_path / "out")]) == 0
    data = json.loads(capsys.readouterr().out)
    assert [row["family"][:12] for row in data["rows"]] == ["structure II", "structure I:", "torsion spri"]
    assert data["rows"][0]["rms"] < 0.05 * data["before"]["rms"]
    assert data["rows"][0]["parts"] == 12
    assert (tmp_path / "out" / "comparison.md").read_text(encoding="utf-8").count("\n") == 5
    html = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "Other joints move too" in html
    for row in data["rows"]:
        assert row["family"] in html
        assert row["reason"].split(" of ")[0] in html
    again = load_problem(tmp_path / "out" / "03_torsion_spring.yaml")
    again.check()
    assert again.objective[0].joints == ("a_joint",)
    left = eq.balance(again.mechanism, again.balancers, again.sweep, objective=again.objective, limits=again.limits)
    assert left.after["a_joint"].rms == pytest.approx(data["rows"][2]["rms"], rel=1e-6)


@pytest.mark.parametrize(
    ("block", "message"),
    [
        ("compare: {families: [C7]}", "scheme C7 is underspecified"),
        ("compare: {families: [hydraulic ram]}", "there is no family 'hydraulic ram'"),
        ("compare: {joint: elbow}", "joint 'elbow' is not driven"),
        ("compare: {joint: turret_joint}", "joint turret_joint carries no load"),
        ("mechanism_gravity", "carries no load"),
    ],
)
def test_what_cannot_be_compared(block, message, tmp_path, capsys):
    gravity = ", gravity: [0, 0, 0]" if block == "mechanism_gravity" else ""
    file = tmp_path / "arm.yaml"
    file.write_text(
        "mechanism: {chain: {links: [{name: turret, length: 0.2, mass: 1, axis: [0, 0, 1]},"
        f" {{name: arm, length: 0.5, mass: 3}}]{gravity}}}}}\nsweep: {{sobol: 32}}\n"
        + ("" if gravity else f"{block}\n"),
        encoding="utf-8",
    )
    assert main(["compare", str(file)]) == 2
    assert message in " ".join(capsys.readouterr().err.split())
