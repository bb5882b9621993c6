"""Collision shapes of a robot file as corner points per link."""

from __future__ import annotations

import itertools
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.interference.meshes import READABLE, corners
from equipoise.mechanism import Mechanism
from equipoise.models.packages import resolve

ROUND = 12
"""Points on a rim."""


def shapes(mechanism: Mechanism) -> Iterator[tuple[str, Array]]:
    """(body, points (V, 3) in its frame, m) of every collision shape that can be read; what cannot is left out."""
    source = mechanism.source
    if source is not None and source.suffix.lower() == ".urdf":
        yield from _urdf(mechanism, source)
    else:
        yield from _geoms(mechanism)


def _urdf(mechanism: Mechanism, source: Path) -> Iterator[tuple[str, Array]]:
    known = set(mechanism.bodies)
    try:
        root = ET.parse(source).getroot()
    except (OSError, ET.ParseError):
        return
    for link in root.iter("link"):
        for collision in link.findall("collision"):
            geometry = collision.find("geometry")
            if geometry is None or link.get("name") not in known:
                continue
            try:
                points = _points(geometry, source)
            except (InputError, ValueError):
                continue
            if points is not None:
                yield str(link.get("name")), _placed(points, collision.find("origin"))


def _points(geometry: ET.Element, source: Path) -> Array | None:
    for shape in geometry:
        if shape.tag == "mesh":
            address = shape.get("filename", "")
            path = _file(address, source)
            if path.suffix.lower() not in READABLE:
                return None
            return corners(path) * np.array([float(v) for v in shape.get("scale", "1 1 1").split()])
        if shape.tag == "box":
            return _box(np.array([float(v) for v in shape.get("size", "0 0 0").split()]) / 2)
        if shape.tag == "sphere":
            return _box(np.full(3, float(shape.get("radius", 0)) / np.sqrt(3.0)))
        if shape.tag in ("cylinder", "capsule"):
            return _tube(float(shape.get("radius", 0)), float(shape.get("length", 0)) / 2)
    return None


def _file(address: str, source: Path) -> Path:
    if address.startswith("package:"):
        return resolve(address, (source.parent, source.parent.parent, source.parent.parent.parent))
    return source.parent / address.removeprefix("file://")


def _placed(points: Array, origin: ET.Element | None) -> Array:
    if origin is None:
        return points
    xyz, rpy = (np.array([float(v) for v in origin.get(key, "0 0 0").split()]) for key in ("xyz", "rpy"))
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    turn = np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
    return points @ turn.T + xyz


def _geoms(mechanism: Mechanism) -> Iterator[tuple[str, Array]]:
    """Geoms of a MuJoCo model that collide."""
    model = mechanism.model
    for geom in range(model.ngeom):
        if not (model.geom_contype[geom] or model.geom_conaffinity[geom]):
            continue
        kind, size = int(model.geom_type[geom]), model.geom_size[geom]
        if kind == mujoco.mjtGeom.mjGEOM_MESH:
            mesh = int(model.geom_dataid[geom])
            first = int(model.mesh_vertadr[mesh])
            points = np.array(model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])], dtype=float)
        elif kind in (mujoco.mjtGeom.mjGEOM_CAPSULE, mujoco.mjtGeom.mjGEOM_CYLINDER):
            points = _tube(float(size[0]), float(size[1]))
        elif kind == mujoco.mjtGeom.mjGEOM_BOX:
            points = _box(size)
        elif kind == mujoco.mjtGeom.mjGEOM_SPHERE:
            points = _box(np.full(3, float(size[0]) / np.sqrt(3.0)))
        else:
            continue
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, model.geom_quat[geom])
        yield (
            model.body(int(model.geom_bodyid[geom])).name,
            points @ turn.reshape(3, 3).T + model.geom_pos[geom],
        )


def _box(half: Array) -> Array:
    return np.array(list(itertools.product((-1.0, 1.0), repeat=3))) * half


def _tube(radius: float, half: float) -> Array:
    angle = np.linspace(0.0, 2 * np.pi, ROUND, endpoint=False)
    rim = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(ROUND)], axis=1)
    up = np.array([0.0, 0.0, half])
    return np.vstack([rim + up, rim - up])
