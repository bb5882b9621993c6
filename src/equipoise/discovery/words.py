"""A front in words."""

from __future__ import annotations

from collections.abc import Sequence

from equipoise.balancers.paths import Cable
from equipoise.balancers.spring import Spring
from equipoise.discovery.front import Bound, Discovery
from equipoise.units import text

CAUSES = {
    "payload": "half of what the payload's own torque varies by",
    "own": "its own load, which no candidate reaches",
}


def summary(front: Discovery) -> str:
    """The front as the console prints it."""
    design = front.designs[0]
    lines = [
        f"{design.mechanism.name}, {len(design.mechanism.driven)} driven joints; {design.sweep.describe()}",
        f"dictionary  {front.candidates} candidates x {front.poses} states, rank {front.rank}; "
        f"{', '.join(front.pairs)}; points {text(front.spacing, 'm', 3)} apart, {text(front.margin, 'm', 3)} about "
        "the links",
    ]
    removed = [f"{count} {reason}" for reason, count in front.refused.items() if count]
    lines += [f"left out    {'; '.join(removed)}"] if removed else []
    lines.append(f"before      {front.aim.norm} {text(front.before, front.unit)}")
    for index, (one, value) in enumerate(zip(front.designs, front.values, strict=True)):
        mark = "  <- meets the target" if front.aim.target is not None and not one.missed else ""
        word = f"{len(one.balancers)} part{'s' * (len(one.balancers) > 1)}"
        mass = f", {text(one.added_mass, 'kg', 3)}" if one.added_mass > 0 else ""
        kind = one.certificate.kind
        lines.append(f"{word:<12}{front.aim.norm} {text(value, front.unit)}{mass} ({kind}){mark}")
        lines += [f"            {line}" for line in parts(front, index)]
    lines += [f"floor       {bound_words(bound)}" for bound in front.bounds]
    for one in front.alternatives:
        lines.append(
            f"lost        {one.springs} at {', '.join(one.places)}: {text(one.value, front.unit)}; {one.reason}"
        )
    lines += [f"note        {note}" for note in front.notes]
    if front.stopped:
        lines.append("the search was stopped by hand: these designs were finished")
    return "\n".join(lines)


def parts(front: Discovery, index: int) -> list[str]:
    """One line per part of a design."""
    found = []
    design = front.designs[index]
    for part, balancer in zip(design.parts(), design.balancers, strict=True):
        ends = " to ".join(place(end["body"], end["at"]) for end in part["ends"])
        if isinstance(balancer, Spring) and isinstance(balancer.path, Cable):
            ends = "cable " + " over ".join(place(item.body, item.at) for item in balancer.path.through)
        if part["kind"] == "counterweight":
            found.append(f"{part['name']}: {text(part['mass'], 'kg')} at {ends}")
            continue
        values = ", ".join(
            f"{name} {text(value, part['units'][name])}" for name, value in part["parameters"].items() if value
        )
        force = part["force"]
        unit = "N" if part["unit"] == "m" else "N m"
        found.append(f"{part['name']}: {part['law']}, {values}; {ends}; {force[0]:.4g} to {force[1]:.4g} {unit}")
    return found


def bound_words(bound: Bound) -> str:
    """A floor in words."""
    return f"{bound.row}: {text(bound.value, bound.unit)}, {CAUSES[bound.cause]}"


def place(body: str, at: Sequence[float]) -> str:
    """A point of a body, mm."""
    return f"{body} ({', '.join(f'{1e3 * v:.4g}' for v in at)}) mm"
