"""verify over a motion: explicit bodies in MuJoCo, the wrench of the base, a floating base."""

from __future__ import annotations

import json

import pytest

import equipoise as eq
from equipoise.cli import main
from equipoise.errors import DisagreementError
from equipoise.verbs.verify import insist
from equipoise.verification.saved import save
from test_rrr3 import manipulator, motion

T = 0.12


@pytest.fixture(scope="module")
def bar():
    return eq.four_bar(0.14, 0.05, 0.15, 0.125, masses=(0.1, 0.3, 0.25))


@pytest.fixture(scope="module")
def turn(bar):
    return eq.Sweep.motion(bar, {"crank_joint": "2*pi*t/T"}, duration=T)


def weights():
    at = {"crank": ((-0.05, 0, 0), 0.2), "rocker": ((-0.0625, 0, 0), 0.55)}
    return [eq.Counterweight(f"w_{body}", eq.Point(body, place), mass=mass) for body, (place, mass) in at.items()]


@pytest.fixture(scope="module")
def geared(bar, turn):
    rotors = [eq.CounterRotor("ring", "coupler", ratio=-1.0), eq.CounterRotor("rotor", "rocker", mass=0.3)]
    return eq.balance(bar, [*weights(), *rotors], turn, objective=eq.Aim("moment"))


def fallen(check):
    """The residual of the simulation is an error of integration: a fourth of the step leaves less than a third."""
    return all(fine.error < 0.35 * coarse.error for coarse, fine in check.differences.values())


def test_counter_rotors_as_bodies(geared):
    found = eq.verify(geared, poses=100).verification
    check = found.motion
    assert found.agrees
    assert set(check.errors) == {"crank_joint", "force", "moment"}
    assert max(error.relative for error in check.errors.values()) < 1e-12
    assert fallen(check)
    assert max(fine.relative for _, fine in check.differences.values()) < 2e-3
    (shift, turned), (coarse, fine) = check.base.before, check.base.after
    assert shift > 0.01
    assert turned > 0.02
    assert fine[0] < 0.4 * coarse[0] < 0.004 * shift
    assert fine[1] < 0.4 * coarse[1] < 0.01 * turned
    json.dumps(found.json())


def test_a_flywheel_as_a_body(bar, turn):
    design = eq.balance(bar, [*weights(), eq.Flywheel("wheel", inertia=0.01)], turn, objective=eq.Aim("force"))
    check = eq.verify(design, poses=100).verification.motion
    assert max(error.relative for error in check.errors.values()) < 1e-12
    assert fallen(check)
    assert check.base.after[1][1] < 0.01 * check.base.before[1]


def test_springs_gas_and_payload_on_an_arm(tmp_path):
    """Laws that no tendon can hold act in memory; the heaviest payload is carried."""
    links = [eq.Link("a", length=0.4, mass=3.0), eq.Link("b", length=0.3, mass=1.5, com=(0.12, 0.02))]
    arm = eq.chain(links, name="arm")
    motion = {"a_joint": eq.Cycloidal(0.2, 1.2), "b_joint": "0.4*sin(3*t)"}
    sweep = eq.Sweep.motion(arm, motion, duration=1.0, samples=121, payload=[eq.Payload("b", [0.0, 1.0], (0.3, 0, 0))])
    line = eq.Line(eq.Point("world", (-0.05, 0.0, 0.3)), eq.Point("a", (0.25, 0.0, 0.0)))
    springs = [
        eq.Spring("s", line, eq.Polynomial((0.02, 0.6), degree=4)),
        eq.Counterweight("tail", eq.Point("a", (-0.1, 0, 0))),
    ]
    design = eq.balance(arm, springs, sweep, objective=eq.Aim("drive"), limits=[eq.MassCap("tail", 2.0)])
    found = eq.verify(design, out=tmp_path, poses=100).verification
    assert found.motion is not None, found.notes
    assert found.agrees
    assert max(error.relative for error in found.motion.errors.values()) < 1e-11
    assert fallen(found.motion)


def test_a_wrong_model_is_found_out(geared, tmp_path):
    """The coupler's inertia does not matter at rest; in motion it does."""
    path = save(geared, tmp_path)
    text = path.read_text()
    body = text.index('name="ring"')
    at = text.index('diaginertia="', body) + len('diaginertia="')
    end = text.index('"', at)
    heavier = " ".join(f"{1.5 * float(value)!r}" for value in text[at:end].split())
    path.write_text(text[:at] + heavier + text[end:])
    found = eq.verify(geared, model=path, poses=50)
    assert not found.verification.agrees
    with pytest.raises(DisagreementError, match="inverse dynamics of the saved model differs"):
        insist(found)


def test_random_states_say_that_they_are_not_simulated(bar):
    design = eq.balance(bar, weights(), eq.Sweep.any_motion(bar, 16), objective=eq.Aim("force"))
    found = eq.verify(design, poses=20).verification
    assert found.motion is None
    assert any("no motion in time" in note for note in found.notes)


def test_the_command_line_tells_of_the_motion(capsys, tmp_path):
    file = tmp_path / "bar.yaml"
    file.write_text(
        "mechanism:\n  four_bar: {ground: 140 mm, crank: 50 mm, coupler: 150 mm, rocker: 125 mm, masses: [1, 3, 2]}\n"
        "sweep: {motion: {crank_joint: 2*pi*t/T}, duration: 0.12 s, samples: 121}\n"
        "balancers: [{counterweight: {name: tail, at: [crank, -50 mm, 0, 0]}}]\nobjective: {goal: force}\n"
    )
    assert main(["verify", str(file), "--json", "--poses", "50", "--out", str(tmp_path / "out")]) == 0
    told = capsys.readouterr()
    check = json.loads(told.out)["verification"]["motion"]
    assert check["agrees"]
    assert check["free_base"]["after"]["shift"]["value"] < check["free_base"]["before"]["shift"]["value"]
    assert "a free base of" in " ".join(told.err.split())


def test_a_manipulator_with_twelve_gears_far_from_its_reference():
    """The straight way to its postures is barred, gears count whole turns: the motion's own way is taken."""
    mechanism = manipulator(7.2, -0.09, 0.02, rod=(2.6, -0.18 / 2.6, 0.017))
    rotors = [
        eq.CounterRotor(f"{kind}_{leg}", f"{body}_{leg}", gear_inertia=gear, like=f"{kind}_1" if leg > 1 else None)
        for kind, body, gear in (("g4", "rod", 0.00586), ("g5", "crank", 0.00504))
        for leg in (1, 2, 3)
    ]
    design = eq.balance(mechanism, rotors, motion(mechanism, samples=201), objective=eq.Aim("moment"))
    found = eq.verify(design, poses=50).verification
    assert found.agrees
    assert "instants of the motion" in found.where
    assert max(error.relative for error in found.motion.errors.values()) < 1e-11
    assert fallen(found.motion)
    (_, turned), (_, fine) = found.motion.base.before, found.motion.base.after
    assert fine[1] < 1e-3 * turned


ANCHORED = """<mujoco><worldbody>
  <body name="crank" euler="0 -68.7549 0"><joint name="j1" axis="0 -1 0"/>
    <geom type="capsule" fromto="0 0 0 .1 0 0" size=".01" mass=".2"/>
    <body name="rod" pos=".1 0 0" euler="0 45.8366 0"><joint name="j2" axis="0 -1 0"/>
      <geom type="capsule" fromto="0 0 0 .3 0 0" size=".01" mass=".5"/>
      <body name="rock" pos=".3 0 0" euler="0 108.862 0"><joint name="j3" axis="0 -1 0"/>
        <geom type="capsule" fromto="0 0 0 .25 0 0" size=".01" mass=".4"/></body></body></body>
  </worldbody><equality><connect name="foot" body1="rock" anchor=".25 0 0"/></equality></mujoco>"""


def test_a_loop_that_ends_on_the_world_leaves_the_base_free(tmp_path):
    """A rod joined to the world by an anchor, not by a site: the base that floats takes the world's place."""
    file = tmp_path / "linkage.xml"
    file.write_text(ANCHORED)
    linkage = eq.Mechanism.load(file, driven=["j1"], gravity=(0, 0, 0))
    sweep = eq.Sweep.motion(linkage, {"j1": eq.Cycloidal(0.0, 0.8)}, duration=0.3, samples=121)
    weight = eq.Counterweight("w", eq.Point("crank", (-0.08, 0, 0)))
    design = eq.balance(linkage, [weight], sweep, objective=eq.Aim("force"))
    check = eq.verify(design, poses=50).verification.motion
    assert fallen(check)
    assert "foot" in [bearing.name for bearing in eq.machine(linkage, sweep).bearings]
    base = check.base
    assert base.before[0] > 1e-3
    assert base.after[1][0] < base.before[0]
