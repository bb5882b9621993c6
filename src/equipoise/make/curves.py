"""What a cam has to do: a force over a travel, or a torque over an angle, with its derivatives and its energy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from equipoise.affine import Array
from equipoise.assemble import effort
from equipoise.balancers.laws import Law
from equipoise.errors import InputError
from equipoise.limits.curve import Pieces
from equipoise.mechanism import Mechanism
from equipoise.payload import Payload
from equipoise.posefile import held
from equipoise.sweep import Sweep
from equipoise.units import Joint

COUNT = 4001


@dataclass(frozen=True, eq=False)
class ForceCurve:
    """f over a travel c (N,): force, df/dc, d2f/dc2 and the energy from the first sample on; unit m or rad of c.

    Along a cable f is a tension in N, along an angle a torque in N m.
    """

    c: Array
    force: Array
    slope: Array
    bend: Array
    energy: Array
    unit: str = "m"

    def __post_init__(self) -> None:
        if self.force.min() <= 0:
            worst = int(self.force.argmin())
            raise InputError(
                f"the force is {self.force[worst]:.4g} at {self.c[worst]:.4g} {self.unit}: a cord can only pull",
                where="make",
                hint="ask for a least force above 0, or narrow the range",
            )


def law_curve(law: Law, values: Mapping[str, float], over: tuple[float, float], count: int = COUNT) -> ForceCurve:
    """The curve of a law at values {parameter: value} of its unknowns over (low, high), at equally spaced lengths."""
    theta = np.array([values[name.name.removeprefix("-.")] for name in law.unknowns("-")])
    pieces = Pieces.of(law, over)
    c = np.linspace(*over, count)
    parts = [pieces.derived((order,), (1.0,)).at(c) for order in (0, 1, 2)]
    force, slope, bend = (basis @ theta + known for basis, known in parts)
    basis, known = law.energy_basis(c)
    energy = basis @ theta + known
    return ForceCurve(c, force, slope, bend, energy - energy[0])


def arm_curve(
    mechanism: Mechanism,
    joint: str,
    over: tuple[Joint, Joint],
    *,
    payload: tuple[Payload, ...] = (),
    count: int = COUNT,
) -> ForceCurve:
    """The torque that holds one joint over a range, the other joints held: what a cam on it must give.

    The curve runs so that the cam's spring lets go of energy while the arm is lifted: c rises from the end where
    gravity's potential is largest. Raises InputError where the torque changes sign within the range.
    """
    index = mechanism.driven.index(joint) if joint in mechanism.driven else -1
    if index < 0:
        mechanism.joint_id(joint)
        raise InputError(f"joint {joint!r} is not driven", where="make")
    low, high = over
    if not low < high:
        raise InputError(f"the range [{low:g}, {high:g}] is empty", where="make", hint="lower end first")
    q = np.linspace(low, high, count)
    poses = np.tile(held(mechanism), (count, 1))
    poses[:, index] = q
    states = mechanism.states(_sweep(mechanism, poses, payload))
    torque = effort(mechanism, (), states).b[:, index]
    if torque.min() * torque.max() <= 0:
        zero = float(q[np.abs(torque).argmin()])
        raise InputError(
            f"the holding effort of {joint} vanishes at {zero:.4g}: a cord's arm would have to change sides",
            where="make",
            hint="narrow the range so that gravity pulls one way",
        )
    sign = np.sign(torque[0])
    from scipy.interpolate import make_interp_spline

    spline = make_interp_spline(q, np.abs(torque), k=5)
    # Where the torque is positive energy grows with q, and the spring's shrinks: run from the far end.
    travel = high - q[::-1] if sign > 0 else q - low
    order = slice(None, None, -1) if sign > 0 else slice(None)
    flip = -1.0 if sign > 0 else 1.0
    force, slope, bend = (part[order] for part in (np.abs(torque), flip * spline(q, 1), spline(q, 2)))
    whole = spline.antiderivative()
    energy = (whole(q[-1]) - whole(q))[order] if sign > 0 else whole(q) - whole(q[0])
    return ForceCurve(travel, force, slope, bend, energy, "rad")


def _sweep(mechanism: Mechanism, poses: Array, payload: tuple[Payload, ...]) -> Sweep:
    given = Sweep.of_poses(mechanism, [{}], payload=payload)
    if len(given.scenarios) > 1:
        raise InputError("a cam serves one payload", where="make", hint="give one mass per place")
    return given.at_poses(poses)
