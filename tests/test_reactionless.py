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
    assert main(["conditions", file, "--reach", "-5 mm"]) == 2
    assert main(["front", file, "--caps", "0.5 kg, 0.2 kg"]) == 2
    assert main(["front", file, "--against", "weight"]) == 2
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
    assert lines["flywheel motor, power"] == (None, None, pytest.approx(200.0, rel=1e-3))
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


@pytest.fixture(scope="module")
def turning_bar(bar):
    """The force-balanced four-bar over one turn at 500 rpm with a flywheel of 0.01 kg m^2, and its law."""
    at = {"crank": ((-0.05, 0, 0), 0.2), "rocker": ((-0.0625, 0, 0), 0.55)}
    weights = [eq.Counterweight(f"w_{body}", eq.Point(body, place), mass=mass) for body, (place, mass) in at.items()]
    wheel = eq.Flywheel("wheel", inertia=0.01)
    sweep = eq.Sweep.motion(bar, {"crank_joint": "2*pi*t/T"}, duration=0.12, samples=361)
    design = eq.balance(bar, [*weights, wheel], sweep, objective=eq.Aim("force"))
    return design, design.flywheel_law(wheel)


def wheel_of(law, **options):
    """The law of another flywheel against the same moment."""
    axis = np.array([0.0, -1.0, 0.0])
    moment, momentum = np.outer(-law.torque, axis), np.outer(-law.speed * law.inertia, axis)
    wheel = eq.Flywheel("wheel", **options)
    wheel.check(None)
    return wheel.law(law.time, moment, momentum)


def test_the_angle_of_a_flywheel_is_a_closed_form(turning_bar):
    """K3 and K4 of Berkof's in-line four-bar; the crank's uniform turning adds nothing to the speed."""
    design, law = turning_bar
    K3, K4 = -0.001125, 0.00579427083
    assert law.form["coupler"] == pytest.approx(K3, rel=1e-8)
    assert law.form["rocker"] == pytest.approx(K4, rel=1e-8)
    q, v = design.states.kin.q, design.states.rates.velocity
    crank = law.form["crank"]
    turned = K3 * (q[:, 0] + q[:, 1]) + K4 * q[:, 2] + crank * q[:, 0]
    begun = K3 * (v[0, 0] + v[0, 1]) + K4 * v[0, 2] + crank * v[0, 0]
    np.testing.assert_allclose(law.angle, (begun * law.time - (turned - turned[0])) / 0.01, atol=1e-10)
    integral = np.concatenate([[0], np.cumsum(0.5 * (law.speed[1:] + law.speed[:-1]) * np.diff(law.time))])
    np.testing.assert_allclose(law.angle, integral, atol=2e-3)
    assert "in closed form" in str(design)


@pytest.mark.parametrize("limits", [{"speed": 100.0}, {"power": 300.0}, {"speed": 60.0, "power": 300.0}])
def test_the_smallest_flywheel_from_rest_and_turning(turning_bar, limits):
    from_rest, turning = (wheel_of(turning_bar[1], **limits, start=start) for start in ("rest", "turning"))
    for law in (from_rest, turning):
        assert np.abs(law.speed).max() <= limits.get("speed", np.inf) * (1 + 1e-9)
        assert np.abs(law.power).max() <= limits.get("power", np.inf) * (1 + 1e-9)
        reached = [np.abs(getattr(law, what)).max() / most for what, most in limits.items()]
        assert max(reached) > 1 - 1e-3
        assert law.inertia == pytest.approx(max(law.needs.values()))
    assert from_rest.speed[0] == 0
    assert turning.inertia < 0.999 * from_rest.inertia
    np.testing.assert_allclose(turning.torque, from_rest.torque, atol=1e-12)
    # no other initial speed needs less
    stored = turning.speed * turning.inertia
    for other in (-1e-2, 1e-2):
        shifted = stored + other * np.ptp(stored)
        speed = np.abs(shifted).max() / limits.get("speed", np.inf)
        power = np.abs(turning.torque * shifted).max() / limits.get("power", np.inf)
        assert max(speed, power) > turning.inertia


def test_a_motor_too_weak_for_the_flywheel_is_refused(turning_bar):
    law = turning_bar[1]
    with pytest.raises(eq.InfeasibleError, match="no inertia changes that"):
        wheel_of(law, inertia=0.01, torque=1.0)
    with pytest.raises(eq.InfeasibleError, match="too little for the motor's speed"):
        wheel_of(law, inertia=1e-4, speed=10.0)
    with pytest.raises(eq.InputError, match="cannot start 'rset'"):
        wheel_of(law, inertia=0.01, start="rset")


def test_meshes_of_a_planetary_pair(three):
    """The belt carries the pair's own inertia and the rotor's through the ratio: (J_gear + rho^2 J) w'."""
    states = three.states(motion(three, samples=101))
    rotor = eq.CounterRotor("g", "rod_1", ratio=2.0, inertia=0.03, gear_inertia=0.006)
    mesh, belt = rotor.meshes(states, {})
    spin = states.placement("rod_1").push @ np.array([0.0, -1.0, 0.0])
    np.testing.assert_allclose(mesh.torque, -0.06 * spin, atol=1e-12)
    np.testing.assert_allclose(belt.torque, (0.006 + 4 * 0.03) * spin, atol=1e-12)
    for one in (mesh, belt):
        assert one.reversals >= 1
        one_sided = (one.torque + one.preload).min() >= -1e-12 or (one.torque - one.preload).max() <= 1e-12
        assert one_sided


def test_a_cap_counts_for_weights_that_no_residual_feels(bar):
    """A point on the uniformly turning crank brings no moment: its mass must count in the cap all the same."""
    weights = [eq.Counterweight(f"w_{b}", eq.Point(b, (-0.03, 0, 0))) for b in ("crank", "rocker")]
    turn = eq.Sweep.motion(bar, {"crank_joint": "2*pi*t/T"}, duration=0.12, samples=61)
    aims = [eq.Aim("moment"), eq.Aim("mass", cap=1.2)]
    with pytest.raises(eq.InfeasibleError, match=r"force balanced in all motions and .*mass"):
        eq.balance(bar, weights, turn, objective=aims, limits=[eq.Balanced("force")])
    free = {"w_crank.at.x": (-0.06, -0.01), "w_rocker.at.x": (-0.08, -0.01)}
    found = eq.shape(bar, weights, turn, free, objective=aims, limits=[eq.Balanced("force")], starts=2)
    assert found.added_mass == pytest.approx(1.2, rel=1e-6)
    assert found.geometry["w_crank.at.x"] * found.values["w_crank.m"] == pytest.approx(-0.01, rel=1e-8)
    assert found.geometry["w_rocker.at.x"] * found.values["w_rocker.m"] == pytest.approx(-0.034375, rel=1e-8)


def test_conditions_in_space():
    """Ten parameters a body: what force balance asks of an arm on a turret, by hand."""
    links = [
        eq.Link("turret", length=0.2, mass=2.0, axis=(0, 0, 1)),
        eq.Link("boom", length=0.5, mass=3.0, com=(0.2, 0.03, 0.05)),
    ]
    arm = eq.chain(links, gravity=(0, 0, 0))
    found = eq.conditions(arm)
    assert len(found.names) == 20
    # the boom's origin lies on the turret's x axis; about its own axis y the boom must have mx = mz = 0
    assert found.rank == 4
    missing = dict(zip([found.names[i] for i in found.solved], found.missing, strict=True))
    assert missing["boom.mx"] == pytest.approx(-0.6)
    assert missing["boom.mz"] == pytest.approx(-0.15)
    assert missing["turret.mx"] == pytest.approx(-(2.0 * 0.1 + 3.0 * 0.2))
    assert missing["turret.my"] == pytest.approx(-0.09)
    assert found.completion.possible
    weights = [eq.Counterweight(f"w_{b}", eq.Point(b), reach=0.4, shape=eq.Solid()) for b in ("turret", "boom")]
    least = eq.Aim("mass", norm="peak")
    design = eq.balance(arm, weights, eq.Sweep.any_motion(arm, 16), objective=least, limits=[eq.Balanced("force")])
    assert design.after["force"].peak < 1e-10 * design.before["force"].peak
    lever = np.hypot(0.6, 0.15) / 0.4
    # a little more than its own lever asks: first moment along y spares the turret
    assert lever < design.values["w_boom.m"] < 1.01 * lever
