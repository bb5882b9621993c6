"""The contest among refined choices: what judges them, what is told of those that lost, what a saved design keeps."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import equipoise as eq
from equipoise.cli import main
from equipoise.designfile import load_design
from equipoise.discovery import contest, entrants
from equipoise.discovery.contest import Contender, Contest
from equipoise.discovery.entrants import Entrant
from equipoise.discovery.refine import Parts, Refiner
from equipoise.errors import ProblemError

FRONT = """
mechanism: {chain: {links: [{name: upper, length: 0.5, mass: 3}, {name: fore, length: 0.4, mass: 2}]}}
sweep: {sobol: 64}
discover: {springs: 2, kinds: [zero_free_length, torsion], candidates: 400, contenders: 3}
objective: {norm: peak}
"""


@pytest.fixture
def ring():
    """A refiner of one link, and the springs that may stand for it: (lever on the link, m) -> refined parts."""
    link = eq.chain([eq.Link("arm", length=0.5, mass=3.0, com=(0.2, 0.0, 0.0))])
    sweep = eq.Sweep.grid(link, {"arm_joint": (-1.0, 1.0, 9)})

    def of(judged, lever=0.1):
        refiner = Refiner(link, sweep, [eq.Aim(norm="peak", judged=judged)], ())
        path = eq.Line(eq.Point("world", (0, 0, 0.1)), link.at("arm", lever))
        return refiner, refiner.refine(Parts((eq.Spring("s1", path, eq.ZeroFreeLength()),), (), {}))

    return of


@pytest.mark.parametrize(("judged", "wins"), [("nominal", "a"), ("band", "b")])
def test_wound_springs_are_judged_by_the_value_that_was_asked_for(ring, monkeypatch, judged, wins):
    """As drawn a is best once both are wound; of specimens b is: each wins where its value counts."""
    refiner, refined = ring(judged)
    drawn, band = {"a": 1.0, "b": 2.0}, {"a": 5.5, "b": 5.0}
    named = {name: replace(refined, geometry={name: 0.0}, energy=1.0) for name in drawn}

    def wound(_refiner, one, _make):
        return replace(one, value=drawn[next(iter(one.geometry))])

    def banded(_self, one, _scatter, _samples):
        return replace(one, value=band[next(iter(one.geometry))])

    monkeypatch.setattr(contest, "wound", wound)
    monkeypatch.setattr(Refiner, "banded", banded)
    found = Contest(refiner, eq.Scatter(), refiner.few)
    winner = found.winner([Contender((name,), one) for name, one in named.items()], eq.Makeable())
    assert winner is not None
    assert winner.places == (wins,)
    assert winner.unwound is not None
    (lost,) = found.lost
    assert lost.places == ({"a": "b", "b": "a"}[wins],)
    reached = {"nominal": "2 N m, the winner to 1 N m", "band": "5.5 N m, the winner to 5 N m"}
    assert lost.reason == f"refined as far as it promised it came to {reached[judged]}"


@pytest.mark.parametrize("judged", ["nominal", "band"])
def test_what_lost_is_told_over_the_whole_sweep(ring, judged):
    """The value of a loser is that of balance over all poses, at its own geometry."""
    refiner, refined = ring(judged, lever=0.02)
    link, balancers = refiner.mechanism, refined.parts.balancers
    whole = eq.Sweep.grid(link, {"arm_joint": (-3.0, 3.0, 61)})
    forced = replace(refined, parts=replace(refined.parts, limits=(eq.Force("s1", max=1e5),)))
    found = Contest(refiner, eq.Scatter(), whole)
    found.lose(Contender(("here",), forced), "it had to")
    design = eq.balance(link, balancers, whole, objective=refiner.objective)
    design = replace(design, tolerance=eq.tolerance(design, samples=10_000)) if judged == "band" else design
    assert found.lost[0].value == pytest.approx(design.judged, rel=1e-9, abs=1e-9)
    assert found.lost[0].reason == "it had to"
    # Where a limit holds over the few poses alone, that is part of the reason.
    short = replace(refined, parts=replace(refined.parts, limits=(eq.Length("s1", max=0.119),)))
    found.lose(Contender(("here",), short), "it had to")
    longest = balancers[0].path.deform(link.states(whole))[0].max()
    assert longest > 0.119 > balancers[0].path.deform(refiner.states)[0].max()
    assert found.lost[1].reason.startswith("it had to; over all poses it breaks a limit by")


def test_a_saved_design_keeps_what_was_considered_in_its_place(tmp_path, capsys):
    file = tmp_path / "arm.yaml"
    file.write_text(FRONT, encoding="utf-8")
    out = tmp_path / "out"
    assert main(["discover", str(file), "--json", "--out", str(out)]) == 0
    front = json.loads(capsys.readouterr().out)
    saved = out / "springs_2" / "design.json"
    written = json.loads(saved.read_text(encoding="utf-8"))
    assert written["alternatives"] == front["front"][1]["alternatives"]
    assert written["alternatives"]
    assert "alternatives" not in front
    _, design, _ = load_design(saved)
    assert [one.json() for one in design.alternatives] == written["alternatives"]
    assert main(["report", str(saved), "--out", str(out / "one")]) == 0
    html = (out / "one" / "report.html").read_text(encoding="utf-8")
    assert "Alternatives considered" in html
    for one in design.alternatives:
        assert " and ".join(one.places) in html
        assert one.reason.split(" J ")[0] in html
        assert np.isfinite(one.value)
    kept = json.loads((out / "one" / "design.json").read_text(encoding="utf-8"))
    assert kept["alternatives"] == written["alternatives"]
    written["alternatives"] = [{"springs": 2}]
    saved.write_text(json.dumps(written), encoding="utf-8")
    with pytest.raises(ProblemError, match="an entry is incomplete"):
        load_design(saved)


def test_who_can_win_is_refined_to_the_end_and_every_stage_is_told(ring):
    refiner, _ = ring("nominal")

    def entrant(name, height, low):
        path = eq.Line(eq.Point("world", (0, 0, height)), refiner.mechanism.at("arm", 0.15))
        spring = eq.Spring("s1", path, eq.ZeroFreeLength())
        free = {"s1.path.line.0.x": (low, 0.05), "s1.path.line.1.x": (0.1, 0.2)}
        return Entrant((name,), Parts((spring,), (), free))

    near, far = entrant("near", 0.1, -0.1), entrant("far", 0.1, 0.04)
    told = []
    tried = {one.places[0]: one.refined for one in entrants.refined(refiner, [near, far], None, told.append)}
    assert tried["near"].value == pytest.approx(refiner.refine(near.parts).value, abs=1e-3 * refiner.bare)
    assert tried["far"].value > 1.2 * tried["near"].value
    assert [str(stage) for stage in told] == [
        "1 part: contender 1 of 2, refining",
        "1 part: contender 2 of 2, refining",
        "1 part: contender 1 of 2, refining to the end",
    ]
