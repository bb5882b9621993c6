"""Paths against independent answers: closed forms, numerical shortest cables, MuJoCo's constraint Jacobian."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from scipy.spatial import ConvexHull

import equipoise as eq
from equipoise.loops import tighten_loops
from equipoise.parameters import candidates

DEG = np.pi / 180


def arm(base=(0.0, 0.0, 0.0), datum="right"):
    links = [eq.Link("upper", length=0.6, mass=3.0), eq.Link("fore", length=0.5, mass=2.0)]
    return eq.chain(links, base=base, datum=datum)


def at(mechanism, *poses):
    return mechanism.states(eq.Sweep(np.array(poses, dtype=float), np.ones(len(poses)), "listed"))


def test_absolute_angles_are_continuous_and_agree_with_the_body():
    poses = np.random.default_rng(0).uniform(-7, 7, (50, 2))
    for datum in ("right", "up"):
        mech = arm(datum=datum)
        states = at(mech, *poses)
        right, rate = eq.Absolute("fore", datum="right").deform(states)
        forward = states.rotation("fore")[0][:, :, 0]
        np.testing.assert_allclose(np.exp(1j * right), forward[:, 0] + 1j * forward[:, 2], atol=1e-12)
        np.testing.assert_allclose(eq.Absolute("fore", datum="up").deform(states)[0], 0.5 * np.pi - right, atol=1e-12)
        sign = 1.0 if datum == "right" else -1.0
        np.testing.assert_allclose(rate, sign * np.ones((50, 2)))
        own = eq.Absolute("fore", datum=datum).deform(states)[0]
        np.testing.assert_allclose(own, poses.sum(axis=1), atol=1e-12)


def test_a_parallelogram_keeps_its_head():
    mech = eq.parallelogram_arm(0.3)
    states = at(mech, [-0.5], [0.2], [0.9])
    angle, rate = eq.Absolute("head").deform(states)
    np.testing.assert_allclose(angle, 0.0, atol=1e-12)
    np.testing.assert_allclose(rate, 0.0, atol=1e-12)
    with pytest.raises(eq.InputError, match="no hinge turns world"):
        eq.Absolute("world").check(mech, "s")


def test_absolute_needs_hinges_across_the_plane():
    links = [eq.Link("turret", length=0.2, axis=(0, 0, 1)), eq.Link("boom", length=0.5)]
    with pytest.raises(eq.InputError, match="turret_joint turns boom out of the x-z plane"):
        eq.Absolute("boom").check(eq.chain(links), "s")


def test_scotch_yoke_has_the_cosine_of_quaglia_and_yin():
    """dl/dtheta = b cos theta for absolute angles from the horizontal, also of the second link."""
    states = at(arm(), *np.random.default_rng(1).uniform(-2, 2, (20, 2)))
    length, rate = eq.ScotchYoke(eq.Absolute("fore"), 0.2, offset=0.05).deform(states)
    theta = states.driven.sum(axis=1)
    np.testing.assert_allclose(length, 0.05 + 0.2 * np.sin(theta), atol=1e-14)
    np.testing.assert_allclose(rate, (0.2 * np.cos(theta))[:, None] * np.ones(2), atol=1e-14)


def test_inverted_slider_crank_is_the_spring_between_two_pins():
    """a10 = sqrt(r^2 + b^2) with the pivot at 90 deg, r = 1.2 m, b = 0.2 m; the same line, drawn between two points."""
    mech = arm()
    states = at(mech, *np.random.default_rng(2).uniform(-3, 3, (20, 2)), [0.0, 0.3])
    path = eq.InvertedSliderCrank(eq.Angle("upper_joint"), 0.2, 1.2, phase=-90 * DEG)
    line = eq.Line(eq.Point("upper", (0.2, 0, 0)), eq.Point("world", (0, 0, 1.2)))
    for one, other in zip(path.deform(states), line.deform(states), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-14)
    assert path.deform(states)[0][-1] == pytest.approx(1.216553, abs=5e-7)


def test_slider_crank_is_the_builders():
    made = eq.slider_crank(0.1, 0.3, offset=0.04)
    states = at(made, [0.3], [1.4], [-2.0])
    slide = eq.Angle("slider_joint", unit="m").deform(states)
    path = eq.SliderCrank(eq.Angle("crank_joint"), 0.1, 0.3, offset=0.04).deform(states)
    for one, other in zip(path, slide, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)


def test_a_dyad_that_cannot_close_names_angle_and_lengths():
    states = at(arm(), *[[angle * DEG, 0.0] for angle in range(0, 181, 5)])
    path = eq.SliderCrank(eq.Angle("upper_joint"), 0.2, 0.15, phase=10 * DEG)
    with pytest.raises(eq.InputError) as caught:
        path.deform(states)
    text = str(caught.value)
    assert "80 deg" in text
    assert "crank 200 mm" in text
    assert "rod 150 mm" in text
    assert "50 mm are missing" in text
    # Of many candidates the limits of `shape` judge: those that do not close have no room.
    spring = eq.Spring("s", path, eq.Linear())
    many = candidates([spring], ["s.path.rod"], np.array([[0.15], [0.25]]))[0]
    length, _ = many.path.deform(states)
    assert np.isfinite(length).all()
    (need,) = many.path.needs(states)
    assert need.room.min(axis=1)[0] == pytest.approx(-0.05, abs=1e-3)
    assert need.room.min(axis=1)[1] > 0
    assert not path.needs(at(arm(), [0.0, 0.0]))


@pytest.mark.parametrize("side", ["left", "right"])
def test_cable_is_the_shortest_way_around_its_pulleys(side):
    """Length against the convex hull of ends and discs, rate against differences."""
    mech = arm()
    big, small = eq.Pulley("world", (-0.2, 0, 0.7), 0.1, side=side), eq.Pulley("upper", (0.4, 0, 0.2), 0.06, side=side)
    flip = 1.0 if side == "right" else -1.0
    ends = eq.Point("world", (-0.6, 0, 0.1)), eq.Point("fore", (0.3, 0, 0.0))
    # Mirrored about the x axis the left-handed cable is the right-handed one.
    big, small = (eq.Pulley(p.body, (p.at[0], 0, flip * p.at[2]), p.radius, side=side) for p in (big, small))
    ends = tuple(eq.Point(p.body, (p.at[0], 0, flip * p.at[2])) for p in ends)
    path = eq.Cable((ends[0], big, small, ends[1]))
    pose = np.array([50 * DEG, -110 * DEG]) * flip
    states = at(mech, pose)
    length, rate = path.deform(states)

    centres = [states.point(p)[0][0][[0, 2]] for p in (ends[0], big.centre, small.centre, ends[1])]

    # Taut over the same side of all discs, the cable is the convex hull but for the edge between its ends.
    turn = np.linspace(0, 2 * np.pi, 40001)[:-1, None]
    ring = np.hstack([np.cos(turn), np.sin(turn)])
    hull = ConvexHull(np.vstack([centres[0], centres[3], centres[1] + 0.1 * ring, centres[2] + 0.06 * ring]))
    assert {0, 1} <= set(hull.vertices)
    assert length[0] == pytest.approx(hull.area - np.linalg.norm(centres[3] - centres[0]), abs=1e-8)
    h = 1e-6
    for joint in range(2):
        step = h * np.eye(2)[joint]
        sides = path.deform(at(mech, pose + step, pose - step))[0]
        assert rate[0, joint] == pytest.approx((sides[0] - sides[1]) / (2 * h), abs=1e-8)


def test_a_cable_lifts_off_without_a_jump():
    mech = arm()
    pulley = eq.Pulley("world", (0.0, 0, 0.25), 0.05, side="right")
    path = eq.Cable((eq.Point("world", (-0.5, 0, 0.2)), pulley, eq.Point("upper", (0.5, 0, 0))))
    angles = np.linspace(0, 60, 2001) * DEG
    states = at(mech, *np.stack([angles, 0 * angles], axis=1))
    wrap = path.taut(states).wrap[:, 1]
    assert wrap.max() > 0.3
    assert (wrap <= 0).any()
    length, rate = path.deform(states)
    np.testing.assert_allclose(np.gradient(length, angles)[1:-1], rate[1:-1, 0], atol=1e-3)
    free = eq.Line(eq.Point("world", (-0.5, 0, 0.2)), eq.Point("upper", (0.5, 0, 0))).deform(states)[0]
    np.testing.assert_allclose(length[wrap <= 0], free[wrap <= 0], atol=1e-14)
    assert (length[wrap > 0] > free[wrap > 0]).all()


def test_cables_refuse_what_they_cannot_be():
    mech, states = arm(), at(arm(), [0.3, 0.4])
    first, last = eq.Point("world", (-0.4, 0, 0.3)), eq.Point("upper", (0.4, 0, 0))

    def refused(*through, match):
        def act():
            path = eq.Cable(through)
            path.check(mech, "s")
            path.deform(states)

        with pytest.raises(eq.InputError, match=match):
            act()

    refused(first, match="two are needed")
    refused(first, eq.Point("world"), match="moves as one")
    refused(first, eq.Pulley("upper", (0.3, 0, 0), 0.1), match="ends on a pulley")
    refused(first, eq.Pulley("world", (0, 0.1, 0.5), 0.1, side="right"), last, match="leaves the plane .* 100 mm")
    refused(first, eq.Pulley("world", (-0.4, 0, 0.35), 0.1), last, match="within 50 mm, closer than .*100 mm")
    refused(first, eq.Pulley("world", (0, 0, 0.9), -0.1), last, match="radius of the pulley is -0.1 m")
    refused(first, eq.Pulley("world", (0, 0, 0.9), 0.1, axis=(0, 0, 0)), last, match="points nowhere")
    far = eq.Pulley("world", (0, 0, -0.9), 0.1, side="right", nominal=55 * DEG)
    refused(first, far, last, match="wraps pulley 2 by .* deg, too far from 55 deg")


def test_tackles_and_drums():
    states = at(arm(), [0.3, 0.4], [0.9, -0.2])
    ends = eq.Point("world", (-0.4, 0, 0.3)), eq.Point("fore", (0.2, 0, 0))
    plain, rate = eq.Line(*ends).deform(states)
    length, tackled = eq.Cable(ends, ratio=0.5, offset=-0.1).deform(states)
    np.testing.assert_allclose(length, 0.5 * plain - 0.1)
    np.testing.assert_allclose(tackled, 0.5 * rate)
    drum = eq.Drum(eq.Gear(eq.Angle("fore_joint"), -2.0, offset=0.3), 0.05, offset=0.2)
    assert drum.unit == "m"
    np.testing.assert_allclose(drum.deform(states)[0], 0.2 + 0.05 * (0.3 - 2 * states.driven[:, 1]))


def test_profiles_are_smooth_and_pass_through_their_points(tmp_path):
    angles = np.linspace(0, 2 * np.pi, 13)
    lifts = 0.03 + 0.01 * np.cos(angles)
    profile = eq.Profile(tuple(angles), tuple(lifts))
    np.testing.assert_allclose(profile(angles)[0], lifts, atol=1e-15)
    turned = np.array([-7.0, 0.3, 6.0, 20.0])
    np.testing.assert_allclose(profile(turned)[0], profile(turned + 4 * np.pi)[0], atol=1e-14)
    step = profile(turned + 1e-30j)[0].imag / 1e-30
    np.testing.assert_allclose(profile(turned)[1], step, atol=1e-15)
    ends = profile(np.array([0.0, 2 * np.pi - 1e-12]))[1]
    assert ends[0] == pytest.approx(ends[1], abs=1e-12)
    dwell = eq.Profile((0.0, 1.0, 2.0, 3.0), (0.0, 0.01, 0.02, 0.02), kind="clamped")
    np.testing.assert_allclose(dwell(np.array([0.0, 3.0]))[1], 0.0, atol=1e-15)
    file = tmp_path / "cam.csv"
    rows = [f"{np.degrees(a)},{1e3 * b}" for a, b in zip(angles, lifts, strict=True)]
    file.write_text("angle deg,lift mm\n" + "\n".join(rows))
    np.testing.assert_allclose(eq.Profile.csv(file)(turned)[0], profile(turned)[0], atol=1e-12)


def test_a_pitch_curve_is_read_as_the_follower_meets_it():
    """An eccentric circle: rho(psi) = e cos psi + sqrt(R^2 - e^2 sin^2 psi), met at psi = -u."""
    e, radius, lead = 0.01, 0.04, 0.7
    psi = np.linspace(0, 2 * np.pi, 361)[:-1]
    points = radius * np.exp(1j * psi) + e * np.exp(1j * lead)
    profile = eq.Profile.pitch(tuple((float(p.real), float(p.imag)) for p in points))
    u = np.linspace(-4, 9, 50)
    met = -u - lead
    exact = e * np.cos(met) + np.sqrt(radius**2 - e**2 * np.sin(met) ** 2)
    np.testing.assert_allclose(profile(u)[0], exact, atol=1e-9)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: eq.Profile((0, 1, 2), (0, 0, 0)), "3 points make no profile"),
        (lambda: eq.Profile((0, 2, 1, 3), (0, 0, 0, 0)), "the angles do not rise: 114.592 deg is followed by 57.2958"),
        (lambda: eq.Profile((0, 1, 2, 3), (0, 0, 0, 0)), "spans 360 deg, this one 171.887 deg"),
        (lambda: eq.Profile((0, 1, 2, 2 * np.pi), (0, 0, 0, 0.001)), "differs from the first by 1 mm"),
        (lambda: eq.Profile((0, 1, 2, 3), (0, 0, 0), kind="free"), "4 angles and 3 lifts"),
        (lambda: eq.Profile.csv("nowhere.csv"), "cannot be read"),
        (lambda: eq.Profile.pitch(((1, 0), (0, -1), (-1, 0), (0, 1))), "counter-clockwise"),
    ],
)
def test_bad_profiles(make, words):
    with pytest.raises(eq.InputError, match=words):
        make()


def test_a_cam_beyond_its_profile_names_the_angle():
    cam = eq.Cam(eq.Angle("upper_joint"), eq.Profile((0.0, 1.0, 2.0, 3.0), (0.0, 0.01, 0.02, 0.02), kind="clamped"))
    with pytest.raises(eq.InputError, match=r"turns to 200\.535 deg, its profile runs from 0 to 171\.887 deg"):
        cam.deform(at(arm(), [1.0, 0.0], [3.5, 0.0]))


@pytest.mark.parametrize(
    ("path", "law", "words"),
    [
        (eq.ScotchYoke(eq.Angle("upper_joint"), 0.0), eq.Linear(), "crank of radius 0"),
        (eq.ScotchYoke(eq.Angle("nowhere"), 0.1), eq.Linear(), "no joint 'nowhere'"),
        (eq.ScotchYoke(eq.Angle("upper_joint"), 0.1, yoke_mass=1.0), eq.Linear(), "does not say where it sits"),
        (eq.ScotchYoke(eq.Drum(eq.Angle("upper_joint"), 0.1), 0.1), eq.Linear(), "driven by a drum"),
        (eq.SliderCrank(eq.Angle("upper_joint"), None, 0.3), eq.Linear(), "crank of spring s is open"),
        (eq.SliderCrank(eq.Angle("upper_joint"), 0.1, -0.3), eq.Linear(), "rod of spring s is -0.3 m"),
        (eq.InvertedSliderCrank(eq.Angle("upper_joint"), 0.1, 0.0), eq.Linear(), "distance of spring s is 0 m"),
        (eq.Drum(eq.Angle("upper_joint"), 0.0), eq.Linear(), "has no radius"),
        (eq.Angle("upper_joint", unit="m"), eq.Linear(), "is a hinge, whose position is in rad"),
        (eq.Angle("upper_joint"), eq.Coil(0.1), "acts along"),
        (eq.Drum(eq.Angle("upper_joint"), 0.1), eq.Torsion(), "acts along"),
    ],
)  # fmt: skip
def test_what_cannot_act_is_refused(path, law, words):
    with pytest.raises(eq.InputError, match=words):
        eq.Spring("s", path, law).check(arm())


def test_a_mount_is_square():
    mount = eq.Mount(eq.Point("world"), direction=(1.0, 0.5, 0.0))
    path = eq.ScotchYoke(eq.Angle("upper_joint"), 0.1, mount=mount)
    with pytest.raises(eq.InputError, match=r"stand at 116\.565 deg, not at 90 deg"):
        path.check(arm(), "s")


def test_transmission_is_that_of_mujoco_s_own_constraint_jacobian():
    """D of the added loops solves efc_J D = 0 at single poses of the reloaded model."""
    mech = arm()
    mount = eq.Mount(eq.Point("world", (0.3, 0.0, -0.1)), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0))
    parts = {
        "dyad": eq.SliderCrank(eq.Absolute("fore"), 0.1, 0.3, offset=0.02, mount=mount),
        "swivel": eq.InvertedSliderCrank(eq.Gear(eq.Angle("upper_joint"), -2.0), 0.1, 0.25, mount=mount),
        "yoke": eq.ScotchYoke(eq.Angle("fore_joint"), 0.1, mount=mount),
    }
    states = at(mech, [0.4, 0.5], [1.1, -0.6], [-0.3, 1.9])
    spec = mech.spec.copy()
    for name, path in parts.items():
        path.install(spec, name, states)
    model = mujoco.MjSpec.from_string(spec.to_xml()).compile()
    q = np.zeros((3, model.nq))
    q[:, [model.joint(name).qposadr[0] for name in mech.driven]] = states.driven
    for name, path in parts.items():
        for joint, value in path.positions(states, name).items():
            q[:, model.joint(joint).qposadr[0]] = value
    reloaded = eq.Mechanism(spec, model, mech.driven, q[0], "with parts", singularity=1e-7)
    closed, transmission = tighten_loops(reloaded, q)
    np.testing.assert_allclose(closed, q, atol=1e-12)
    data = mujoco.MjData(model)
    for row in range(3):
        data.qpos[:] = closed[row]
        mujoco.mj_forward(model, data)
        jacobian = np.zeros((data.nefc, model.nv))
        if mujoco.mj_isSparse(model):
            mujoco.mju_sparse2dense(jacobian, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
        else:
            jacobian = data.efc_J.reshape(data.nefc, model.nv)
        equal = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
        np.testing.assert_allclose(data.efc_pos[equal], 0.0, atol=1e-14)
        np.testing.assert_allclose(jacobian[equal] @ transmission[row], 0.0, atol=1e-12)


def test_the_saved_file_has_a_closed_keyframe(tmp_path):
    mech = eq.four_bar(0.4, 0.15, 0.35, 0.3, masses=(1.0, 2.0, 1.5))
    spring = eq.Spring("s", eq.SliderCrank(eq.Angle("crank_joint"), 0.1, 0.35), eq.Linear())
    sweep = eq.Sweep.grid(mech, {"crank_joint": (0.3, 2.5, 12)})
    design = eq.verify(eq.balance(mech, [spring], sweep, norm="rms"), out=tmp_path, poses=400)
    assert design.verification.agrees
    assert design.verification.max_abs_error < 1e-8 * max(e.load for e in design.verification.errors.values())
    model = mujoco.MjModel.from_xml_path(str(design.verification.model))
    assert {model.key(index).name for index in range(model.nkey)} == {"balanced", "open"}
    data = mujoco.MjData(model)
    for index in range(model.nkey):
        mujoco.mj_resetDataKeyframe(model, data, index)
        mujoco.mj_forward(model, data)
        np.testing.assert_allclose(data.efc_pos, 0.0, atol=1e-12)


def test_a_cable_s_pulleys_are_saved_up_to_long_arcs(tmp_path):
    """Arcs from 121 to 182 degrees, a tackle and a heavy spring whose end moves along the first run."""
    mech = arm(base=(0.0, 0.0, 0.3))
    pulley = eq.Pulley("world", (0, 0, 0.9), 0.06, side="right", mass=0.5)
    through = eq.Point("world", (-0.5, 0, 0.3)), pulley, eq.Point("upper", (0.3, 0, 0))
    spring = eq.Spring("s", eq.Cable(through, ratio=0.5, offset=-0.2), eq.Linear(), mass=0.7)
    sweep = eq.Sweep.grid(mech, {"upper_joint": (0.0, 170 * DEG, 18), "fore_joint": (-1.0, 1.0, 3)})
    design = eq.verify(eq.balance(mech, [spring], sweep, norm="rms"), out=tmp_path, poses=300)
    assert design.verification.agrees
    assert np.degrees(spring.path.taut(design.states).wrap.max()) > 180


@pytest.mark.parametrize(
    ("at_", "anchor", "hook", "side", "limits", "wraps"),
    [
        ((0.1, 0, 0), (-0.4, 0, 0), (0.25, 0, 0), "right", (-115, 23), (-30, 137)),
        ((0.1, 0, 0), (0.0, 0, 0.5), (0.25, 0, 0), "left", (-115, 23), (-49, 123)),
        ((0.1, 0, 0), (0.4346, 0, 0.3716), (0.25, 0, 0), "left", (-115, 20), (4.3, 171.5)),
        ((0.3, 0, 0), (-0.2, 0, 0.02), (0.28, 0, 0), "right", (-168, -12), (117, 176)),
        ((0.3, 0, 0), (-0.5, 0, 0.01), (0.25, 0, 0), "left", (-168, -12), (188, 244)),
    ],
)
def test_wraps_that_change_a_lot_are_saved_and_their_rate_is_exact(at_, anchor, hook, side, limits, wraps):
    """Signed wraps from a lifted cable to more than half a turn; MuJoCo's tendon has the same length throughout."""
    mech = arm()
    pulley = eq.Pulley("world", at_, 0.015, side, nominal=90 * DEG)
    path = eq.Cable((eq.Point("world", anchor), pulley, eq.Point("upper", hook)), offset=-0.1)
    poses = np.column_stack([np.linspace(*limits, 61) * DEG, np.zeros(61)])
    states, h = at(mech, *poses), 1e-6
    ((number, wrap, rate),) = path.embraces(states)
    assert number == 1
    assert (wrap.min() / DEG, wrap.max() / DEG) == pytest.approx(wraps, abs=1.0)
    sides = [path.embraces(at(mech, *(poses + np.array([step, 0.0]))))[0][1] for step in (h, -h)]
    np.testing.assert_allclose(rate, np.column_stack([(sides[0] - sides[1]) / (2 * h), np.zeros(61)]), atol=1e-7)
    spec = mech.spec.copy()
    path.install(spec, "s", states)
    model = spec.compile()
    data, lengths = mujoco.MjData(model), []
    for pose in poses:
        data.qpos[:2] = pose
        mujoco.mj_forward(model, data)
        lengths.append(data.ten_length[model.tendon("s_cable").id])
    np.testing.assert_allclose(lengths, path.taut(states).length, atol=1e-12)


def test_a_swivel_follows_the_hook_to_all_sides():
    """Against the closed form, out of the plane too; square to the run it is a distance but for a constant."""
    mech, radius = arm(), 0.03
    poses = np.column_stack([np.linspace(-3.1, 3.1, 40), np.linspace(-2.0, 2.5, 40)])
    states = at(mech, *poses)
    for start, hook in (((-0.5, 0.1, 0.2), (0.3, 0.05, 0.1)), ((0.1, 0.4, 0.3), (0.25, 0.0, -0.1))):
        place = np.array([0.1, radius, 0.3])
        path = eq.Cable((eq.Point("world", start), eq.Swivel("world", tuple(place), radius), eq.Point("fore", hook)))
        run = place - start
        gap = states.point(eq.Point("fore", hook))[0] - place
        ahead = gap @ run / np.linalg.norm(run)
        aside = np.sqrt((gap * gap).sum(-1) - ahead**2)
        free = np.sqrt(ahead**2 + aside**2 - 2 * aside * radius)
        wrap = np.arctan2(aside - radius, ahead) + np.arctan2(radius, free)
        np.testing.assert_allclose(path.embraces(states)[0][1], wrap, atol=1e-12)
        np.testing.assert_allclose(path.deform(states)[0], np.linalg.norm(run) + radius * wrap + free, atol=1e-12)
    np.testing.assert_allclose(wrap, np.pi / 2, atol=1e-12)
    distance = np.linalg.norm(gap + np.array([0.0, radius, 0.0]), axis=1)
    np.testing.assert_allclose(np.ptp(path.deform(states)[0] - distance), 0.0, atol=1e-12)


def test_a_swivel_needs_a_run_that_is_fixed_to_its_body():
    mech, hook = arm(), eq.Point("fore", (0.2, 0, 0))
    moving = eq.Cable((eq.Point("world", (0.1, 0, 0.3)), eq.Swivel("upper", (0.1, 0, 0.1), 0.02), hook))
    beside = eq.Cable(
        (eq.Point("world"), eq.Swivel("world", (0.1, 0, 0.1), 0.02), eq.Pulley("upper", radius=0.1), hook)
    )
    last = eq.Cable((eq.Point("world"), eq.Swivel("upper", (0.1, 0, 0.1))))
    # Its length follows no single distance.
    assert (
        eq.Cable((eq.Point("world"), eq.Swivel("world", (0.1, 0, 0.1), 0.02), hook)).run(at(mech, [0.1, 0.2])) is None
    )
    for path, words in ((moving, "no line to swivel about"), (beside, "beside another"), (last, "ends on a pulley")):
        with pytest.raises(eq.InputError, match=words):
            path.check(mech, "s")


def test_files_refuse_cables_that_they_cannot_hold():
    mech = arm()
    through = (
        eq.Point("world", (-0.5, 0, 0.1)),
        eq.Pulley("world", (-0.4, 0, 0.9), 0.05, side="right"),
        eq.Pulley("world", (-0.1, 0, 0.85), 0.08, side="left"),
        eq.Point("upper", (0.3, 0, 0.0)),
    )
    states = at(mech, [120 * DEG, 0.0])
    path = eq.Cable(through)
    assert (path.taut(states).wrap[:, 2] <= 0).any()
    with pytest.raises(eq.InputError, match="lifts off a pulley beside another"):
        path.install(mech.spec.copy(), "s", states)


def test_a_heavy_spring_lies_along_one_body():
    mech, states = arm(), at(arm(), [0.3, 0.4])
    ends = eq.Point("world", (-0.4, 0, 0.3)), eq.Point("upper", (0.4, 0, 0)), eq.Point("fore", (0.2, 0, 0))
    spring = eq.Spring("s", eq.Cable(ends, offset=-0.2), eq.Linear(), mass=0.5)
    spring.check(mech)
    with pytest.raises(eq.InputError, match="first run leads from world to upper"):
        spring.effort(states, "hold")
