"""Efforts of a finished design at chosen poses: what the pictures and the CSV show."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.design import Design
from equipoise.errors import EquipoiseError
from equipoise.posefile import held
from equipoise.reporting.numbers import shown, sort_out
from equipoise.reporting.phrases import main_joint
from equipoise.states import States

FINE = 241


@dataclass(frozen=True, eq=False)
class Sample:
    """A design with its holding effort before and after over its own sweep (S N, nd), computed once."""

    design: Design

    @cached_property
    def before(self) -> Array:
        """Effort of the bare mechanism."""
        return self.design.states.holding

    @cached_property
    def after(self) -> Array:
        """Effort with the added parts."""
        return self.design.residual(self.design.states)

    @property
    def main(self) -> int:
        """Number of the joint that gains most; where no joint counts, of the one that the parts load most."""
        name, driven = main_joint(self.design), self.design.mechanism.driven
        return driven.index(name) if name in driven else int(np.abs(self.after - self.before).max(axis=0).argmax())

    @property
    def scenarios(self) -> int:
        """How many payloads every pose is seen with."""
        return len(self.design.sweep.scenarios)

    @cached_property
    def counted(self) -> list[int]:
        """Numbers of the joints that count in the objective; all where it speaks of none."""
        names = {joint for aim in self.design.objective for joint in aim.counted(self.design.mechanism)}
        driven = self.design.mechanism.driven
        return [index for index, joint in enumerate(driven) if joint in names] or list(range(len(driven)))

    @cached_property
    def matter(self) -> list[int]:
        """Numbers of the joints that carry a load worth a picture, the most loaded first."""
        design = self.design
        names = sort_out(design.before, design.after)[0]
        driven = design.mechanism.driven
        order = sorted(names, key=lambda name: -max(design.before[name].peak, design.after[name].peak))
        return [driven.index(name) for name in order if name in driven]

    @cached_property
    def box(self) -> Array:
        """Range of every driven joint over the sweep (nd, 2)."""
        sweep = self.design.sweep
        if sweep.box is not None:
            return sweep.box
        return np.stack([sweep.poses.min(axis=0), sweep.poses.max(axis=0)], axis=1)

    def is_slide(self, joint: int) -> bool:
        """Whether a driven joint is a slide."""
        mechanism = self.design.mechanism
        return bool(mechanism.model.jnt_type[mechanism.driven_ids[joint]] == mujoco.mjtJoint.mjJNT_SLIDE)

    def position(self, joint: int, value: Array | float) -> Array:
        """A joint position in mm or degrees."""
        return np.asarray(value) * shown(1.0, "m" if self.is_slide(joint) else "rad")[0]

    def axis_label(self, joint: int) -> str:
        """`elbow_joint [deg]`."""
        return f"{self.design.mechanism.driven[joint]} [{'mm' if self.is_slide(joint) else 'deg'}]"

    def worst(self, effort: Array, joint: int) -> tuple[int, int]:
        """Pose and scenario numbers of the largest |effort| of a joint."""
        row = int(np.abs(effort[:, joint]).argmax())
        count = len(self.design.sweep.poses)
        return row % count, row // count

    def calm(self, pose: Array) -> Array:
        """The pose with every joint that no load reaches brought to its reference, which leaves the drawing clear."""
        driven = self.design.mechanism.driven
        idle = [driven.index(n) for n in sort_out(self.design.before, self.design.after)[2] if n in driven]
        calmed = pose.copy()
        calmed[idle] = held(self.design.mechanism)[idle]
        return calmed

    def at(self, poses: Array) -> tuple[States, Array, Array] | None:
        """States and efforts (S, M, nd) before and after at poses (M, nd); None where the loops do not close."""
        design = self.design
        try:
            states = design.mechanism.states(design.sweep.at_poses(poses))
        except EquipoiseError:
            return None
        shape = (self.scenarios, len(poses), -1)
        return states, states.holding.reshape(shape), design.residual(states).reshape(shape)

    def line(self, joint: int, pose: Array, count: int = FINE) -> Array:
        """Poses (count, nd) along one joint's range, the others as in `pose`."""
        poses = np.tile(pose, (count, 1))
        poses[:, joint] = self.ticks(joint, count)
        return poses

    def ticks(self, joint: int, count: int) -> Array:
        """`count` positions (count,) over a joint's range, rad or m."""
        return np.linspace(float(self.box[joint, 0]), float(self.box[joint, 1]), count)

    def moves(self, joint: int) -> bool:
        """Whether the sweep moves a joint."""
        return bool(self.box[joint, 1] - self.box[joint, 0] > 1e-9)
