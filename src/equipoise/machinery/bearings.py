"""Forces in bearings and pins over a motion, through closed loops."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.assemble import Balancer, settled
from equipoise.balancers.counter_rotor import CounterRotor
from equipoise.loops import constraint_jacobian
from equipoise.loops.constraints import Connect, Weld
from equipoise.machinery.loosened import beyond, carried_bodies, is_bearing, loosen, own_loads
from equipoise.mechanism import Mechanism
from equipoise.states import States

_CHUNK = 4096
_SEEN = 1e-7


@dataclass(frozen=True)
class Bearing:
    """A bearing or pin: the two bodies that it joins, the force on the second one.

    indeterminate are unit directions (world axes) along which rigid links in redundantly constrained loops leave the
    force open, at one posture at least; what is told there is the least force.
    """

    name: str
    between: tuple[str, str]
    indeterminate: tuple[tuple[float, float, float], ...] = ()

    @property
    def on_base(self) -> bool:
        """Whether it stands on the base."""
        return "world" in self.between


@dataclass(frozen=True, eq=False)
class BearingForces:
    """Forces (N, B, 3), world axes, N, that bearings exert on the second of their bodies, at N states.

    The equations of motion give the forces of the loops, J_dep' lambda = f_dep, f what the motion asks for at the
    joints where no loop closes: exact where lambda is unique, else the least one.
    """

    bearings: tuple[Bearing, ...]
    force: Array

    @property
    def magnitude(self) -> Array:
        """|F| (N, B), N."""
        return np.linalg.norm(self.force, axis=2)

    def of(self, name: str) -> Array:
        """The force (N, 3) in one bearing, N."""
        return self.force[:, [bearing.name for bearing in self.bearings].index(name)]


def bearing_forces(
    states: States, balancers: Sequence[Balancer] = (), values: Mapping[str, float] | None = None
) -> BearingForces:
    """Forces in all bearings and pins over a motion, weight, springs and added parts included.

        R = F_beyond - B' lambda,   J_dep' lambda = f_dep

    F_beyond (3,) is what moves and holds all that lies beyond a bearing, f the generalised force of each joint in
    the mechanism without its loops, J the loop equations' Jacobian, B its part in the bearing's separation. Along a
    driven slide R holds the motor's force too. The teeth of a counter-rotor's gears push on the bearing of the body
    that drives it; belts and pairs of gears on one carrier count as pure torques. values {name: SI value} are
    those of the balancers' unknowns. Raises InputError for states at rest.
    """
    return BearingForces(named(states), forces_between(states, balancers, values or {}))


def forces_between(states: States, balancers: Sequence[Balancer], values: Mapping[str, float]) -> Array:
    """Forces (N, B, 3) in the order of `named`, as `bearing_forces` tells them."""
    mechanism, model = states.mechanism, states.mechanism.model
    total = own_loads(states)
    if balancers:
        fixed, parts = settled(balancers, values), [slice(i, i + _CHUNK) for i in range(0, len(states), _CHUNK)]
        total = total + np.concatenate([_added(loosen(states.take(part)), fixed, values) for part in parts])
    held = total[:, model.nv :].reshape(len(states), -1, 3).copy()
    for balancer in balancers:
        teeth = balancer.pushed(states, values) if isinstance(balancer, CounterRotor) else None
        if teeth is not None:
            held[:, list(carried_bodies(model)).index(teeth[0])] += teeth[1]
    kept = np.array([is_bearing(model, int(body)) for body in carried_bodies(model)], dtype=bool)
    loop = constraint_jacobian(mechanism, states.kin)
    if loop is None:
        return held[:, kept]
    tension, _ = loop.multipliers(total[:, : model.nv])
    pins = []
    after, first = beyond(model), 0
    for item in loop.equalities:
        joined = item.point if isinstance(item, Weld) else item
        if isinstance(joined, Connect):
            force = tension[:, first : first + 3]
            sides = after[:, joined.bodies[0]].astype(float) - after[:, joined.bodies[1]]
            held = held - sides[:, None] * force[:, None]
            pins.append(-force)
        first += len(item.factor)
    return np.concatenate([held[:, kept], *[pin[:, None] for pin in pins]], axis=1)


def _added(loose: States, balancers: Sequence[Balancer], values: Mapping[str, float]) -> Array:
    """What balancers ask for in all coordinates (N, nv + 3 K) of loosened states."""
    total = np.zeros_like(loose.driven)
    for balancer in balancers:
        share = balancer.effort(loose, "drive")
        total = total + share.at(np.array([values[unknown.name] for unknown in share.unknowns]))
    return total


def named(states: States) -> tuple[Bearing, ...]:
    """Bearings of the bodies' own joints, then the pins of loops, with the directions that stay open."""
    mechanism, model = states.mechanism, states.mechanism.model
    some = slice(None, None, max(1, len(states) // 8))
    after, loop = beyond(model), constraint_jacobian(mechanism, states.kin.take(some))
    found: list[Bearing] = []
    open_rows = np.zeros((0, 0, 0)) if loop is None else loop.open_rows()
    equalities = [] if loop is None else loop.equalities
    starts = np.cumsum([0, *[len(item.factor) for item in equalities]])
    joined = {
        int(start): item.point if isinstance(item, Weld) else item
        for start, item in zip(starts, equalities, strict=False)
    }
    pins = {start: item for start, item in joined.items() if isinstance(item, Connect)}
    for place, body in enumerate(carried_bodies(model)):
        if not is_bearing(model, int(body)):
            continue
        first = model.body_jntadr[body]
        name = "/".join(model.joint(first + i).name for i in range(model.body_jntnum[body]))
        free = np.zeros((1, 3, 1))
        for start, item in pins.items():
            sides = float(after[place, item.bodies[0]]) - float(after[place, item.bodies[1]])
            free = free + sides * open_rows[:, start : start + 3]
        bodies = (model.body(model.body_parentid[body]).name, model.body(body).name)
        found.append(Bearing(name, bodies, _directions(free)))
    for number, (start, item) in enumerate(pins.items()):
        bodies = (model.body(item.bodies[0]).name, model.body(item.bodies[1]).name)
        name = _equality_name(mechanism, number)
        found.append(Bearing(name, bodies, _directions(open_rows[:, start : start + 3])))
    return tuple(found)


def _equality_name(mechanism: Mechanism, number: int) -> str:
    """The name of the n-th active point that closes a loop."""
    import mujoco

    model = mechanism.model
    kinds = (int(mujoco.mjtEq.mjEQ_CONNECT), int(mujoco.mjtEq.mjEQ_WELD))
    points = np.flatnonzero(np.isin(model.eq_type, kinds) & (model.eq_active0 != 0))
    return model.equality(int(points[number])).name or f"pin {number + 1}"


def _directions(free: Array) -> tuple[tuple[float, float, float], ...]:
    """Unit directions spanned by forces (S, 3, k) that change nothing else."""
    if not free.size:
        return ()
    table: NDArray[np.float64] = np.moveaxis(free, 1, 0).reshape(3, -1)
    left, sizes, _ = np.linalg.svd(table, full_matrices=False)
    found = left[:, sizes > _SEEN * max(1.0, float(sizes.max(initial=0.0)))].T
    if len(found) == 3:
        return ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    rounded = [np.round(axis * np.sign(axis[np.abs(axis).argmax()]), 9) + 0.0 for axis in found]
    return tuple((float(x), float(y), float(z)) for x, y, z in rounded)
