"""Balance exactly at given poses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from equipoise.errors import InputError
from equipoise.limits.limit import Setting
from equipoise.ranges import pose_vector
from equipoise.solve.program import Rows
from equipoise.units import Joint


@dataclass(frozen=True)
class ExactAt:
    """The holding effort vanishes at the given poses {joint: value}, on the given joints (default: all that load)."""

    poses: tuple[Mapping[str, Joint], ...]
    joints: tuple[str, ...] | None = None

    def rows(self, setting: Setting) -> tuple[Rows, ...]:
        """A theta = -b, one equality row per pose, payload and joint."""
        mechanism = setting.states.mechanism
        if not self.poses:
            raise InputError("exact_at names no pose", where="limits")
        effort = setting.hold_at(np.array([pose_vector(mechanism, pose) for pose in self.poses]))
        joints = self.joints or mechanism.driven
        found = []
        for joint in joints:
            column = effort.rows(joint).start
            b, A = effort.b[..., column], effort.A[..., column, :]
            load = max(float(np.abs(np.real(b)).max()), 1e-12)
            if self.joints is None and not A.any() and load <= 1e-9:
                continue
            for pose in range(len(self.poses)):
                # Scenarios are stacked pose by pose, so one pose's rows are every len(poses)-th.
                pick = slice(pose, None, len(self.poses))
                found.append(
                    Rows(
                        f"exact balance of {joint} at {_words(self.poses[pose])}",
                        effort.blocks[column].unit,
                        A[..., pick, :],
                        -b[..., pick],
                        effort.unknowns,
                        equality=True,
                        scale=load,
                    )
                )
        return tuple(found)


def _words(pose: Mapping[str, float]) -> str:
    return ", ".join(f"{joint} = {value:.4g}" for joint, value in pose.items())
