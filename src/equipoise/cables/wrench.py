"""The wrench matrix of a cable platform."""

from __future__ import annotations

import numpy as np

from equipoise import platform
from equipoise.affine import Array
from equipoise.balancers.paths import Line
from equipoise.errors import InputError
from equipoise.states import States


def wrench_matrix(states: States) -> tuple[Array, Array, Array]:
    """W (N, n, m), w (N, n) and the cables' lengths (N, m): W t + w is the resultant on the platform.

        W = J^-T (-dl/dq)',   w = -J^-T dV/dq

    t (m,) tensions in N, w weights of platform and payload; moments are divided by the platform's length, so all
    rows are in N. Raises InputError for a mechanism without a platform or without cables.
    """
    mechanism = states.mechanism
    found = platform.platform_of(mechanism)
    if not found.cables:
        raise InputError(f"{mechanism.name} has no cables", where="platform")
    turn = platform.transform(states)
    lines = [Line(*mechanism.cable(cable)).deform(states) for cable in found.cables]
    W = np.stack([turn(rate) for _, rate in lines], axis=-1)
    return W, turn(states.holding), np.stack([length for length, _ in lines], axis=-1)
