"""The parts of a design as design.json holds them: what each is, where it goes, and what it does over the sweep."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from equipoise.balancers.counter_rotor import CounterRotor
from equipoise.balancers.counterweight import Counterweight
from equipoise.balancers.flywheel import Flywheel
from equipoise.balancers.gearing import Mesh
from equipoise.balancers.shapes import Disc, PointMass
from equipoise.balancers.spring import Spring
from equipoise.mechanism import Point
from equipoise.parts import Part
from equipoise.swept import swept_box

if TYPE_CHECKING:
    from equipoise.design import Design


def part_records(design: Design) -> list[dict[str, Any]]:
    """One entry per balancer, SI units."""
    return [_RECORDS[type(balancer)](design, balancer) for balancer in design.balancers]


def _spring_part(design: Design, spring: Spring) -> dict[str, Any]:
    length, force = spring.force(design.states, design.values)
    model = design.mechanism.model
    seats = [place if isinstance(place, Point) else place.seat(model, spring.name) for place, _ in spring.path.ends()]
    ends = spring.path.sketch(design.states, 0).anchors or seats
    storage = spring.effort(design.states, "storage")
    energy = storage.at(np.array([design.values[unknown.name] for unknown in storage.unknowns]))[:, 0]
    stored = spring.stored(design.values, design.states)
    parameters = spring.parameters(design.values)
    units = spring.law.parameter_units(spring.path.unit)
    return {
        "name": spring.name,
        "kind": "spring",
        "law": type(spring.law).__name__,
        "path": type(spring.path).__name__,
        "unit": spring.path.unit,
        "parameters": parameters,
        "units": {name: units[name] for name in parameters},
        "details": {
            words: {"value": value, "unit": unit}
            for words, (value, unit) in spring.law.details(spring.own(design.values), length).items()
        },
        "stored": {"exact": stored.exact, "error": stored.error},
        "ends": [{"body": end.body, "at": [float(v) for v in end.at]} for end in ends],
        "length": [float(length.min()), float(length.max())],
        "stroke": float(length.max() - length.min()),
        "room": swept_box(spring.path, design.states).tolist(),
        "force": [float(force.min()), float(force.max())],
        "energy": [float(energy.min()), float(energy.max())],
        "mass": float(spring.own_mass),
        **(spring.law.record(length) if isinstance(spring.law, Part) else {}),
    }


def _weight_part(design: Design, weight: Counterweight) -> dict[str, Any]:
    mass, where = weight.place(design.values)
    part = {
        "name": weight.name,
        "kind": "counterweight",
        "mass": mass,
        "ends": [{"body": weight.at.body, "at": [float(v) for v in where]}],
    }
    if not isinstance(weight.shape, PointMass):
        part["inertia"] = weight.inertia(design.values).tolist()
    if isinstance(weight.shape, Disc) and weight.shape.density is not None:
        part["thickness"] = weight.shape.thickness_of(mass)
    return part


def _rotor_part(design: Design, rotor: CounterRotor) -> dict[str, Any]:
    part = {
        "name": rotor.name,
        "kind": "counter_rotor",
        "body": rotor.body,
        "ratio": float(rotor.ratio),
        "inertia": rotor.found(design.values),
        "mass": rotor.own_mass(design.values),
        "ends": [{"body": rotor.shaft.body, "at": [float(v) for v in rotor.shaft.at]}],
    }
    if design.states.rates is not None:
        meshes = rotor.meshes(design.states, design.values)
        own = meshes[0]
        part["mesh_torque"] = [float(own.torque.min()), float(own.torque.max())]
        if design.sweep.instants is not None:
            part["torque_reversals"] = own.reversals
        part["preload"] = own.preload
        part["meshes"] = [
            {"name": mesh.name, "torque": float(np.abs(mesh.torque).max()), "preload": mesh.preload}
            | ({"reversals": mesh.reversals} if design.sweep.instants is not None else {})
            | _teeth(mesh)
            for mesh in meshes
        ]
    return part


def _teeth(mesh: Mesh) -> dict[str, float]:
    """Pitch radius of the driven gear, m, and the largest force on its teeth, N, where they are known."""
    if mesh.radius is None or mesh.tooth_force is None:
        return {}
    return {"pitch_radius": float(mesh.radius), "tooth_force": float(mesh.tooth_force.max())}


def _flywheel_part(design: Design, wheel: Flywheel) -> dict[str, Any]:
    part: dict[str, Any] = {"name": wheel.name, "kind": "flywheel", "axis": wheel.normal.tolist(), "mass": wheel.mass}
    part["ends"] = [{"body": "world", "at": [0.0, 0.0, 0.0]}]
    law = design.flywheel_law(wheel)
    if law is None:
        return part | {"inertia": wheel.inertia}
    return part | {
        "inertia": law.inertia,
        "needs": dict(law.needs),
        "torque": float(np.abs(law.torque).max()),
        "speed": float(np.abs(law.speed).max()),
        "power": float(np.abs(law.power).max()),
        "angle": float(law.angle[-1]),
        "form": dict(law.form),
    }


_RECORDS: dict[type, Callable[[Design, Any], dict[str, Any]]] = {
    Spring: _spring_part,
    Counterweight: _weight_part,
    CounterRotor: _rotor_part,
    Flywheel: _flywheel_part,
}
