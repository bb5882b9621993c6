"""Motors and bearings of a mechanism over one motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from equipoise.affine import Array, Block
from equipoise.assemble import Balancer
from equipoise.friction import Friction
from equipoise.machinery.bearings import Bearing, forces_between, named
from equipoise.machinery.drive import Drive, drive_blocks, drive_sizes, drives, effort_parts, power_of
from equipoise.machinery.norms import rows_of
from equipoise.machinery.rubbed import rubbed, rubbed_blocks, rubbing
from equipoise.machinery.supply import Supply, supplies
from equipoise.mechanism import Mechanism
from equipoise.row import Row
from equipoise.states import States
from equipoise.sweep import Sweep


@dataclass(frozen=True, eq=False)
class Machine:
    """What motors do and bearings carry over a motion.

    drives {joint: Drive}; supply is the energy of all motors on one common supply, braking ones feeding the others;
    bearings and forces {bearing: |F|, N} are those of joints and of pins that close loops.
    """

    drives: Mapping[str, Drive]
    supply: Supply | None
    bearings: tuple[Bearing, ...]
    forces: Mapping[str, Row]

    def json(self) -> dict[str, Any]:
        """The machine as design.json holds it."""
        return {
            "drive": {joint: drive.json() for joint, drive in self.drives.items()},
            "work": self.supply.json() if self.supply else None,
            "bearings": {
                bearing.name: {
                    "between": list(bearing.between),
                    "on_base": bearing.on_base,
                    "indeterminate": [list(axis) for axis in bearing.indeterminate],
                    **self.forces[bearing.name].json(),
                }
                for bearing in self.bearings
            },
        }


def machine(
    mechanism: Mechanism,
    sweep: Sweep,
    states: States | None = None,
    balancers: Sequence[Balancer] = (),
    values: Mapping[str, float] | None = None,
    friction: Friction | None = None,
) -> Machine | None:
    """Motors and bearings over a motion in time; None for poses at rest and for random states.

    states are those of the sweep (computed where not given); values {name: SI value} the balancers' unknowns; friction
    the coefficients of what rubs.
    """
    if sweep.instants is None:
        return None
    states, values = states or mechanism.states(sweep), values or {}
    bearings = named(states)
    names = [f"force in {bearing.name}" for bearing in bearings]

    def parts(other: States) -> dict[str, Array]:
        return effort_parts(other, balancers, values)

    def lost(other: States) -> Array:
        return rubbing(other, balancers, values, friction or Friction())

    split, against = parts(states), lost(states)
    rubs = bool(against.any())

    def sizes(other: States, split: Mapping[str, Array], against: Array | None) -> Array:
        told = [drive_sizes(other, split)]
        told += [] if against is None else [np.abs(against), np.abs(sum(split.values()) + against)]
        return np.concatenate([*told, np.linalg.norm(forces_between(other, balancers, values), axis=2)], axis=1)

    blocks = [*drive_blocks(mechanism), *(rubbed_blocks(mechanism) if rubs else [])]
    blocks += [Block(name, "N") for name in names]
    rows = rows_of(
        mechanism,
        sweep,
        states,
        sizes(states, split, against if rubs else None),
        blocks,
        lambda other: sizes(other, parts(other), lost(other) if rubs else None),
    )
    power, taken = power_of(states, split), against * states.moving.driven_velocity
    work = supplies(mechanism, sweep, power)
    friction_told = {}
    if rubs:
        friction_told = rubbed(
            mechanism, rows, supplies(mechanism, sweep, taken), supplies(mechanism, sweep, power + taken)
        )
    return Machine(
        drives=drives(mechanism, rows, work, friction_told),
        supply=work.get("all"),
        bearings=bearings,
        forces={bearing.name: rows[name] for bearing, name in zip(bearings, names, strict=True)},
    )
