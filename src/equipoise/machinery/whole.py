"""Motors and bearings of a mechanism over one motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from equipoise.affine import Array, Block
from equipoise.assemble import Balancer
from equipoise.machinery.bearings import Bearing, forces_between, named
from equipoise.machinery.drive import (
    Drive,
    Supply,
    drive_blocks,
    drive_sizes,
    drives,
    effort_parts,
    power_of,
    supplies,
)
from equipoise.machinery.norms import rows_of
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
) -> Machine | None:
    """Motors and bearings over a motion in time; None for poses at rest and for random states.

    states are those of the sweep (computed where not given); values {name: SI value} the balancers' unknowns.
    """
    if sweep.instants is None:
        return None
    states, values = states or mechanism.states(sweep), values or {}
    bearings = named(states)
    names = [f"force in {bearing.name}" for bearing in bearings]

    def parts(other: States) -> dict[str, Array]:
        return effort_parts(other, balancers, values)

    def sizes(other: States, split: Mapping[str, Array]) -> Array:
        forces = np.linalg.norm(forces_between(other, balancers, values), axis=2)
        return np.concatenate([drive_sizes(other, split), forces], axis=1)

    split = parts(states)
    blocks = [*drive_blocks(mechanism), *(Block(name, "N") for name in names)]
    size = sizes(states, split)
    rows = rows_of(mechanism, sweep, states, size, blocks, lambda other: sizes(other, parts(other)))
    work = supplies(mechanism, sweep, power_of(states, split))
    return Machine(
        drives=drives(mechanism, rows, work),
        supply=work.get("all"),
        bearings=bearings,
        forces={bearing.name: rows[name] for bearing, name in zip(bearings, names, strict=True)},
    )
