"""Motors and bearings over a motion: torque by cause, work with and without regeneration, forces in every bearing."""

from __future__ import annotations

import json

import mujoco
import numpy as np
import pytest

import equipoise as eq
from equipoise.assemble import effort
from equipoise.cli import main
from equipoise.machinery.drive import effort_parts

T = 0.12


@pytest.fixture(scope="module")
def bar():
    coms = ((0.03, 0.004), (0.08, 0.02), (0.05, -0.01))
    return eq.four_bar(0.14, 0.05, 0.15, 0.125, masses=(0.1, 0.3, 0.25), coms=coms)


@pytest.fixture(scope="module")
def turn(bar):
    return eq.Sweep.motion(bar, {"crank_joint": "2*pi*t/T + 0.2*sin(4*pi*t/T)"}, duration=T)


def parts():
    line = eq.Line(eq.Point("world", (0.1, 0.0, 0.3)), eq.Point("rocker", (0.1, 0.0, 0.01)))
    return [
        eq.Counterweight("tail", eq.Point("crank", (-0.05, 0.0, 0.01)), mass=0.2, shape=eq.Disc(0.03)),
        eq.Counterweight("free", eq.Point("rocker"), reach=0.1),
        eq.CounterRotor("rotor", "rocker", inertia=0.005, mass=0.1, at=eq.Point("world", (0.2, 0.0, -0.03))),
        eq.Spring("s", line, eq.ZeroFreeLength(k=300.0)),
    ]


VALUES = {"free.m": 0.3, "free.mx": -0.02, "free.my": 0.0, "free.mz": 0.003}


def test_every_link_of_a_loop_obeys_newton_and_euler(bar, turn):
    """Forces at its two pins and its weight give the coupler's centre and its rotation their accelerations."""
    states = bar.states(turn)
    found = eq.bearing_forces(states)
    at, out = found.of("coupler_joint"), -found.of("pin")
    com = eq.Point("coupler", (0.08, 0.0, 0.02))
    mass, weight = 0.3, 0.3 * bar.gravity
    np.testing.assert_allclose(at + out + weight, mass * states.acceleration(com), atol=1e-11)
    centre, ends = states.point(com)[0], [states.point(eq.Point("coupler", (x, 0, 0)))[0] for x in (0.0, 0.15)]
    turning = np.cross(ends[0] - centre, at) + np.cross(ends[1] - centre, out)
    about = states.placement("coupler").push * mass * 0.15**2 / 12
    np.testing.assert_allclose(turning[:, 1], about[:, 1], atol=1e-12)
    assert np.abs(found.force[..., 1]).max() < 1e-12


def test_the_base_bearings_carry_all_that_shakes_and_weighs(bar, turn):
    states = bar.states(turn)
    added = parts()
    found = eq.bearing_forces(states, added, VALUES)
    base = sum(found.of(bearing.name) for bearing in found.bearings if bearing.on_base)
    total = effort(bar, added, states, "force")
    force = total.at(np.array([VALUES[unknown.name] for unknown in total.unknowns]))
    # the rotor's own bearing stands on the base, what the spring pulls there goes past the bearings
    end, place = states.point(eq.Point("rocker", (0.1, 0.0, 0.01)))[0], np.array([0.1, 0.0, 0.3])
    mass = bar.mass + 0.2 + 0.3
    (rotor,) = (one for one in added if isinstance(one, eq.CounterRotor))
    _, teeth = rotor.pushed(states, VALUES)
    base = base - teeth  # the teeth push the rotor's shaft as they push the rocker's bearing, the other way
    np.testing.assert_allclose(base + mass * bar.gravity - 300.0 * (end - place), force, atol=1e-10)
    assert {bearing.name for bearing in found.bearings if bearing.on_base} == {"crank_joint", "rocker_joint"}
    assert all(bearing.indeterminate == ((0.0, 1.0, 0.0),) for bearing in found.bearings)


def test_bearings_of_a_tree_agree_with_mujoco():
    links = [
        eq.Link("turret", length=0.2, mass=2.0, axis=(0, 0, 1)),
        eq.Link("boom", length=0.5, mass=3.0, com=(0.2, 0.03, 0.05)),
        eq.Link("slide", length=0.3, mass=1.0, joint="slide", axis=(1, 0, 0), at=(0.3, 0.0, 0.0), stroke=(0.0, 0.3)),
    ]
    arm = eq.chain(links, name="arm")
    motion = {"turret_joint": "0.4*sin(9*t)", "boom_joint": eq.Cycloidal(-0.3, 0.8), "slide_joint": "0.1 + 0.1*t**2"}
    states = arm.states(eq.Sweep.motion(arm, motion, duration=0.7, samples=12))
    found = eq.bearing_forces(states)
    assert [bearing.indeterminate for bearing in found.bearings] == [(), (), ()]
    data = mujoco.MjData(arm.model)
    for row in range(len(states)):
        data.qpos, data.qvel, data.qacc = (
            x[row] for x in (states.kin.q, states.rates.velocity, states.rates.acceleration)
        )
        mujoco.mj_fwdPosition(arm.model, data)
        mujoco.mj_fwdVelocity(arm.model, data)
        mujoco.mj_rnePostConstraint(arm.model, data)
        for bearing in found.bearings:
            body = arm.model.body(bearing.between[1]).id
            np.testing.assert_allclose(found.of(bearing.name)[row], data.cfrc_int[body, 3:], rtol=1e-9, atol=1e-9)


def test_a_redundant_parallelogram_says_where_its_pins_are_open():
    """Three equal cranks carry one rod: which of them pulls along the rod, rigid links do not tell."""
    xml = """<mujoco><option gravity="0 0 -9.81"/><worldbody>
      <body name="a"><joint name="a" axis="0 -1 0"/><geom type="capsule" fromto="0 0 0 0 0 .2" size=".01" mass=".2"/>
        <body name="rod" pos="0 0 .2"><joint name="rod" axis="0 -1 0"/>
          <geom type="capsule" fromto="0 0 0 .4 0 0" size=".01" mass="1"/></body></body>
      <body name="b" pos=".2 0 0"><joint name="b" axis="0 -1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 .2" size=".01" mass=".2"/></body>
      <body name="c" pos=".4 0 0"><joint name="c" axis="0 -1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 .2" size=".01" mass=".2"/></body>
      </worldbody><equality>
      <connect name="at_b" body1="rod" body2="b" anchor=".2 0 0"/>
      <connect name="at_c" body1="rod" body2="c" anchor=".4 0 0"/></equality></mujoco>"""
    spec = mujoco.MjSpec.from_string(xml)
    model = spec.compile()
    frame = eq.Mechanism(spec, model, ("a",), np.zeros(4), "frame")
    states = frame.states(eq.Sweep.motion(frame, {"a": "0.4*sin(5*t)"}, duration=1.0, samples=40))
    found = eq.bearing_forces(states)
    assert all(len(bearing.indeterminate) >= 2 for bearing in found.bearings)
    rod = found.of("rod") - found.of("at_b") - found.of("at_c")
    expected = states.acceleration(eq.Point("rod", (0.2, 0, 0))) - frame.gravity
    np.testing.assert_allclose(rod, expected, atol=1e-10)


def test_the_parts_of_a_drive_add_up(bar, turn):
    states = bar.states(turn)
    added = parts()
    split = effort_parts(states, added, VALUES)
    fixed = [part.settled(VALUES) if isinstance(part, eq.Counterweight) else part for part in added]
    total = effort(bar, fixed, states, "drive").at(np.zeros(0))
    np.testing.assert_allclose(sum(split.values()), total, atol=1e-12)
    still = effort(bar, fixed, states, "hold").at(np.zeros(0))
    np.testing.assert_allclose(split["gravity"] + split["springs"], still, atol=1e-12)
    assert np.abs(split["springs"]).max() > 0.1
    assert not split["friction"].any()


def test_work_of_a_swinging_pendulum():
    """A motor that swings q = a sin(w t) over one period: kinetic energy goes to and fro four times."""
    rod = eq.chain([eq.Link("rod", length=0.6, mass=2.0)], gravity=(0, 0, 0), name="rod")
    sweep = eq.Sweep.motion(rod, {"rod_joint": "0.5*sin(2*pi*t/T)"}, duration=0.8, samples=401)
    found = eq.machine(rod, sweep)
    energy = 0.5 * (2.0 * 0.6**2 / 3) * (0.5 * 2 * np.pi / 0.8) ** 2
    drive = found.drives["rod_joint"]
    assert drive.work.positive == pytest.approx(2 * energy, rel=1e-6)
    assert drive.work.braking == pytest.approx(2 * energy, rel=1e-6)
    assert abs(drive.work.net) < 1e-9 * energy
    assert drive.power == pytest.approx(energy * 2 * np.pi / 0.8, rel=1e-7)
    assert drive.parts["inertial"].peak == pytest.approx(2.0 * 0.6**2 / 3 * 0.5 * (2 * np.pi / 0.8) ** 2, rel=1e-9)
    assert drive.parts["gravity"].rms == 0.0
    assert found.forces["rod_joint"].peak == pytest.approx(2.0 * 0.3 * 0.5 * (2 * np.pi / 0.8) ** 2, rel=1e-9)


def test_motors_on_one_supply_feed_each_other():
    links = [eq.Link("a", length=0.3, mass=1.0), eq.Link("b", length=0.3, mass=1.0)]
    arm = eq.chain(links, name="arm")
    motion = {"a_joint": "0.6*sin(6*t)", "b_joint": "-1.2*sin(6*t)"}
    found = eq.machine(arm, eq.Sweep.motion(arm, motion, duration=np.pi / 3, samples=301))
    alone = [drive.work for drive in found.drives.values()]
    assert found.supply.positive < sum(work.positive for work in alone) * (1 - 1e-3)
    assert found.supply.net == pytest.approx(sum(work.net for work in alone), abs=1e-9)


def test_poses_at_rest_have_no_machine(bar):
    assert eq.machine(bar, eq.Sweep.grid(bar, {"crank_joint": (0, 1, 5)})) is None
    assert eq.machine(bar, eq.Sweep.any_motion(bar, 8)) is None
    with pytest.raises(eq.InputError, match="inertia needs a motion"):
        eq.bearing_forces(bar.states(eq.Sweep.grid(bar, {"crank_joint": (0, 1, 5)})))


def test_analysis_and_design_tell_motors_and_bearings(capsys, tmp_path):
    file = tmp_path / "bar.yaml"
    file.write_text(
        "mechanism:\n  four_bar: {ground: 140 mm, crank: 50 mm, coupler: 150 mm, rocker: 125 mm, masses: [1, 3, 2]}\n"
        "sweep: {motion: {crank_joint: 2*pi*t/T}, duration: 0.12 s, samples: 121}\n"
        "balancers: [{counterweight: {name: tail, at: [crank, -50 mm, 0, 0]}}]\nobjective: {goal: force}\n"
    )
    assert main(["analyze", str(file), "--json"]) == 0
    told = capsys.readouterr()
    machine = json.loads(told.out)["machine"]
    work = machine["drive"]["crank_joint"]["work"]
    assert abs(work["with_regeneration"]) < 1e-6 * work["without_regeneration"]
    assert machine["bearings"]["pin"]["between"] == ["coupler", "rocker"]
    assert "motor crank_joint" in told.err
    assert main(["balance", str(file), "--json"]) == 0
    told = capsys.readouterr()
    machine = json.loads(told.out)["machine"]
    assert machine["after"]["bearings"]["crank_joint"]["peak"] < machine["before"]["bearings"]["crank_joint"]["peak"]
    assert set(machine["after"]["drive"]["crank_joint"]["parts"]) == {"inertial", "gravity", "springs", "friction"}
    assert "bearing rocker_joint" in told.err


def test_the_table_of_a_report_is_the_motion_again(tmp_path, bar):
    """residuals.csv holds time, efforts, force and moment; read back it is the same motion."""
    sweep = eq.Sweep.motion(bar, {"crank_joint": "2*pi*t/T"}, duration=T, samples=61)
    weight = eq.Counterweight("tail", eq.Point("crank", (-0.05, 0.0, 0.0)))
    design = eq.balance(bar, [weight], sweep, objective=eq.Aim("force"))
    eq.report(eq.verify(design, poses=20), tmp_path)
    head = (tmp_path / "residuals.csv").read_text().splitlines()[0].split(",")
    assert head[:3] == ["time [s]", "crank_joint [rad]", "weight"]
    assert "after force z [N]" in head
    assert "before moment y [N m]" in head
    table = np.genfromtxt(tmp_path / "residuals.csv", delimiter=",", skip_header=1)
    force = table[:, [head.index(f"after force {axis} [N]") for axis in "xyz"]]
    rms = np.sqrt(table[:, 2] @ (force**2).sum(axis=1) / table[:, 2].sum())
    assert rms == pytest.approx(design.after["force"].rms, rel=1e-9)
    again = eq.Sweep.motion(bar, tmp_path / "residuals.csv")
    assert again.poses == pytest.approx(sweep.poses)
    page = (tmp_path / "report.html").read_text()
    for words in ("Motors and bearings over the motion", "floating base", "crank to coupler", "Force in the bearings"):
        assert words in page
