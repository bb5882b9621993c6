"""Laws that every balancer, path, law and limit obeys; a new class joins by being listed."""

from __future__ import annotations

from dataclasses import fields, is_dataclass

import mujoco
import numpy as np
import pytest

import equipoise as eq
from equipoise.assemble import effort, setting_of
from equipoise.limits import Setting, implied
from equipoise.parameters import candidates, read, tag, unit_of, write
from equipoise.verification.simulate import holding

STEP = 1e-30
HINGE = int(mujoco.mjtJoint.mjJNT_HINGE)


def planar():
    links = [eq.Link("upper", length=0.5, mass=3.0), eq.Link("fore", length=0.4, mass=2.0, com=(0.15, 0.02))]
    return eq.chain(links, base=(0.0, 0.0, 0.3))


def spatial():
    links = [
        eq.Link("turret", length=0.2, mass=2.0, axis=(0, 0, 1)),
        eq.Link("boom", length=0.5, mass=3.0, com=(0.2, 0.03, 0.05)),
        eq.Link("slide", length=0.3, mass=1.0, joint="slide", axis=(1, 0, 0), at=(0.3, 0.0, 0.0), stroke=(0.0, 0.3)),
        eq.Link("hand", length=0.2, mass=0.7, axis=(0, 0.6, 0.8)),
    ]
    return eq.chain(links, name="spatial")


def linkage():
    return eq.four_bar(0.4, 0.15, 0.35, 0.3, masses=(1.0, 2.0, 1.5), coms=(0.07, (0.2, 0.05), 0.15))


MECHANISMS = {"planar": planar, "spatial": spatial, "linkage": linkage}


def bodies(mechanism):
    return mechanism.bodies[1], mechanism.bodies[-1]


LAWS = {
    "zero_free_length": eq.ZeroFreeLength(),
    "zero_free_length_given": eq.ZeroFreeLength(k=800.0),
    "linear": eq.Linear(),
    "linear_preload_given": eq.Linear(preload=-20.0),
    "coil": eq.Coil(free_length=0.1),
    "coil_tension": eq.Coil(free_length=0.1, initial_tension=None),
    "coil_free_length_unknown": eq.Coil(free_length=None),
    "coil_all_unknown": eq.Coil(free_length=None, initial_tension=None),
    "constant": eq.Constant(),
    "weight": eq.Weight(),
    "constant_pressure": eq.ConstantPressure(3e-4),
    "constant_pressure_given": eq.ConstantPressure(3e-4, 4e5, "pull", "absolute"),
    "gas_push": eq.Gas(area=3e-4, volume=1.2e-3, length=0.4),
    "gas_pull_isothermal": eq.Gas(area=3e-4, volume=1.2e-3, length=0.4, exponent=1.0, action="pull"),
    "gas_gauge": eq.Gas(area=3e-4, volume=1.2e-3, length=0.4, action="pull", reading="gauge", temperature=313.15),
    "gas_given": eq.Gas(area=3e-4, volume=1.2e-3, length=0.4, pressure=2e6, exponent=1.2, action="pull"),
    "gas_real": eq.Gas(area=3e-4, volume=1.2e-3, length=0.4, exponent=eq.Nitrogen(at=17e6), temperature=302.0),
    "hydro_pneumatic": eq.HydroPneumatic(
        3e-4, 1.4e-3, 1e-3, 0.4, exponent=eq.Nitrogen(0.5, at=15.5e6), temperature=302.0
    ),
    "hydro_pneumatic_gauge": eq.HydroPneumatic(3e-4, 1.4e-3, 1e-3, 0.4, exponent=1.3, action="pull", reading="gauge"),
    "hydro_pneumatic_given": eq.HydroPneumatic(3e-4, 1.4e-3, 1e-3, 0.4, precharge=1.01e7, temperature=302.0),
    "bspline": eq.BSpline((0.05, 1.6), pieces=4),
    "polynomial": eq.Polynomial((0.05, 1.6), degree=5),
    "polynomial_given": eq.Polynomial((0.05, 1.6), degree=2, coefficients=(30.0, 8.0, -2.0)),
    "extension_spring": eq.ExtensionSpring(0.003, 0.03, 40.0, initial_tension=20.0, number=2.0, leader=0.01),
    "extension_spring_302": eq.ExtensionSpring(0.0024, 0.03, 40.0, grade="ASTM A313 302", free_length=0.3),
    "compression_spring": eq.CompressionSpring(0.004, 0.05, 20.0, free_length=0.6, number=3.0),
    "compression_spring_guided": eq.CompressionSpring(0.004, 0.05, 20.0, free_length=0.6, seating=None),
    "gas_spring": eq.GasSpring(200.0, 260.0, stroke=0.5, length=0.9, friction=15.0, temperature=303.15),
    "constant_force_spring": eq.ConstantForceSpring(0.02, 2e-4, 0.0125, travel=0.5),
    "stock_spring": eq.StockSpring("S", 400.0, 0.2, limit=0.6, force=150.0, initial_tension=8.0, number=2.0),
    "windable_spring": eq.WindableSpring(0.003, 8.0, number=2.0, width=0.05, heaviest=2.0),
}
TORQUES = {
    **{name: LAWS[name] for name in ("zero_free_length", "linear", "linear_preload_given", "constant")},
    "torsion": eq.Torsion(),
    "torsion_rest_unknown": eq.Torsion(rest=None),
    "torsion_preload_unknown": eq.Torsion(rest=0.4, preload=None),
    "torsion_given": eq.Torsion(k=3.0, rest=-0.2, preload=1.5),
    "torsion_spring": eq.TorsionSpring(0.005, 0.05, 8.0, rest=-0.3, number=2.0),
    "polynomial": eq.Polynomial((-9.0, 9.0), degree=4),
}
PATHS = {
    "to_world": lambda m: eq.Line(eq.Point("world", (0.1, 0.05, 0.6)), eq.Point(bodies(m)[0], (0.12, 0.01, 0.03))),
    "to_body": lambda m: eq.Line(eq.Point("world", (-0.1, 0.2, 0.7)), eq.Point(bodies(m)[1], (0.05, -0.02, 0.04))),
    "between": lambda m: eq.Line(eq.Point(bodies(m)[0], (0.05, 0.1, 0.08)), eq.Point(bodies(m)[1], (0.1, 0.03, -0.06))),
}


def joints(mechanism):
    """A hinge of each mechanism, and a body whose absolute angle is defined."""
    hinges = [j for j in mechanism.joints if mechanism.model.joint(j).type == HINGE]
    return hinges[0], hinges[-1]


def standing(mechanism):
    """Where a path with masses stands: aslant on a moving body."""
    return eq.Mount(eq.Point(bodies(mechanism)[0], (0.03, -0.02, 0.05)), (0.6, 0.0, 0.8), (0.0, -1.0, 0.0))


def geared(mechanism):
    """An angle through two gears."""
    return eq.Gear(eq.Gear(eq.Angle(joints(mechanism)[1], offset=0.1), ratio=-0.7, offset=0.2), ratio=1.3)


LIFT = eq.Profile((0.0, 1.0, 2.5, 4.0, 5.5, 2 * np.pi), (0.02, 0.05, 0.09, 0.06, 0.03, 0.02))
DRIVEN = {
    "scotch_yoke": lambda m: eq.ScotchYoke(
        geared(m), 0.12, phase=0.3, offset=0.4, mount=standing(m), crank_mass=0.3, yoke_mass=0.8
    ),
    "slider_crank": lambda m: eq.SliderCrank(
        geared(m), 0.1, 0.35, offset=0.04, phase=-0.4, mount=standing(m), crank_mass=0.5, rod_mass=0.7, slider_mass=0.9,
        crank_com=0.3, rod_com=0.6,
    ),
    "slider_crank_back": lambda m: eq.SliderCrank(eq.Angle(joints(m)[0]), 0.1, 0.35, offset=-0.03, sense="backward"),
    "inverted_slider_crank": lambda m: eq.InvertedSliderCrank(
        geared(m), 0.1, 0.3, phase=0.5, mount=standing(m), crank_mass=0.4, rod_mass=0.6, rod_com=0.25
    ),
    "inverted_with_rod": lambda m: eq.InvertedSliderCrank(
        geared(m), 0.1, 0.3, rod=0.55, phase=0.5, mount=standing(m), crank_mass=0.4, rod_mass=0.6, rod_com=0.25
    ),
    "fusee": lambda m: eq.Cam(geared(m), eq.ConstantTorque(0.06, 0.04), offset=0.2, mount=standing(m)),
    "cam_constant_energy": lambda m: eq.Cam(
        geared(m), eq.ConstantEnergy(0.06, 0.8), offset=0.2, mount=standing(m), follower_mass=0.7
    ),
    "cam": lambda m: eq.Cam(geared(m), LIFT, phase=0.2, offset=0.05, scale=1.5, mount=standing(m), follower_mass=0.7),
}  # fmt: skip
LENGTHS = {
    "drum": lambda m: eq.Drum(geared(m), 0.08, offset=0.5),
    "cable_eye": lambda m: eq.Cable(
        (eq.Point("world", (0.1, 0.1, 0.9)), eq.Pulley("world", (0.0, 0.05, 0.7), mass=0.3),
         eq.Pulley(bodies(m)[0], (0.1, 0.02, 0.05), mass=0.4), eq.Point(bodies(m)[1], (0.1, 0.0, 0.04))),
        ratio=0.5, offset=0.1,
    ),
    "cable_swivel": lambda m: eq.Cable(
        (eq.Point("world", (0.1, 0.1, 0.9)), eq.Swivel("world", (0.0, 0.05, 0.7), 0.03, mass=0.3),
         eq.Pulley(bodies(m)[0], (0.1, 0.02, 0.05)), eq.Swivel(bodies(m)[0], (0.15, 0.04, 0.08), 0.02, mass=0.4),
         eq.Point(bodies(m)[1], (0.1, 0.0, 0.04))),
        ratio=0.5, offset=0.1,
    ),
    **DRIVEN,
}  # fmt: skip
PATHS |= LENGTHS
ANGLES = {
    "four_bar": lambda m: eq.FourBar(
        geared(m), 0.3, 0.1, 0.25, 0.2, phase=0.4, mount=standing(m), coupler_mass=0.5, rocker_mass=0.3
    ),
    "four_bar_crossed": lambda m: eq.FourBar(eq.Angle(joints(m)[0]), 0.1, 0.3, 0.25, 0.28, branch="crossed"),
    "angle": lambda m: eq.Angle(joints(m)[0], ratio=-1.5, offset=0.3),
    "gear": geared,
}
PLANAR = {
    "absolute": lambda m: eq.Gear(eq.Absolute(bodies(m)[1], ratio=2.0, offset=0.1, datum="up"), ratio=-0.5),
    "yoke_of_absolute": lambda m: eq.ScotchYoke(eq.Absolute(bodies(m)[1]), 0.2, phase=0.1),
    "cable_pulley": lambda m: eq.Cable(
        (eq.Point("world", (-0.5, 0.0, 0.2)), eq.Pulley("world", (-0.2, 0.0, 1.1), 0.05, side="right"),
         eq.Pulley("world", (-0.1, 0.0, 1.1)), eq.Point(bodies(m)[0], (0.05, 0.0, 0.3)),
         eq.Pulley(bodies(m)[0], (0.3, 0.0, 0.3), 0.04, side="right", mass=0.2),
         eq.Point(bodies(m)[1], (0.3, 0, 0.0))),
        ratio=0.5, offset=-0.1,
    ),
}  # fmt: skip
EVERY_PATH = PATHS | ANGLES | PLANAR
MASSES = {"massless": 0.0, "heavy": 1.7}
WEIGHTS = {
    "at_point": lambda m: eq.Counterweight("b", eq.Point(bodies(m)[1], (-0.1, 0.02, 0.03))),
    "free": lambda m: eq.Counterweight("b", eq.Point(bodies(m)[1]), reach=0.2),
    "given_mass_free_place": lambda m: eq.Counterweight("b", eq.Point(bodies(m)[1]), mass=2.0, reach=0.2),
    "given": lambda m: eq.Counterweight("b", eq.Point(bodies(m)[0], (-0.1, 0.0, 0.0)), mass=1.3),
    "disc": lambda m: eq.Counterweight("b", eq.Point(bodies(m)[1], (-0.1, 0.02, 0.03)), shape=eq.Disc(0.05)),
    "solid": lambda m: eq.Counterweight("b", eq.Point(bodies(m)[1], (0.05, 0.0, 0.0)), reach=0.1, shape=eq.Solid()),
    "flywheel": lambda m: eq.Flywheel("b", inertia=0.1),
}
BALANCERS = {
    f"{path}-{law}-{mass}": (lambda m, p=p, w=w, k=k: eq.Spring("b", p(m), w, mass=k))
    for path, p in PATHS.items()
    for law, w in LAWS.items()
    for mass, k in MASSES.items()
    if mass == "massless" or law in ("coil", "gas_push")
} | WEIGHTS
BALANCERS |= {
    f"{path}-{law}": (lambda m, p=p, w=w: eq.Spring("b", p(m), w, mass=0.4))
    for path, p in ANGLES.items()
    for law, w in TORQUES.items()
}

EVERYWHERE = [(m, b) for m in MECHANISMS for b in BALANCERS]
FLAT = {
    f"{path}-{law}": (lambda m, p=p, w=w: eq.Spring("b", p(m), w, mass=0.4))
    for path, p in PLANAR.items()
    for law, w in (TORQUES if path == "absolute" else LAWS).items()
}
EVERYWHERE += [(m, b) for m in ("planar", "linkage") for b in FLAT if m == "planar" or "pulley" not in b]
BALANCERS |= FLAT

every = pytest.mark.parametrize(("mechanism", "balancer"), EVERYWHERE, ids=lambda name: name)


@pytest.fixture(scope="module")
def posed():
    """Each mechanism with states at random poses and at poses displaced along every driven joint."""
    found = {}
    for name, make in MECHANISMS.items():
        mechanism = make()
        rng = np.random.default_rng(5)
        box = np.where(np.isnan(mechanism.box), [-0.5, 0.5], mechanism.box)
        poses = box.mean(axis=1) + 0.4 * (rng.random((7, len(box))) - 0.5) * (box[:, 1] - box[:, 0])
        h = 1e-5
        shifted = np.concatenate([poses + h * sign * unit for unit in np.eye(len(box)) for sign in (1, -1)])
        sweep = eq.Sweep(poses, np.ones(len(poses)), "random")
        found[name] = mechanism, mechanism.states(sweep), mechanism.states(sweep.at_poses(shifted)), h
    return found


def slope(affine, count, joints, h):
    """Central differences of an energy affine over the displaced states: b (N, nd) and A (N, nd, P)."""
    b = affine.b[:, 0].reshape(joints, 2, count)
    A = affine.A[:, 0].reshape(joints, 2, count, -1)
    return ((b[:, 0] - b[:, 1]) / (2 * h)).T, np.moveaxis((A[:, 0] - A[:, 1]) / (2 * h), 0, 1)


@every
def test_effort_is_the_derivative_of_energy(posed, mechanism, balancer):
    mech, states, shifted, h = posed[mechanism]
    part = BALANCERS[balancer](mech)
    hold, energy = part.effort(states, "hold"), part.effort(shifted, "energy")
    b, A = slope(energy, len(states), len(mech.driven), h)
    size = max(1.0, np.abs(hold.b).max(), np.abs(hold.A).max(initial=0.0))
    np.testing.assert_allclose(hold.b, b, atol=2e-8 * size)
    np.testing.assert_allclose(hold.A, A, atol=2e-8 * size)
    assert hold.unknowns == energy.unknowns == part.unknowns


@every
def test_efforts_add_up_and_units_agree(posed, mechanism, balancer):
    mech, states, _, _ = posed[mechanism]
    part = BALANCERS[balancer](mech)
    part.check(mech)
    alone, total = part.effort(states, "hold"), effort(mech, [part], states)
    theta = np.linspace(1.0, 2.0, len(part.unknowns))
    np.testing.assert_allclose(total.at(theta), states.holding + alone.at(theta), atol=1e-10)
    assert [block.unit for block in alone.blocks] == list(mech.driven_units)
    assert {unknown.unit for unknown in part.unknowns} <= {"N/m", "N", "N m/rad", "N m", "kg", "kg m", "kg m^2", "Pa"}
    assert part.effort(states, "storage").blocks[0].unit == "J"


def pairs():
    """Every path with every law on one mechanism, and every path on every mechanism with one law."""
    for path in EVERY_PATH:
        angle = path in ANGLES or path == "absolute"
        homes = ("planar", "linkage") if path in PLANAR else tuple(MECHANISMS)
        homes = homes[:1] if path == "cable_pulley" else homes
        for law in TORQUES if angle else LAWS:
            yield homes[0], path, law
        yield from ((home, path, "linear") for home in homes[1:])


@pytest.mark.parametrize(("mechanism", "path", "law"), list(pairs()), ids=lambda name: name)
def test_the_saved_model_agrees(posed, mechanism, path, law):
    """Explicit bodies, saved and reloaded, their loops closed there, forces through the constraint Jacobian."""
    mech, _, around, _ = posed[mechanism]
    part = eq.Spring("b", EVERY_PATH[path](mech), (LAWS | TORQUES)[law], mass=0.4)
    values = {unknown.name: 2.0 + index for index, unknown in enumerate(part.unknowns)}
    spec = mech.spec.copy()
    spec.compiler.savecompiled = False
    part.install(spec, values, around)
    reloaded = mujoco.MjSpec.from_string(spec.to_xml())
    exact = part.stored(values, around).exact
    forces = {} if exact else {"b": lambda length: part.law.force_at(length, part.own(values))}
    found = holding(reloaded, around, forces, part.path.positions(around, "b"), part.path.laws(around, "b"))
    own = part.effort(around, "hold").at(np.array(list(values.values())))
    assert np.abs(own).max() > 0
    np.testing.assert_allclose(found, around.holding + own, rtol=0, atol=1e-8 * np.abs(own).max())


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_the_mechanism_obeys_the_same_law(posed, mechanism):
    mech, states, shifted, h = posed[mechanism]
    b, _ = slope(mech.effort(shifted, "energy"), len(states), len(mech.driven), h)
    np.testing.assert_allclose(mech.effort(states, "hold").b, b, atol=1e-7)


FIXED = ("direction", "axis", "profile")


def numbers(item, name):
    """Names of all numbers inside a path that `shape` may free: all but vectors that only point, and tables."""
    if isinstance(item, tuple):
        return [found for index, entry in enumerate(item) for found in numbers(entry, f"{name}.{index}")]
    if not is_dataclass(item):
        return [name] if isinstance(item, float | int) else []
    kept = [field.name for field in fields(item) if field.name not in FIXED]
    if isinstance(item, eq.Point):
        return [f"{name}.{axis}" for axis in "xyz"]
    return [found for field in kept for found in numbers(getattr(item, field), f"{name}.{field}")]


@pytest.mark.parametrize("law", ["coil", "zero_free_length"])
@pytest.mark.parametrize("path", [*PATHS, *ANGLES, *PLANAR])
def test_geometry_derivatives_are_exact(posed, path, law):
    mech, states, _, _ = posed["planar" if path in PLANAR else "spatial"]
    part = eq.Spring("b", EVERY_PATH[path](mech), LAWS[law], mass=0.4)
    names = numbers(part.path, "b.path")
    if path.startswith("cable"):  # an eye has no radius to change, and a pulley's cable stays in its plane
        names = [name for name in names if not name.endswith(".radius") or read([part], name)]
        names = [name for name in names if path != "cable_pulley" or not name.endswith((".y", "at.1"))]
    here = np.array([read([part], name) for name in names])
    theta = np.linspace(1.0, 2.0, len(part.unknowns))
    steps = here + 1j * STEP * np.eye(len(names))
    exact = candidates([part], names, steps)[0].effort(states, "hold").at(theta).imag / STEP
    for index, name in enumerate(names):
        h = 1e-6
        sides = [write([part], {name: here[index] + s})[0].effort(states, "hold").at(theta) for s in (h, -h)]
        np.testing.assert_allclose(exact[index], (sides[0] - sides[1]) / (2 * h), atol=1e-6)
        assert isinstance(unit_of([part], name), str)


@pytest.mark.parametrize("law", [name for name in LAWS if not name.startswith(("constant", "linear"))])
def test_laws_follow_their_own_numbers_exactly(posed, law):
    """Complex step against differences, for force and energy, in every number that `shape` may free."""
    mech, states, _, _ = posed["spatial"]
    part = eq.Spring("b", PATHS["between"](mech), LAWS[law])
    names = [f"b.law.{field.name}" for field in fields(part.law) if isinstance(getattr(part.law, field.name), float)]
    names += [f"b.law.interval.{end}" for end in (0, 1) if law == "polynomial"]
    here = np.array([read([part], name) for name in names])
    theta = np.linspace(1.0, 2.0, len(part.unknowns))
    steps = here + 1j * STEP * np.abs(here) * np.eye(len(names))
    for goal in ("hold", "storage"):
        exact = candidates([part], names, steps)[0].effort(states, goal).at(theta).imag / STEP
        exact = np.broadcast_to(exact, (len(names), *part.effort(states, goal).b.shape))
        for index, name in enumerate(names):
            if name == "b.law.exponent" and here[index] == 1.0:  # differences would leave 1..2
                continue
            h = 1e-6 * abs(here[index])
            sides = [write([part], {name: here[index] + s})[0].effort(states, goal).at(theta) for s in (h, -h)]
            slope = (sides[0] - sides[1]) / 2e-6
            size = max(1.0, np.abs(sides[0]).max())
            np.testing.assert_allclose(exact[index], slope, atol=2e-9 * size, err_msg=name)


def test_candidates_are_the_geometries_one_by_one(posed):
    mech, states, _, _ = posed["spatial"]
    part = eq.Spring("b", PATHS["between"](mech), eq.Coil(free_length=0.1, k=500.0), mass=0.4)
    names = ["b.path.line.1.z", "b.law.k", "b.path.a.x"]
    gammas = np.array([[0.01, 400.0, 0.02], [-0.05, 900.0, 0.06]])
    together = candidates([part], names, gammas)[0].effort(states, "hold").b
    for gamma, b in zip(gammas, together, strict=True):
        alone = write([part], dict(zip(names, gamma.tolist(), strict=True)))[0]
        np.testing.assert_allclose(alone.effort(states, "hold").b, b, atol=1e-12)
    assert unit_of([part], "b.law.coil.k") == "N/m"
    assert tag(eq.ZeroFreeLength) == "zero_free_length"


LIMITS = {
    "force": lambda: eq.Force("b", max=300.0, min=10.0),
    "slack": lambda: eq.Slack("b"),
    "length": lambda: eq.Length("b", max=0.9, min=0.1),
    "stroke": lambda: eq.Stroke("b", max=0.3),
    "avoid": lambda: eq.Avoid("b", radius=0.03, gap=0.01),
    "avoid_coil": lambda: eq.Avoid("b", radius=0.03),
    "avoid_axes": lambda: eq.Avoid("b", gap=0.01, what="axes"),
    "stiffness": lambda: eq.Stiffness("b", max=2000.0, min=5.0),
    "elongation": lambda: eq.Elongation("b", max=1.0, min=0.05),
    "extension": lambda: eq.Extension("b", max=0.2),
    "spring_index": lambda: eq.SpringIndex("b", min=4.0, max=15.0, diameter=0.04, coils=60.0),
    "force_over": lambda: eq.Force("b", max=300.0, min=10.0, over=(0.1, 0.9)),
    "slope": lambda: eq.Slope("b", (0.1, 0.9), min=5.0),
    "curvature": lambda: eq.Curvature("b", (0.1, 0.9), max=50.0),
    "convex": lambda: eq.Convex("b", (0.1, 0.9), radius=0.2),
    "exact_at": lambda: eq.ExactAt(({"boom_joint": 0.3},), joints=("boom_joint",)),
    "wrap": lambda: eq.Wrap("b", min=0.1, max=2.0, gap=0.01),
}
LIMITED_ON = {
    "wrap": ("planar", "cable_pulley", "b.path.through.5.x"),
    "avoid_coil": ("spatial", "cable_eye", "b.path.through.1.at.x"),
}
"""Mechanism, path and freed number of limits that do not belong to straight lines."""


LIMITED = {
    "coil": eq.Coil(free_length=None),
    "gas": eq.Gas(area=3e-4, volume=1.2e-3, length=0.4, action="pull"),
    "polynomial": LAWS["polynomial"],
}


@pytest.mark.parametrize("law", LIMITED)
@pytest.mark.parametrize("limit", LIMITS)
def test_limits_answer_rows_that_follow_the_geometry(posed, limit, law):
    """Rows are finite, as many as their right sides, and their complex-step slope is that of differences."""
    home, path, name = LIMITED_ON.get(limit, ("spatial", "between", "b.path.line.1.x"))
    mech, states, _, _ = posed[home]
    part = eq.Spring("b", EVERY_PATH[path](mech), LIMITED[law])
    curved = law == "gas" and limit in ("force_over", "slope", "curvature", "convex")
    if curved or (law != "coil" and limit in ("elongation", "extension", "spring_index")):
        with pytest.raises(eq.InputError, match=r"is no (polynomial|coil)|has no rate"):
            LIMITS[limit]().rows(Setting({"b": part}, states, lambda poses: effort(mech, [part], states)))
        return
    h = 1e-6
    here = read([part], name)

    def rows(balancers):
        def hold_at(poses):
            return effort(mech, balancers, mech.states(eq.Sweep(poses, np.ones(len(poses)), "exact")))

        return LIMITS[limit]().rows(Setting({"b": balancers[0]}, states, hold_at))

    plain, up, down = (rows(write([part], {name: here + s})) for s in (0.0, h, -h))
    exact = rows(candidates([part], [name], np.array([[here + 1j * STEP]])))
    assert plain
    for base, plus, minus, complex_row in zip(plain, up, down, exact, strict=True):
        assert base.G.shape[:-1] == base.h.shape
        assert np.isfinite(base.G).all()
        for what in ("G", "h"):
            value = np.broadcast_to(getattr(complex_row, what), (1, *getattr(base, what).shape))[0]
            difference = (getattr(plus, what) - getattr(minus, what)) / (2 * h)
            np.testing.assert_allclose(np.imag(value) / STEP, difference, atol=1e-5)
            np.testing.assert_allclose(np.real(value), getattr(base, what), atol=1e-12)


@pytest.mark.parametrize("goal", ["force", "moment", "both"])
@pytest.mark.parametrize("kind", ["planar", "spatial"])
def test_balance_in_all_motions_answers_rows_that_follow_the_geometry(posed, kind, goal):
    """One more equality than unknowns for each of p and L, with slopes; they say the momentum, whatever the weights."""
    mech = posed[kind][0]
    part = eq.Counterweight("b", eq.Point(bodies(mech)[1], (0.1, 0.0, 0.05)))
    name, h = "b.at.x", 1e-6

    def rows(balancers):
        return eq.Balanced(goal).rows(setting_of(mech, balancers, None, posed[kind][1]))

    plain, up, down = (rows(write([part], {name: 0.1 + s})) for s in (0.0, h, -h))
    exact = rows(candidates([part], [name], np.array([[0.1 + 1j * STEP]])))
    assert len(plain) == (2 if goal == "both" else 1)
    for base, plus, minus, complex_row in zip(plain, up, down, exact, strict=True):
        assert base.equality
        assert base.G.shape == (2, 1)
        for what in ("G", "h"):
            value = np.broadcast_to(getattr(complex_row, what), (1, *getattr(base, what).shape))[0]
            difference = (getattr(plus, what) - getattr(minus, what)) / (2 * h)
            np.testing.assert_allclose(np.imag(value) / STEP, difference, atol=1e-7)
            np.testing.assert_allclose(np.real(value), getattr(base, what), atol=1e-12)


def test_closed_coils_and_reach_are_implied(posed):
    mech, states, _, _ = posed["planar"]
    coil = eq.Spring("c", PATHS["to_world"](mech), eq.Coil(free_length=0.2, initial_tension=5.0))
    weight = eq.Counterweight("w", eq.Point("fore"), reach=0.1)
    setting = Setting({"c": coil, "w": weight}, states, lambda poses: effort(mech, [coil, weight], states))
    words = [rows.limit for rows in implied([coil, weight], setting)]
    assert words == ["closed length of c (0.2 m)", "reach of w (0.1 m)"]


MOVING = WEIGHTS | {
    "heavy_spring": lambda m: eq.Spring("b", PATHS["between"](m), eq.Coil(free_length=0.1), mass=1.7),
}
ROTORS = {
    "rotor": lambda m: eq.CounterRotor("b", bodies(m)[1], ratio=1.5),
    "planetary": lambda m: eq.CounterRotor("b", bodies(m)[1], gear_inertia=0.01, at=eq.Point(bodies(m)[0]), radius=0.1),
    "belt": lambda m: eq.CounterRotor("b", bodies(m)[1], ratio=-2.0, inertia=0.02, mass=0.3),
    "steep": lambda m: eq.CounterRotor(
        "b", bodies(m)[1], inertia=0.02, at=eq.Point("world", (0.1, 0.0, 0.2)), pressure_angle=0.4
    ),
    "plate": lambda m: eq.Counterweight("b", eq.Point(bodies(m)[1]), reach=0.1, shape=eq.Plate()),
}


@pytest.mark.parametrize(
    ("mechanism", "balancer"),
    [(m, b) for m in MECHANISMS for b in MOVING if "place" not in b and b != "free"]
    + [(m, b) for m in ("planar", "linkage") for b in ROTORS],
    ids=lambda name: name,
)
def test_power_is_the_rate_of_energy_and_wrenches_are_rates_of_momentum(mechanism, balancer):
    """tau . v = d(T + V)/dt, F = dp/dt, M = dL/dt along a motion, for every unknown by itself."""
    from scipy.interpolate import make_interp_spline

    mech = MECHANISMS[mechanism]()
    part = (MOVING | ROTORS)[balancer](mech)
    part.check(mech)
    box = np.where(np.isnan(mech.box), [-0.5, 0.5], mech.box).clip(-1.0, 1.0)
    middle, span = box.mean(axis=1), 0.3 * (box[:, 1] - box[:, 0])
    drivers = {
        joint: f"{middle[i]} + {span[i]}*sin({3 + i}*t + {i})" for i, joint in enumerate(mech.driven)
    }  # fmt: skip
    sweep = eq.Sweep.motion(mech, drivers, duration=1.0, samples=801)
    states, time = mech.states(sweep), sweep.instants.time
    theta = np.linspace(1.0, 2.0, len(part.unknowns))

    def answer(at, goal):
        return part.effort(at, goal).at(theta)

    def rate(values):
        return make_interp_spline(time, values, k=5)(time, 1)[20:-20]

    drive = answer(states, "drive")
    power = (drive * states.rates.driven_velocity).sum(axis=1)
    # twice the kinetic energy is the inertial effort that velocities in the place of accelerations would give
    inertial = answer(states.momenta, "drive") - answer(states, "hold")
    kinetic = 0.5 * (inertial * states.rates.driven_velocity).sum(axis=1)
    energy = rate(kinetic + answer(states, "energy")[:, 0])
    np.testing.assert_allclose(power[20:-20], energy, atol=2e-6 * max(1.0, np.abs(power).max()))
    for goal in ("force", "moment"):
        want = answer(states, goal)[20:-20]
        np.testing.assert_allclose(rate(answer(states.momenta, goal)), want, atol=2e-6 * max(1.0, np.abs(want).max()))
