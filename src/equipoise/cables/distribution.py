"""What the motors still do: tensions along a path of poses, with and without springs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import clarabel
import numpy as np
from scipy import sparse

from equipoise.affine import Array
from equipoise.assemble import effort
from equipoise.balancers.paths import Reel, Winding
from equipoise.balancers.spring import Spring
from equipoise.cables.tensions import allowed
from equipoise.cables.wrench import wrench_matrix
from equipoise.design import Design
from equipoise.errors import InfeasibleError
from equipoise.platform import platform_of, transform
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
    t_min: float | Sequence[float] | None = None,
    t_max: float | Sequence[float] | None = None,
    *,
    design: Design | None = None,
    least: Literal["norm", "peak"] = "norm",
) -> Distribution:
    """Tensions that hold the platform at every pose with the least effort of the motors.

        min |t_M|_2 or max_i |t_M,i|   subject to   W (t_S + t_M) + w = 0,  t_min <= t_S + t_M <= t_max

    t_S are the tensions of the design's springs behind reels, zero without a design; t_min and t_max are one for all
    cables or one for each, by default the platform's own; w is the weight, in a motion with its inertia. Raises
    InfeasibleError naming the first pose that cannot be held, InputError for reversed limits.
    """
    low, high = allowed(states, t_min, t_max)
    W, w, lengths = wrench_matrix(states)
    if states.rates is not None:
        w = transform(states)(effort(states.mechanism, (), states, "drive").b)
    springs = np.zeros_like(lengths) if design is None else spring_tensions(design, states)
    total = np.empty_like(lengths)
    for row in range(len(W)):
        found = _least(W[row], w[row], springs[row], low, high, least)
        if found is None:
            pose = dict(zip(states.mechanism.driven, np.round(states.driven[row], 6).tolist(), strict=True))
            raise InfeasibleError(
                f"no tensions from {low.max():g} to {high.min():g} N hold the platform at {pose}",
                where="tension distribution",
                hint="widen the limits, or stay where `feasible` has a margin",
            )
        total[row] = found
    return Distribution(total, total - springs, lengths)


def spring_tensions(design: Design, states: States) -> Array:
    """What the springs of a design pull with, by cable (N, m), N: t = f(l) dl/dc behind every reel."""
    platform = platform_of(states.mechanism)
    found = np.zeros((len(states), len(platform.cables)))
    for balancer in design.balancers:
        cable = reel_of(balancer)
        if cable is None or not isinstance(balancer, Spring):
            continue
        length, _ = Reel(cable).deform(states)
        turned, rate = balancer.path.along(length)
        theta = np.array([design.values[unknown.name] for unknown in balancer.unknowns])
        basis, known = balancer.law.force_basis(turned)
        found[:, platform.cables.index(cable)] += (basis @ theta + known) * rate
    return found


def reel_of(balancer: object) -> str | None:
    """The cable whose reel a spring sits behind; None for anything else."""
    path = getattr(balancer, "path", None)
    while path is not None and not isinstance(path, Reel | Winding):
        path = getattr(path, "input", None)
    return None if path is None else path.cable


def _least(W: Array, w: Array, springs: Array, low: Array, high: Array, least: str) -> Array | None:
    count = len(springs)
    eye = np.eye(count)
    bounded = np.isfinite(high)
    scale = max(1.0, float(np.abs(w).max()), float(np.abs(low).max()), *high[bounded].tolist())
    rows, rhs = [W, -eye, eye[bounded]], [-w / scale, -low / scale, high[bounded] / scale]
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
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-12
    cones = [clarabel.ZeroConeT(len(W)), clarabel.NonnegativeConeT(len(b) - len(W))]
    found: Any = clarabel.DefaultSolver(P, q, A, b, cones, settings).solve()
    return None if "Solved" not in str(found.status) else np.array(found.x[:count]) * scale
