"""discover: columns against the assembled effort, subsets against brute force, fronts against known optima."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import lsq_linear

import equipoise as eq
from equipoise.assemble import effort
from equipoise.cli import main
from equipoise.discovery.ask import masses, tip
from equipoise.discovery.collect import collect
from equipoise.discovery.plain import plain_problem
from equipoise.discovery.subsets import Search
from equipoise.discovery.words import next_steps, summary
from equipoise.errors import InfeasibleError
from equipoise.problem import load_problem, problem_of
from equipoise.reporting.front_page import page
from equipoise.reporting.numbers import place
from equipoise.verbs.shape import descended
from equipoise.yamlfile import Document

G = 9.81


def arm(**options):
    links = [
        eq.Link("upper", length=0.5, mass=3.0),
        eq.Link("fore", length=0.4, mass=2.0, com=(0.15, 0.02)),
    ]
    return eq.chain(links, base=(0.0, 0.0, 0.3), **options)


def spatial():
    """A turret and two links whose axes are not parallel to those of their frames."""
    links = [
        eq.Link("turret", length=0.2, mass=2.0, axis=(0, 0, 1)),
        eq.Link("boom", length=0.5, mass=3.0, com=(0.2, 0.03, 0.05)),
        eq.Link("hand", length=0.3, mass=0.7, axis=(0, 0.6, 0.8)),
    ]
    return eq.chain(links, name="spatial")


KINDS = {
    "ideal": eq.Ideal(),
    "coils": eq.Coils(stretch=4.0),
    "compression": eq.CompressionCoils(solid=0.2),
    "cable": eq.CableSprings(elongation=2.0, ratio=0.5),
    "constant": eq.ConstantForce(stroke=0.4),
    "gas": eq.GasStruts(reach=3.0),
    "torsion": eq.TorsionSprings(),
    "counterweights": eq.Counterweights(mass=3.0),
}


@pytest.fixture(scope="module", params=["planar", "spatial"])
def posed(request):
    mech = arm() if request.param == "planar" else spatial()
    payload = [eq.Payload(mech.bodies[-1], (0.0, 1.0), (0.1, 0.0, 0.0))]
    return mech, eq.Sweep.sobol(mech, 64, payload=payload)


@pytest.mark.parametrize("kind", KINDS)
def test_columns_are_the_effort_of_the_balancers_they_become(posed, kind):
    """A column times its unknown is what the proposed balancer does, at the values the column stands for."""
    mech, sweep = posed
    found = collect(mech, sweep, eq.Discover(kinds=(KINDS[kind],), candidates=300), eq.Aim(norm="peak"))
    dictionary, states = found.dictionary, found.scene.states
    rng = np.random.default_rng(3)
    assert np.abs(dictionary.loads[1] - dictionary.loads[0]).max() > 0.1
    for index in rng.choice(len(dictionary), 6):
        proposal = dictionary.propose(int(index), 1)
        total = effort(mech, [proposal.balancer], states)
        rows = np.stack([found.scene.counted(total.A[..., p]) for p in range(total.A.shape[-1])], axis=-1)
        known = found.scene.counted(total.b - states.holding)
        column = dictionary.columns((int(index),))[:, 0]
        scale = np.abs(column).max()
        # The column lies in the span of the balancer's own unknowns: nothing is promised that it cannot do.
        theta = np.linalg.lstsq(rows, column, rcond=None)[0]
        np.testing.assert_allclose(rows @ theta, column, atol=1e-9 * scale)
        assert np.abs(known).max() < 0.02 * scale + 1e-9
        if kind == "ideal":
            longest = proposal.balancer.path.deform(states)[0].max()
            assert theta[0] * longest == pytest.approx(5000.0, rel=1e-9)


def test_compression_keeps_every_norm(posed):
    mech, sweep = posed
    request = eq.Discover(kinds=(eq.Ideal(), eq.Coils(stretch=4.0), eq.Counterweights()), candidates=400)
    dictionary = collect(mech, sweep, request, eq.Aim(norm="rms")).dictionary
    short = dictionary.compressed
    assert short.lost < 1e-4
    rng = np.random.default_rng(1)
    for _ in range(5):
        subset = tuple(int(i) for i in rng.choice(len(dictionary), 4, replace=False))
        k = rng.random(4)
        whole = dictionary.loads + dictionary.columns(subset) @ k
        exact = float((dictionary.weight * whole**2).sum() / len(whole))
        left = short.load + short.columns[:, list(subset)] @ k
        assert float(left @ left) + short.constant == pytest.approx(exact, rel=1e-3)


def test_ideal_springs_span_few_functions(posed):
    mech, sweep = posed
    dictionary = collect(mech, sweep, eq.Discover(candidates=2000), eq.Aim(norm="rms")).dictionary
    assert len(dictionary) > 300
    assert dictionary.compressed.rank <= 16 * len(dictionary.batches)


def brute(columns, load, spots, size):
    """The best subset by a bounded least-squares solve of every one."""
    best = np.inf, ()
    for subset in itertools.combinations(range(columns.shape[1]), size):
        if len({int(spots[i]) for i in subset}) < size:
            continue
        value = 2 * lsq_linear(columns[:, list(subset)], -load, bounds=(0, 1), tol=1e-12).cost
        best = min(best, (value, subset))
    return best


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("tight", [False, True])
def test_pairs_are_those_of_an_exhaustive_search(seed, tight):
    """Closed form against a solver, with bounds that bind and columns of one place that exclude each other."""
    rng = np.random.default_rng(seed)
    columns = rng.normal(size=(5, 24)) * (0.4 if tight else 4.0)
    columns[:, 7] = 1.3 * columns[:, 3]
    load, spots = rng.normal(size=5), np.repeat(np.arange(12), 2)
    search = Search(columns, load, spots)
    value, subset = search.pairs(8)[0]
    expected, chosen = brute(columns, load, spots, 2)
    assert value == pytest.approx(expected, rel=1e-6, abs=1e-9)
    assert search.solve(subset)[0] == pytest.approx(search.solve(chosen)[0], rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_triples_by_beam_and_exchange_are_the_best(seed):
    rng = np.random.default_rng(seed)
    columns, load = rng.normal(size=(6, 11)) * 3.0, rng.normal(size=6)
    search = Search(columns, load, np.arange(11))
    value, _ = search.best(3, keep=64)[3][0]
    assert value == pytest.approx(brute(columns, load, np.arange(11), 3)[0], rel=1e-6, abs=1e-9)


def test_the_best_pair_of_a_real_dictionary_is_the_exhaustive_one():
    mech = arm()
    sweep = eq.Sweep.sobol(mech, 128)
    found = collect(mech, sweep, eq.Discover(candidates=60), eq.Aim(norm="rms"))
    short = found.dictionary.compressed
    search = Search.of(short, found.dictionary.spots)
    value, _ = search.pairs(4)[0]
    root = np.sqrt(found.dictionary.weight)
    A = found.dictionary.columns(tuple(range(len(found.dictionary)))) * root[:, None]
    b = found.dictionary.loads[0] * root
    expected, _ = brute(A, b, found.dictionary.spots, 2)
    assert value + short.constant == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_two_ideal_springs_balance_a_planar_arm():
    """One spring leaves the elbow's own torque; a second to the forearm takes all of it."""
    mech = arm()
    seen = []
    request = eq.Discover(3, candidates=1500, contenders=2)
    front = eq.discover(mech, eq.Sweep.sobol(mech, 128), request, progress=lambda *told: seen.append(told))
    elbow = 2.0 * G * np.hypot(0.15, 0.02)
    assert front.before == pytest.approx(G * (3 * 0.25 + 2 * (0.5 + np.hypot(0.15, 0.02))), rel=1e-3)
    assert [len(design.balancers) for design in front.designs] == [1, 2]
    assert front.values[0] == pytest.approx(elbow, rel=5e-3)
    assert front.values[1] < 1e-6
    assert seen[0][:2] == (1, 3)
    assert any("floor" in note or "next to nothing" in note for note in front.notes) or front.alternatives
    checked = eq.verify(front.designs[1], poses=200).verification
    assert checked.agrees


def test_a_payload_range_ends_at_half_of_its_own_torque():
    mech = arm()
    sweep = eq.Sweep.sobol(mech, 64, payload=[eq.Payload("fore", (0.0, 2.0), (0.4, 0.0, 0.0))])
    front = eq.discover(mech, sweep, eq.Discover(2, candidates=1500, contenders=2))
    floors = {bound.row: bound.value for bound in front.bounds if bound.cause == "payload"}
    assert floors["upper_joint"] == pytest.approx(2.0 * G * 0.9 / 2, rel=1e-6)
    assert floors["fore_joint"] == pytest.approx(2.0 * G * 0.4 / 2, rel=1e-6)
    assert front.values[-1] == pytest.approx(floors["upper_joint"], rel=5e-3)


def test_coils_keep_their_stretch_and_force():
    mech = arm()
    front = eq.discover(mech, eq.Sweep.sobol(mech, 128), eq.Discover(1, kinds=(eq.Coils(force=2000.0),)))
    part = front.designs[0].parts()[0]
    free, (short, long) = part["parameters"]["free_length"], part["length"]
    assert free <= 0.95 * short * (1 + 1e-6)
    assert long <= 2.0 * free * (1 + 1e-6)
    assert part["force"][1] <= 2000.0 * (1 + 1e-6)
    assert front.values[0] < front.before


def test_pairs_regions_and_points_are_obeyed():
    mech = arm()
    sweep = eq.Sweep.sobol(mech, 64)
    base, upper, fore = mech.bodies[0], "upper", "fore"
    request = eq.Discover(
        forbid=((base, fore),), keep_out=(eq.KeepOut(upper, (0.2, -1, -1), (1, 1, 1)),), candidates=400
    )
    found = collect(mech, sweep, request, eq.Aim(norm="rms"))
    assert found.refused["keep out"] > 0
    for index in range(0, len(found.dictionary), 7):
        path = found.dictionary.propose(index, 1).balancer.path
        assert {path.a.body, path.b.body} != {base, fore}
        assert all(end.at[0] <= 0.2 for end in (path.a, path.b) if end.body == upper)
    points = {upper: ((0.1, 0.0, 0.05), (0.3, 0.0, 0.05)), fore: ((0.2, 0.0, 0.0),)}
    found = collect(mech, sweep, eq.Discover(pairs=((upper, fore),), points=points), eq.Aim(norm="rms"))
    assert len(found.dictionary) == 2
    assert found.dictionary.propose(1, 1).balancer.path.a.at == (0.3, 0.0, 0.05)


def test_bad_requests_say_what_and_where():
    mech = arm()
    sweep = eq.Sweep.sobol(mech, 32)

    def ask(**options):
        return eq.discover(mech, sweep, eq.Discover(**options))

    with pytest.raises(eq.InputError, match=r"point 1, \(0.2, 0, 3\) m, lies 2.962 m from the skeleton of fore"):
        ask(points={"fore": ((0.2, 0.0, 3.0),)}, pairs=(("upper", "fore"),))
    with pytest.raises(eq.InputError, match="move as one"):
        ask(pairs=(("fore", "fore"),))
    with pytest.raises(eq.InputError, match="no body 'for'"):
        ask(pairs=(("upper", "for"),))
    with pytest.raises(eq.InputError, match="all 3 pairs are forbidden"):
        ask(forbid=tuple(itertools.combinations((mech.bodies[0], "upper", "fore"), 2)))
    with pytest.raises(InfeasibleError, match="by 'keep out'"):
        ask(keep_out=tuple(eq.KeepOut(body, (-9, -9, -9), (9, 9, 9)) for body in mech.bodies))
    with pytest.raises(InfeasibleError, match=r"by 'longest over 1 times the shortest length'"):
        ask(kinds=(eq.Coils(rest=0.95, stretch=1.053),))
    with pytest.raises(eq.InputError, match="springs is 0"):
        ask(springs=0)
    with pytest.raises(eq.InputError, match="raise `candidates`"):
        ask(spacing=0.001)
    one = eq.chain([eq.Link("upper", length=0.5, mass=3.0)], gravity=(0.0, 0.0, 0.0))
    with pytest.raises(eq.InputError, match="gravity loads no joint"):
        eq.discover(one, eq.Sweep.sobol(one, 16))
    with pytest.raises(eq.InputError, match="holding effort"):
        eq.discover(mech, sweep, objective=(eq.Aim("force"),))


def test_found_balancers_read_back_from_a_problem_file():
    """What the plain data says is what was found, for every kind."""
    mech = spatial()
    sweep = eq.Sweep.sobol(mech, 64)
    content = {"mechanism": {"chain": {"links": [{"name": "a", "length": 1, "mass": 1}]}}, "discover": {"springs": 2}}
    for kind in KINDS.values():
        found = collect(mech, sweep, eq.Discover(kinds=(kind,), candidates=200), eq.Aim(norm="rms"))
        proposal = found.dictionary.propose(len(found.dictionary) // 2, 1)
        data = plain_problem(content, [proposal.balancer], proposal.limits, proposal.free)
        assert "discover" not in data
        read = problem_of(Document("", json.loads(json.dumps(data))), None).content
        assert read.balancers == (proposal.balancer,)
        assert read.limits == proposal.limits
        assert {name: tuple(pair) for name, pair in (read.shape or {}).items()} == dict(proposal.free)


def test_words_of_the_command_line():
    assert masses("0,5kg") == [0.0, 5.0]
    assert masses("0, 2500 g") == [0.0, 2.5]
    with pytest.raises(eq.InputError, match="--payload"):
        masses("0,heavy")
    with pytest.raises(eq.InputError, match="a payload of -1 kg"):
        masses("-1")
    assert tip(arm()) == "fore"


def test_command_line_writes_designs_that_other_verbs_accept(tmp_path, capsys):
    file = tmp_path / "arm.yaml"
    file.write_text(
        "mechanism: {chain: {links: [{name: upper, length: 0.5, mass: 3}, {name: fore, length: 0.4, mass: 2}]}}\n"
        "sweep: {sobol: 64}\n"
        "discover: {springs: 2, kinds: [zero_free_length, torsion], candidates: 400, contenders: 2}\n"
        "objective: {norm: peak, target: 1 N m}\n",
        encoding="utf-8",
    )

    out = tmp_path / "out"
    assert main(["discover", str(file), "--json", "--out", str(out)]) == 0
    data = json.loads(capsys.readouterr().out)
    assert [len(design["parts"]) for design in data["front"]] == [1, 2]
    assert data["front"][1]["verification"]["max_abs_error"] < 1e-9
    assert data == json.loads((out / "front.json").read_text(encoding="utf-8"))
    assert main(["verify", str(out / "springs_2" / "design.json"), "--json", "--poses", "50"]) == 0
    assert json.loads(capsys.readouterr().out)["after"]["upper_joint"]["peak"] < 1.0
    file.write_text(file.read_text(encoding="utf-8").replace("springs: 2", "sprungs: 2"), encoding="utf-8")
    assert main(["discover", str(file)]) == 2
    assert "line 3" in capsys.readouterr().err


EXAMPLES = Path(__file__).parent.parent / "examples"


def found(name, poses):
    """The front of an example over the first few of its poses, which a Sobol sweep spreads evenly too."""
    problem = load_problem(EXAMPLES / name)
    problem.check()
    sweep = problem.sweep.thinned(np.arange(poses))
    return eq.discover(
        problem.mechanism, sweep, problem.content.discover, objective=problem.objective, limits=problem.limits
    )


def test_ur10_discover():
    """Two ideal springs leave the wrist's own load, from 121 N m at the shoulder."""
    front = found("ur10_discover.yaml", 256)
    assert front.before == pytest.approx(121.03, abs=0.05)
    assert front.values[0] == pytest.approx(34.235, abs=0.3)
    assert front.values[1] <= 0.3
    assert not front.designs[1].missed
    assert front.recommended == 1
    for design in front.designs:
        assert all(part["force"][1] <= 2000 * (1 + 1e-6) for part in design.parts())
        assert design.certificate.kind == "local"


def test_panda_discover_with_one_spring():
    """A single spring across shoulder, roll and elbow; the whole example, with two, takes minutes."""
    problem = load_problem(EXAMPLES / "panda_discover.yaml")
    problem.check()
    request = replace(problem.content.discover, springs=1, contenders=1)
    front = eq.discover(problem.mechanism, problem.sweep.thinned(np.arange(128)), request, objective=problem.objective)
    assert front.before == pytest.approx(57.0, abs=0.8)
    assert front.values[0] < 26.0
    assert eq.verify(front.designs[0], poses=200).verification.agrees


def test_a_cable_over_a_guide_realises_zero_free_length_in_the_room_of_a_link():
    """The coil lies along the upper arm; its free length, extension and cable follow from the room there."""
    mech = arm()
    kind = eq.CableSprings(elongation=1.0, ratio=0.5, fittings=0.02, force=4000.0)
    request = eq.Discover(1, kinds=(kind,), pairs=((mech.bodies[0], "upper"),), candidates=900, contenders=2)
    front = eq.discover(mech, eq.Sweep.sobol(mech, 64), request)
    design = front.designs[0]
    spring, part = design.balancers[0], design.parts()[0]
    anchor, guide, hook = spring.path.through
    assert anchor.body == guide.body != hook.body
    run = np.linalg.norm(np.subtract(anchor.at, guide.at))
    free = part["parameters"]["free_length"]
    assert 2 * free <= run - 0.02 + 1e-9
    assert part["length"][1] <= 2 * free * (1 + 1e-6)
    assert part["length"][0] >= free * (1 - 1e-6)
    assert part["force"][1] <= 4000.0 * (1 + 1e-6)
    # The spring's length by plain geometry: half of the cable's, whatever its own length was cut to.
    pose = design.states
    there = [pose.point(point)[0] for point in (anchor, guide.centre, hook)]
    cable = sum(np.linalg.norm(b - a, axis=-1) for a, b in itertools.pairwise(there))
    np.testing.assert_allclose(spring.path.deform(pose)[0], 0.5 * cable + spring.path.offset, atol=1e-9)
    assert front.values[0] < 0.6 * front.before
    assert eq.verify(design, poses=200).verification.agrees


def test_the_fewest_falls_behind_which_a_spring_reaches_zero_free_length():
    mech = arm()
    kind = eq.CableSprings(elongation=1.0, ratio=(0.25, 1.0, 0.5), room=0.4, fittings=0.0)
    request = eq.Discover(kinds=(kind,), pairs=((mech.bodies[0], "upper"), (mech.bodies[0], "fore")), candidates=400)
    found = collect(mech, eq.Sweep.sobol(mech, 64), request, eq.Aim(norm="rms"))
    states, extension = found.scene.states, 0.2
    chosen = set()
    for index in range(0, len(found.dictionary), max(1, len(found.dictionary) // 60)):
        path = found.propose(index, 1).balancer.path
        guide, hook = (states.point(point)[0] for point in (path.through[1].centre, path.through[2]))
        longest = np.linalg.norm(hook - guide, axis=-1).max()
        fits = [ratio for ratio in (1.0, 0.5, 0.25) if ratio * longest <= extension]
        assert path.ratio == (fits or [0.25])[0]
        chosen.add(path.ratio)
    assert len(chosen) > 1


def test_ratios_of_a_cable_that_are_no_tackle():
    with pytest.raises(eq.InputError, match=r"ratio is -0\.5"):
        eq.CableSprings(ratio=(1.0, -0.5))
    with pytest.raises(eq.InputError, match="no ratio"):
        eq.CableSprings(ratio=())


def test_coils_on_the_arm_are_told_of_a_housing():
    mech = arm()
    pairs = ((mech.bodies[0], "upper"),)
    told = {}
    for carrier in ("upper", mech.bodies[0]):
        kind = eq.CableSprings(elongation=2.0, room=0.01, rooms={carrier: 0.5}, force=150.0)
        front = eq.discover(
            mech, eq.Sweep.sobol(mech, 48), eq.Discover(1, (kind,), pairs, candidates=300, contenders=1)
        )
        told[carrier] = str(front)
    assert f"housing on {mech.bodies[0]} do not weigh" in told["upper"].replace("\n            ", " ")
    assert "housing" not in told[mech.bodies[0]]


def test_springs_that_gain_nothing_are_said_to():
    """Between upper arm and forearm no ideal spring lowers a peak that the shoulder alone holds."""
    mech = arm()
    request = eq.Discover(1, pairs=(("upper", "fore"),), candidates=400, contenders=1)
    with pytest.raises(InfeasibleError, match="gains anything"):
        eq.discover(mech, eq.Sweep.sobol(mech, 64), request)


def test_a_pulley_with_a_radius_keeps_the_cable_on_one_side():
    links = [
        eq.Link("upper", length=0.5, mass=3.0, limits=(-1.2, 1.2)),
        eq.Link("fore", length=0.4, mass=2.0, limits=(0.3, 1.6)),
    ]
    mech = eq.chain(links)
    kind = eq.CableSprings(elongation=1.5, radius=0.02, room=0.4)
    request = eq.Discover(kinds=(kind,), pairs=(("upper", "fore"),), candidates=900)
    found = collect(mech, eq.Sweep.sobol(mech, 64), request, eq.Aim(norm="rms"))
    assert found.refused["the cable does not keep to one side of the pulley and in its plane"] > 0
    states = found.scene.states
    for index in range(0, len(found.dictionary), max(1, len(found.dictionary) // 5)):
        path = found.propose(index, 1).balancer.path
        wrap = path.taut(states).wrap[:, 1]
        assert wrap.min() > 0
        assert path.through[1].radius == 0.02


def test_refinement_and_the_winder_keep_the_cable_on_its_side(tmp_path):
    """The limit `wrap` holds over the sweep, between its samples, and in the saved file."""
    links = [
        eq.Link("upper", length=0.5, mass=3.0, limits=(-1.2, 1.2)),
        eq.Link("fore", length=0.4, mass=2.0, limits=(0.3, 1.6)),
    ]
    mech = eq.chain(links)
    kind = eq.CableSprings(radius=0.02, ratio=0.5, rooms={"world": 0.5})
    for make in (None, eq.Makeable(grade="SH", parallel=2, width=0.05)):
        request = eq.Discover(1, kinds=(kind,), candidates=400, contenders=1, poses=100, make=make)
        (design,) = eq.discover(mech, eq.Sweep.sobol(mech, 64), request, objective=eq.Aim(norm="peak")).designs
        assert eq.Wrap("s1", min=0.1, max=3.0, gap=0.02) in design.limits
        dense = mech.states(eq.Sweep.sobol(mech, 4096))
        ((_, wrap, _),) = design.balancers[0].path.embraces(dense)
        assert wrap.min() > 0.1 - 1e-3
        assert wrap.max() < 3.0 + 1e-3
        # The poses at which it is extreme are among those that the design was shaped over.
        ((_, kept, _),) = design.balancers[0].path.embraces(design.states)
        assert (kept.min(), kept.max()) == pytest.approx((wrap.min(), wrap.max()), abs=2e-3)
        assert eq.verify(design, poses=500).verification.agrees


def test_a_swivel_leads_a_cable_through_a_full_turn():
    """One link that turns all the way round is balanced by a coil behind a swivelling pulley, to rounding."""
    mech = eq.chain([eq.Link("link", length=0.5, mass=3.0)])
    kind = eq.CableSprings(radius=0.015, guide="swivel", ratio=0.5, rooms={"world": 0.5})
    request = eq.Discover(1, kinds=(kind,), candidates=400, contenders=1, poses=100)
    sweep, aim = eq.Sweep.sobol(mech, 64), eq.Aim(norm="peak")
    front = eq.discover(mech, sweep, request, objective=aim)
    (design,) = front.designs
    assert front.values[0] < 0.02 * front.before
    ((_, wrap, _),) = design.balancers[0].path.embraces(mech.states(eq.Sweep.sobol(mech, 2048)))
    assert np.degrees(wrap.max()) < 172
    assert eq.verify(design, poses=500).verification.agrees
    pulley = replace(request, kinds=(replace(kind, guide="pulley"),))
    assert "keep to one side" in " ".join(collect(mech, sweep, pulley, aim).refused)


def test_a_coil_behind_a_pulley_lies_either_way_along_its_link():
    links = [
        eq.Link("upper", length=0.5, mass=3.0, limits=(-1.2, 1.2)),
        eq.Link("fore", length=0.4, mass=2.0, limits=(0.3, 1.6)),
    ]
    mech = eq.chain(links)
    sweep, kind = eq.Sweep.sobol(mech, 64), eq.CableSprings(elongation=1.5, radius=0.02, rooms={"upper": 0.4})
    for pair, ways in ((("upper", "fore"), 4), (("fore", "upper"), 2)):
        request = eq.Discover(kinds=(replace(kind, room=0.4),), pairs=(pair,), candidates=900)
        found = collect(mech, sweep, request, eq.Aim(norm="rms"))
        through = [found.propose(index, 1).balancer.path.through for index in range(len(found.dictionary))]
        seen = {
            tuple(np.round((np.array(one[0].at) - one[1].at) / 0.4, 6)) for one in through if one[0].body == pair[0]
        }
        assert 1 < len(seen) <= ways


@pytest.fixture(scope="module")
def small():
    mech = arm()
    aim = eq.Aim(norm="peak", target=2.0)
    sweep = eq.Sweep.sobol(mech, 64)
    front = eq.discover(mech, sweep, eq.Discover(2, candidates=400, contenders=2), objective=aim)
    scattered = [replace(design, tolerance=eq.tolerance(design, samples=2000)) for design in front.designs]
    return front.with_designs(tuple(scattered))


def test_a_front_reads_in_workshop_words(small, monkeypatch):
    """A table first, then each design; no class names, no powers of ten beyond rounding, wrapped."""
    monkeypatch.setattr("equipoise.reporting.layout.width", lambda: 90)
    told = str(small)
    lines = told.splitlines()
    table = lines.index(next(line for line in lines if "peak [N m]" in line))
    none, one, two = (line.split() for line in lines[table + 1 : table + 4])
    assert none[:2] == ["no", "parts"]
    assert float(none[3]) == pytest.approx(small.before, rel=5e-3)
    assert float(one[3]) == pytest.approx(small.values[0], rel=5e-3)
    assert float(one[4]) == pytest.approx(100 * small.values[0] / small.before, rel=5e-3)
    assert two[3:6] == ["0", "0", "%"]
    assert max(map(len, lines)) <= 90
    assert "ZeroFreeLength" not in told
    assert "zero free length, k = " in told
    assert "2 N m: met with 2 parts" in told
    for design, clashes in zip(small.designs, small.clashes, strict=True):
        for part in design.parts():
            assert f"{place(part['ends'][0])}" in " ".join(told.split())
        assert all(clash.what in told for clash in clashes)
    assert all(" and ".join(one.places) in " ".join(told.split()) for one in small.alternatives)


def test_numbers_of_parts_are_judged_by_the_band_where_asked(small):
    """A target between one spring's value and its 95 % value asks for the second spring."""
    mech, sweep = small.designs[0].mechanism, eq.Sweep.sobol(small.designs[0].mechanism, 64)
    between = (small.values[0] + small.highs[0]) / 2
    request = eq.Discover(2, candidates=400, contenders=2)
    plain = eq.Aim(norm="peak", target=between)
    nominal = eq.discover(mech, sweep, eq.Discover(1, candidates=400, contenders=2), objective=plain)
    assert nominal.recommended == 0
    assert not nominal.designs[0].missed
    banded = eq.discover(mech, sweep, request, objective=replace(plain, judged="band"))
    assert "the 95 % value of the peak is" in banded.designs[0].missed
    assert banded.recommended == 1
    assert banded.highs[1] == banded.designs[1].judged < between
    assert banded.json()["highs"] == list(banded.highs)
    assert "95 % value: met with 2 parts" in str(banded)


def test_flat_directions_of_a_found_design_are_settled_by_least_stored_energy(small, monkeypatch):
    """The same search that stops at the first of the equal optima does not store less, and reaches no more."""
    design = small.designs[1]
    assert "settled by least stored energy" in " ".join(design.certificate.flat)
    monkeypatch.setattr(
        "equipoise.verbs.shape.relaxed", lambda search, best, balanced, *_, **__: (search, best, balanced)
    )
    sweep = eq.Sweep.sobol(design.mechanism, 64)
    first = eq.discover(design.mechanism, sweep, eq.Discover(2, candidates=400, contenders=2), objective=small.aim)

    def stored(found):
        return max(part["energy"][1] for part in found.parts())

    assert stored(design) < stored(first.designs[1])
    assert small.values[1] <= first.values[1] + 1e-8 * small.before


@pytest.mark.parametrize(("height", "reach"), [(0.02, 0.4), (0.3, 0.05), (0.1, 0.12)])
def test_a_wasteful_balance_becomes_the_one_that_stores_least(height, reach):
    """k a b = m g c balances; of these k (a + b)^2 / 2 is least at a = b, twice m g c."""
    link = eq.chain([eq.Link("arm", length=0.5, mass=3.0, com=(0.2, 0, 0))])
    torque = 3.0 * 9.81 * 0.2
    spring = eq.Spring("s1", eq.Line(eq.Point("world", (0, 0, height)), link.at("arm", reach)), eq.ZeroFreeLength())
    sweep = eq.Sweep.grid(link, {"arm_joint": (-np.pi, np.pi, 73)})
    free = dict.fromkeys(("s1.path.line.0.z", "s1.path.line.1.x"), (0.01, 0.4))
    aims = (eq.Aim(norm="peak"),)
    design = descended(link, [spring], sweep, free, objective=aims, limits=(), precision=1e-5, detour=1e-3)
    assert design.certificate.primal < 1e-12 * torque
    assert design.parts()[0]["energy"][1] == pytest.approx(2 * torque, rel=0.01)


def test_the_report_shows_the_front_what_lost_and_where_to_attach(small):
    front = small
    html = page(front)
    assert html.count("<h2>With ") == len(front.designs) == 2
    for design in front.designs:
        for part in design.parts():
            for end in part["ends"]:
                assert f"{round(1e3 * end['at'][0], 2) + 0.0:.5g}" in html
    assert "Alternatives considered" in html
    assert all(one.reason.split()[0] in html for one in front.alternatives)
    assert "as good" in html or "refined as the winner was" in html
    for words in ("to mount", "s1 breaks", "5 to 95 % of specimens", "stay below", "clashes", "limited by"):
        assert words in html
    assert max(front.highs) > max(front.values)
    assert "http" not in html.replace("http://www.w3.org", "")


def test_next_steps_name_the_folder_and_forces_that_are_out_of_proportion(small, tmp_path):
    told = " ".join(summary(small, tmp_path / "out").split())
    assert f"{tmp_path / 'out'}/springs_2/design.json" in told or "DIR" not in told
    assert "`--out DIR`" not in told
    mech = small.designs[0].mechanism
    weight = mech.mass * 9.81
    point = eq.Point("world", (0.0, 0.0, 0.3))
    for times in (10, 40):
        stiff = eq.Spring("s1", eq.Line(point, mech.at("upper", 0.2)), eq.ZeroFreeLength(times * weight / 0.2))
        design = eq.balance(mech, [stiff], eq.Sweep.sobol(mech, 16))
        steps = next_steps(replace(small, designs=(design,)))
        heavy = design.parts()[0]["force"][1] > 20 * weight
        assert any("times the mechanism's weight" in step for step in steps) == heavy == (times == 40)


def test_ctrl_c_returns_what_is_finished():
    mech = arm()

    def stop(done, most, value):
        raise KeyboardInterrupt

    front = eq.discover(mech, eq.Sweep.sobol(mech, 64), eq.Discover(3, candidates=400, contenders=1), progress=stop)
    assert front.stopped
    assert [len(design.balancers) for design in front.designs] == [1]
    assert "stopped by hand" in str(front)
    assert front.json()["stopped"]


def test_ur10_cables():
    """Two wound springs behind swivelling pulleys, clear of the links; few poses and candidates do not cost much."""
    problem = load_problem(EXAMPLES / "ur10_cables.yaml")
    problem.check()
    pairs = (("shoulder_link", "forearm_link"), ("shoulder_link", "upper_arm_link"))
    request = replace(problem.content.discover, pairs=pairs, candidates=400, contenders=1)
    front = eq.discover(problem.mechanism, problem.sweep.thinned(np.arange(48)), request, objective=problem.objective)
    assert front.values[-1] < 2.0
    design = front.designs[-1]
    assert len(design.balancers) == 2
    unseen = problem.mechanism.states(eq.Sweep.sobol(problem.mechanism, 2048, seed=11))
    for spring in design.balancers:
        assert isinstance(spring.law, eq.ExtensionSpring)
        anchor, guide, hook = spring.path.through
        assert (anchor.body, guide.body, hook.body) == ("shoulder_link", "shoulder_link", "forearm_link")
        assert guide.radius == 0.015
        length = spring.path.deform(unseen)[0]
        assert spring.law.span[0] - 1e-3 <= length.min()
        assert length.max() <= spring.law.span[1] + 1e-3
        room = np.linalg.norm(np.subtract(anchor.at, guide.at)) - 0.04
        assert length.max() <= room + 1e-3
    found = eq.verify(design, poses=200).verification
    assert found.agrees
    assert max(bound.polished for bound in found.bounds.values()) < 2.0
    links = {clash.what for clash in front.clashes[-1] if clash.depth} - {"s1", "s2"}
    assert not links


def test_ur10_makeable():
    """One place of wound springs, over few poses and candidates; the whole example takes a minute or two."""
    problem = load_problem(EXAMPLES / "ur10_makeable.yaml")
    problem.check()
    few = {"springs": 1, "candidates": 400, "contenders": 1}
    request = replace(problem.content.discover, **few)
    front = eq.discover(problem.mechanism, problem.sweep.thinned(np.arange(48)), request, objective=problem.objective)
    assert front.before == pytest.approx(121.0, abs=2.0)
    assert front.values[0] < 40.0
    for design in front.designs:
        for spring in design.balancers:
            assert isinstance(spring.law, eq.ExtensionSpring)
            assert np.abs(request.make.sizes - spring.law.wire).min() < 1e-12
            length = spring.path.deform(design.states)[0]
            assert spring.law.span[0] <= length.min() * (1 + 1e-6)
            assert length.max() <= spring.law.span[1] * (1 + 1e-6)
            assert design.added_mass >= spring.law.own_mass
