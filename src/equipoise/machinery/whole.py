"""Motors and bearings of a mechanism over one motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from equipoise.assemble import Balancer
from equipoise.machinery.bearings import Bearing, bearing_rows, named
from equipoise.machinery.drive import Drive, Supply, drives, supplies
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
    return Machine(
        drives=drives(mechanism, sweep, states, balancers, values),
        supply=supplies(sweep, states, balancers, values).get("all"),
        bearings=named(states),
        forces=bearing_rows(mechanism, sweep, states, balancers, values),
    )
