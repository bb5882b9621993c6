"""One call from a curve to a part: profile, feasibility, wrapped cord, files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from equipoise.errors import InputError, nearest
from equipoise.make.cams import CamWithSpring, ConstantForceCam, DrumWithTorsion
from equipoise.make.curves import ForceCurve, arm_curve, law_curve
from equipoise.make.export import write_csv, write_dxf
from equipoise.make.profile import WoundProfile, wind
from equipoise.make.wrap import Wrapped, simulate

Kind = DrumWithTorsion | CamWithSpring | ConstantForceCam


@dataclass(frozen=True, eq=False)
class Part:
    """A finished cam or drum: what it makes, its profile, and what its wrapped cord does (with a guide)."""

    name: str
    kind: Kind
    curve: ForceCurve
    profile: WoundProfile
    wrapped: Wrapped | None

    def facts(self) -> dict[str, Any]:
        """What the workshop and the report want to know, SI units."""
        profile, travel = self.profile, self.kind.travel(self.curve)
        pull = self.kind.pull(travel)
        radius = np.linalg.norm(profile.points, axis=1)
        return {
            "name": self.name,
            "kind": type(self.kind).__name__,
            "parameters": {key: float(value) for key, value in vars(self.kind).items()},
            "guide": profile.guide,
            "turns": profile.turns,
            "arm": [float(profile.winding.arm.min()), float(profile.winding.arm.max())],
            "radius": [float(radius.min()), float(radius.max())],
            "curvature": [float(profile.curvature.min()), float(profile.curvature.max())],
            "spring_travel": [float(travel.min()), float(travel.max())],
            "spring_force": [float(pull.min()), float(pull.max())],
            "energy": float(self.curve.energy[-1]),
            "crosses": profile.crosses,
            "helical": profile.helical,
            "wrap_error": None if self.wrapped is None else self.wrapped.error,
            "unit": "N" if self.curve.unit == "m" else "N m",
        }

    def write(self, folder: Path) -> tuple[Path, Path]:
        """`<name>.dxf` and `<name>.csv` in a folder."""
        drum = getattr(self.kind, "radius", None) if self.curve.unit == "m" else None
        return (
            write_dxf(folder / f"{self.name}.dxf", self.profile, drum),
            write_csv(folder / f"{self.name}.csv", self.curve, self.profile),
        )

    def __str__(self) -> str:
        f = self.facts()
        lines = [
            f"{self.name}: {f['kind']}, {f['turns']:.3g} turns, "
            f"arm {1e3 * f['arm'][0]:.4g} to {1e3 * f['arm'][1]:.4g} mm, "
            f"least radius of curvature {1e3 * f['curvature'][0]:.4g} mm",
        ]
        if f["wrap_error"] is not None:
            lines.append(f"  wrapped cord agrees to {f['wrap_error']:.2g} {f['unit']}")
        if f["helical"]:
            why = "more than one turn" if f["turns"] >= 1 else f"at {100 * f['crosses']:.0f} % of the poses"
            lines.append(f"  cut the groove as a helix: the free cord would meet another lobe ({why})")
        return "\n".join(lines)


def make_part(curve: ForceCurve, kind: Kind, guide: float | None = None, name: str = "part") -> Part:
    """Profile and, with a guide at distance D in m, the simulated cord; raises InputError naming what to change."""
    profile = wind(kind.winding(curve), guide)
    return Part(name, kind, curve, profile, simulate(kind, curve, profile) if guide is not None else None)


def make_spring(design: Any, spring: str, kind: Kind, guide: float | None = None, over: Any = None) -> Part:
    """The part that realises a spring of a design on its reel, over (low, high) or its law's own interval."""
    from equipoise.balancers.spring import Spring

    known = [balancer.name for balancer in design.balancers if isinstance(balancer, Spring)]
    if spring not in known:
        raise InputError(f"there is no spring {spring!r} to make", where="make", hint=nearest(spring, known))
    found = next(balancer for balancer in design.balancers if balancer.name == spring)
    if found.path.unit != "m":
        raise InputError(f"spring {spring} acts along an angle", where="make", hint="a cable winds along a length")
    interval = over or getattr(found.law, "interval", None)
    if interval is None:
        length, _ = found.path.deform(design.states)
        interval = (float(length.min()), float(length.max()))
    values = {u.name.removeprefix(f"{found.owner}."): design.values[u.name] for u in found.unknowns}
    return make_part(law_curve(found.law, values, interval), kind, guide, spring)


def arm_cam(
    mechanism: Any,
    joint: str,
    over: tuple[float, float],
    *,
    rate: float,
    preload: float,
    ratio: float = 1.0,
    guide: float | None = None,
    payload: Any = (),
) -> Part:
    """A cam on a joint, or geared to it, whose extension spring balances the arm exactly over a range.

        k x^2 / 2 + V(q) = const,   h = dx/dphi = |dV/dq| / (k x ratio)

    over (low, high) of the joint in rad, the others held; rate k in N/m; preload in J, what the spring still stores
    where the arm is highest; ratio turns of the cam per turn of the joint; guide in m; payload carried. Raises
    InputError where gravity's torque changes sign or the profile cannot be cut.
    """
    curve = arm_curve(mechanism, joint, over, payload=tuple(payload))
    if not ratio > 0:
        raise InputError(f"the ratio is {ratio:g}, it must be above 0", where="make")
    return make_part(curve, CamWithSpring(1.0 / ratio, rate, preload), guide, f"{joint}_cam")
