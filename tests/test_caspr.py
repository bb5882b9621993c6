"""CASPR's files: written here after its format, read into the same platform as the builder's."""

from __future__ import annotations

import numpy as np
import pytest

import equipoise as eq
from equipoise.errors import InputError, ModelError

BODIES = """<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE bodies_system SYSTEM "../templates/bodies.dtd">
<bodies_system><links display_range="0 1 0 1 0 1">
  <link_rigid num="1" name="small plate">
    <joint type="{joint}"/>
    <physical><mass>2.5</mass><com_location>0.01 0.02 0.0</com_location><end_location>0 0 0</end_location>
      <inertia ref="com"><Ixx>0.1</Ixx><Iyy>0.1</Iyy><Izz>0.1</Izz><Ixy>0</Ixy><Ixz>0</Ixz><Iyz>0</Iyz></inertia>
    </physical>
    <parent><num>0</num><location>0 0 0</location></parent>
  </link_rigid>
</links></bodies_system>
"""
ANCHORS = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
ENDS = [(-0.1, -0.05), (0.1, -0.05), (0.1, 0.05), (-0.1, 0.05)]


def cable_file(anchors, ends, reference="joint", plane=lambda x, y: (x, y, 0.0)):
    def point(link, place):
        return f"<attachment><link>{link}</link><location>{' '.join(map(str, plane(*place)))}</location></attachment>"

    made = "".join(
        f'<cable_ideal name="cable {i}" attachment_reference="{reference}"><properties><force_min>1</force_min>'
        f"<force_max>90</force_max></properties><attachments>{point(0, a)}{point(1, b)}</attachments></cable_ideal>"
        for i, (a, b) in enumerate(zip(anchors, ends, strict=True), 1)
    )
    head = '<?xml version="1.0"?>\n<!DOCTYPE cables [\n  <!ATTLIST cable_set id ID #REQUIRED>\n]>\n'
    return f'{head}<cables default_cable_set="basic"><cable_set id="basic">{made}</cable_set></cables>'


@pytest.fixture
def files(tmp_path):
    def write(bodies, cables):
        (tmp_path / "b.xml").write_text(bodies)
        (tmp_path / "c.xml").write_text(cables)
        return tmp_path / "b.xml", tmp_path / "c.xml"

    return write


def test_a_planar_platform_in_the_horizontal_plane(files):
    made = eq.caspr(*files(BODIES.format(joint="PLANAR_XY"), cable_file(ANCHORS, ENDS)))
    assert made.driven == ("x", "z", "turn")
    assert made.name == "small_plate"
    assert made.platform.cables == ("cable_1", "cable_2", "cable_3", "cable_4")
    assert not made.gravity.any()
    assert made.mass == 2.5
    assert made.platform.t_min == (1.0,) * 4
    assert made.platform.t_max == (90.0,) * 4
    same = eq.cable_platform(tuple(ANCHORS), tuple(ENDS), mass=2.5, com=(0.01, 0.02), gravity=(0, 0, 0))
    for cable in made.platform.cables:
        np.testing.assert_allclose(
            [end.at for end in made.cable(cable)], [end.at for end in same.cable(cable)], atol=1e-15
        )


def test_a_vertical_plane_and_ends_from_the_centre_of_mass(files):
    text = BODIES.format(joint="PLANAR_XZ").replace("0.01 0.02 0.0", "0.01 0.0 0.02")
    made = eq.caspr(*files(text, cable_file(ANCHORS, ENDS, "com", lambda x, y: (x, 0.0, y))))
    assert made.gravity[2] == pytest.approx(-9.81)
    assert made.cable("cable_1")[1].at == pytest.approx((-0.09, 0.0, -0.03))


def test_a_spatial_platform(files):
    box = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    ends = [tuple(0.2 * (np.array(p) - 0.5)) for p in box]
    made = eq.caspr(*files(BODIES.format(joint="SPATIAL_EULER_XYZ"), cable_file(box, ends, plane=lambda *p: p)))
    assert made.driven == ("x", "y", "z", "yaw", "pitch", "roll")
    assert len(made.platform.rows) == 6


BAD = {
    "malformed": (lambda b, c: (b.replace("</links>", ""), c), "not well-formed"),
    "entity": (lambda b, c: (b.replace("SYSTEM", '[<!ENTITY a "b">]\n<!DOCTYPE x SYSTEM'), c), "declares DOCTYPE"),
    "joint": (lambda b, c: (b.replace("PLANAR_XY", "R_Z"), c), "no platform"),
    "number": (lambda b, c: (b.replace("2.5", "heavy"), c), "mass is 'heavy'"),
    "no mass": (lambda b, c: (b.replace("<mass>2.5</mass>", ""), c), "no physical/mass"),
    "swapped": (lambda b, c: (c, b), "0 links"),
    "set": (lambda b, c: (b, c.replace('default_cable_set="basic"', 'default_cable_set="best"')), "no cable set"),
    "links": (lambda b, c: (b, c.replace("<link>1</link>", "<link>2</link>", 1)), "runs over links"),
    "place": (lambda b, c: (b, c.replace("0.0 0.0 0.0", "0.0 0.0", 1)), "needs 3 numbers"),
}


@pytest.mark.parametrize("fault", BAD)
def test_faults_are_named(files, fault):
    change, words = BAD[fault]
    pair = files(*change(BODIES.format(joint="PLANAR_XY"), cable_file(ANCHORS, ENDS)))
    with pytest.raises(ModelError, match=words) as caught:
        eq.caspr(*pair)
    assert ".xml" in caught.value.where


def test_too_few_cables(files):
    with pytest.raises(InputError, match="cannot hold"):
        eq.caspr(*files(BODIES.format(joint="PLANAR_XY"), cable_file(ANCHORS[:2], ENDS[:2])))


def test_from_a_problem_file(files, tmp_path):
    files(BODIES.format(joint="PLANAR_XY"), cable_file(ANCHORS, ENDS))
    problem = tmp_path / "p.yaml"
    problem.write_text(
        "mechanism: {caspr: {bodies: b.xml, cables: c.xml, limits: {x: [0.2, 0.8]}}}\nsweep: {sobol: 8}\n"
    )
    assert eq.load_problem(problem).mechanism.box[0] == pytest.approx([0.2, 0.8])
