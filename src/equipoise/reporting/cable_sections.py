"""The report's words on a cable platform, and on the parts that are made for it."""

from __future__ import annotations

from equipoise.design import Design
from equipoise.make.synthesis import Part
from equipoise.reporting.cablewords import LEAST_WORDS, behaviour_lines, pose_words
from equipoise.reporting.markup import Raw, element, join, section, table
from equipoise.reporting.numbers import quantity, sig, span

MOST = 24
LEAD = (
    "Equilibria are where the platform rests with the motors off; in a corner sink it is drawn onto an anchor. "
    "Stiffness is principal, in N/m; an angle counts as the arc at the platform's length."
)


def platform(design: Design) -> Raw:
    """Reach, clearance, stiffness, equilibria, what the motors still do, and the floor of all springs."""
    found = design.cables
    if found is None:
        return Raw("")
    rows = [[label, words] for label, words in behaviour_lines(design)]
    kinds = [
        [
            one.kind,
            pose_words(design.mechanism, one.pose),
            " / ".join(sig(value, 3) for value in one.stiffness) or "none",
        ]
        for one in found.equilibria[:MOST]
    ]
    more = len(found.equilibria) - MOST
    return section(
        "The platform",
        table(["", ""], rows, numbers=2),
        join([element("h3", "Equilibria"), table(["kind", "pose", "stiffness [N/m]"], kinds, numbers=2)])
        if kinds
        else "",
        element("p", f"and {more} more, in design.json", class_="note") if more > 0 else "",
        _motors(design),
        lead=LEAD,
    )


def _motors(design: Design) -> Raw:
    motors = design.cables.motors if design.cables is not None else None
    if motors is None:
        return Raw("")
    rows = []
    for least, words in LEAST_WORDS.items():
        for what, told in (("motors alone", motors.alone[least]), ("with springs", motors.helped[least])):
            rows.append([f"{words}, {what}", sig(told.peak, 3), sig(told.rms, 3), sig(told.work, 3)])
        saved = motors.saved(least)
        rows.append([f"{words}, saved", sig(saved["peak"], 3), "", sig(saved["energy"], 3)])
    head = ["tensions of", "peak [N]", "rms [N]", "energy [J]"]
    return join([element("h3", f"Motors along the trajectory: {motors.label}"), table(head, rows, numbers=1)])


def made(part: Part) -> Raw:
    """What the workshop wants to know of a cam or drum, with its files."""
    facts = part.facts()
    rows = [
        ["turns", sig(facts["turns"], 3)],
        ["arm", span(facts["arm"], "m")],
        ["distance of the profile from the shaft", span(facts["radius"], "m")],
        ["radius of curvature", span(facts["curvature"], "m")],
        ["spring travels", span(facts["spring_travel"], "rad" if facts["kind"] == "DrumWithTorsion" else "m")],
        ["spring pulls", span(facts["spring_force"], "N m" if facts["kind"] == "DrumWithTorsion" else "N")],
        ["guide", "far away" if facts["guide"] is None else f"{quantity(facts['guide'], 'm')} from the shaft"],
        ["groove", "a helix" if facts["helical"] else "flat"],
        ["files", f"{part.name}.dxf, {part.name}.csv"],
    ]
    return table(["", ""], rows, numbers=1, kind="facts")
