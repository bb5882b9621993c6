"""side_by_side: what several designs for one mechanism add, leave at the base, and ask of the motors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from equipoise.balancers.counter_rotor import CounterRotor
from equipoise.design import Design
from equipoise.errors import InputError
from equipoise.machinery import Machine, machine


@dataclass(frozen=True)
class Line:
    """One quantity of all columns: what it is, its unit, a value for each design (None where it does not apply)."""

    what: str
    unit: str
    values: tuple[float | None, ...]


@dataclass(frozen=True, eq=False)
class SideBySide:
    """Designs beside each other, the bare mechanism first: columns (names) and lines."""

    columns: tuple[str, ...]
    lines: tuple[Line, ...]

    def json(self) -> dict[str, Any]:
        """Plain data: a list of lines, each with a value for every column."""
        rows = [
            {"what": one.what, "unit": one.unit, **dict(zip(self.columns, one.values, strict=True))}
            for one in self.lines
        ]
        return {"columns": list(self.columns), "lines": rows}

    def __str__(self) -> str:
        from equipoise.reporting.balance import columns_text

        return columns_text(self)


def side_by_side(designs: Mapping[str, Design]) -> SideBySide:
    """Mass, inertia, shaking force and moment, torque, power and work of designs {name: design} over one motion.

    Torques and powers are the largest over the driven joints, heat torque the root of the summed squares; energy is
    that of all drives on one supply, over the motion. A flywheel's own motor stands apart. Raises InputError for
    designs of different mechanisms or motions, and for sweeps that are no motion in time.
    """
    found = list(designs.values())
    if not found:
        raise InputError("there is no design to show", where="side_by_side")
    first = found[0]
    for name, design in designs.items():
        if design.mechanism.driven != first.mechanism.driven or design.sweep.describe() != first.sweep.describe():
            raise InputError(
                f"{name} is for another mechanism or motion than {next(iter(designs))}",
                where="side_by_side",
                hint="compare designs of one mechanism over one motion",
            )
        if design.sweep.instants is None:
            raise InputError(f"{name} is over no motion in time", where="side_by_side", hint="sweep: {motion: ...}")
    bare = machine(first.mechanism, first.sweep, first.states)
    machines = [bare, *(design.machine[1] for design in found if design.machine)]
    tables = [first.before, *(design.after for design in found)]
    parts = [[], *(design.parts() for design in found)]
    masses = [0.0, *(design.added_mass for design in found)]
    lines = [
        Line("added mass", "kg", tuple(masses)),
        Line("inertia of rotors", "kg m^2", (0.0, *(_turning(design) for design in found))),
    ]
    lines += [
        Line(f"shaking {row}, {norm}", tables[0][row].unit, tuple(getattr(table[row], norm) for table in tables))
        for row in ("force", "moment")
        for norm in ("peak", "rms")
    ]
    unit = first.mechanism.driven_units[0]
    torques = [[drive.effort.peak for drive in one.drives.values()] for one in machines if one]
    heats = [[drive.effort.rms for drive in one.drives.values()] for one in machines if one]
    powers = [[drive.power for drive in one.drives.values()] for one in machines if one]
    lines += [
        Line("drive effort, peak", unit, tuple(max(row) for row in torques)),
        Line("drive effort, rms over all", unit, tuple(float(np.linalg.norm(row)) for row in heats)),
        Line("drive power, peak", "W", tuple(max(row) for row in powers)),
        Line("energy without regeneration", "J", tuple(_energy(one) for one in machines)),
    ]
    for what, key, measure in (
        ("flywheel motor, torque", "torque", "N m"),
        ("flywheel motor, speed", "speed", "rad/s"),
        ("flywheel motor, power", "power", "W"),
    ):
        values = tuple(_wheel(column, key) for column in parts)
        if any(value is not None for value in values):
            lines.append(Line(what, measure, values))
    meshes = [[mesh for part in column for mesh in part.get("meshes", ())] for column in parts]
    if any(meshes):
        counts = tuple(float(sum(mesh.get("reversals", 0) for mesh in column)) if column else None for column in meshes)
        preload = tuple(max(mesh["preload"] for mesh in column) if column else None for column in meshes)
        lines.append(Line("torque reversals in all meshes", "", counts))
        lines.append(Line("anti-backlash preload, largest", "N m", preload))
    return SideBySide(("bare", *designs), tuple(lines))


def _turning(design: Design) -> float:
    """Inertia of counter-rotors, their gears and flywheels, kg m^2."""
    gears = sum(r.found(design.values) + r.gear_inertia for r in design.balancers if isinstance(r, CounterRotor))
    wheels = sum(part.get("inertia") or 0.0 for part in design.parts() if part["kind"] == "flywheel")
    return float(gears + wheels)


def _energy(one: Machine | None) -> float | None:
    return one.supply.positive if one and one.supply else None


def _wheel(parts: list[dict[str, Any]], key: str) -> float | None:
    found = [part[key] for part in parts if part["kind"] == "flywheel" and key in part]
    return max(found) if found else None
