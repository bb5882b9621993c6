"""Profiles as files: DXF for the workshop, CSV for everything else."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from equipoise.errors import InputError
from equipoise.make.curves import ForceCurve
from equipoise.make.profile import WoundProfile

MM = 1e3
VERTICES = 2001


def write_dxf(path: Path, profile: WoundProfile, drum: float | None = None) -> Path:
    """The profile as a polyline in mm about the shaft's centre, with the centre's cross and the round drum's circle.

    Layers: profile, centre, drum; drawn at angle 0. Raises InputError where the file cannot be written.
    """
    from ezdxf import units
    from ezdxf.filemanagement import new

    drawing = new("R2010", setup=False)
    drawing.units = units.MM
    for layer, colour in (("profile", 7), ("centre", 1), ("drum", 5)):
        drawing.layers.add(layer, color=colour)
    space = drawing.modelspace()
    rows = np.linspace(0, len(profile.points) - 1, min(VERTICES, len(profile.points))).astype(int)
    space.add_lwpolyline((MM * profile.points[rows]).tolist(), dxfattribs={"layer": "profile"})
    arm = 0.1 * MM * float(np.linalg.norm(profile.points, axis=1).min())
    for x, y in ((arm, 0.0), (0.0, arm)):
        space.add_line((-x, -y), (x, y), dxfattribs={"layer": "centre"})
    if drum is not None:
        space.add_circle((0.0, 0.0), MM * drum, dxfattribs={"layer": "drum"})
    try:
        drawing.saveas(path)
    except OSError as error:
        raise InputError(f"cannot write the drawing: {error.strerror or error}", where=str(path)) from None
    return path


def write_csv(path: Path, curve: ForceCurve, profile: WoundProfile) -> Path:
    """A row per sample: travel, force, angle, arm, contact point, radius of curvature, free cord."""
    head = [f"travel [{curve.unit}]", f"force [{'N' if curve.unit == 'm' else 'N m'}]", "angle [rad]", "arm [m]"]
    head += ["x [m]", "y [m]", "radius of curvature [m]", "free cord [m]"]
    table = np.column_stack(
        [
            curve.c,
            curve.force,
            profile.winding.angle,
            profile.winding.arm,
            profile.points,
            profile.curvature,
            profile.free,
        ]
    )
    try:
        with path.open("w", newline="", encoding="utf-8") as stream:
            csv.writer(stream).writerow(head)
            np.savetxt(stream, table, fmt="%.12g", delimiter=",")
    except OSError as error:
        raise InputError(f"cannot write the table: {error.strerror or error}", where=str(path)) from None
    return path
