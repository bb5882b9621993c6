"""Sentences that both the terminal and the HTML page say: parts, limits and prices, certificates, next steps."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import isfinite
from typing import Any

from equipoise.balancers.laws.law import FORCE
from equipoise.design import Active, Design
from equipoise.objective import joint_goal
from equipoise.parameters import tag
from equipoise.reporting.numbers import (
    SHOWN,
    effort_word,
    percent,
    place,
    plain,
    quantity,
    seen,
    shown,
    sig,
    sort_out,
    span,
)
from equipoise.reporting.rehearsal import motion_words
from equipoise.units import along_path

STEPS = {
    "m": 0.01,
    "m^2": 1e-4,
    "m^3": 1e-3,
    "N": 10.0,
    "N/m": 100.0,
    "N m/rad": 1.0,
    "Pa": 1e5,
    "kg": 0.1,
    "kg m": 0.01,
    "rad": 0.0174532925,
    "N m": 1.0,
}
"""How far a limit is relaxed when its price is put into words, SI."""

BOUND = re.compile(r"([<>]=) *(-?[\d.]+(?:e[+-]?\d+)?)")
"""The side and value at the end of a limit's name."""

LAWS = {"constant": "constant force", "linear": "straight force line", "hydro_pneumatic": "hydro-pneumatic"}
"""What laws are called, where it is not their tag."""

PARAMETERS = {"k_free_length": "k x free length", "k_rest": "k x rest angle"}
"""What parameters are called, where it is not their name."""

PRODUCTS = {"k_free_length": "free_length", "k_rest": "rest"}
"""Products that are left out where the parameter in them is known."""

SOUND = "nothing to remark: masses and inertias are possible"
"""What the mass audit says of a sound file."""

KINDS = {
    "exact": "Exact: nothing is left at any pose, also at poses outside the sweep, to rounding.",
    "convex": "Convex: for this geometry no other values do better; the gap between what was found and what is "
    "provably impossible to beat is recomputed from the problem's data.",
    "bracketed": "Bracketed: the best value over all geometries lies between the two bounds.",
    "local": "Local: at this geometry the values are proven best; no small change of the geometry improves it, but a "
    "better geometry elsewhere cannot be ruled out.",
}


def headline(design: Design) -> str:
    """Robot, joints, mass and what was swept, in one line."""
    mechanism = design.mechanism
    count = len(mechanism.driven)
    found = f"; {design.refined} more pose{'s' * (design.refined != 1)} found between them" if design.refined else ""
    return (
        f"{mechanism.name or 'mechanism'}, {count} driven joint{'s' * (count != 1)}, {plain(mechanism.mass)} kg; "
        f"{design.sweep.describe()}{found}"
    )


def result(design: Design) -> str:
    """The number that matters: the most loaded counted joint in the norm that was made small."""
    joint = main_joint(design)
    norm = design.norm
    before, after = design.before[joint], design.after[joint]
    was, left = getattr(before, norm), getattr(after, norm)
    what = {"peak": "The peak", "rms": "The rms", "mean": "The mean"}[norm]
    if joint not in design.mechanism.driven:
        bare = f"it is {sig(was)}" if seen(was) else "nothing pulls"
        return f"{what} of the {joint} is {sig(left)} {after.unit}; without the added parts {bare}."
    start = f"{what} {supplied(design)} {effort_word(before.unit)} at {joint}"
    if left <= 1e-9 * was:
        return f"{start} vanishes: {sig(was)} {before.unit} before, {sig(left)} {after.unit} (rounding) after."
    change = f"falls from {sig(was)} to {sig(left)} {after.unit}" if left < was else "does not fall"
    gives = "holds" if supplied(design) == "holding" else "gives"
    return f"{start} {change}, {plain(100 * left / was, 3)} % of what the motor {gives} without the added parts."


def supplied(design: Design) -> str:
    """What the rows of the joints are: `holding` efforts at rest, or what the `motor` supplies over a motion."""
    return "motor" if joint_goal(design.objective, design.states.rates is not None) == "drive" else "holding"


def main_joint(design: Design) -> str:
    """The counted joint that gains most, as a share of what it may supply or of the largest load."""
    counted = {row for aim in design.objective for row in aim.counted(design.mechanism)}
    norm = design.norm
    by_motor = any(aim.divisor for aim in design.objective)

    def gain(joint: str) -> float:
        before, after = design.before[joint], design.after[joint]
        size = before.limit if by_motor and before.limit else 1.0
        return (getattr(before, norm) - getattr(after, norm)) / size

    # where only mass counts, what the limits keep small is what there is to show
    shown_rows = [row for row in design.before if row in counted] or [
        row for row in design.before if row not in design.mechanism.driven
    ]
    return max(shown_rows or design.before, key=gain)


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


def goal_word(design: Design) -> str:
    """What a price lowers: `the peak`, or the weighted objective of several aims."""
    aims = [aim for aim in design.objective if aim.cap is None]
    return f"the {aims[0].norm}" if len(aims) == 1 else "the objective"


def price_words(active: Active, design: Design) -> str:
    """`stroke of s1 <= 380 mm: 10 mm more would lower the peak by 0.4 N m`."""
    gained, _, per = active.unit.rpartition(" per ")
    limit = limit_words(active.limit)
    bound = BOUND.search(active.limit)
    if is_natural(active):
        return f"{limit}, the bound that nature sets"
    if not gained:
        return f"{limit} (price {sig(active.price, 3)} {active.unit})"
    step = STEPS.get(per, 1.0)
    # A price is a slope: it is quoted over a step that changes the objective by less than a third.
    while step * active.price > 0.3 * design.certificate.primal > 0:
        step /= 10
    amount = quantity(step, per, 2)
    move = {"<=": f"{amount} more", ">=": f"{amount} less"}.get(bound[1] if bound else "", f"relaxing it by {amount}")
    gain = sig(shown(step * active.price, gained)[0], 2)
    return f"{limit}: {move} would lower {goal_word(design)} by {gain} {shown(0.0, gained)[1]}"


def is_natural(active: Active) -> bool:
    """Whether nature sets the bound: a rate or a mass cannot be negative."""
    bound = BOUND.search(active.limit)
    user = active.limit.startswith(("slack", "force", "length", "stiffness"))
    return bool(bound and bound[1] == ">=" and float(bound[2]) == 0 and not user)


def limit_words(limit: str) -> str:
    """A limit's name with its value in mm, degrees, litres or bar where it is a length, an angle, a volume ..."""

    def convert(match: re.Match[str]) -> str:
        return quantity(float(match[1]), match[2])

    return re.sub(r"(-?\d[\d.]*(?:e[+-]?\d+)?) (m\^[23]|m|rad|Pa|K)(?=$|[\s);,])", convert, limit)


def floor_words(design: Design) -> list[str]:
    """What holds the objective up although no part can lower it."""
    words = []
    for floor in design.certificate.floors:
        row = design.after[floor.row]
        kind = "torque" if row.unit == "N m" else "force"
        size = f"{sig(row.peak)} {row.unit}"
        if floor.cause == "own":
            words.append(f"{floor.row}'s own {kind} ({size}), which no added part reaches")
        else:
            words.append(
                f"the payload: half of what it changes at {floor.row} ({size}), which no fixed design can beat"
            )
    return words


SHARES = {"motor": ", each as a share of its motor limit", "before": " as a share of its value before"}


def objective_words(design: Design) -> str:
    """`the peak over all driven joints`, with weights, caps and divisors where there are any."""
    words = []
    for aim in design.objective:
        if aim.goal in ("hold", "drive"):
            what = f"the {aim.norm} over {', '.join(aim.joints) if aim.joints else 'all driven joints'}"
        else:
            what = "the added mass" if aim.goal == "mass" else f"the {aim.norm} of the {aim.goal}"
            what = what.replace("wrench", "resultant on the platform")
        what += SHARES.get(aim.divisor or "", "")
        number, unit = shown(aim.cap or 0.0, aim.unit(design.mechanism))
        weight = "" if aim.weight == 1 else f"{plain(aim.weight)} x "
        words.append(f"{what}, kept below {plain(number)} {unit}" if aim.cap is not None else f"{weight}{what}")
    return "; ".join(words)


def limited_by(design: Design) -> list[str]:
    """Everything that holds the optimum where it is, the dearest first."""
    held = floor_words(design) + [price_words(active, design) for active in design.certificate.active]
    if not held and design.certificate.kind != "exact":
        return ["no limit or bound: only the places and kinds of the parts"]
    return held


def certificate_words(design: Design) -> str:
    """Kind, gap and what is known of the geometry, in one line."""
    c = design.certificate
    value, unit = shown(c.primal, c.unit)
    share = f" ({sig(c.gap / c.primal, 1)} of the value)" if c.primal > 0 else ""
    if c.kind == "bracketed":
        words = (
            f"bracketed: no geometry within the bounds leaves less than {sig(shown(c.dual, c.unit)[0])} {unit}, "
            f"{sig(100 * c.gap / c.primal, 2) if c.primal > 0 else '0'} % below this one; {c.boxes} boxes"
        )
    elif c.kind == "exact":
        words = f"exact: {sig(value, 2)} {unit} left, also at poses outside the sweep"
    else:
        words = f"convex, gap {sig(shown(c.gap, c.unit)[0], 2)} {unit}{share}"
    if design.geometry and c.kind == "exact":
        words += f"; geometry found from {c.starts} start{'s' * (c.starts != 1)}, none does better"
    elif design.geometry:
        optima = "1 optimum" if c.optima == 1 else f"{c.optima} different optima"
        apart = f", values up to {sig(shown(c.spread, c.unit)[0], 3)} {unit} apart" if c.optima > 1 else ""
        words += f"; geometry: local, {c.starts} start{'s' * (c.starts != 1)}, {optima}{apart}"
    rule = [f"quadrature good to {sig(c.quadrature, 1)} of the value"] if c.quadrature is not None else []
    return "; ".join([words, *rule, *c.flat])


def next_steps(design: Design) -> list[str]:
    """At most two things worth trying, the most promising first."""
    c = design.certificate
    steps = []
    if design.missed:
        steps.append("relax the target, free more geometry, or add a part")
    if own := [floor.row for floor in c.floors if floor.cause == "own"]:
        acting = " and ".join(own)
        steps.append(f"add a spring with {acting} between its ends: the rest cannot fall before that does")
    bounds = [active.limit for active in c.active if active.limit.split(" ")[0] in design.geometry]
    if bounds:
        steps.append(f"widen the bound {limit_words(bounds[0])} if there is room")
    elif dear := [active for active in c.active if not (is_natural(active) or _is_the_purpose(active))]:
        steps.append(f"relax {limit_words(dear[0].limit)}: it costs most")
    if not design.geometry and c.kind == "convex" and not c.floors:
        steps.append("free the attachment points (`shape` in the problem file)")
    if c.kind == "local" and c.optima > 1:
        steps.append("use more starts: the search found several optima")
    if not steps and design.verification is None:
        steps.append("verify in simulation and write the report")
    return steps[:2]


def _is_the_purpose(active: Active) -> bool:
    """Whether the limit is what the design is made for: balance in all motions, exact poses."""
    return "balanced in all motions" in active.limit or active.limit.startswith("exact")


def verified_words(design: Design) -> str:
    """Engine, poses, agreement and the bound between the samples; what is missing where nothing was verified."""
    found = design.verification
    if found is None:
        return "not yet: `equipoise verify` simulates the design at poses it never saw"
    error = sig(found.max_abs_error, 2)
    verdict = f"agrees to {error} {found.unit}" if found.agrees else f"DISAGREES by {error} {found.unit}"
    if found.agrees and not any(one.load for one in found.errors.values()):
        verdict = "nothing to hold at rest, and it agrees"
    poses = f"{found.poses:,}".replace(",", " ")
    words = f"{found.engine}, {poses} unseen poses, saved file reloaded: {verdict}"
    moved = motion_words(found.motion) if found.motion else []
    return "; ".join([words, *filter(None, [between_words(design, main_joint(design))]), *moved])


def between_words(design: Design, joint: str) -> str:
    """`between the samples at most 34.3 N m at elbow_joint`, or nothing where no bound is known."""
    bound = design.verification.bounds.get(joint) if design.verification else None
    if bound is None or not isfinite(bound.upper):
        return ""
    sure = "at most" if bound.rigorous else "estimated at most"
    return f"between the samples {sure} {sig(bound.upper)} {bound.unit} at {joint}"


def unloaded_words(design: Design) -> str:
    """The joints that the table leaves out, in one sentence, or nothing."""
    _, minor, none = sort_out(design.before, design.after)
    small = [f"{name} ({sig(max(design.before[name].peak, design.after[name].peak), 3)} {design.before[name].unit})"
             for name in minor]  # fmt: skip
    words = [f"under 1 % of the largest load: {', '.join(small)}"] if small else []
    return "; ".join(words + ([f"no load: {', '.join(none)}"] if none else []))
