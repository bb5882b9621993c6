"""Vertical axes and gantries: slides balanced like hinges, in N; TIAGo's torso lift by four means."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import mujoco
import numpy as np
import pytest

import equipoise as eq
from equipoise.cli import main
from equipoise.parameters import geometry, unit_of
from equipoise.problem import load_problem
from equipoise.reporting.pathwords import path_words

EXAMPLES = Path(__file__).parents[1] / "examples"
G = 9.81
LIFT = "torso_lift_joint"


@pytest.fixture(scope="module")
def tiago():
    problem = load_problem(EXAMPLES / "vertical_axis.yaml")
    problem.check()
    return problem


def moved_mass(mechanism, joint):
    """Mass that a joint carries, from MuJoCo's own tree."""
    model = mechanism.model
    return float(model.body_subtreemass[model.jnt_bodyid[mechanism.joint_id(joint)]])


def balanced(problem, path, law, free=None, norm="rms"):
    spring = eq.Spring("lift", path, law)
    if free:
        return eq.shape(problem.mechanism, [spring], problem.sweep, free, norm=norm, starts=3)
    return eq.balance(problem.mechanism, [spring], problem.sweep, norm=norm)


def test_a_counterweight_over_a_pulley_is_exact(tiago):
    design = balanced(tiago, tiago.balancers[0].path, tiago.balancers[0].law)
    carried = moved_mass(tiago.mechanism, LIFT)
    assert design.before[LIFT].unit == "N"
    assert design.before[LIFT].peak == pytest.approx(carried * G, rel=1e-9)
    assert design.values["lift.m"] == pytest.approx(carried, rel=1e-9)
    assert design.certificate.kind == "exact"
    assert eq.verify(design, poses=50).verification.agrees


def test_the_weight_is_inertia_in_the_saved_model(tmp_path):
    """On a plain vertical slide: M + m along the axis, against a model with the weight on a slide of its own."""
    axis = eq.chain([eq.Link("lift", length=0.2, mass=7.0, joint="slide", axis=(0, 0, 1), stroke=(0.0, 0.5))])
    sweep = eq.Sweep.grid(axis, {"lift_joint": (0.0, 0.5, 11)})
    path = eq.Angle("lift_joint", ratio=-0.5, unit="m")
    design = eq.balance(axis, [eq.Spring("w", path, eq.Weight())], sweep)
    assert design.values["w.m"] == pytest.approx(14.0)  # a tackle halves its way and doubles its weight
    verified = eq.verify(design, out=tmp_path, poses=20)
    model = mujoco.MjModel.from_xml_path(str(verified.verification.model))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    rope = np.array([1.0, -0.5])  # the saved model's second joint is the tackle's other end, coupled to the lift
    assert rope @ full @ rope == pytest.approx(7.0 + 14.0 * 0.25)
    explicit = mujoco.MjModel.from_xml_string("""
        <mujoco><worldbody>
          <body><joint name="lift" type="slide" axis="0 0 1"/><geom size=".1" mass="7"/></body>
          <body pos="1 0 0"><joint name="down" type="slide" axis="0 0 1"/><geom size=".1" mass="14"/></body>
        </worldbody></mujoco>""")
    data = mujoco.MjData(explicit)
    mujoco.mj_forward(explicit, data)
    assert rope @ data.qfrc_bias == pytest.approx(0.0, abs=1e-12)
    mujoco.mj_fullM(explicit, data, weights := np.zeros((2, 2)))
    assert rope @ weights @ rope == pytest.approx(rope @ full @ rope)


def test_constant_force_and_a_coil_on_a_fusee_are_exact_and_gas_is_not(tiago):
    position = eq.Angle(LIFT, unit="m")
    load = moved_mass(tiago.mechanism, LIFT) * G
    constant = balanced(tiago, eq.Angle(LIFT, ratio=-1.0, unit="m"), eq.Constant())
    assert constant.values["lift.force"] == pytest.approx(load, rel=1e-9)
    assert constant.certificate.kind == "exact"
    cam = eq.Cam(eq.Pinion(position, 0.03), eq.ConstantTorque(0.06, -0.07), offset=0.21)
    free = {"lift.path.profile.share": (-0.08, -0.02), "lift.path.offset": (0.15, 0.25)}
    coil = balanced(tiago, cam, eq.Coil(0.2), free)
    assert coil.certificate.kind == "exact"
    assert coil.after[LIFT].peak < 1e-9 * load
    # k base^2 share / (2 radius) by hand; the spring is free at the cam's own zero.
    share = coil.geometry["lift.path.profile.share"]
    assert -coil.values["lift.k"] * 0.06**2 * share / (2 * 0.03) == pytest.approx(load, rel=1e-9)
    assert coil.geometry["lift.path.offset"] == pytest.approx(0.2, abs=1e-9)
    assert eq.verify(coil, poses=20).verification.agrees
    gas = balanced(tiago, dataclasses.replace(position, offset=0.3), eq.Gas(3.14e-4, 5e-4, 0.3), norm="peak")
    # By hand: the force of P0 (1 + x)^-1.4 - Pa, x the share of volume swept; least peak for a free P0.
    area, pressure = 3.14e-4, 101325.0
    swept = (1 + area * np.linspace(0, 0.35, 36) / 5e-4) ** -1.4
    charges = np.linspace(0.5, 1.5, 200001) * load / area
    ends = charges[:, None] * swept[[0, -1]] - pressure - load / area
    best = np.abs(ends).max(axis=1).min() * area
    assert gas.after[LIFT].sample_peak == pytest.approx(best, rel=1e-4)
    assert gas.after[LIFT].sample_peak > 0.05 * load


def test_a_gantry_on_a_tilted_base():
    """Two level slides and a vertical one: only the last has weight, and a tilt loads the others too."""
    links = [
        eq.Link("x", length=0.3, mass=20.0, joint="slide", axis=(1, 0, 0), stroke=(0.0, 1.0)),
        eq.Link("y", length=0.3, mass=10.0, joint="slide", axis=(0, 1, 0), stroke=(0.0, 0.8)),
        eq.Link("z", length=0.3, mass=5.0, joint="slide", axis=(0, 0, 1), stroke=(0.0, 0.4)),
    ]
    gantry = eq.chain(links, name="gantry")
    sweep = eq.Sweep.sobol(gantry, 64)
    weight = eq.Spring("w", eq.Angle("z_joint", ratio=-1.0, unit="m"), eq.Weight())
    design = eq.balance(gantry, [weight], sweep)
    assert design.values["w.m"] == pytest.approx(5.0)
    assert design.certificate.kind == "exact"
    assert {row.unit for row in design.before.values()} == {"N"}
    lean = np.radians(10)
    cases = [eq.Case(name, mech, sweep) for name, mech in eq.Tilt(lean, 4).apply(gantry).items()]
    found = eq.adjust(cases, [weight], {}, norm="peak")
    # The level axes feel m g sin(lean), whatever the weight does; of the vertical one 1 - cos is left.
    worst = max(design.after["x_joint"].peak for design in found.designs)
    assert worst == pytest.approx(35 * G * np.sin(lean), rel=1e-9)
    assert max(d.after["y_joint"].peak for d in found.designs) == pytest.approx(15 * G * np.sin(lean), rel=1e-9)


def test_pinions_and_fusees_refuse_what_they_cannot_be():
    axis = eq.chain([eq.Link("lift", length=0.2, mass=7.0, joint="slide", axis=(0, 0, 1), stroke=(0.0, 0.5))])
    sweep = eq.Sweep.grid(axis, {"lift_joint": (0.0, 0.5, 11)})
    slide = eq.Angle("lift_joint", unit="m")
    arm = eq.chain([eq.Link("arm", length=0.5, mass=3.0)])
    with pytest.raises(eq.InputError, match="no slide's position"):
        eq.Pinion(eq.Angle("arm_joint"), 0.03).check(arm, "s")
    with pytest.raises(eq.InputError, match="no radius"):
        eq.Pinion(slide, 0.0).check(axis, "s")
    cam = eq.Cam(eq.Pinion(slide, 0.03), eq.ConstantTorque(0.06, -0.2))
    with pytest.raises(eq.InputError, match="beyond its point"):
        eq.balance(axis, [eq.Spring("s", cam, eq.Coil(0.1))], sweep)
    with pytest.raises(eq.InputError, match="cannot be negative"):
        eq.Weight(-1.0)


def test_the_tilted_gantry(capsys):
    """The best weight for 0 and 5 degrees halves what the cosine changes: m g (1 - cos 5 deg) / 2."""
    assert main(["balance", str(EXAMPLES / "tilted_gantry.yaml"), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert len(data["cases"]) == 9
    worst = max(case["after"]["z_joint"]["peak"] for case in data["cases"])
    assert worst == pytest.approx(5 * G * (1 - np.cos(np.radians(5))) / 2, rel=1e-6)


@pytest.mark.parametrize(("unit", "said"), [("m", "offset 125 mm"), ("rad", "offset 7.162 deg")])
def test_an_offset_is_in_the_joint_s_own_unit(unit, said):
    path = eq.Angle("lift_joint", offset=0.125, unit=unit)
    assert said in path_words(path)
    spring = eq.Spring("s1", path, eq.Linear())
    assert unit_of([spring], "s1.path.offset") == unit
    yoke = eq.Spring("s2", eq.ScotchYoke(path, 0.1), eq.Linear())
    assert unit_of([yoke], "s2.path.input.offset") == unit
    assert dict(geometry(yoke))["s2.path.input.offset"] == unit
