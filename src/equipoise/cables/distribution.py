"""What the motors still do: tensions along a path of poses, with and without springs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import clarabel
import numpy as np
from scipy import sparse

from equipoise.affine import Array
from equipoise.balancers.paths import Reel
from equipoise.balancers.spring import Spring
from equipoise.cables.wrench import wrench_matrix
from equipoise.design import Design
from equipoise.errors import InfeasibleError, InputError
from equipoise.states import States


@dataclass(frozen=True, eq=False)
class Distribution:
    """Tensions along poses: total and motors' (N, m), N, and lengths (N, m), m.

    The motors' share is the total less what the springs pull.
    """

    total: Array
    motors: Array
    lengths: Array

    @property
    def peak(self) -> float:
        """Largest |tension| that a motor makes, N."""
        return float(np.abs(self.motors).max())

    @property
    def rms(self) -> float:
        """Root of the mean over poses of the sum of squared motor tensions, N: what heats the windings."""
        return float(np.sqrt((self.motors**2).sum(axis=1).mean()))

    @property
    def work(self) -> float:
        """Sum over the path of |motor tension times change of length|, J: energy if nothing is recovered."""
        middle = (self.motors[1:] + self.motors[:-1]) / 2
        return float(np.abs(middle * np.diff(self.lengths, axis=0)).sum())


def distribute(
    states: States,
    t_min: float,
    t_max: float,
    *,
    design: Design | None = None,
    least: Literal["norm", "peak"] = "norm",
) -> Distribution:
    """Tensions that hold the platform at every pose with the least effort of the motors.

        min |t_M|_2 or max_i |t_M,i|   subject to   W (t_S + t_M) + w = 0,  t_min <= t_S + t_M <= t_max

    t_S are the tensions of the design's springs on reels, zero without a design. Raises InfeasibleError naming
    the first pose that cannot be held, InputError for reversed limits.
    """
    if not t_min <= t_max:
        raise InputError(f"t_min {t_min:g} N is above t_max {t_max:g} N", where="tension limits")
    W, w, lengths = wrench_matrix(states)
    springs = np.zeros_like(lengths)
    platform = states.mechanism.platform
    assert platform is not None
    for balancer in design.balancers if design is not None else ():
        if isinstance(balancer, Spring) and isinstance(balancer.path, Reel):
            assert design is not None
            column = platform.cables.index(balancer.path.cable)
            springs[:, column] += balancer.force(states, design.values)[1]
    total = np.empty_like(lengths)
    for row in range(len(W)):
        found = _least(W[row], w[row], springs[row], t_min, t_max, least)
        if found is None:
            pose = dict(zip(states.mechanism.driven, np.round(states.driven[row], 6).tolist(), strict=True))
            raise InfeasibleError(
                f"no tensions from {t_min:g} to {t_max:g} N hold the platform at {pose}",
                where="tension distribution",
                hint="widen the limits, or stay where `feasible` has a margin",
            )
        total[row] = found
    return Distribution(total, total - springs, lengths)


def _least(W: Array, w: Array, springs: Array, low: float, high: float, least: str) -> Array | None:
    count = len(springs)
    eye = np.eye(count)
    scale = max(abs(high), 1.0) if np.isfinite(high) else max(1.0, float(np.abs(w).max()), abs(low))
    rows, rhs = [W, -eye], [-w / scale, np.full(count, -low / scale)]
    if np.isfinite(high):
        rows, rhs = [*rows, eye], [*rhs, np.full(count, high / scale)]
    if least == "peak":
        rows = [np.hstack([part, np.zeros((len(part), 1))]) for part in rows]
        bound = -np.ones((count, 1))
        rows += [np.hstack([eye, bound]), np.hstack([-eye, bound])]
        rhs += [springs / scale, -springs / scale]
        P, q = sparse.csc_matrix((count + 1, count + 1)), np.append(np.zeros(count), 1.0)
    else:
        P, q = sparse.csc_matrix(eye), -springs / scale
    A, b = sparse.csc_matrix(np.vstack(rows)), np.concatenate(rhs)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    cones = [clarabel.ZeroConeT(len(W)), clarabel.NonnegativeConeT(A.shape[0] - len(W))]
    found = clarabel.DefaultSolver(P, q, A, b, cones, settings).solve()
    return None if "Solved" not in str(found.status) else np.array(found.x[:count]) * scale
