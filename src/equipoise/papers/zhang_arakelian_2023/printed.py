"""Eqs. 20 to 30 as printed, with switches for what has to be put right."""

from __future__ import annotations

import numpy as np

from equipoise.affine import Array
from equipoise.papers.zhang_arakelian_2023.model import FREE, MOMENT, Dyad, K


def moment_as_printed(dyad: Dyad, phi: Array, *, cosine: bool, sign: bool) -> Array:
    """M_ub (N,), N m, by forces: cosine keeps the factor of Eq. 26, sign the sum of Eq. 30."""
    u = phi - dyad.beta
    y = dyad.r * np.cos(u) + np.sqrt(dyad.l**2 - (dyad.r * np.sin(u)) ** 2)
    cos_theta = (y * y + dyad.l**2 - dyad.r**2) / (2 * y * dyad.l)
    force = K * (y - FREE)
    rod = force * cos_theta if cosine else force / cos_theta
    of_spring = rod * dyad.r * y * np.sin(u) / dyad.l
    of_gravity = -MOMENT * np.sin(phi)
    return -(of_spring + of_gravity) if sign else of_spring - of_gravity
