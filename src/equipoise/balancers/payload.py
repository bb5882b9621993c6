"""How the balancers of an arm must be set for a payload: the exact rule, body by body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.payload import Payload
from equipoise.sweep import Sweep

EXACT = 1e-9
POSES = 64


@dataclass(frozen=True)
class Adjustment:
    """What balances one body: torque cos(angle + lead), angle the body's to the horizontal.

    torque in N m, lead in rad: by as much the crank of the balancer is turned ahead of the body, and by as much a
    fixed pivot back, from where they stand for a body whose weight acts along its x axis.
    """

    body: str
    torque: float
    lead: float

    def force(self, radius: float) -> float:
        """F = torque / radius: the constant force, N, on a Scotch yoke with a crank of radius m."""
        return self.torque / radius

    def rate(self, crank: float, distance: float) -> float:
        """k = torque / (crank distance): the rate, N/m, of a zero-free-length spring from crank pin to pivot, m."""
        return self.torque / (crank * distance)


def payload_rule(
    mechanism: Mechanism,
    payload: Payload | Sequence[Payload] = (),
    *,
    bodies: Sequence[str] | None = None,
    sweep: Sweep | None = None,
) -> tuple[Adjustment, ...]:
    """What the balancers of a planar arm must supply, exactly, with a payload of one mass at one point.

        V = const + sum_i torque_i sin(angle_i + lead_i)

    angle_i is that of body i's x axis to world x, counter-clockwise in x-z. For two links with first moments
    m1 c1, m2 c2 and a payload mp at x + i y of the second, torque_2 exp(i lead_2) = g (m2 c2 + mp (x + i y)) and
    torque_1 = g (m1 c1 + (m2 + mp) l1): the crank's angle, the magnitude and the other link's force all follow the
    payload. bodies are those whose balancers are adjusted (default: the body that each driven joint moves); the rule
    is read from the energy at the poses of sweep (default: 64 Sobol poses over the joint limits). It replaces
    the adjustment of the crank alone in Fig. 27 of [quaglia_yin_2015].

    Raises InputError for a body that is not there, a payload of several masses, bodies that move as one, and a
    mechanism whose energy is no such sum.
    """
    carried = (payload,) if isinstance(payload, Payload) else tuple(payload)
    names = _bodies(mechanism) if bodies is None else tuple(bodies)
    for item in carried:
        mechanism.body_id(item.body)
        if len(item.masses) != 1:
            raise InputError(
                f"a payload of {len(item.masses)} masses on {item.body}, the rule is for one", where="payload_rule"
            )
    over = Sweep.sobol(mechanism, POSES) if sweep is None else sweep
    states = mechanism.states(replace(over, payloads=(), scenarios=np.zeros((1, 0))))
    energy = states.potential + sum(states.weight_energy(item.point, item.masses[0]) for item in carried)
    angles = [_angle(states.rotation(name)[0]) for name in names]
    basis = np.stack([np.ones(len(states)), *(part(a) for a in angles for part in (np.sin, np.cos))], axis=1)
    found, _, rank, _ = np.linalg.lstsq(basis, energy, rcond=1e-10)
    if rank < basis.shape[1]:
        raise InputError(
            f"{', '.join(names)} do not turn independently, so their shares cannot be told apart",
            where="payload_rule",
            hint="name one body for each group that turns as one",
        )
    load = float(np.abs(found[1:]).max())
    off = float(np.abs(basis @ found - energy).max())
    if off > EXACT * max(load, 1e-300):
        raise InputError(
            f"the weight of {mechanism.name} is no sum over the angles of {', '.join(names)}: {off:.3g} J are left",
            where="payload_rule",
            hint="the rule needs a planar arm of hinges and one body for each angle that moves a weight",
        )
    return tuple(
        Adjustment(name, float(np.hypot(s, c)), float(np.arctan2(c, s)))
        for name, s, c in zip(names, found[1::2], found[2::2], strict=True)
    )


def _bodies(mechanism: Mechanism) -> tuple[str, ...]:
    """The body that each driven joint moves."""
    return tuple(mechanism.model.body(mechanism.model.jnt_bodyid[joint]).name for joint in mechanism.driven_ids)


def _angle(rotation: Array) -> Array:
    """Angle (N,) of the x axis in the x-z plane."""
    return np.arctan2(rotation[:, 2, 0], rotation[:, 0, 0])
