"""What a problem file may ask to be made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from equipoise import units
from equipoise.make.cams import CamWithSpring, ConstantForceCam, DrumWithTorsion
from equipoise.make.synthesis import Part, arm_cam, make_spring
from equipoise.payload import Payload
from equipoise.units import Joint, Length, Number, Stiffness, TorsionRate

if TYPE_CHECKING:
    from equipoise.design import Design
    from equipoise.mechanism import Mechanism


@dataclass(frozen=True)
class MakeDrum:
    """A non-circular drum on a torsion spring for a spring of the design, see `DrumWithTorsion`; guide in m."""

    spring: str
    rate: TorsionRate
    preload: units.Energy
    guide: Length | None = None
    over: tuple[Length, Length] | None = None

    def part(self, mechanism: Mechanism, design: Design | None) -> Part:  # noqa: ARG002
        """The part."""
        return make_spring(design, self.spring, DrumWithTorsion(self.rate, self.preload), self.guide, self.over)


@dataclass(frozen=True)
class MakeCam:
    """A round drum with a coaxial cam and an extension spring, see `CamWithSpring`; guide in m."""

    spring: str
    radius: Length
    rate: Stiffness
    preload: units.Energy
    guide: Length | None = None
    over: tuple[Length, Length] | None = None

    def part(self, mechanism: Mechanism, design: Design | None) -> Part:  # noqa: ARG002
        """The part."""
        kind = CamWithSpring(self.radius, self.rate, self.preload)
        return make_spring(design, self.spring, kind, self.guide, self.over)


@dataclass(frozen=True)
class MakeConstantForceCam:
    """A round drum with a coaxial cam and a constant-force spring, see `ConstantForceCam`; guide in m."""

    spring: str
    radius: Length
    force: units.Force
    guide: Length | None = None
    over: tuple[Length, Length] | None = None

    def part(self, mechanism: Mechanism, design: Design | None) -> Part:  # noqa: ARG002
        """The part."""
        return make_spring(design, self.spring, ConstantForceCam(self.radius, self.force), self.guide, self.over)


@dataclass(frozen=True)
class MakeArmCam:
    """A cam that balances a joint of an arm exactly over a range, see `arm_cam`."""

    joint: str
    over: tuple[Joint, Joint]
    rate: Stiffness
    preload: units.Energy
    ratio: Number = 1.0
    guide: Length | None = None
    payload: tuple[Payload, ...] = ()

    def part(self, mechanism: Mechanism, design: Design | None) -> Part:  # noqa: ARG002
        """The part."""
        return arm_cam(
            mechanism,
            self.joint,
            self.over,
            rate=self.rate,
            preload=self.preload,
            ratio=self.ratio,
            guide=self.guide,
            payload=self.payload,
        )
