"""URDF files: checked and cleaned as text, then read by MuJoCo without meshes."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator

import mujoco
import numpy as np

from equipoise.models.inertia import LEAST_INERTIA, TOKEN_MASS, Repairs, valid_inertia
from equipoise.models.notices import refusals, some
from equipoise.models.urdf_tree import Inertial, Joint, Link, Tree, read_tree


def read_urdf(root: ET.Element, where: str) -> tuple[mujoco.MjSpec, list[str]]:
    """The MuJoCo spec of a URDF `robot` element, and remarks on what was repaired or left out.

    Bodies keep the link frames (m, world axes at the zero posture), fixed links stay bodies, masses and
    centres of mass are the file's own. Raises ModelError naming the link or joint at fault.
    """
    tree = read_tree(root, where)
    remarks = list(_settle(tree))
    repairs = Repairs()
    masses = _masses(tree, repairs)
    text = ET.tostring(_clean(tree, masses), encoding="unicode")
    with refusals(where):
        spec = mujoco.MjSpec.from_string(text)
    for joint in tree.joints:
        if joint.type == "fixed" and joint.held:
            _turn(spec, joint)
    return spec, [*remarks, *repairs.remarks()]


def _settle(tree: Tree) -> Iterator[str]:
    """Turn joints that cannot move into fixed ones, and say which."""
    by_name = {joint.name: joint for joint in tree.joints}
    equal, held = [], []
    for joint in tree.joints:
        loose = joint.type == "floating" and joint.parent != "world"
        if joint.type == "planar" or loose:
            held.append(joint.name)
            joint.type = "fixed"
        elif joint.type in ("revolute", "prismatic") and joint.range and joint.range[0] == joint.range[1]:
            equal.append(joint.name)
            joint.type, joint.held = "fixed", joint.range[0]
    followers = [joint for joint in tree.joints if joint.mimic]
    ignored = [joint.name for joint in followers if joint.type in ("fixed", "floating")]
    stopped = []
    # A chain of followers stops from its source onwards, at most one joint per pass.
    for _ in followers:
        for joint in followers:
            source = by_name[joint.mimic] if joint.mimic else None
            if source is not None and joint.type != "fixed" and source.type in ("fixed", "floating"):
                stopped.append(joint.name)
                joint.was_slide = joint.type == "prismatic"
                joint.type, joint.held = "fixed", joint.multiplier * source.held + joint.offset
    unlimited = [j.name for j in tree.joints if j.type in ("revolute", "prismatic") and j.range is None]
    if equal:
        yield f"fixed, because the limits are equal: {some(equal)}"
    if held:
        yield f"planar or floating, held at the reference posture: {some(held)}"
    if stopped:
        yield f"fixed, because the joint it follows is: {some(stopped)}"
    if ignored:
        yield f"mimic ignored, because the joint itself does not turn or slide: {some(ignored)}"
    if unlimited:
        yield f"without limits, because the file gives none: {some(unlimited)}"


def _masses(tree: Tree, repairs: Repairs) -> dict[str, Inertial]:
    """The inertial of every link that needs one, valid for MuJoCo."""
    result = {}
    for link in tree.links.values():
        if link.inertial is None or (link.inertial.mass == 0.0 and not np.any(link.inertial.matrix)):
            continue
        result[link.name] = link.inertial.replaced(valid_inertia(link.inertial.matrix, link.name, repairs))
    carrier = tree.rigid()
    heavy = {carrier[name] for name, inertial in result.items() if inertial.mass >= TOKEN_MASS}
    for joint in tree.joints:
        if joint.type != "fixed" and joint.child not in heavy:
            repairs.massless.append(joint.child)
            result[joint.child] = Inertial(TOKEN_MASS, LEAST_INERTIA * np.eye(3))
    return result


def _clean(tree: Tree, masses: dict[str, Inertial]) -> ET.Element:
    """The URDF that MuJoCo reads: links, joints and inertias, nothing that refers to another file."""
    root = ET.Element("robot", name=tree.name)
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", fusestatic="false", strippath="true")
    for link in tree.links.values():
        _write_link(ET.SubElement(root, "link", name=link.name), link, masses)
    for joint in tree.joints:
        _write_joint(ET.SubElement(root, "joint", name=joint.name, type=joint.type), joint)
    return root


def _write_link(element: ET.Element, link: Link, masses: dict[str, Inertial]) -> None:
    body = masses.get(link.name)
    if body is None:
        return
    inertial = ET.SubElement(element, "inertial")
    ET.SubElement(inertial, "origin", xyz=_text(body.xyz), rpy=_text(body.rpy))
    ET.SubElement(inertial, "mass", value=repr(body.mass))
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.matrix.tolist()
    named = {"ixx": xx, "ixy": xy, "ixz": xz, "iyy": yy, "iyz": yz, "izz": zz}
    ET.SubElement(inertial, "inertia", {key: repr(value) for key, value in named.items()})


def _write_joint(element: ET.Element, joint: Joint) -> None:
    ET.SubElement(element, "origin", xyz=_text(joint.xyz), rpy=_text(joint.rpy))
    ET.SubElement(element, "parent", link=joint.parent)
    ET.SubElement(element, "child", link=joint.child)
    if joint.type in ("fixed", "floating"):
        return
    ET.SubElement(element, "axis", xyz=_text(joint.axis))
    if joint.range or joint.effort:
        low, high = joint.range or (0.0, 0.0)
        ET.SubElement(element, "limit", lower=repr(low), upper=repr(high), effort=repr(joint.effort))
    if joint.range is None:
        element.set("type", "continuous" if joint.type != "prismatic" else "prismatic")
    if joint.damping or joint.friction:
        ET.SubElement(element, "dynamics", damping=repr(joint.damping), friction=repr(joint.friction))
    if joint.mimic:
        law = {"joint": joint.mimic, "multiplier": repr(joint.multiplier), "offset": repr(joint.offset)}
        ET.SubElement(element, "mimic", law)


def _turn(spec: mujoco.MjSpec, joint: Joint) -> None:
    """Move the child of a joint that is stuck away from zero to where it is stuck."""
    body = spec.body(joint.child)
    if body is None:
        return
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, body.quat)
    if joint.was_slide:
        body.pos = body.pos + rotation.reshape(3, 3) @ np.array(joint.axis) * joint.held
        return
    turn, quat = np.empty(4), np.empty(4)
    mujoco.mju_axisAngle2Quat(turn, np.array(joint.axis), math.remainder(joint.held, 2 * math.pi))
    mujoco.mju_mulQuat(quat, body.quat, turn)
    body.quat = quat


def _text(values: tuple[float, ...]) -> str:
    return " ".join(map(repr, values))
