"""Momentum as a linear function of mass parameters: the regressor whose row space is what balance asks for.

    (p; L) = Y(q, qdot) pi

pi stacks the parameters of all moving bodies: m, the first moments m r and the second ones about the body's frame. In
a planar mechanism these are m, two first moments and the polar J (four for each body), else all ten.
"""

from __future__ import annotations

import weakref
from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.counterweight import MOMENTS, SECOND, moves_in_plane
from equipoise.loops import ancestors
from equipoise.mechanism import Mechanism
from equipoise.momentum import body_inertia, momentum
from equipoise.posefile import held
from equipoise.states import States
from equipoise.sweep import Sweep

AXES = "xyz"
ROUNDING = 1e-10
"""Beside the largest singular value, what counts as zero; exact ranks leave a gap of many decades around it."""

NEAR = 0.1
"""Share of the joints' ranges within which loops are tried first; any open set of poses has the same row space."""

_free: weakref.WeakKeyDictionary[Mechanism, dict[Any, States]] = weakref.WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class Parameter:
    """One mass parameter `body.m`, `body.mx`, `body.J`: part (4, 4) is the pseudo-inertia that one unit of it adds."""

    name: str
    body: str
    unit: str
    part: Array

    @property
    def diagonal(self) -> bool:
        """Whether it is a second moment that no body has negative."""
        return self.unit == "kg m^2" and bool(np.diag(self.part).any())

    def of(self, J: Array) -> float:
        """The value of the parameter in a pseudo-inertia (4, 4)."""
        first, last = np.argwhere(self.part)[[0, -1]]
        if self.name.endswith(".J"):
            return float(J[tuple(first)] + J[tuple(last)])
        return float(J[tuple(first)])


@dataclass(frozen=True, eq=False)
class Frame:
    """The mass parameters of a mechanism and the rows of momentum that can differ from zero.

    plane is the axis (3,) that a planar mechanism turns about, None for a spatial one; own (P,) the parameters of the
    mechanism's bodies.
    """

    parameters: tuple[Parameter, ...]
    plane: Array | None
    own: Array

    def rows(self, states: States, goal: str) -> Array:
        """Y (M, P) of `force` (p), `moment` (L about the world origin) or `both`, at states that move."""
        blocks = []
        for body in dict.fromkeys(parameter.body for parameter in self.parameters):
            parts = np.array([p.part for p in self.parameters if p.body == body])
            blocks.append(momentum(states.placement(body), parts))
        Y = np.concatenate(blocks, axis=2)
        linear, angular = Y[:, :3], Y[:, 3:]
        if self.plane is not None:
            angular = np.einsum("i,nip->np", self.plane, angular)[:, None]
        chosen = {"force": [linear], "moment": [angular], "both": [linear, angular]}[goal]
        return np.concatenate(chosen, axis=1).reshape(-1, Y.shape[2])


def frame(mechanism: Mechanism) -> Frame:
    """The mass parameters of all bodies that joints move, the innermost first."""
    model = mechanism.model
    moved = [body for body in range(1, model.nbody) if ancestors(model, body)]
    moved.sort(key=lambda body: (len(ancestors(model, body)), body))
    across = {body: [axis for axis in range(3) if moves_in_plane(mechanism, body, axis)] for body in moved}
    planar = all(across.values()) and bool(moved)
    normals = [_normal(mechanism, body, across[body][0]) for body in moved] if planar else []
    planar = planar and all(abs(normals[0] @ normal) > 1 - 1e-9 for normal in normals)
    parameters = []
    for body in moved:
        name = model.body(body).name
        axes = [i for i in range(3) if not planar or i != across[body][0]]
        parameters.append(_parameter(name, "m", "kg", (3, 3)))
        parameters += [_parameter(name, MOMENTS[i], "kg m", (i, 3)) for i in axes]
        if planar:
            polar = np.zeros((4, 4))
            polar[axes, axes] = 0.5
            parameters.append(Parameter(f"{name}.J", name, "kg m^2", polar))
        else:
            parameters += [_parameter(name, what, "kg m^2", (i, j)) for what, i, j in SECOND]
    own = np.array([p.of(body_inertia(model, model.body(p.body).id)) for p in parameters])
    plane = None
    if planar:
        plane = np.abs(normals[0]) if np.abs(normals[0]).max() > 1 - 1e-9 else normals[0]
        plane = np.array([0.0, -1.0, 0.0]) if plane[1] > 1 - 1e-9 else plane
    return Frame(tuple(parameters), plane, np.where(np.abs(own) < 1e-12, 0.0, own))


def free_states(mechanism: Mechanism, sweep: Sweep | None, count: int, seed: int = 0) -> States:
    """Random admissible states with velocities in the place of accelerations, with the payloads of a sweep."""
    payloads, scenarios = ((), np.zeros((1, 0))) if sweep is None else (sweep.payloads, sweep.scenarios)
    known = _free.setdefault(mechanism, {})
    key = (count, seed, payloads, scenarios.tobytes())
    if key not in known:
        free = Sweep.any_motion(mechanism, count, seed=seed, ranges=_around(mechanism))
        known[key] = mechanism.states(replace(free, payloads=payloads, scenarios=scenarios)).momenta
    return known[key]


def _around(mechanism: Mechanism) -> dict[str, tuple[float, float]]:
    """Ranges of the driven joints: all there is, or where loops may have walls, near the reference."""
    centre, box = held(mechanism), mechanism.box
    low, high = np.where(np.isnan(box), centre[:, None] + [-0.5, 0.5], box).T
    share = NEAR if mechanism.model.neq else 1.0
    low, high = (centre + share * (end - centre) for end in (low, high))
    return {joint: (float(a), float(b)) for joint, a, b in zip(mechanism.driven, low, high, strict=True)}


def row_space(rows: Array) -> tuple[Array, Array, float]:
    """Orthonormal basis (rank, P) of the row space and (P - rank, P) of the null space; the gap between both.

    The gap is the least kept over the largest dropped singular value (inf where nothing is dropped).
    """
    _, singular, vectors = np.linalg.svd(rows, full_matrices=True)
    rank = int((singular > ROUNDING * singular.max(initial=0.0)).sum())
    dropped = singular[rank:].max(initial=0.0)
    gap = float(singular[rank - 1] / dropped) if rank and dropped > 0 else float("inf")
    return vectors[:rank], vectors[rank:], gap


def _parameter(body: str, what: str, unit: str, place: tuple[int, int]) -> Parameter:
    part = np.zeros((4, 4))
    part[place] = part[place[::-1]] = 1.0
    return Parameter(f"{body}.{what}", body, unit, part)


def _normal(mechanism: Mechanism, body: int, axis: int) -> Array:
    data = mujoco.MjData(mechanism.model)
    data.qpos[:] = mechanism.reference
    mujoco.mj_kinematics(mechanism.model, data)
    return data.xmat[body].reshape(3, 3)[:, axis]
