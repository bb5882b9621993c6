"""Surveys and picks: batched against one by one, honest about limits, resumable, told with what was refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize
from survey_by_scipy import Arm, one_by_one

import equipoise as eq
from equipoise.cli import main
from equipoise.errors import InfeasibleError, InputError
from equipoise.parameters import write
from equipoise.parts.ranking import Ledger, Line
from equipoise.picking import picked
from equipoise.problem import load_problem
from equipoise.solve.small import boxed, elastic
from equipoise.solving import shaped
from equipoise.thinning import thin
from equipoise.verbs.workers import shared

STOCK = Path(__file__).parents[1] / "examples" / "stock_springs.csv"
BOUNDS = {
    "s1.path.line.0.x": (-0.3, 0.3), "s1.path.line.0.z": (0.1, 0.8),
    "s1.path.line.1.x": (0.05, 0.55), "s1.path.line.1.z": (-0.1, 0.1),
}  # fmt: skip


@pytest.fixture(scope="module")
def arm():
    return eq.chain([eq.Link("arm", length=0.6, mass=4.0)])


@pytest.fixture(scope="module")
def sweep(arm):
    return eq.Sweep.grid(arm, {"arm_joint": (-1.0, 1.2, 121)})


def ideal(arm):
    return eq.Spring("s1", eq.Line(arm.at("world", 0, 0, 0.3), arm.at("arm", 0.2)), eq.ZeroFreeLength())


@pytest.fixture(scope="module")
def stock():
    whole = eq.read_catalogue(STOCK)
    return whole.take(np.arange(600, 1300, 37))


@pytest.fixture(scope="module")
def ranking(arm, sweep, stock):
    return eq.survey_catalogue(arm, [ideal(arm)], sweep, BOUNDS, stock, parallel=2)


def test_small_programs_are_solved_as_one_by_one():
    rng = np.random.default_rng(0)
    root = rng.normal(size=(8, 3, 3))
    H, q = root @ np.swapaxes(root, 1, 2) + 0.1 * np.eye(3), rng.normal(size=(8, 3))
    low, high = -rng.uniform(0, 1, (8, 3)), rng.uniform(0, 1, (8, 3))
    free, _ = elastic(H, q, np.zeros((8, 1, 3)), -np.ones((8, 1)), low, high, np.ones(8))
    corner, least = boxed(H, q, low, high)
    assert 0 < least.sum() < 8
    for k in range(8):
        found = minimize(
            lambda z, k=k: z @ H[k] @ z / 2 + q[k] @ z, np.zeros(3), bounds=list(zip(low[k], high[k], strict=True))
        )
        assert free[k] == pytest.approx(found.x, abs=1e-4)
        if least[k]:
            assert corner[k] == pytest.approx(found.x, abs=1e-4)


def test_a_program_without_a_step_ends_where_it_is():
    """A matrix that rounding has spoilt warns of nothing and leaves its neighbours alone."""
    rng = np.random.default_rng(2)
    H, q = np.tile(np.eye(3), (3, 1, 1)), rng.normal(size=(3, 3))
    A, e, price = rng.normal(size=(3, 2, 3)), rng.normal(size=(3, 2)), np.ones(3)
    low, high = -np.ones((3, 3)), np.ones((3, 3))
    z, dual = elastic(H, q, A, e, low, high, price)
    spoilt = H.copy()
    spoilt[1] = 1e200 * np.array([[1, 2, 3], [2, 1, 4], [3, 4, 1]])
    beside, pushed = elastic(spoilt, q, A, e, low, high, price)
    assert np.isfinite(beside).all()
    assert np.isfinite(pushed).all()
    assert beside[[0, 2]] == pytest.approx(z[[0, 2]])
    assert pushed[[0, 2]] == pytest.approx(dual[[0, 2]])


def test_rows_that_cannot_be_kept_are_passed_least():
    """Elastic rows against SLSQP with one more variable; multipliers balance the slope, together no more than price."""
    rng = np.random.default_rng(1)
    root = rng.normal(size=(12, 3, 3))
    H, q = root @ np.swapaxes(root, 1, 2) + 0.1 * np.eye(3), rng.normal(size=(12, 3))
    A, e, price = rng.normal(size=(12, 4, 3)), rng.normal(size=(12, 4)), rng.uniform(0.5, 20, 12)
    low, high = -np.ones((12, 3)), np.ones((12, 3))
    z, dual = elastic(H, q, A, e, low, high, price)
    assert (dual.sum(axis=1) <= price + 1e-4).all()
    passed = []
    for k in range(12):

        def value(x, k=k):
            return x[:3] @ H[k] @ x[:3] / 2 + q[k] @ x[:3] + price[k] * x[3]

        rows = {"type": "ineq", "fun": lambda x, k=k: x[3] - A[k] @ x[:3] - e[k]}
        found = minimize(value, np.append(np.zeros(3), 5.0), bounds=[(-1, 1)] * 3 + [(0, None)], constraints=rows)
        assert z[k] == pytest.approx(found.x[:3], abs=2e-3)
        passed.append(found.x[3] > 1e-6)
        inside = (np.abs(z[k]) < 0.999).all()
        if inside:
            assert H[k] @ z[k] + q[k] + A[k].T @ dual[k] == pytest.approx(0, abs=1e-4)
    assert 0 < sum(passed) < 12


def test_few_states_integrate_like_all(arm):
    states = arm.states(eq.Sweep.grid(arm, {"arm_joint": (-1.0, 1.2, 601)}))
    few = thin(states, 16)
    q = states.driven[:, 0]
    for f in (np.cos(q) ** 2, np.sin(3 * q), np.sqrt(1.3 + np.cos(q))):
        assert few.weight @ f[few.rows] == pytest.approx(states.weight @ f, abs=1e-5 * states.weight.sum())
    assert {0, 600} <= set(few.rows)


def test_lines_are_what_balance_says_of_the_part(arm, sweep, ranking):
    """Norms and the verdict on limits of every line against a plain balance with that part at that geometry."""
    assert len(ranking.lines) == 2 * len(ranking.catalogue)
    assert len(ranking.ranked) >= 20
    for line in ranking.ranked[::4]:
        part = ranking.catalogue.spring(ranking.row(line), line.number)
        spring = eq.Spring("s1", ideal(arm).path, part)
        placed = write([spring], dict(zip(ranking.free, line.geometry, strict=True)))
        design = eq.balance(arm, placed, sweep)
        assert design.after["arm_joint"].rms == pytest.approx(line.rms, rel=1e-6)
        assert design.after["arm_joint"].sample_peak == pytest.approx(line.peak, rel=1e-6)
        low, high = part.span
        assert low - 1e-6 <= design.parts()[0]["length"][0] <= design.parts()[0]["length"][1] <= high + 1e-6


def test_no_worse_than_scipy_row_by_row(arm, ranking):
    """SLSQP from six beginnings each, plain code that shares nothing with equipoise, on every sixth row."""
    plain = Arm(poses=121)
    cat = ranking.catalogue
    rows = np.arange(2, len(cat), 6)
    columns = (cat.rate, cat.free_length, cat.initial_tension, cat.free_length + cat.travel, cat.mass)
    theirs = one_by_one(plain, np.stack(columns, axis=1)[rows], starts=6, seed=0)
    lines = {line.part: line for line in ranking.lines if line.number == 1}
    ours = np.array([np.inf if lines[cat.part[row]].refused else lines[cat.part[row]].rms for row in rows])
    assert (ours <= 1.001 * theirs).all()


def test_no_worse_than_shape(arm, sweep, ranking):
    """The general search from 4 starts, for the best and a middling line."""
    ranked = ranking.ranked
    for line in (ranked[0], ranked[len(ranked) // 2]):
        part = ranking.catalogue.spring(ranking.row(line), line.number)
        spring = eq.Spring("s1", ideal(arm).path, part)
        shaped = eq.shape(arm, [spring], sweep, BOUNDS, norm="rms", starts=4)
        assert line.rms <= shaped.after["arm_joint"].rms * 1.05 + 1e-3


@pytest.mark.parametrize("norm", ["peak", "mean"])
def test_the_cut_by_closed_form_keeps_the_best_of_any_norm(arm, sweep, norm):
    """Of 33 candidates six are worked on: the best of all is among them."""
    few = eq.read_catalogue(STOCK).take(np.arange(0, 1300, 40))
    over = eq.Sweep.grid(arm, {"arm_joint": (-1.0, 1.2, 31)})
    whole, cut = (eq.survey_catalogue(arm, [ideal(arm)], over, BOUNDS, few, norm=norm, most=most) for most in (None, 6))
    assert len(cut.lines) == 6
    assert cut.outranked == len(few) - 6
    assert cut.ranked[0].value == pytest.approx(whole.ranked[0].value, rel=1e-3)


def test_ranked_and_refused(ranking):
    values = [line.value for line in ranking.ranked]
    assert values == sorted(values)
    assert sum(ranking.refused.values()) + len(ranking.ranked) == len(ranking.lines)
    assert set(ranking.refused) <= {"working range of s1"}
    table = ranking.table().splitlines()
    assert len(table) == 1 + len(ranking.lines)
    assert table[1].startswith(f"1,{ranking.ranked[0].part},")


def test_a_survey_goes_on_where_it_was_stopped(arm, sweep, stock, ranking, tmp_path):
    """Stopped after the first chunk, read back, gone on with: the same lines, none twice, a torn last line dropped."""
    few = stock.take(np.arange(8))
    ledger = Ledger(tmp_path / "out" / "rows.csv", "abc", ranking.free, ranking.units)
    first = eq.survey_catalogue(arm, [ideal(arm)], sweep, BOUNDS, few.take([0, 1, 2]), store=ledger.append)
    with ledger.path.open("a") as stream:
        stream.write("SY-torn,1,0.1")
    done = ledger.load()
    assert done == list(first.lines)
    worked = []
    whole = eq.survey_catalogue(
        arm,
        [ideal(arm)],
        sweep,
        BOUNDS,
        few,
        done=done,
        store=lambda lines: (worked.extend(lines), ledger.append(lines)),
    )
    assert len(worked) == 5
    assert {line.part for line in whole.lines} == set(few.part)
    assert sorted(ledger.load(), key=str) == sorted(whole.lines, key=str)
    with pytest.raises(InputError, match="another survey"):
        Ledger(ledger.path, "xyz", ranking.free, ranking.units).load()
    ledger.path.write_text(ledger.path.read_text().replace(",1,", ",one,", 1))
    with pytest.raises(InputError, match="not as it was written") as error:
        ledger.load()
    assert error.value.where.endswith("row 3")


def test_processes_find_the_same(arm, sweep, stock, monkeypatch):
    """Two processes against this one: the same lines to the last digit, though they finish in any order."""
    monkeypatch.setattr("equipoise.verbs.survey.CHUNK", 3)
    few, told = stock.take(np.arange(6)), []
    alone = eq.survey_catalogue(arm, [ideal(arm)], sweep, BOUNDS, few)
    both = eq.survey_catalogue(
        arm, [ideal(arm)], sweep, BOUNDS, few, workers=2, progress=lambda done, count, best: told.append((done, count))
    )
    assert sorted(both.lines, key=str) == sorted(alone.lines, key=str)
    assert told == [(3, 6), (6, 6)]


def test_what_cannot_be_sent_stays_here():
    assert list(shared(lambda piece: piece + 1, [1, 2, 3], 2)) == [2, 3, 4]


def test_ctrl_c_keeps_what_is_done(arm, sweep, stock):
    def stop(done, count, best):
        raise KeyboardInterrupt

    found = eq.survey_catalogue(arm, [ideal(arm)], sweep, BOUNDS, stock.take(np.arange(5)), progress=stop)
    assert len(found.lines) == 5


def test_what_a_survey_cannot_do_it_says(arm, sweep, stock):
    other = eq.Spring("s2", ideal(arm).path, eq.ZeroFreeLength())
    with pytest.raises(InputError, match="which spring"):
        eq.survey_catalogue(arm, [ideal(arm), other], sweep, BOUNDS, stock)
    with pytest.raises(InputError, match="no spring 's3'"):
        eq.survey_catalogue(arm, [ideal(arm)], sweep, BOUNDS, stock, spring="s3")
    with pytest.raises(InputError, match="no spring along a length"):
        eq.survey_catalogue(arm, [eq.Counterweight("w", arm.at("arm", -0.1))], sweep, {}, stock)


def test_other_springs_stay_unknown_beside_the_part(stock):
    """Two joints: the elbow's ideal spring finds its rate while the shoulder's part is sought."""
    two = eq.chain([eq.Link("upper", length=0.4, mass=2.0), eq.Link("fore", length=0.3, mass=1.0)])
    over = eq.Sweep.grid(two, {"upper_joint": (0.2, 1.2, 9), "fore_joint": (-1.0, 0.0, 9)})
    s1 = eq.Spring("s1", eq.Line(two.at("world", 0, 0, 0.3), two.at("upper", 0.2)), eq.ZeroFreeLength())
    s2 = eq.Spring("s2", eq.Line(two.at("upper", 0, 0, 0.2), two.at("fore", 0.1)), eq.Linear())
    bounds = {"s1.path.line.0.z": (0.1, 0.6), "s1.path.line.1.x": (0.1, 0.35)}
    found = eq.survey_catalogue(two, [s1, s2], over, bounds, stock, spring="s1")
    line = found.ranked[0]
    from equipoise.parameters import write

    placed = write(
        [eq.Spring("s1", s1.path, found.catalogue.spring(found.row(line))), s2],
        dict(zip(found.free, line.geometry, strict=True)),
    )
    design = eq.balance(two, placed, over)
    assert np.hypot(*(row.rms for row in design.after.values())) == pytest.approx(line.value, rel=1e-3)


def test_pick_puts_the_best_part_in_place(arm, stock):
    over = eq.Sweep.sobol(arm, 64, ranges={"arm_joint": (-1.0, 1.2)})
    design = eq.shape(arm, [ideal(arm)], over, BOUNDS, norm="peak", starts=2)
    grid = eq.MakeableGrid(wire=(0.0018, 0.0032), index=(8.0, 12.0), coils=(50.0, 80.0), tension=(0.8,))
    picked = eq.pick(design, eq.Pick(grid=grid, keep=2))
    made, choice = picked.design, picked.choices[0]
    assert isinstance(made.balancers[0].law, eq.ExtensionSpring)
    assert made.after["arm_joint"].peak < 0.2 * design.before["arm_joint"].peak
    assert made.after["arm_joint"].peak <= 1.01 * min(one.value for one in choice.tried)
    assert choice.order == made.parts()[0]["order"]
    assert len(choice.tried) == 2
    assert choice.json()["candidates"] == 2 * len(grid.catalogue())
    assert choice.order in str(picked)
    assert type(choice).read(choice.json()) == choice
    assert eq.verify(made, poses=100).verification.agrees
    low, high = made.balancers[0].law.span
    length = made.parts()[0]["length"]
    assert low - 1e-6 <= length[0] <= length[1] <= high + 1e-6


def test_the_last_choice_is_by_the_band_where_it_judges(arm):
    """Of the parts that were shaped around the one with the least 95 % value stays."""
    over = eq.Sweep.sobol(arm, 64, ranges={"arm_joint": (-1.0, 1.2)})
    banded = eq.Aim(norm="peak", judged="band")
    design = eq.shape(arm, [ideal(arm)], over, BOUNDS, objective=banded, starts=2)
    grid = eq.MakeableGrid(wire=(0.0018, 0.0032), index=(8.0, 12.0), coils=(50.0, 80.0), tension=(0.8,))
    picked = eq.pick(design, eq.Pick(grid=grid, keep=2), scatter=eq.Scatter(anchor=4e-3))
    tried = picked.choices[0].tried
    assert [one.high for one in tried] == sorted(one.high for one in tried)
    assert tried[0] is picked.choices[0].taken
    again = eq.tolerance(picked.design, eq.Scatter(anchor=4e-3))
    assert tried[0].high == pytest.approx(again.band.high, rel=1e-9)
    assert all(one.high > one.value for one in tried)
    assert f"(95 %: {tried[0].high:.4g})" in str(picked)


def test_pick_without_a_fitting_part_counts_the_reasons(arm, sweep, tmp_path):
    design = eq.balance(arm, [ideal(arm)], sweep)
    file = tmp_path / "long.csv"
    file.write_text("part,rate [N/mm],free length [mm],max length [mm]\nA,1,900,950\nB,1,5,6\n")
    with pytest.raises(InfeasibleError, match=r"none of 4 candidates .* refused 4 by working range of s1") as error:
        eq.pick(design, eq.Pick(catalogue=file))
    assert "comes nearest and misses" in error.value.hint
    with pytest.raises(InputError, match="no ideal spring 's9'"):
        eq.pick(design, eq.Pick(springs=("s9",)))


PROBLEM = """\
mechanism: {chain: {links: [{name: arm, length: 600 mm, mass: 4 kg, limits: [-57 deg, 68 deg]}]}}
sweep: {grid: {arm_joint: [-57 deg, 68 deg, 41]}}
balancers:
  - spring: {name: s1, path: {line: [[world, 0, 0, 300 mm], [arm, 200 mm, 0, 0]]}, law: zero_free_length}
shape: {s1.path.line.0.z: [100 mm, 800 mm], s1.path.line.1.x: [50 mm, 550 mm]}
search: {starts: 2}
objective: {goal: hold, norm: rms}
"""


@pytest.fixture
def problem(tmp_path):
    (tmp_path / "springs.csv").write_text(
        "".join(line for i, line in enumerate(STOCK.read_text().splitlines(keepends=True)) if i < 2 or i % 60 == 0)
    )
    file = tmp_path / "arm.yaml"
    file.write_text(PROBLEM + "pick: {catalogue: springs.csv, parallel: 1, keep: 1}\n")
    return file


def test_design_picks_where_the_file_asks(problem, tmp_path, capsys):
    assert main(["design", str(problem), "--json", "--out", str(tmp_path / "out")]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["parts"][0]["law"] == "StockSpring"
    assert found["parts"][0]["order"].startswith("SY-")
    assert found["verification"]["agrees"]
    again = load_problem(tmp_path / "out" / "picked.yaml")
    again.check()
    assert again.content.pick is None
    assert isinstance(again.balancers[0].law, eq.StockSpring)
    assert (tmp_path / "out" / "candidates_s1.csv").exists()
    page = (tmp_path / "out" / "report.html").read_text()
    assert found["parts"][0]["order"] in page
    assert "What to order" in page
    assert "s1 breaks" in page
    assert "Candidates tried" in page
    assert "taken</td>" in page
    assert main(["verify", str(tmp_path / "out" / "design.json")]) == 0
    assert main(["report", str(tmp_path / "out" / "design.json"), "--out", str(tmp_path / "again")]) == 0
    assert "taken</td>" in (tmp_path / "again" / "report.html").read_text()


def test_survey_command_resumes(problem, tmp_path, capsys):
    out = tmp_path / "survey"
    arguments = ["survey", str(problem), "--json", "--out", str(out)]
    assert main(arguments) == 0
    first = json.loads(capsys.readouterr().out)
    rows = (out / "survey.rows.csv").read_text().splitlines()
    assert len(rows) == 2 + first["candidates"]
    (out / "survey.rows.csv").write_text("\n".join(rows[:9]) + "\n")
    assert main(arguments) == 0
    said = capsys.readouterr()
    assert "7 candidates were finished before" in said.err
    second = json.loads(said.out)
    assert [line["part"] for line in second["ranked"]] == [line["part"] for line in first["ranked"]]
    assert second["ranked"][0]["value"] == pytest.approx(first["ranked"][0]["value"], rel=1e-6)
    assert (out / "survey.csv").read_text().startswith("rank,part,number,value")


def test_a_folder_that_cannot_be_written_is_known_first(problem, tmp_path, capsys):
    file = tmp_path / "taken"
    file.write_text("")
    assert main(["survey", str(problem), "--out", str(file)]) == 2
    assert "cannot write" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--catalogue", "nowhere.csv"], "nowhere.csv: the catalogue cannot be read"),
        (["--catalogue", "{bad}"], "row 3, column 'rate [N/mm]': the rate is -1"),
        (["--units", "cubits"], "no system of units 'cubits'"),
        (["--column", "rate"], "--column rate='Spring Rate'"),
    ],
)
def test_bad_input_ends_with_2(problem, tmp_path, capsys, arguments, words):
    bad = tmp_path / "bad.csv"
    bad.write_text("part,rate [N/mm],free length [mm],max length [mm]\nA,1,50,80\nB,-1,50,80\n")
    for verb in ("pick", "survey"):
        given = [part.format(bad=bad) for part in arguments]
        assert main([verb, str(problem), "--out", str(tmp_path / "out"), *given]) == 2
        said = capsys.readouterr()
        assert words in said.err
        assert said.out == ""


def test_a_line_reads_back_exactly(tmp_path):
    line = Line('a, "b"', 2, 0.1, 0.2, 1 / 3, 1e-17, (0.1, -2.0), "stroke of s1", 0.3)
    ledger = Ledger(tmp_path / "rows.csv", "s", ("x", "y"), ("m", ""))
    ledger.append([line])
    assert ledger.load() == [line]


def test_so101_stock_spring(tmp_path):
    """The example on fewer poses and fewer rows: a part of the catalogue within 10 % of the floor, verified."""
    examples = STOCK.parent
    text = (examples / "so101_stock_spring.yaml").read_text().replace("sobol: 256", "sobol: 32")
    file = tmp_path / "so101_stock_spring.yaml"
    file.write_text(text.replace("width: 16 mm", "width: 16 mm\n  part: SY-0[13578]?2").replace("keep: 3", "keep: 1"))
    (tmp_path / "stock_springs.csv").write_text(STOCK.read_text())
    problem = load_problem(file)
    problem.check()
    ideal_one = shaped(problem, None, 2)[0]
    found, real = picked(problem, ideal_one, problem.content.pick, 0)
    elbow = found.design.before["elbow_flex"].peak
    assert elbow <= found.design.after["shoulder_lift"].peak <= 1.1 * elbow
    assert found.choices[0].removed["width <= 16 mm"] > 5
    part = found.design.parts()[0]
    assert part["part_number"] in {row.split(",")[0] for row in STOCK.read_text().splitlines()}
    assert 0 < part["clauses"]["travel"]["used"] <= 1 + 1e-6
    assert isinstance(real.balancers[0].law, eq.StockSpring)
    assert eq.verify(found.design, poses=100).verification.agrees
