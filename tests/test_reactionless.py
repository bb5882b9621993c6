"""Balance for all motions: ranks, conditions, what forbids it, and what it costs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import equipoise as eq
from equipoise.cli import main
from equipoise.problem import load_problem
from test_rrr3 import manipulator, motion

EXAMPLES = Path(__file__).parents[1] / "examples"


@pytest.fixture(scope="module")
def bar():
    return eq.four_bar(0.14, 0.05, 0.15, 0.125, masses=(0.1, 0.3, 0.25), gravity=(0, 0, 0))


@pytest.fixture(scope="module")
def three():
    return manipulator()


RANKS = [("bar", "force", 4, 12), ("bar", "both", 8, 12), ("three", "force", 10, 28), ("three", "both", 19, 28)]


@pytest.mark.parametrize(("name", "goal", "rank", "count"), RANKS)
def test_ranks(request, name, goal, rank, count):
    found = eq.conditions(request.getfixturevalue(name), goal)
    assert (found.rank, len(found.names)) == (rank, count)
    assert found.gap > 1e8
    assert found.null.shape == (count - rank, count)
    np.testing.assert_allclose(found.rows @ found.null.T, 0.0, atol=1e-9)


@pytest.mark.parametrize("com", [(0.075, 0.0), (0.06, 0.02)])
def test_force_conditions_of_a_four_bar_are_those_of_berkof_and_lowen(com):
    """m2 b2 e^(i f2) = -m3 a (1 - (b3/b) e^(i f3)), m4 b4 e^(i f4) = -m3 c (b3/b) e^(i f3)."""
    a, b, c, m3 = 0.05, 0.15, 0.125, 0.3
    bar = eq.four_bar(0.14, a, b, c, masses=(0.1, m3, 0.25), coms=(0.0, com, 0.0))
    found = eq.conditions(bar)
    share = complex(*com) / b
    crank, rocker = -m3 * a * (1 - share), -m3 * c * share
    assert [found.names[i] for i in found.solved] == ["crank.mx", "crank.mz", "rocker.mx", "rocker.mz"]
    np.testing.assert_allclose(found.missing, [crank.real, crank.imag, rocker.real, rocker.imag], atol=1e-12)
    rocker_first = eq.conditions(bar, solve_for=["coupler"])
    assert {rocker_first.names[i] for i in rocker_first.solved} >= {"coupler.mx", "coupler.mz"}


# Full balance without counter-rotation exists for antiparallelograms and two kinds of kites only.
FAMILIES = {
    "generic": ((2.8, 1, 3, 2.5, "open"), False),
    "parallelogram": ((3, 1, 3, 1, "open"), False),
    "antiparallelogram": ((3, 1, 3, 1, "crossed"), True),
    "kite a = b": ((2.2, 1, 1, 2.2, "open"), True),
    "kite a = d": ((2.2, 2.2, 1, 1, "open"), True),
    "kite b = c": ((1, 1, 2.2, 2.2, "open"), False),
}


@pytest.mark.parametrize("family", FAMILIES)
def test_full_balance_by_mass_alone(family):
    (ground, crank, coupler, rocker, branch), possible = FAMILIES[family]
    bar = eq.four_bar(ground, crank, coupler, rocker, branch=branch, masses=(0, 1.0, 0))
    found = eq.conditions(bar, "both")
    assert found.completion.possible is possible
    if possible:
        added = found.own + np.array([found.completion.added.get(name, 0.0) for name in found.names])
        np.testing.assert_allclose(found.rows @ added, 0.0, atol=1e-8)
        for m, mx, mz, J in added.reshape(-1, 4):
            assert m * J - mx**2 - mz**2 > -1e-8
    else:
        assert found.completion.form
        assert found.completion.own > 0
        assert all(share.second >= 0 and share.first >= 0 for share in found.completion.form)


def discs(bodies):
    radius = {"crank": 0.103433, "rod": 0.108095}
    return [
        eq.Counterweight(f"c_{body}", eq.Point(body), reach=radius[body.partition("_")[0]], shape=eq.Plate())
        for body in bodies
    ]


EVERY = tuple(f"{kind}_{leg}" for leg in (1, 2, 3) for kind in ("crank", "rod"))


@pytest.mark.parametrize(
    ("bodies", "mass", "rms", "peak"), [(EVERY, 26.2479, 6.3036, 9.994), (EVERY[:-1], 29.2333, 10.31, 16.75)]
)
def test_least_mass_that_balances_the_force_of_a_3rrr(three, bodies, mass, rms, peak):
    least = eq.Aim("mass", norm="peak")
    found = eq.balance(three, discs(bodies), motion(three), objective=least, limits=[eq.Balanced("force")])
    assert found.added_mass == pytest.approx(mass, rel=2e-6)
    assert found.after["force"].peak < 1e-10 * found.before["force"].peak
    assert found.after["moment"].rms == pytest.approx(rms, abs=3e-3)
    assert found.after["moment"].peak == pytest.approx(peak, abs=6e-3)


@pytest.mark.parametrize(("ratio", "com"), [(1.0, (0.075, 0.0)), (2.5, (0.06, 0.02)), (0.7, (0.06, 0.02))])
def test_gears_and_weights_balance_all_motions_at_any_ratio(ratio, com):
    """Off-line couplers need a weight on the coupler too; one program finds weights and rotors together."""
    bar = eq.four_bar(0.14, 0.05, 0.15, 0.125, masses=(0.1, 0.3, 0.25), coms=(0.025, com, 0.06), gravity=(0, 0, 0))
    added = [
        eq.Counterweight(f"w_{b}", eq.Point(b), reach=0.08, shape=eq.Plate()) for b in ("crank", "coupler", "rocker")
    ]
    added += [eq.CounterRotor(f"g_{b}", b, ratio=ratio, radius=0.1) for b in ("crank", "coupler", "rocker")]
    sweep = eq.Sweep.motion(bar, {"crank_joint": "9*t + 2*sin(5*t)"}, duration=0.8, samples=81)
    found = eq.balance(bar, added, sweep, objective=eq.Aim("mass", norm="peak"), limits=[eq.Balanced("both")])
    for row in ("force", "moment"):
        assert found.after[row].peak < 1e-10 * found.before[row].peak


def test_mass_alone_is_refused_with_the_reason(bar):
    weights = [
        eq.Counterweight(f"w_{b}", eq.Point(b), reach=0.5, shape=eq.Plate()) for b in ("crank", "coupler", "rocker")
    ]
    aim = eq.Aim("mass", norm="peak")
    with pytest.raises(eq.InfeasibleError, match="moment of inertia of coupler about its joint"):
        eq.balance(bar, weights, eq.Sweep.any_motion(bar, 16), objective=aim, limits=[eq.Balanced("both")])


def test_the_command_and_its_mistakes(capsys):
    file = str(EXAMPLES / "four_bar_balance.yaml")
    assert main(["conditions", file, "--goal", "both", "--json"]) == 0
    said = capsys.readouterr()
    assert "0.6944 x the moment of inertia of coupler" in said.err
    assert '"rank": 8' in said.out
    assert main(["conditions", file, "--goal", "torque"]) == 2
    assert main(["conditions", file, "--on", "wheel"]) == 2
    assert main(["conditions", file, "--for", "wheel"]) == 2
    capsys.readouterr()


@pytest.fixture(scope="module")
def both_ways():
    found = {}
    for name in ("rrr3_reactionless", "rrr3_flywheel"):
        problem = load_problem(EXAMPLES / f"{name}.yaml")
        pieces = (problem.mechanism, problem.balancers, problem.sweep)
        found[name] = eq.balance(*pieces, objective=problem.objective, limits=problem.limits)
    return found


@pytest.mark.parametrize("name", ["rrr3_reactionless", "rrr3_flywheel"])
def test_examples_leave_nothing_at_the_base(both_ways, name):
    design = both_ways[name]
    for row in ("force", "moment"):
        assert design.after[row].peak < 1e-10 * design.before[row].peak
    assert design.certificate.kind == "convex"
    assert 0 <= design.certificate.gap < 1e-6 * design.certificate.primal


def test_gears_hold_the_inertia_that_the_links_have(both_ways):
    """Eqs. 18 and 19 with the masses found: I4 and I5 are what turns with each link, their gears included."""
    values, links = both_ways["rrr3_reactionless"].values, 0.5 * 0.18**2 / 3
    share = (3 + values["platform_ring.m"]) / 3
    rod = links + values["rod_weight.J"] + share * 0.18**2
    crank = links + values["crank_weight.J"] + (share + 0.5 + values["rod_weight.m"]) * 0.18**2
    assert values["rod_gear.J"] == pytest.approx(rod + 0.006, rel=1e-5)
    assert values["crank_gear.J"] == pytest.approx(crank + 0.005, rel=1e-5)


def test_side_by_side(both_ways):
    table = eq.side_by_side(both_ways)
    assert table.columns == ("bare", "rrr3_reactionless", "rrr3_flywheel")
    lines = {line.what: line.values for line in table.lines}
    assert lines["added mass"][1:] == pytest.approx([design.added_mass for design in both_ways.values()])
    assert lines["flywheel motor, power"] == (None, None, pytest.approx(200.0))
    assert lines["drive effort, peak"][1] > 2 * lines["drive effort, peak"][2]
    assert lines["torque reversals in all meshes"][1] >= 6
    assert "shaking moment, peak [N m]" in str(table)
    with pytest.raises(eq.InputError, match="no design"):
        eq.side_by_side({})


def flat_weights():
    reaches = {"crank": 0.05, "rocker": 0.0625}
    return [eq.Counterweight(f"w_{b}", eq.Point(b), reach=reach, shape=eq.Plate()) for b, reach in reaches.items()]


def test_the_front_of_force_moment_and_torque_against_mass(bar):
    turn = eq.Sweep.motion(bar, {"crank_joint": "2*pi*t/T"}, duration=0.12)
    aims = [eq.Aim(goal, divisor="before") for goal in ("force", "moment", "drive")]
    found = eq.front(bar, flat_weights(), turn, objective=aims, caps=(0.25, 0.5, 0.75, 1.5))
    sums = [0.64194 + 0.98137 + 1.00870, 0.54662 + 0.77064 + 1.09745, 2.24210952, 0.43527 + 0.35179 + 1.16068]
    np.testing.assert_allclose([step.value for step in found.steps], sums, atol=2e-5)
    assert found.steps[2].value == pytest.approx(2.24210952, abs=1e-8)
    for step in found.steps:
        assert 0 <= step.value - step.dual < 1e-8
    slopes = np.diff([step.value for step in found.steps]) / np.diff([step.cap for step in found.steps])
    prices = [-step.price for step in found.steps]
    assert all(first <= slope <= last for first, slope, last in zip(prices, slopes, prices[1:], strict=False))


def test_the_front_of_moment_against_mass_begins_at_force_balance(bar):
    turn = eq.Sweep.motion(bar, {"crank_joint": "2*pi*t/T"}, duration=0.12, samples=121)
    found = eq.front(bar, flat_weights(), turn, objective=eq.Aim("moment"), limits=[eq.Balanced("force")], points=4)
    assert found.least == pytest.approx(0.75, rel=1e-6)
    assert found.steps[0].value == pytest.approx(5.78867, rel=1e-3)
    assert all(b.value < a.value for a, b in zip(found.steps, found.steps[1:], strict=False))
    assert "0.7500 kg at least" in str(found)
    with pytest.raises(eq.InfeasibleError, match=r"ask for 0\.75 at least"):
        eq.front(bar, flat_weights(), turn, objective=eq.Aim("moment"), limits=[eq.Balanced("force")], caps=[0.5])
