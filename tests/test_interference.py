"""Interference: distances against brute force, capsules that hold their shapes, lines that keep clear."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

import equipoise as eq
from equipoise.discovery.ground import Ground
from equipoise.interference import closest, shell
from equipoise.interference.axes import passed, ways
from equipoise.interference.bulk import half_width, outside
from equipoise.interference.capsules import fit
from equipoise.interference.findings import clashes, room_words
from equipoise.interference.meshes import corners
from equipoise.limits import Setting
from equipoise.limits.avoid import rooms


def arm(span=180.0):
    reach = np.radians(span)
    links = [
        eq.Link("upper", length=0.5, mass=3.0, limits=(-reach, reach)),
        eq.Link("fore", length=0.4, mass=2.0, limits=(-reach, reach)),
    ]
    return eq.chain(links)


@pytest.mark.parametrize("seed", range(12))
def test_distance_of_segments_is_the_least_over_both(seed):
    rng = np.random.default_rng(seed)
    a, b, c, d = rng.normal(size=(4, 3))
    if seed % 3 == 1:
        d = c + (b - a) * rng.normal()
    if seed % 3 == 2:
        b = a
    best = min(
        minimize(lambda x: np.linalg.norm(a + x[0] * (b - a) - c - x[1] * (d - c)), start, bounds=((0, 1), (0, 1))).fun
        for start in ((0.1, 0.1), (0.9, 0.1), (0.1, 0.9), (0.9, 0.9))
    )
    assert closest(a, b, c, d) == pytest.approx(best, abs=1e-6)


def test_capsules_hold_every_point_and_are_lean():
    rng = np.random.default_rng(0)
    group = Ground(arm(), np.zeros(2), ()).groups["upper"]
    tube = np.stack([0.05 * np.cos(t := rng.uniform(0, 7, 400)), 0.05 * np.sin(t), rng.uniform(0, 0.6, 400)], axis=1)
    for points in (tube, rng.normal(size=(50, 3)), rng.normal(size=(30, 3)) * [1, 0.01, 0.01] + 2):
        capsule = fit("upper", points, group)
        gap = closest(points, points, np.array(capsule.start), np.array(capsule.end))
        assert gap.max() <= capsule.radius * (1 + 1e-6)
    lean = fit("upper", tube, group)
    assert lean.radius == pytest.approx(0.05, abs=0.005)


CORNERS = np.array([[0.0, 0, 0], [0.4, 0, 0], [0, 0.1, 0], [0.4, 0, 0.2]])


def written(kind, folder):
    """One facet pair as a mesh file."""
    path = folder / f"link.{kind.split('_')[0]}"
    facets = (CORNERS[[0, 1, 2]], CORNERS[[0, 1, 3]])
    if kind == "stl_binary":
        data = b"solid looks like text".ljust(80) + len(facets).to_bytes(4, "little")
        for facet in facets:
            data += np.zeros(3, "<f4").tobytes() + facet.astype("<f4").tobytes() + b"\0\0"
        path.write_bytes(data)
    elif kind == "stl_text":
        body = "".join(
            "facet normal 0 0 0\nouter loop\n"
            + "".join(f"vertex {x} {y} {z}\n" for x, y, z in facet)
            + "endloop\nendfacet\n"
            for facet in facets
        )
        path.write_text(f"solid s\n{body}endsolid s\n")
    else:
        path.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "f 1 2 3\nf 1 2 4\n")
    return path


@pytest.mark.parametrize("kind", ["stl_binary", "stl_text", "obj"])
def test_meshes_are_read_and_fitted(kind, tmp_path):
    path = written(kind, tmp_path)
    found = corners(path)
    assert sorted(map(tuple, found.round(6).tolist())) == sorted(map(tuple, CORNERS.tolist()))
    (tmp_path / "arm.urdf").write_text(
        '<robot name="arm"><link name="base"/><link name="bar"><inertial><mass value="1"/><origin xyz="0.2 0 0"/>'
        '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
        f'<collision><origin xyz="0.1 0 0"/><geometry><mesh filename="{path.name}" scale="0.5 0.5 0.5"/></geometry>'
        '</collision></link><joint name="pin" type="continuous"><parent link="base"/><child link="bar"/>'
        '<axis xyz="0 1 0"/></joint></robot>'
    )
    mechanism = eq.Mechanism.load(tmp_path / "arm.urdf")
    (capsule,) = (one for one in shell(mechanism).capsules if one.fitted)
    assert capsule.body == "bar"
    places = 0.5 * CORNERS + [0.1, 0, 0]
    assert closest(places, places, np.array(capsule.start), np.array(capsule.end)).max() <= capsule.radius * (1 + 1e-6)
    assert "fitted to collision shapes: bar" in shell(mechanism).words


@pytest.mark.parametrize("data", [b"", b"solid nothing", b"\xff" * 300, b"v 1 2\n"])
def test_a_file_that_is_no_mesh_is_refused(data, tmp_path):
    for name in ("a.stl", "a.obj"):
        (tmp_path / name).write_bytes(data)
        with pytest.raises(eq.ModelError, match="mesh"):
            corners(tmp_path / name)


def test_drawn_capsules_say_their_radius():
    found = shell(arm(), 0.035)
    assert {capsule.radius for capsule in found.capsules} == {0.035}
    assert "drawn joint to joint with radius 35 mm" in found.words


def test_a_line_through_a_link_has_no_room():
    """From the base to the forearm past a straight upper arm, and the same line moved aside."""
    mechanism = arm()
    states = mechanism.states(eq.Sweep(np.zeros((1, 2)), np.ones(1), "one pose"))
    through = eq.Line(eq.Point("world", (0.2, 0.0, 0.3)), eq.Point("fore", (-0.2, 0.0, -0.3)))
    room = dict(rooms(states, through, 0.03))
    assert room["upper"][0] == pytest.approx(-0.03, abs=1e-6)
    aside = eq.Line(eq.Point("world", (0.2, 0.1, 0.3)), eq.Point("fore", (-0.2, 0.1, -0.3)))
    assert dict(rooms(states, aside, 0.03))["upper"][0] == pytest.approx(0.07, abs=1e-6)


@pytest.mark.parametrize(("span", "over"), [(170.0, True), (60.0, False)])
def test_a_line_passes_an_axis_only_where_the_joint_turns_that_far(span, over):
    mechanism = arm(span)
    states = mechanism.states(eq.Sweep.sobol(mechanism, 256))
    found = passed(states, ("world", "upper"), np.array([[0.1, 0, 0]]), np.array([[0.3, 0, 0]]))
    assert list(found) == ["upper_joint"]
    assert bool(found["upper_joint"][0]) is over


def test_a_discovery_that_avoids_bodies_keeps_clear():
    mechanism = arm()
    request = eq.Discover(1, avoid="bodies", radius=0.02, candidates=600, contenders=1)
    front = eq.discover(mechanism, eq.Sweep.sobol(mechanism, 64), request)
    assert front.refused["a body in the way"] >= 0
    design = front.designs[0]
    assert any(isinstance(limit, eq.Avoid) for limit in design.limits)
    assert not [clash for clash in clashes(design, 0.02) if clash.depth > 1e-6]
    assert front.values[0] < 0.5 * front.before
    assert any("drawn joint to joint with radius 20 mm" in note for note in front.notes)


def test_a_cable_keeps_clear_and_so_do_axes():
    """The run from guide to hook counts as a line, the coil on its link besides; a line keeps off a joint's axis."""
    mechanism = arm(60.0)
    states = mechanism.states(eq.Sweep.sobol(mechanism, 32))
    cable = eq.Cable(
        (eq.Point("upper", (0.4, 0.1, 0.1)), eq.Pulley("upper", (0.1, 0.1, 0.1)), eq.Point("world", (0.0, 0.1, 0.6))),
        ratio=0.5,
    )
    line = eq.Line(eq.Point("upper", (0.1, 0.1, 0.1)), eq.Point("world", (0.0, 0.1, 0.6)))
    law = eq.Coil(free_length=0.1)
    for what in ("bodies", "axes", "both"):
        found = []
        for path in (cable, line):
            spring = eq.Spring("s", path, law)
            limit = eq.Avoid("s", radius=0.03, gap=0.02, what=what)
            rows = limit.rows(Setting({"s": spring}, states, lambda _: None))
            found.append([row for row in rows if not row.limit.endswith("(its coil)")])
            assert (len(rows) > len(found[-1])) == (path is cable and what != "axes")
        assert [row.limit for row in found[0]] == [row.limit for row in found[1]]
        for one, other in zip(*found, strict=True):
            np.testing.assert_allclose(one.h, other.h, atol=1e-12)
        assert any("axis of upper_joint" in row.limit for row in found[0]) == (what != "bodies")
        assert any("from fore" in row.limit for row in found[0]) == (what != "axes")
    # Square to the axis along y, the line from (0.1, 0.1) of the link at rest to (0, 0.6): its way past the hinge.
    rest = mechanism.states(eq.Sweep(np.zeros((1, 2)), np.ones(1), "one pose"))
    way = ways(rest, line)["upper_joint"][0]
    a, b = rest.point(line.a)[0][0, [0, 2]], rest.point(line.b)[0][0, [0, 2]]
    hinge = rest.point(eq.Point("upper", (0.0, 0.0, 0.0)))[0][0, [0, 2]]
    shares = np.linspace(0.0, 1.0, 100_001)[:, None]
    assert way == pytest.approx(np.linalg.norm(a + shares * (b - a) - hinge, axis=1).min(), abs=1e-9)
    with pytest.raises(eq.InputError, match="neither a straight line nor a cable"):
        eq.Avoid("s").rows(Setting({"s": eq.Spring("s", eq.Angle("upper_joint"), eq.Torsion())}, rest, lambda _: None))


@pytest.mark.parametrize("count", [1, 2, 3, 4, 7, 8, 12])
def test_a_bundle_holds_its_coils(count):
    """As wide as the best known packing of equal circles in a circle, or a little wider."""
    best = {1: 1.0, 2: 2.0, 3: 2.1547, 4: 2.4142, 7: 3.0, 8: 3.3047, 12: 4.0296}[count]
    law = eq.ExtensionSpring(0.003, 0.03, 40.0, number=float(count))
    assert outside(law) == pytest.approx(0.033)
    assert best * 0.0165 * (1 - 1e-4) <= half_width(law) <= 1.1 * best * 0.0165
    wound = eq.WindableSpring(0.003, 10.0, number=float(count))
    assert half_width(wound) == pytest.approx(half_width(law))
    assert half_width(eq.Coil(free_length=0.1)) == 0.0


def beside_the_arm(name, aside, number=3.0):
    """A coil in the base, `aside` from the arm's plane, behind a cable to the upper link."""
    path = eq.Cable(
        (
            eq.Point("world", (-0.4, aside, 0.0)),
            eq.Pulley("world", (0.1, aside, 0.0)),
            eq.Point("upper", (0.2, aside, 0.0)),
        ),
        offset=-0.2,
    )
    return eq.Spring(name, path, eq.ExtensionSpring(0.003, 0.03, 60.0, number=number))


def test_the_coil_behind_a_cable_keeps_its_width_from_links():
    """In the arm's plane the upper link sweeps through the coil; three coils beside it are kept half a bundle away."""
    mech = arm()
    states = mech.states(eq.Sweep.sobol(mech, 256))
    (capsule,) = (one.radius for one in shell(mech).capsules if one.body == "upper")
    bundle = 0.0165 * (1 + 2 / np.sqrt(3))
    for aside in (0.0, 0.06, 0.12):
        spring = beside_the_arm("s", aside)
        rows = eq.Avoid("s").rows(Setting({"s": spring}, states, lambda _: None))
        coil = [row.h for row in rows if row.limit == "clearance of s from upper (its coil)"]
        # The upper link turns about the origin, above which the coil's line passes.
        assert np.min(coil) == pytest.approx(max(aside, 1e-12) - capsule - bundle, abs=2e-3)
        sweep = eq.Sweep.sobol(mech, 256)
        design = eq.balance(mech, [spring], sweep, norm="rms")
        found = [clash for clash in clashes(design) if clash.what == "upper with its coil"]
        assert bool(found) == (aside < capsule + bundle)
        assert all(clash.depth == pytest.approx(-np.min(coil), abs=1e-6) for clash in found)


def test_springs_against_each_other_and_the_room_they_need():
    mech = arm()
    near, far, ideal = beside_the_arm("s1", 0.2), beside_the_arm("s2", 0.25, number=1.0), beside_the_arm("s3", 0.5)
    ideal = eq.Spring("s3", ideal.path, eq.ZeroFreeLength())
    design = eq.balance(mech, [near, far, ideal], eq.Sweep.sobol(mech, 64), norm="rms")
    found = {(clash.spring, clash.what): clash for clash in clashes(design)}
    both = 0.0165 * (2 + 2 / np.sqrt(3))
    assert found["s1", "s2"].depth == pytest.approx(both - 0.05)
    assert found["s1", "s2"].share == 1.0
    assert not {("s1", "s3"), ("s2", "s3"), ("s2", "s1")} & set(found)
    one, other = room_words(design)
    assert one.startswith("s1: 3 x 33 mm side by side, or a bundle 71.1 mm thick, by ")
    assert one.endswith("along world")
    assert other.startswith("s2: 33 mm across, by ")


def test_a_discovery_that_avoids_bodies_keeps_coils_clear_and_knows_the_nearest_poses():
    """A housing stands on that side of the arm where it is not in the way; at 4000 unseen poses nothing is met."""
    mech = arm(60.0)
    kind = eq.CableSprings(rooms={"world": 0.4}, ratio=0.5)
    make = eq.Makeable(grade="SH", parallel=2, width=0.04)
    request = eq.Discover(1, kinds=(kind,), candidates=900, contenders=2, poses=100, make=make, avoid="bodies")
    (design,) = eq.discover(mech, eq.Sweep.sobol(mech, 64), request, objective=eq.Aim(norm="peak")).designs
    (spring,) = design.balancers
    setting = Setting({"s1": spring}, mech.states(eq.Sweep.sobol(mech, 4096)), lambda _: None)
    rows = [row for limit in design.limits if isinstance(limit, eq.Avoid) for row in limit.rows(setting)]
    assert any(row.limit.endswith("(its coil)") for row in rows)
    assert min(row.h.min() for row in rows) > -2e-3
