"""A joint's own position."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import mujoco

from equipoise.affine import Array
from equipoise.balancers.paths.mount import Mount
from equipoise.balancers.paths.turn import Terms, Turn, joint_shaft
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.states import States
from equipoise.units import Extent, Number

SLIDE, HINGE = int(mujoco.mjtJoint.mjJNT_SLIDE), int(mujoco.mjtJoint.mjJNT_HINGE)


@dataclass(frozen=True)
class Angle(Turn):
    """The position of a joint, as a spring about it or a belt from it sees it.

        l = ratio q + offset

    joint is a hinge (q in rad) or, with unit `m`, a slide (q in m); driven or not. ratio has no unit, offset is in
    the joint's. Raises InputError for a joint that is neither, or of the other unit.
    """

    joint: str
    ratio: Number = 1.0
    offset: Extent = 0.0
    unit: Literal["rad", "m"] = "rad"

    def terms(self, model: mujoco.MjModel) -> Terms:  # noqa: ARG002
        """The joint with the ratio."""
        return {self.joint: self.ratio}, self.offset

    def shaft(self, model: mujoco.MjModel) -> Mount:
        """The joint's axis."""
        return joint_shaft(model, model.joint(self.joint).id)

    def check(self, mechanism: Mechanism, name: str) -> None:
        """Raise InputError for a joint that is not there, no hinge or slide, or of the other unit."""
        where = f"spring {name}"
        kind = int(mechanism.model.jnt_type[mechanism.joint_id(self.joint)])
        if kind not in (SLIDE, HINGE):
            raise InputError(f"joint {self.joint} is no hinge or slide, so it has no single position", where=where)
        unit = "m" if kind == SLIDE else "rad"
        if self.unit != unit:
            raise InputError(
                f"joint {self.joint} is a {'slide' if kind == SLIDE else 'hinge'}, whose position is in {unit}",
                where=where,
                hint=f"say `unit: {unit}`",
            )

    def install(self, spec: mujoco.MjSpec, name: str, states: States) -> mujoco.MjsTendon:
        """A tendon that reads the joint; with an offset, a shaft that turns with it."""
        if self.offset or self.unit == "m":
            return super().install(spec, name, states)
        tendon = spec.add_tendon(name=name)
        tendon.wrap_joint(self.joint, float(self.ratio))
        return tendon

    def positions(self, states: States, name: str) -> dict[str, Array]:
        """The shaft's position where there is one."""
        return super().positions(states, name) if self.offset or self.unit == "m" else {}
