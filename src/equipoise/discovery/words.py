"""A front in words."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from equipoise.balancers.laws import ZeroFreeLength
from equipoise.balancers.paths import Cable, Line
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.discovery.alternative import Alternative
from equipoise.discovery.front import Bound, Discovery
from equipoise.interference.findings import clash_words, room_words
from equipoise.loops import ancestors
from equipoise.parts import Part
from equipoise.reporting import limitwords, phrases
from equipoise.reporting.alternatives import meaning, reached_words
from equipoise.reporting.layout import blank_repeats, labelled, table, wrapped
from equipoise.reporting.numbers import headed, percent, plain, quantity, shown, sig
from equipoise.reporting.tolerance import tolerance_words
from equipoise.reporting.words import part_lines

CAUSES = {
    "payload": "half of what the payload's own torque varies by",
    "own": "its own load, which no candidate reaches",
}
NOTHING = 1e-9
"""Share of the value before below which nothing is left."""
FAINT = 0.01
"""Share of the highest floor below which floors are only named."""
HEAVY = 20.0
"""Multiple of the mechanism's weight above which a spring's force is remarked on."""
CLOSE = 1.01
"""Multiple of a floor at which it counts as reached."""


def summary(front: Discovery, out: Path | None = None) -> str:
    """The front as the console prints it: a table, floors, what was looked at, then every design.

    out is the folder that its designs are written to.
    """
    mechanism, sweep = front.designs[0].mechanism, front.designs[0].sweep
    joints = len(mechanism.driven)
    lines = wrapped(
        f"{mechanism.name or 'mechanism'}, {joints} driven joint{'s' * (joints != 1)}, {plain(mechanism.mass)} kg; "
        f"{sweep.describe()}"
    )
    lines += front_table(front)
    for label, words in (*told(front), *_looked(front)):
        lines += labelled(label, words)
    for index in range(len(front.designs)):
        lines += ["", *_design(front, index)]
    lines.append("")
    for step in next_steps(front, out):
        lines += labelled("next", step)
    if front.stopped:
        lines.append("the search was stopped by hand: these designs were finished")
    return "\n".join(blank_repeats(lines))


def front_table(front: Discovery) -> list[str]:
    """One line per number of parts: what is added, what is left of the objective, and what holds it there."""
    unit = headed(front.unit)
    known = bool(front.highs)
    band = [f"95 % [{unit}]"] if known else []
    head = ["mass added", f"{front.aim.norm} [{unit}]", "of before", *band, "limited by"]
    body = [["-", number(front, front.before), "100 %", *([""] if known else []), ""]]
    for index, (design, value) in enumerate(zip(front.designs, front.values, strict=True)):
        mass = quantity(design.added_mass, "kg", 3) if design.added_mass > 0 else "-"
        mark = "; meets the target" if front.aim.target is not None and not design.missed else ""
        high = [number(front, front.highs[index])] if known else []
        body.append([mass, number(front, value), share(front, value), *high, limited_words(front, index) + mark])
    names = ["no parts", *(counted(len(design.balancers)) for design in front.designs)]
    return table(names, head, body)


def counted(count: int) -> str:
    """`1 part`, `2 parts`."""
    return f"{count} part{'s' * (count != 1)}"


def number(front: Discovery, value: float) -> str:
    """A value of the objective without its unit; what is at rounding level is 0."""
    return sig(shown(value, front.unit)[0], 3) if abs(value) > NOTHING * front.before else "0"


def value_words(front: Discovery, value: float) -> str:
    """A value of the objective with its unit."""
    return f"{number(front, value)} {shown(0.0, front.unit)[1]}".rstrip()


def share(front: Discovery, value: float) -> str:
    """A value as a share of that without parts."""
    return percent(value / front.before) if value > NOTHING * front.before else "0 %"


def limited_words(front: Discovery, index: int) -> str:
    """What holds one design's value where it is, in a few words."""
    design, value = front.designs[index], front.values[index]
    if value <= NOTHING * front.before:
        return "nothing is left"
    for bound in front.bounds:
        if bound.value * CLOSE >= value:
            return f"floor: {bound.row}'s own load" if bound.cause == "own" else f"floor: the payload at {bound.row}"
    for floor in design.certificate.floors:
        return f"{floor.row}, which no part reaches" if floor.cause == "own" else f"the payload at {floor.row}"
    dear = [active for active in design.certificate.active if not limitwords.is_natural(active)]
    return limitwords.limit_words(dear[0].limit) if dear else "number and kind of the parts"


def limits(front: Discovery, index: int) -> list[str]:
    """What holds one design's value where it is: the floor that it reaches, else at most three limits, the dearest."""
    value = front.values[index]
    reached = [bound for bound in front.bounds if NOTHING * front.before < value <= bound.value * CLOSE]
    return [f"the floor at {bound_words(bound)}" for bound in reached] or limitwords.limited_by(front.designs[index])[
        :3
    ]


def told(front: Discovery) -> list[tuple[str, str]]:
    """The target and the floors, each with its label."""
    lines = []
    if front.aim.target is not None:
        met = not front.designs[front.recommended].missed
        with_ = counted(len(front.designs[front.recommended].balancers))
        asked = quantity(front.aim.target, front.unit) + (", 95 % value" if front.aim.judged == "band" else "")
        lines.append(("target", f"{asked}: {f'met with {with_}' if met else 'missed'}"))
    matter, faint = floors(front)
    lines += [("floor", bound_words(bound)) for bound in matter]
    return [*lines, *([("", f"next to nothing: {', '.join(faint)}")] if faint else [])]


def floors(front: Discovery) -> tuple[list[Bound], list[str]]:
    """The floors that matter, highest first, and the joints whose floors are far below the highest."""
    highest = max((bound.value for bound in front.bounds), default=0.0)
    matter = [bound for bound in front.bounds if bound.value >= FAINT * highest]
    rows = dict.fromkeys(bound.row for bound in front.bounds)
    told = {bound.row for bound in matter}
    return sorted(matter, key=lambda bound: -bound.value), [row for row in rows if row not in told]


def _looked(front: Discovery) -> list[tuple[str, str]]:
    """What was searched, and what the filters removed."""
    words = (
        f"{front.candidates} candidates over {front.poses} states: {', '.join(front.pairs)}; points "
        f"{quantity(front.spacing, 'm', 3)} apart, within {quantity(front.margin, 'm', 3)} of the links"
    )
    removed = [f"{count} ({reason})" for reason, count in front.refused.items() if count]
    lines = [("looked at", words), *([("left out", ", ".join(removed))] if removed else [])]
    lines += [("note", note) for note in front.notes]
    return [*lines, *([("note", meaning(front.designs[0]))] if front.alternatives else [])]


def _design(front: Discovery, index: int) -> list[str]:
    """One design: its parts, what limits it, what its springs run into, how sure it is, and what lost to it."""
    design = front.designs[index]
    count = len(design.balancers)
    lines = labelled(
        f"{counted(count)}:", f"{front.aim.norm} {value_words(front, front.values[index])}, "
        f"{share(front, front.values[index])} of before"
    )  # fmt: skip
    for part, balancer in zip(design.parts(), design.balancers, strict=True):
        lines += part_lines(part, balancer, design)
    for words in limits(front, index):
        lines += labelled("limited by", words)
    for words in room_words(design):
        lines += labelled("room", words)
    for words in clash_words(front.clashes[index]) if front.clashes else ():
        lines += labelled("clashes", words)
    lines += labelled("certificate", phrases.certificate_words(design))
    if design.verification is not None:
        lines += labelled("verified", phrases.verified_words(design))
    for label, words in tolerance_words(design):
        lines += labelled(label, words)
    for one in design.alternatives:
        lines += labelled("lost", alternative_words(design, one))
    return lines


def alternative_words(design: Design, one: Alternative) -> str:
    """A choice that lost, with what it reached and why it lost."""
    count = "" if one.springs == len(design.balancers) else f"{counted(one.springs)}, "
    return f"{count}{' and '.join(one.places)}, {reached_words(design, one)}: {one.reason}"


def next_steps(front: Discovery, out: Path | None = None) -> list[str]:
    """At most three things worth trying."""
    best = front.designs[front.recommended]
    springs = [b for b in best.balancers if isinstance(b, Spring)]
    steps = []
    if best.missed:
        steps.append("allow more parts (`springs`), other `kinds`, or a wider `margin`: the target is missed")
    steps += [*_overdone(best), *_housed(front, best)]
    names = {balancer.name for balancer in best.balancers}
    met = front.clashes[front.recommended] if front.clashes else ()
    collides = any(clash.depth and clash.what not in names for clash in met)
    if collides and any(isinstance(spring.path, Line) for spring in springs):
        steps.append("`avoid: bodies` in the `discover` block keeps springs out of the links")
    if any(isinstance(spring.law, ZeroFreeLength) for spring in springs):
        steps.append("a spring of zero free length is a coil with a cable over a guide: `kinds: [cable]` lays them out")
    file = f"{out or 'DIR'}/{front.folder(best)}/design.json"
    first = "" if out else "`--out DIR` writes the designs; "
    if any(spring.path.unit == "m" and not isinstance(spring.law, Part) for spring in springs):
        steps.append("`--make SH` looks for springs that can be wound from the start, their own masses counted")
        steps.append(f"{first}`equipoise pick {file}` finds parts one can buy or wind")
    else:
        steps.append(f"{first}`equipoise report {file}` draws one")
    return steps[:3]


def _housed(front: Discovery, design: Design) -> list[str]:
    """A housing for coils that weigh on the motors they serve, where more is left than the floor."""
    floor = max((bound.value for bound in front.bounds), default=0.0)
    if front.values[front.recommended] <= CLOSE * floor:
        return []
    model = design.mechanism.model
    for balancer in design.balancers:
        if isinstance(balancer, Spring) and isinstance(balancer.path, Cable):
            carrier, hook = (balancer.path.through[index].body for index in (0, -1))
            deep = [len(ancestors(model, design.mechanism.body_id(body))) for body in (carrier, hook)]
            if deep[1] < deep[0]:
                asked = f"kinds: [{{cable: {{rooms: {{{hook}: 500 mm}}}}}}]"
                return [f"coils in a housing on {hook} do not weigh on the arm: `{asked}`"]
    return []


def _overdone(design: Design) -> list[str]:
    """A force that no robot of this weight is built to bear, and what limits it."""
    weight = design.mechanism.mass * float(np.linalg.norm(design.mechanism.gravity))
    pulls = {part["name"]: max(map(abs, part["force"])) for part in design.parts() if part.get("unit") == "m"}
    name = max(pulls, key=lambda spring: pulls[spring], default="")
    if not pulls or pulls[name] <= HEAVY * weight:
        return []
    times = f"{sig(pulls[name] / weight, 2)} times the mechanism's weight"
    return [
        f"{name} pulls {quantity(pulls[name], 'N', 3)}, {times}: a smaller `force` of its kind looks for gentler ones"
    ]


def bound_words(bound: Bound) -> str:
    """A floor in words."""
    value, unit = shown(bound.value, bound.unit)
    return f"{bound.row}: {sig(value, 3)} {unit}, {CAUSES[bound.cause]}"
