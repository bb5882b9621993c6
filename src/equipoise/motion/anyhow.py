"""States that a mechanism can be in, moving in any way it admits."""

from __future__ import annotations

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.loops import reachable
from equipoise.mechanism import Mechanism
from equipoise.motion.moves import Free
from equipoise.posefile import held

PROBE = 12
"""How many random poses must be in reach before more are tried."""
SHRUNK = (1.0, 0.4, 0.15, 0.05, 0.02)
"""Shares of the box around the reference that poses are drawn from until the loops reach enough of them."""


def any_states(mechanism: Mechanism, box: Array, n: int, rng: np.random.Generator) -> Free:
    """n random states in a box (nd, 2) of poses, with velocities and accelerations from -1..1.

    Raises InputError where the loops do not reach n poses.
    """
    centre, kept = held(mechanism), np.zeros((0, len(box)))
    for share in SHRUNK:
        near = centre + share * (box - centre[:, None]).T
        poses = near[0] + rng.random((2 * n, len(box))) * (near[1] - near[0])
        some = poses[:PROBE][reachable(mechanism, poses[:PROBE])]
        reached = poses[reachable(mechanism, poses)] if len(some) == len(poses[:PROBE]) else some
        if len(reached) == len(poses):  # a room without walls: its poses also reach each other
            kept = reached
            break
        kept = np.vstack([kept, reached])
    if len(kept) < n:
        raise InputError(
            f"only {len(kept)} of {n} random poses can be reached by the loops",
            where="sweep.any_motion",
            hint="narrow the `ranges` of the driven joints",
        )
    kept = kept[-n:]
    rates = rng.uniform(-1.0, 1.0, (n, 2 * len(box)))
    unit = np.repeat([[-1.0, 1.0]], 2 * len(box), axis=0)
    return Free(np.hstack([kept, rates]), np.vstack([np.stack([kept.min(axis=0), kept.max(axis=0)], axis=1), unit]))
