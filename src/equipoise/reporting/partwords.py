"""What a part of a design is called, where it goes, and what it does, in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from equipoise.balancers.laws.law import FORCE
from equipoise.design import Design
from equipoise.parameters import tag
from equipoise.reporting.numbers import (
    SHOWN,
    percent,
    place,
    plain,
    quantity,
    sig,
    span,
)
from equipoise.units import along_path

LAWS = {"constant": "constant force", "linear": "straight force line", "hydro_pneumatic": "hydro-pneumatic"}
"""What laws are called, where it is not their tag."""

PARAMETERS = {"k_free_length": "k x free length", "k_rest": "k x rest angle"}
"""What parameters are called, where it is not their name."""

PRODUCTS = {"k_free_length": "free_length", "k_rest": "rest"}
"""Products that are left out where the parameter in them is known."""


def law_words(part: Mapping[str, Any], balancer: Any) -> str:
    """`zero free length, k = 1684 N/m`; a real part says how it is ordered."""
    law = tag(type(balancer.law))
    if "order" in part:
        return f"{law.replace('_', ' ')}: {part['order']}"
    # A rate whose force is below rounding beside the rest is the solver's way to say none.
    least = 1e-9 * max(abs(force) for force in part["force"]) / max(*map(abs, part["length"]), 1e-9)
    parameters = {key: 0.0 if key == "k" and abs(k) <= least else k for key, k in part["parameters"].items()}
    words = parameter_words(parameters, part["units"])
    return ", ".join([LAWS.get(law, law.replace("_", " ")), *balancer.law.remarks, *words])


def weight_words(part: Mapping[str, Any], design: Design) -> str:
    """`counterweight, 2.6 kg`, `counter-rotor, 0.0058 kg m^2`; a mass at rounding level is none."""
    if part["kind"] == "counter_rotor":
        return _rotor_words(part)
    if part["kind"] == "flywheel":
        return _flywheel_words(part)
    wanted = part["mass"] > 1e-9 * design.mechanism.mass
    return f"counterweight, {plain(part['mass'])} kg" if wanted else "counterweight, 0 kg: it does not help here"


def _rotor_words(part: Mapping[str, Any]) -> str:
    sense = "against" if part["ratio"] > 0 else "along with"
    words = f"counter-rotor, {quantity(part['inertia'], 'kg m^2')}"
    words += f" at ratio {plain(abs(part['ratio']))} {sense} {part['body']}"
    if part["mass"]:
        words += f", {plain(part['mass'])} kg"
    if "torque_reversals" in part:
        words += f"; {part['torque_reversals']} torque reversals a run"
        words += f", anti-backlash preload {quantity(part['preload'], 'N m', 3)}"
        if "tooth_force" in part["meshes"][0]:
            own = part["meshes"][0]
            force, radius = quantity(own["tooth_force"], "N", 3), quantity(own["pitch_radius"], "m", 3)
            words += f", teeth {force} at a pitch radius of {radius}"
        for belt in part["meshes"][1:]:
            words += f"; its belt {belt['reversals']} and {quantity(belt['preload'], 'N m', 3)}"
    return words


def _flywheel_words(part: Mapping[str, Any]) -> str:
    if "speed" not in part:
        return "flywheel on the base"
    return (
        f"flywheel on the base, {quantity(part['inertia'], 'kg m^2')}: up to {quantity(part['speed'], 'rad/s')}, "
        f"{quantity(part['torque'], 'N m')}, {quantity(part['power'], 'W')}; it turns {quantity(part['angle'], 'rad')}"
        + (" in all, in closed form" if part["form"] else " in all, integrated")
    )


def parameter_words(parameters: Mapping[str, float], units: Mapping[str, str]) -> list[str]:
    """Each parameter of a law with its unit; a product such as k L0 is left out where the free length is known."""
    words = []
    for parameter, value in parameters.items():
        if PRODUCTS.get(parameter) in parameters or (parameter in ("initial_tension", "preload") and value == 0):
            continue
        name, shown_value = PARAMETERS.get(parameter, parameter.replace("_", " ")), quantity(value, units[parameter])
        words.append(f"{name} = {shown_value}" if parameter == "k" else f"{name} {shown_value}")
    return words


def used_words(part: Mapping[str, Any]) -> str:
    """`used: body shear 61 % of allowed, ...; unsourced: ...` of a real part, or nothing."""
    if "order" not in part:
        return ""
    used = [f"{name} {percent(clause['used'])} of allowed" for name, clause in part["clauses"].items()]
    doubts = [f"unsourced, ask the maker: {', '.join(part['unsourced'])}"] if part["unsourced"] else []
    return "; ".join([*([f"used: {', '.join(used)}"] if used else []), *doubts])


def where_words(part: Mapping[str, Any]) -> str:
    """`shoulder_link (0, 220, 150) mm to upper_arm_link (0, 0, 200) mm`."""
    return "  to  ".join(f"{end['body']} {place(end)}" for end in part["ends"])


def work_words(part: Mapping[str, Any]) -> str:
    """Length, force and energy of a spring over the sweep."""
    mass = f", own mass {quantity(part['mass'], 'kg', 3)}" if part.get("mass") else ""
    return ", ".join(f"{name} {value}" for name, value in facts(part)) + room_words(part) + mass + pushing(part)


def placed_words(part: Mapping[str, Any], design: Design) -> str:
    """Where the spring was put among equals, the area it sweeps and the workspace that costs; or nothing."""
    placed = design.places.get(part["name"])
    if placed is None:
        return ""
    turn = f"turned about the joint by {quantity(placed.turn, 'rad', 3)}" if abs(placed.turn) > 1e-9 else "not turned"
    swap = ", distances of crank and pivot swapped" if placed.swapped else ""
    return (
        f"placed {turn}{swap}; sweeps {sig(placed.area, 3)} m^2 with rods and guides, "
        f"{sig(100 * placed.share, 2)} % of the links' own sweep"
    )


def room_words(part: Mapping[str, Any]) -> str:
    """`, room 130 x 0 x 260 mm`: the box that spring and rods sweep, along the world's axes."""
    sides = [high - low for low, high in zip(*part["room"], strict=True)]
    return f", room {' x '.join(plain(round(1e3 * side, 1), 3) for side in sides)} mm" if max(sides) > 1e-6 else ""


def facts(part: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What a spring does over the sweep: length or angle with its stroke, force or torque, energy."""
    unit = part["unit"]
    length, force = ("angle", "torque") if unit == "rad" else ("length", "force")
    stroke = f" (stroke {quantity(part['stroke'], unit, 3)})"
    return [
        (length, span(part["length"], unit) + stroke),
        (force, span(part["force"], along_path(FORCE, unit))),
        ("energy", energy_words(part).removeprefix("energy ")),
    ]


def details(part: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What else a law tells of itself: pressures, volumes, powers."""
    words = []
    for name, detail in part["details"].items():
        value, unit = detail["value"], detail["unit"]
        if isinstance(value, float):
            words.append((name, quantity(value, unit)))
        elif len(value) == 2 and unit in SHOWN:
            words.append((name, span(value, unit, 4)))
        else:
            words.append((name, f"{', '.join(plain(item) for item in value)} ({unit})"))
    return words


def pushing(part: Mapping[str, Any]) -> str:
    """That a spring pushes, where it is no strut that always does."""
    low, high = part["force"]
    return "; it pushes where the force is negative" if low < -1e-9 * abs(high) and high > 0 else ""


def stored_words(part: Mapping[str, Any]) -> str:
    """How far the cubic in the saved model is from a law that no tendon can hold, or nothing."""
    stored = part["stored"]
    if stored["exact"]:
        return ""
    error = f"{sig(stored['error'], 2)} {along_path(FORCE, part['unit'])}"
    return f"in the saved model the nearest cubic stands for it, within {error}; verified with the law itself"


def energy_words(part: Mapping[str, Any]) -> str:
    """How much a spring stores at most, or by how much its energy varies where it has no natural zero."""
    low, high = part["energy"]
    return f"energy up to {quantity(high, 'J', 3)}" if low >= 0 else f"energy varies by {quantity(high - low, 'J', 3)}"
