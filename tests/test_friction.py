"""Friction of paths and laws, and the dead band that it makes."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import equipoise as eq
from equipoise.cli import main
from equipoise.rubbing import drags

STEP = 1e-6
PIN = eq.Friction(pin=0.2, pin_radius=0.01, slide=0, rope=0, mesh=0, seal=0)
SLIDE = eq.Friction(pin=0, slide=0.3, rope=0, mesh=0, seal=0)
SHARE = eq.Friction(pin=0, slide=0, rope=0.04, mesh=0.05, seal=0)


@pytest.fixture(scope="module")
def states():
    arm = eq.chain([eq.Link("arm", length=0.5, mass=2.0)])
    return arm.states(eq.Sweep.grid(arm, {"arm_joint": (0.3, 1.4, 9)}))


def shifted(states, step: float):
    arm = states.mechanism
    return arm.states(eq.Sweep(states.driven + step, np.ones(len(states)), "moved"))


def paces(path, states) -> dict[str, np.ndarray]:
    """How fast the joints of the path's own explicit bodies turn, by differences of their positions."""
    there, back = (path.positions(shifted(states, sign * STEP), "x") for sign in (1, -1))
    return {name: (there[name] - back[name]) / (2 * STEP) for name in there}


U = eq.Angle("arm_joint")


def torque(path, states, friction, law=None, values=None):
    spring = eq.Spring("s", path, law or eq.Constant(50.0))
    return drags(spring, states, values or {}, friction)[:, 0]


def test_a_slider_crank_rubs_in_three_pins_and_a_guide(states):
    path = eq.SliderCrank(U, crank=0.1, rod=0.3, offset=0.02, phase=0.4)
    pace = paces(path, states)
    tilt = pace["x_crank"] * 0 + path.positions(states, "x")["x_crank"] + path.positions(states, "x")["x_rod"]
    rod = 50.0 / np.cos(tilt)
    turns = np.abs(pace["x_crank"]) + np.abs(pace["x_rod"]) + np.abs(pace["x_crank"] + pace["x_rod"])
    np.testing.assert_allclose(torque(path, states, PIN), 0.2 * 0.01 * np.abs(rod) * turns, rtol=1e-7)
    side = np.abs(50.0 * np.tan(tilt) * pace["x_slider"])
    np.testing.assert_allclose(torque(path, states, SLIDE), 0.3 * side, rtol=1e-6)


def test_an_inverted_slider_crank_rubs_in_its_pins(states):
    path = eq.InvertedSliderCrank(U, crank=0.1, distance=0.35, phase=0.5)
    pace = paces(path, states)
    turns = sum(np.abs(p) for p in (pace["x_crank"], pace["x_swivel"], pace["x_crank"] - pace["x_swivel"]))
    np.testing.assert_allclose(torque(path, states, PIN), 0.2 * 0.01 * 50.0 * turns, rtol=1e-7)


def test_a_scotch_yoke_rubs_in_its_slot(states):
    path = eq.ScotchYoke(U, radius=0.08, phase=0.2)
    block = np.abs(paces(path, states)["x_block"])
    np.testing.assert_allclose(torque(path, states, SLIDE), 0.3 * 50.0 * block, rtol=1e-7)
    np.testing.assert_allclose(torque(path, states, SLIDE), 0.3 * 50 * 0.08 * np.sin(states.driven[:, 0] + 0.2))
    np.testing.assert_allclose(torque(path, states, PIN), 0.2 * 0.01 * 50.0 * 2)


def test_a_four_bar_rubs_in_its_four_pins(states):
    path = eq.FourBar(U, ground=0.12, crank=0.05, coupler=0.13, rocker=0.09, phase=0.3)
    pace = paces(path, states)
    turn, coupler, rocker = pace["x_crank"], pace["x_crank"] + pace["x_coupler"], pace["x_rocker"]
    turns = np.abs(turn) + np.abs(turn - coupler) + np.abs(rocker - coupler) + np.abs(rocker)
    # The coupler is a two-force member: it turns the rocker with its lever about D, c sin(mu).
    place = path.positions(states, "x")
    along = place["x_crank"] + place["x_coupler"] - place["x_rocker"]
    force = 50.0 / np.abs(0.09 * np.sin(along))
    expected = 0.2 * 0.01 * force * turns
    np.testing.assert_allclose(torque(path, states, PIN), expected, rtol=1e-6)


def test_a_line_swings_about_its_pins(states):
    path = eq.Line(eq.Point("world", (0, 0, 0.2)), eq.Point("arm", (0.1, 0, 0.03)))

    def lean(at) -> np.ndarray:
        a, b = (at.point(point)[0] for point in (path.a, path.b))
        return np.arctan2((b - a)[:, 2], (b - a)[:, 0])

    swing = (lean(shifted(states, STEP)) - lean(shifted(states, -STEP))) / (2 * STEP)
    body = states.rotation("arm")[1][:, 1, 0]
    turns = np.abs(swing) + np.abs(swing + body)
    np.testing.assert_allclose(torque(path, states, PIN), 0.2 * 0.01 * 50.0 * turns, rtol=1e-6)


def test_ropes_and_meshes_lose_their_share(states):
    gear = eq.Gear(U, ratio=-2.0)
    law = eq.Torsion(k=7.0)
    wound = 7.0 * 2.0 * np.abs(states.driven[:, 0])
    np.testing.assert_allclose(torque(gear, states, SHARE, law), 0.05 * wound * 2.0)
    drum = eq.Drum(gear, radius=0.04)
    # The rope loses its share of 50 N at 0.08 m/rad, the mesh before it its share of the same power.
    np.testing.assert_allclose(torque(drum, states, SHARE), (0.04 + 0.05) * 50 * 0.08)
    sheave = eq.Pulley("world", (0, 0, 0.5), radius=0.03, side="right")
    cable = eq.Cable((eq.Point("world", (-0.3, 0, 0.2)), sheave, eq.Point("arm", (0.3, 0, 0))))
    taut = cable.taut(states)
    lost = 0.04 * 50 * taut.wrap[:, 1] / np.pi * np.abs(taut.rate[:, 0])
    assert lost.max() > 0
    np.testing.assert_allclose(torque(cable, states, SHARE), lost)
    # Three falls: the lead pulls a third of 50 N, and at the tackle's sheaves the rope moves by 2/3 and 1/3 of it.
    tackle = replace(cable, ratio=1 / 3, offset=-0.1)
    inside = 0.04 * 50 / 3 * (2 / 3 + 1 / 3) * np.abs(taut.rate[:, 0])
    np.testing.assert_allclose(torque(tackle, states, SHARE), lost / 3 + inside)


def test_gas_springs_drag_by_their_data_sheet_or_their_seals(states):
    path = eq.Line(eq.Point("world", (0, 0, 0.25)), eq.Point("arm", (0.1, 0, 0.03)))
    sheet = eq.GasSpring(f1=200.0, f2=260.0, stroke=0.2, length=0.4, friction=15.0, number=2)
    rate = np.abs(path.deform(states)[1][:, 0])
    only = replace(SHARE, rope=0, mesh=0)
    np.testing.assert_allclose(torque(path, states, only, sheet), 30.0 * rate)
    gas = eq.Gas(area=3e-4, volume=4e-4, length=0.2, pressure=20e5, action="pull")
    size = np.abs(gas.force_at(path.deform(states)[0], {}))
    np.testing.assert_allclose(torque(path, states, replace(only, seal=0.1), gas), 0.1 * size * rate)


def test_where_an_arm_stays_drifts_and_runs_away():
    """A pendulum with half the spring it needs rests hanging: above the level it runs away, below it drifts."""
    arm = eq.chain([eq.Link("arm", length=0.5, mass=2.0)])
    over = eq.Sweep.grid(arm, {"arm_joint": (-1.5, 1.5, 100)})
    path = eq.Line(eq.Point("world", (0, 0, 0.2)), eq.Point("arm", (0.1, 0, 0)))
    half = eq.Spring("s", path, eq.ZeroFreeLength(k=0.5 * 2 * 9.81 * 0.25 / (0.2 * 0.1)))
    found = eq.dead_band(eq.balance(arm, [half], over), eq.Friction(pin=0))
    assert (found.stays, found.drifts, found.runs) == (0.0, 0.5, 0.5)
    exact = eq.dead_band(eq.balance(arm, [replace(half, law=eq.ZeroFreeLength())], over))
    assert exact.stays == 1.0
    assert exact.rows["arm_joint"].peak == pytest.approx(exact.parts["s"])


def test_the_robots_own_friction_counts(tmp_path):
    (tmp_path / "arm.xml").write_text(
        '<mujoco><worldbody><body name="arm"><joint name="j" type="hinge" axis="0 1 0" range="-90 90" limited="true"'
        ' frictionloss="1.5"/><geom type="box" size="0.2 0.01 0.01" pos="0.2 0 0" mass="1"/>'
        "</body></worldbody></mujoco>"
    )
    arm = eq.Mechanism.load(tmp_path / "arm.xml")
    path = eq.Line(eq.Point("world", (0, 0, 0.2)), eq.Point("arm", (0.1, 0, 0)))
    found = eq.dead_band(eq.balance(arm, [eq.Spring("s", path, eq.ZeroFreeLength())], eq.Sweep.sobol(arm, 64)))
    assert found.parts["the robot's own joints"] == 1.5


def test_the_file_sets_coefficients(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (
        "mechanism: {chain: {links: [{name: arm, length: 0.5, mass: 2}]}}\n"
        "sweep: {grid: {arm_joint: [-90 deg, 90 deg, 19]}}\n"
        "balancers:\n"
        "  - spring: {name: s, path: {line: [[world, 0, 0, 0.2], [arm, 0.1, 0, 0]]}, law: zero_free_length}\n"
        "friction: {pin: 0.3, pin_radius: 8 mm}\n"
    )
    (tmp_path / "p.yaml").write_text(text)
    assert main(["design", "p.yaml", "--json", "--out", "out"]) == 0
    out, err = capsys.readouterr()
    found = json.loads(out)["dead_band"]
    assert found["friction"]["pin"] == 0.3
    assert found["stays"] == 1.0
    assert "stays in 100 % of the poses" in err
    assert "Friction and the dead band" in (tmp_path / "out/report.html").read_text()
    (tmp_path / "p.yaml").write_text(text.replace("0.3,", "-0.3,"))
    assert main(["design", "p.yaml"]) == 2
    assert "line 5" in capsys.readouterr().err


def swinging(mechanism, drivers, balancers=(), values=None, friction=None):
    over = eq.Sweep.motion(mechanism, drivers, duration=1.0, samples=401)
    return over, eq.machine(mechanism, over, None, balancers, values, friction)


def test_motors_supply_what_friction_takes():
    """A constant force on a Scotch yoke: mu F r |sin| in the slot against the motion, work 4 mu F r (1 - cos)."""
    arm = eq.chain([eq.Link("arm", length=0.5, mass=2.0)], gravity=(0, 0, 0))
    yoke = eq.Spring("s", eq.ScotchYoke(eq.Angle("arm_joint"), radius=0.08), eq.Constant(50.0))
    _, found = swinging(arm, {"arm_joint": "sin(2*pi*t/T)"}, [yoke], friction=SLIDE)
    drive = found.drives["arm_joint"]
    assert drive.rubbed.peak == pytest.approx(0.3 * 50 * 0.08 * np.sin(1.0), rel=1e-4)
    # |sin q| dq over one cycle, -1 to 1 and back
    taken = 4 * 0.3 * 50 * 0.08 * (1 - np.cos(1.0))
    assert drive.rubbed.lost == pytest.approx(taken, rel=1e-4)
    assert drive.rubbed.work.net == pytest.approx(drive.work.net + taken, abs=1e-4 * taken)
    assert drive.parts["friction"].peak == 0.0  # dampers of the file: there are none
    assert drive.json()["with_friction"]["lost"] == drive.rubbed.lost


def test_friction_of_two_joints_at_one_contact_is_not_counted_twice():
    """Two links that keep an absolute angle do not slide its belt: nothing is lost, whatever each would lose alone."""
    arm = eq.chain([eq.Link("upper", length=0.4, mass=1.0), eq.Link("fore", length=0.3, mass=1.0)])
    belt = eq.Spring("s", eq.Absolute("fore"), eq.Torsion(k=5.0, rest=1.0))
    together = {"upper_joint": "0.5*sin(2*pi*t/T)", "fore_joint": "-0.5*sin(2*pi*t/T)"}
    _, found = swinging(arm, together, [belt], friction=SHARE)
    assert all(drive.rubbed is None or drive.rubbed.peak < 1e-12 for drive in found.drives.values())
    _, alone = swinging(arm, {"upper_joint": "0.5*sin(2*pi*t/T)"}, [belt], friction=SHARE)
    states = arm.states(eq.Sweep.motion(arm, {"upper_joint": "0.5*sin(2*pi*t/T)"}, duration=1.0, samples=401))
    wound = np.abs(belt.force(states, {})[1])
    assert alone.drives["upper_joint"].rubbed.peak == pytest.approx(0.05 * wound.max(), rel=1e-6)


def test_frictionloss_of_the_file_takes_work(tmp_path):
    (tmp_path / "arm.xml").write_text(
        '<mujoco><option gravity="0 0 0"/><worldbody><body name="arm"><joint name="j" axis="0 1 0" frictionloss="0.7"/>'
        '<geom type="capsule" size="0.02" fromto="0 0 0 0.5 0 0" mass="1"/></body></worldbody></mujoco>'
    )
    arm = eq.Mechanism.load(tmp_path / "arm.xml")
    _, found = swinging(arm, {"j": "sin(2*pi*t/T)"})
    rubbed = found.drives["j"].rubbed
    assert (rubbed.peak, rubbed.lost) == (pytest.approx(0.7), pytest.approx(4 * 0.7, rel=1e-3))


def test_the_problem_s_coefficients_reach_the_motors(tmp_path, capsys):
    text = """
mechanism: {chain: {links: [{name: arm, length: 0.5, mass: 2}]}}
sweep: {motion: {arm_joint: 0.8 + 0.5*sin(2*pi*t/T)}, duration: 1 s, samples: 101}
balancers:
  - spring: {name: s, path: {line: [[world, 0, 0, 0.3], [arm, 0.2, 0, 0]]}, law: zero_free_length}
objective: {goal: drive}
friction: {pin: %s, pin_radius: 5 mm}
"""
    peaks = []
    for pin in (0.1, 0.2):
        (tmp_path / "p.yaml").write_text(text % pin)
        assert main(["balance", str(tmp_path / "p.yaml"), "--json"]) == 0
        machine = json.loads(capsys.readouterr().out)["machine"]
        assert machine["before"]["drive"]["arm_joint"]["with_friction"] is None
        peaks.append(machine["after"]["drive"]["arm_joint"]["with_friction"]["peak"])
    assert peaks[1] == pytest.approx(2 * peaks[0])
    assert main(["balance", str(tmp_path / "p.yaml")]) == 0
    assert "friction beside it up to" in " ".join(capsys.readouterr().err.split())
