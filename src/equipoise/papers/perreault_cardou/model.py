"""The triangle with three cables, its springs, and what is read of them [perreault_cardou]."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np

from equipoise.balancers.laws import Polynomial
from equipoise.balancers.paths import Reel
from equipoise.balancers.spring import Spring
from equipoise.claim import Source
from equipoise.limits import Convex, Force
from equipoise.limits.curve import Pieces
from equipoise.models.cable_platform import cable_platform
from equipoise.objective import Aim
from equipoise.sweep import Sweep
from equipoise.verbs.balance import balance

if TYPE_CHECKING:
    from equipoise.affine import Array
    from equipoise.design import Design
    from equipoise.limits import Limit

S = Source("perreault-cardou")
SIDE = 1.0
HEIGHT = 3**0.5 / 2 * SIDE
CORNERS = ((-SIDE / 2, -HEIGHT / 3), (SIDE / 2, -HEIGHT / 3), (0.0, 2 * HEIGHT / 3))
AREA = SIDE * HEIGHT / 2
FLOOR = 0.01990344571
"""inf of f over all identical springs: the integral equation of the obstacle problem, see docs/cables.md."""


@functools.cache
def solved(k: int, exact: bool = False, norm: str = "rms", t_min: float = 1.0, drum: float = 0.0) -> Design:
    """The paper's program: k coefficients, t >= t_min at 10 k lengths of [0, a], or (exact) at all of them."""
    robot = cable_platform(CORNERS)
    law = Polynomial((0.0, SIDE), degree=k - 1)
    assert robot.platform is not None
    springs = [
        Spring(f"s{i + 1}", Reel(cable), law, like="s1" if i else None) for i, cable in enumerate(robot.platform.cables)
    ]
    limits: list[Limit] = [Force("s1", min=t_min, over=(0.0, SIDE), samples=None if exact else 10 * k)]
    if drum:
        limits.append(Convex("s1", (0.0, SIDE), radius=drum))
    points = 10 if norm == "mean" else 12
    sweep = Sweep.triangle(robot, CORNERS, points=points)
    return balance(robot, springs, sweep, objective=Aim(goal="wrench", norm=norm), limits=limits)  # type: ignore[arg-type]


def objective(design: Design) -> float:
    """f = 1/2 int |f_r|^2 dA, Eqs. 10 and 16, N^2 m^2."""
    return 0.5 * AREA * design.after["resultant"].rms ** 2


def tension(design: Design, c: Array) -> Array:
    """t(c), N."""
    spring = design.balancers[0]
    assert isinstance(spring, Spring)
    return spring.law.force_basis(c)[0] @ np.array([design.values[u.name] for u in spring.unknowns])


def least(design: Design) -> float:
    """Least tension over [0, a], N, from the roots of t'."""
    spring = design.balancers[0]
    assert isinstance(spring, Spring)
    theta = np.array([design.values[u.name] for u in spring.unknowns])
    return float(Pieces.of(spring.law, (0.0, SIDE)).extremes(theta)[1].min())


def resultants(design: Design) -> tuple[Array, Array]:
    """|f_r| (N,), N, at the sweep's poses and their weights."""
    force = design.residual(design.states, "wrench")
    return np.linalg.norm(force, axis=1), design.states.weight


def light(design: Design, cells: int = 250) -> float:
    """Share of the area, %, with |f_r| < 0.1 N: of equal triangles, each judged at its centre."""
    i, j = (part.ravel() for part in np.meshgrid(np.arange(cells), np.arange(cells)))
    upright = np.stack([i, j], axis=1)[i + j < cells] + 1 / 3
    inverted = np.stack([i, j], axis=1)[i + j < cells - 1] + 2 / 3
    shares = np.concatenate([upright, inverted]) / cells
    corners = np.array(CORNERS)
    poses = corners[0] + shares @ (corners[1:] - corners[0])
    states = design.mechanism.states(design.sweep.at_poses(poses))
    size = np.linalg.norm(design.residual(states, "wrench"), axis=1)
    return float(100 * (size < 0.1).mean())
