"""The force on the teeth of counter-rotors, and what bearings it loads, against hand computations."""

from __future__ import annotations

import numpy as np
import pytest

import equipoise as eq
from equipoise.errors import InputError
from equipoise.objective import Aim

ALPHA = np.radians(25.0)


@pytest.fixture
def rod():
    """A rod of 0.4 m and 2 kg, mass at its middle, that turns about the base at the origin, gravity downward."""
    return eq.chain([eq.Link("rod", length=0.4, mass=2.0, com=0.2, inertia=0.03)])


@pytest.fixture
def turn(rod):
    return eq.Sweep.motion(rod, {"rod_joint": "0.3 + 0.5*sin(2*pi*t/T)"}, duration=0.5, samples=41)


def rotor(**change):
    fields = {"ratio": 2.0, "inertia": 0.004, "mass": 0.5, "at": eq.Point("world", (0.09, 0.0, 0.12))}
    return eq.CounterRotor("r", "rod", **(fields | {"pressure_angle": ALPHA} | change))


def test_a_bearing_carries_the_teeth(rod, turn):
    """R = m (a - g) + F: torque J rho alpha at radius a / (1 + rho) = 50 mm, tangential, and radial as if to part."""
    states = rod.states(turn)
    q = states.driven[:, 0]
    v, a = states.moving.velocity[:, 0], states.moving.acceleration[:, 0]
    out, along = (np.stack(pair, axis=1) for pair in ((np.cos(q), np.sin(q)), (-np.sin(q), np.cos(q))))
    inertial = 2.0 * 0.2 * (a[:, None] * along - v[:, None] ** 2 * out)
    # centres 150 mm apart: e leads from the rod's axis to the rotor's, t is 90 degrees ahead of it
    e, t = np.array([0.6, 0.8]), np.array([-0.8, 0.6])
    torque = -0.004 * 2.0 * a  # on the rotor, which turns against the rod
    # the contact lies 50 mm from the rotor's axis, towards the rod's: (-0.05 e) x (f t) = torque
    tangential = -torque / 0.05
    radial = np.abs(tangential) * np.tan(ALPHA)
    teeth = tangential[:, None] * t + radial[:, None] * e
    expected = inertial + teeth + np.array([0.0, 2.0 * 9.81])
    found = eq.bearing_forces(states, [rotor()]).of("rod_joint")
    np.testing.assert_allclose(found[:, [0, 2]], expected, atol=1e-12)
    assert np.abs(found[:, 1]).max() < 1e-12
    # the gear of 100 mm turns the rod against its motion: the motor's torque knows it
    drive = rod.effort(states, "drive").b[:, 0] + rotor().effort(states, "drive").b[:, 0]
    at_teeth = 0.1 * tangential
    own = (0.03 + 2.0 * 0.2**2) * a + 2.0 * 9.81 * 0.2 * np.cos(q)
    np.testing.assert_allclose(drive, own + at_teeth, atol=1e-12)


def test_the_base_feels_the_same_however_large_the_teeth(rod, turn):
    """Bearing and shaft together bear what moves: R - F + m (a - g) of the rotor is the wrench of the base."""
    states = rod.states(turn)
    one = rotor()
    held, teeth = one.pushed(states, {})
    assert rod.model.body(held).name == "rod"
    bearing = eq.bearing_forces(states, [one]).of("rod_joint")
    shaft = -teeth + [0.0, 0.0, 0.5 * 9.81]
    moved = (rod.effort(states, "force").b + one.effort(states, "force").b) + [0.0, 0.0, 2.5 * 9.81]
    np.testing.assert_allclose(bearing + shaft, moved, atol=1e-12)


def test_teeth_on_a_moving_carrier_load_the_hinge_between(turn):
    """A rotor on the first link, driven by the second: its teeth load the second link's bearing, and no other."""
    arm = eq.chain([eq.Link("upper", length=0.4, mass=2.0), eq.Link("fore", length=0.3, mass=1.0)])
    sweep = eq.Sweep.motion(arm, {"upper_joint": "sin(2*pi*t/T)", "fore_joint": "cos(2*pi*t/T)"}, duration=0.5,
                            samples=21)  # fmt: skip
    states = arm.states(sweep)
    geared = eq.CounterRotor("r", "fore", ratio=1.5, inertia=0.002, at=eq.Point("upper", (0.35, 0.0, 0.0)))
    found, bare = eq.bearing_forces(states, [geared]), eq.bearing_forces(states, [belt_of(geared)])
    change = found.force - bare.force
    torque = geared.meshes(states, {})[0]
    assert torque.radius == pytest.approx(0.05 / 2.5)
    np.testing.assert_allclose(np.linalg.norm(change[:, 1], axis=1), torque.tooth_force, atol=1e-12)
    np.testing.assert_allclose(change[:, 0], 0.0, atol=1e-12)


def belt_of(geared):
    """The same rotor through a pair of gears on its carrier, whose first gear has next to no inertia."""
    from dataclasses import replace

    return replace(geared, gear_inertia=1e-300)


def test_belts_pairs_and_rods_elsewhere_load_bearings_with_torques_alone(rod, turn):
    states = rod.states(turn)
    bare = eq.bearing_forces(states).force
    for one in (rotor(ratio=-2.0), rotor(gear_inertia=0.01), rotor(at=eq.Point("world")), rotor(at=None)):
        assert one.pushed(states, {}) is None
        np.testing.assert_allclose(eq.bearing_forces(states, [one]).force, bare, atol=1e-12)
    pair = rotor(gear_inertia=0.01, pitch_radius=0.04).meshes(states, {})
    assert pair[0].tooth_force == pytest.approx(np.abs(pair[0].torque) / (0.04 * np.cos(ALPHA)))
    assert pair[1].tooth_force is None


def test_gears_that_do_not_meet_are_refused(rod, turn):
    for change, words in (
        ({"pitch_radius": 0.06}, "60 mm and 120 mm need their axes 180 mm apart, they are 150 mm"),
        ({"pitch_radius": -0.05}, "the pitch_radius is -0.05, it must be positive"),
        ({"pressure_angle": 1.0}, "the pressure angle is 57.2958 deg"),
        ({"pitch_radius": 0.05, "ratio": -2.0}, "a negative ratio is a belt"),
    ):
        with pytest.raises(InputError, match=words):
            eq.balance(rod, [rotor(**change)], turn, objective=[Aim("drive")])
    rotor(pitch_radius=0.05).check(rod)


def test_a_design_tells_the_force_on_the_teeth(rod, turn):
    design = eq.balance(rod, [rotor(inertia=None), eq.Counterweight("w", eq.Point("rod", (-0.2, 0.0, 0.0)))], turn,
                        objective=[Aim("moment")])  # fmt: skip
    (mesh,) = design.parts()[0]["meshes"]
    assert mesh["pitch_radius"] == pytest.approx(0.05)
    assert mesh["tooth_force"] == pytest.approx(mesh["torque"] / 0.05 / np.cos(ALPHA))
    assert "at a pitch radius of 50 mm" in str(design)
