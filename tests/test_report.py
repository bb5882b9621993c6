"""What the user reads: terminal prose, the HTML page, its data files."""

import csv
import html
import json
import math
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import equipoise as eq
from equipoise.certificate import Active
from equipoise.reporting import layout, limitwords, numbers, phrases, words
from equipoise.reporting.html import page
from equipoise.reporting.jsonfile import strict
from equipoise.reporting.maps import draw_map
from equipoise.reporting.ordering import mounting
from equipoise.reporting.pathwords import path_words
from equipoise.reporting.references import entries, reference
from equipoise.reporting.sample import Sample
from equipoise.reporting.style import figure, styled

NASTY = 'arm <script>alert("1")</script> & co'
UR10 = "package://example-robot-data/robots/ur_description/urdf/ur10_robot.urdf"


@pytest.fixture(scope="module")
def planar():
    links = [
        eq.Link("upper", 0.5, 4.0, limits=(-0.3, 2.0), motor_limit=80.0),
        eq.Link("fore<i>", 0.4, 2.5, limits=(-2.2, 0.2)),
    ]
    arm = eq.chain(links, name=NASTY)
    over = eq.Sweep.grid(
        arm,
        {"upper_joint": (-0.3, 2.0, 15), "fore<i>_joint": (-2.2, 0.2, 15)},
        payload=[eq.Payload("fore<i>", (0.0, 3.0), (0.4, 0.0, 0.0))],
    )
    spring = eq.Spring("lift<b>", eq.Line(arm.at("world", -0.05, 0, 0.25), arm.at("upper", 0.2, 0, 0.03)), eq.Coil(0.1))
    weight = eq.Counterweight("bob", arm.at("fore<i>", -0.15, 0, 0))
    limits = [eq.Force("lift<b>", max=200.0), eq.MassCap("bob", max=2.0)]
    return eq.balance(arm, [spring, weight], over, norm="rms", limits=limits)


@pytest.fixture(scope="module")
def pendulum():
    arm = eq.chain([eq.Link("rod", 0.5, 2.0)], name="pendulum")
    over = eq.Sweep.grid(arm, {"rod_joint": (-1.5, 1.5, 61)})
    line = eq.Line(arm.at("world", 0, 0, 0.3), arm.at("rod", 0.25, 0, 0.0))
    return eq.balance(arm, [eq.Spring("s", line, eq.ZeroFreeLength())], over, norm="peak")


@pytest.fixture(scope="module")
def written(planar, tmp_path_factory):
    out = tmp_path_factory.mktemp("report")
    return eq.report(planar, out).parent


def test_numbers_have_three_to_four_digits():
    assert numbers.sig(121.030644) == "121.0"
    assert numbers.sig(0.2292734) == "0.2293"
    assert numbers.sig(9.99996) == "10.00"
    assert numbers.sig(2.66e-15) == "2.7e-15"
    assert numbers.sig(0.0) == "0"
    assert numbers.quantity(0.38, "m") == "380 mm"
    assert numbers.quantity(math.pi / 2, "rad") == "90 deg"
    assert numbers.span((0.0500089, 0.350001), "m") == "50 to 350 mm"
    assert numbers.place((0.0, 0.22, -1e-9)) == "(0, 220, 0) mm"


def test_summary_of_an_exact_design_says_so(pendulum):
    text = words.summary(pendulum)
    # m g l / 2 = 2 * 9.81 * 0.25 and k = m g (l / 2) / (0.3 * 0.25).
    assert "4.905" in text
    assert "k = 65.4 N/m" in text
    assert "certificate exact" in text
    assert "world (0, 0, 300) mm  to  rod (250, 0, 0) mm" in text
    assert "limited by" not in text
    assert "vanishes" in phrases.result(pendulum)


def test_summary_states_prices_in_words(planar):
    text = str(planar)
    assert max(map(len, text.splitlines())) <= 110
    assert "force of lift<b> <= 200 N: " in text
    assert "more would lower the rms by" in text
    assert "not yet" in text
    active = Active("stroke of s1 <= 0.38 m", 40.0, "N m per m")
    assert (
        limitwords.price_words(active, planar) == "stroke of s1 <= 380 mm: 10 mm more would lower the rms by 0.40 N m"
    )
    natural = Active("s1.k >= 0", 1e-3, "N m per N/m")
    assert limitwords.price_words(natural, planar) == "s1.k >= 0, the bound that nature sets"


def test_table_columns_align(planar):
    lines = words.summary(planar).splitlines()
    head = next(i for i, line in enumerate(lines) if line.split()[:3] == ["peak", "rms", "mean"])
    ends = [match.end() for match in re.finditer(r"peak|rms|mean", lines[head])]
    for row in lines[head + 1 : head + 3]:
        assert all(row[end - 1].isdigit() and row[end : end + 1] in (" ", "") for end in ends)


def test_analysis_names_unloaded_joints_and_the_next_step():
    arm = eq.chain([eq.Link("pan", 0.2, 1.0, axis=(0, 0, 1)), eq.Link("rod", 0.5, 2.0)], name="pan and tilt")
    text = str(eq.analyze(arm, eq.Sweep.sobol(arm, 64)))
    assert "pan_joint: gravity does not load it" in text
    assert "one from pan to rod acts on rod_joint" in " ".join(text.split())
    assert re.search(r"rod_joint \[N m\] +4\.905", text)


def test_page_needs_no_network_and_no_scripts(written):
    text = (written / "report.html").read_text(encoding="utf-8")
    assert "<script" not in text
    assert "@import" not in text
    assert not re.search(r"""(src|href|action|data|url)\s*[=(]\s*["']?\s*(https?:|//|file:)""", text, flags=re.I)
    assert "http" not in re.sub(r"base64,[A-Za-z0-9+/=]+", "", text)
    sources = re.findall(r'<img src="([^"]{0,30})', text)
    assert len(sources) == 4
    assert all(source.startswith("data:image/svg+xml;base64,") for source in sources)


def test_page_escapes_every_name(written):
    text = (written / "report.html").read_text(encoding="utf-8")
    assert NASTY not in text
    assert html.escape(NASTY) in text
    for name in ("fore<i>", "lift<b>"):
        assert name not in text
        assert html.escape(name) in text


def test_json_is_strict_and_agrees_with_the_page(written):
    def refuse(constant):
        raise AssertionError(constant)

    data = json.loads((written / "design.json").read_text(encoding="utf-8"), parse_constant=refuse)
    text = (written / "report.html").read_text(encoding="utf-8")
    for row in (*data["before"].values(), *data["after"].values()):
        for norm in ("peak", "rms", "mean"):
            assert f">{numbers.sig(row[norm])}<" in text
    assert f"k = {numbers.quantity(data['unknowns']['lift<b>.k']['value'], 'N/m')}" in text
    assert data["verification"]["agrees"] is True
    assert (written / data["verification"]["model"]).is_file()
    assert all(reference(key) in html.unescape(text) for key in data["cite"])


def test_strict_json_has_no_infinity():
    assert strict({"a": [np.inf, np.float64(2.0)], "b": (float("nan"),), "c": np.int64(3)}) == {
        "a": [None, 2.0],
        "b": [None],
        "c": 3,
    }


def test_residuals_read_back_as_the_sweep(planar, written):
    path = written / "residuals.csv"
    again = eq.Sweep.of_poses(planar.mechanism, path)
    np.testing.assert_allclose(again.poses, planar.states.driven, atol=1e-11)
    np.testing.assert_allclose(again.weight, planar.states.weight, rtol=1e-11)
    with path.open(newline="", encoding="utf-8") as stream:
        head = next(csv.reader(stream))
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    after = table[:, head.index("after upper_joint [N m]")]
    assert np.abs(after).max() == pytest.approx(planar.after["upper_joint"].sample_peak, rel=1e-9)


def test_nothing_is_left_where_writing_fails(pendulum, tmp_path, monkeypatch):
    def broken(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("equipoise.verbs.report._write_residuals", broken)
    with pytest.raises(eq.InputError, match="No space left"):
        eq.report(pendulum, tmp_path / "full")
    assert not (tmp_path / "full").exists()
    (tmp_path / "file").write_text("")
    with pytest.raises(eq.InputError, match="cannot write the report"):
        eq.report(pendulum, tmp_path / "file")


def test_a_disagreement_is_shown(pendulum):
    verified = eq.verify(pendulum, poses=32)
    assert verified.verification is not None
    wrong = replace(verified.verification.errors["rod_joint"], error=0.5)
    failed = replace(verified, verification=replace(verified.verification, errors={"rod_joint": wrong}))
    assert "DISAGREES by 0.50 N m" in str(failed)
    assert "<b>DISAGREES</b>" in page(failed, "model.xml")
    assert "Not verified yet" in page(pendulum, "model.xml")


def test_ledger_of_an_exact_design_is_level(pendulum):
    from equipoise.reporting.ledger import balance_sheet

    sheet = balance_sheet(Sample(pendulum))
    assert sheet is not None
    _, gravity, _, total = sheet
    assert np.ptp(gravity) == pytest.approx(2 * 2 * 9.81 * 0.25 * math.sin(1.5), rel=1e-9)
    assert np.ptp(total) < 1e-12


def test_map_of_a_norm_shows_optimum_and_conflict():
    x, y = np.linspace(0, 100, 11), np.linspace(50, 150, 13)
    Z = (x - 30) ** 2 / 100 + (y[:, None] - 90) ** 2 / 100 + 5
    Z[:3, :4] = np.nan
    with styled():
        made = figure(6, 4)
        ax = made.subplots()
        draw_map(ax, x, y, Z, labels=("x [mm]", "z [mm]"), optimum=(30.0, 90.0), unit="peak [N m]")
        made.canvas.draw()
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["limits conflict", "optimum"]
    assert ax.get_xlabel() == "x [mm]"


def test_references_resolve():
    keys = {"arakelian_ghazaryan_2008", "quaglia_yin_2015", "arakelian_smith_2008", "zhang_arakelian_2023"}
    assert keys | {"perreault_cardou", "mujoco", "clarabel"} <= set(entries())
    assert "43(5), pp. 565–575, 2008. doi:10.1016/j.mechmachtheory.2007.05.002." in reference(
        "arakelian_ghazaryan_2008"
    )


def test_ur10_reads_as_the_design_document_shows(tmp_path):
    try:
        arm = eq.Mechanism.load(UR10)
    except eq.ModelError:
        pytest.skip("needs the extra `robots`")
    line = eq.Line(arm.at("shoulder_link", 0, 0.22, 0.15), arm.at("upper_arm_link", 0, 0, 0.2))
    design = eq.balance(arm, [eq.Spring("s1", line, eq.ZeroFreeLength())], eq.Sweep.sobol(arm, 2048), norm="peak")
    text = str(design)
    assert re.search(r"shoulder_lift_joint \[N m\] +121\.0 .* 34\.23 .* 330", text)
    assert "elbow_joint's own torque (34.23 N m)" in text
    assert "no load: shoulder_pan_joint" in text
    shown = eq.report(design, tmp_path).read_text(encoding="utf-8")
    assert "falls from 121.0 to 34.23 N m, 28.3 %" in shown
    assert (tmp_path / "ur10_balanced.xml").is_file()


def test_prose_fills_the_terminal_and_numbers_keep_their_units(monkeypatch):
    text = "a spring pulls 12.5 N at 380 mm " * 8
    assert max(map(len, layout.wrapped(text))) <= 110
    monkeypatch.setenv("COLUMNS", "72")
    monkeypatch.setattr("sys.stderr", SimpleNamespace(isatty=lambda: True))
    lines = layout.labelled("force", text)
    assert max(map(len, lines)) <= 72
    assert not any(line.endswith(("12.5", "380")) for line in lines)
    assert all(line.startswith(" " * layout.LABEL) for line in lines[1:])
    monkeypatch.setenv("COLUMNS", "20")
    assert layout.width() == layout.NARROWEST


def test_a_cable_reads_as_it_is_rigged():
    """Falls of a tackle, eyes that are no pulleys; other ratios stay numbers."""
    through = (eq.Point("world", (0, 0.5, 0)), eq.Pulley("world", (0, 0, 0.1), 0.0), eq.Point("arm", (0.2, 0, 0)))
    assert path_words(eq.Cable(through, 1 / 3, -0.1)) == (
        "cable: world (0, 500, 0) mm - eye (world (0, 0, 100) mm) - arm (200, 0, 0) mm, tackle of 3 falls, "
        "offset -100 mm"
    )
    assert "ratio 0.4" in path_words(eq.Cable(through, 0.4))
    assert "ratio 2" in path_words(eq.Cable(through, 2.0))


def test_a_spring_is_mounted_at_joints_that_move_it():
    """A joint that turns the spring as a whole says nothing of where it is easiest to hook in."""
    links = [eq.Link("turret", length=0.2, mass=1.0, axis=(0, 0, 1)), eq.Link("arm", length=0.5, mass=3.0)]
    machine = eq.chain(links)
    path = eq.Line(machine.at("turret", 0.0, 0.0, 0.2), machine.at("arm", 0.2))
    spring = eq.Spring("s1", path, eq.ZeroFreeLength())
    design = eq.balance(machine, [spring], eq.Sweep.sobol(machine, 32))
    pull, where = mounting(design, design.balancers[0])
    assert pull.endswith(" N")
    assert "arm_joint" in where
    assert "turret_joint" not in where
