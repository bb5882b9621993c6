"""How to look at a mechanism: along the hinge that bends it, and from a corner."""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.design import Design
from equipoise.states import States

AZIMUTH = math.radians(38.0)
ELEVATION = math.radians(24.0)


@dataclass(frozen=True, eq=False)
class View:
    """Unit vectors (3,) to the right and up on the paper, and towards the reader."""

    right: Array
    up: Array
    toward: Array

    def flat(self, points: Array) -> Array:
        """Paper coordinates (..., 2), m."""
        return np.stack([points @ self.right, points @ self.up], axis=-1)

    def corner(self) -> View:
        """The same scene seen from the side and from above."""
        turned = math.cos(AZIMUTH) * self.right - math.sin(AZIMUTH) * self.toward
        toward = math.cos(AZIMUTH) * self.toward + math.sin(AZIMUTH) * self.right
        up = math.cos(ELEVATION) * self.up - math.sin(ELEVATION) * toward
        return View(turned, up, math.cos(ELEVATION) * toward + math.sin(ELEVATION) * self.up)


def side(design: Design, states: States, row: int, joint: int) -> View:
    """The view along a driven hinge's axis (across a slide's), gravity downwards, +x or +y to the right."""
    model = design.mechanism.model
    number = int(design.mechanism.driven_ids[joint])
    axis = states.kin.xmat[row, model.jnt_bodyid[number]] @ model.jnt_axis[number]
    up = up_of(design)
    if model.jnt_type[number] == mujoco.mjtJoint.mjJNT_SLIDE:
        axis = np.cross(axis, up)
    level = axis - (axis @ up) * up
    if np.linalg.norm(level) < 1e-3:
        # A vertical axis bends the arm in a level plane: any upright view shows it, the one along y is usual.
        level = np.array([0.0, -1.0, 0.0]) - up * -up[1]
    if np.linalg.norm(level) < 1e-3:
        level = np.array([1.0, 0.0, 0.0])
    toward = np.asarray(level / np.linalg.norm(level), dtype=float)
    right = np.asarray(np.cross(up, toward), dtype=float)
    if right[np.abs(right).argmax()] < 0:
        right, toward = -right, -toward
    return View(right, up, toward)


def up_of(design: Design) -> Array:
    """The direction against gravity; +z where there is none."""
    gravity = design.mechanism.gravity
    size = np.linalg.norm(gravity)
    return -gravity / size if size > 1e-9 else np.array([0.0, 0.0, 1.0])


def is_planar(states: States, view: View) -> bool:
    """Whether everything stays in the plane of the view."""
    depth = states.kin.xpos @ view.toward
    return bool(np.ptp(depth) < 1e-6 * max(1e-3, float(np.ptp(states.kin.xpos))))
