"""All pictures of a design, in the order in which the report shows them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from equipoise.design import Design
from equipoise.make.synthesis import Part
from equipoise.reporting import style
from equipoise.reporting.cam_plots import cam_drawing
from equipoise.reporting.curves import curves
from equipoise.reporting.cycle import bearing_curves, cycle
from equipoise.reporting.drawing import drawing
from equipoise.reporting.ledger import ledger
from equipoise.reporting.maps import draw_map, residual_map
from equipoise.reporting.platform_plots import motor_tensions, resultant_map, tension_curves
from equipoise.reporting.sample import Sample

if TYPE_CHECKING:
    from matplotlib.figure import Figure


Wanted = tuple[str, "Callable[[Sample], Figure | None]", str, str]
"""Title, how it is drawn, what it shows in words, caption."""


@dataclass(frozen=True)
class Picture:
    """A picture as a data address, with its title, what it shows, and how to read it."""

    title: str
    address: str
    alternative: str
    caption: str


def pictures(design: Design) -> list[Picture]:
    """Every picture that this design has something to show in."""
    sample = Sample(design)
    name = design.mechanism.name
    wanted: list[Wanted] = [
        (
            "The mechanism with its parts",
            drawing,
            f"{name} with its springs and counterweights in two poses",
            "Skeleton from joint to joint; filled dots are driven joints. Below each title: joint position, holding "
            "effort before → after. Joints without load are drawn at their reference.",
        ),
        (
            "Along the joints, and over the sweep",
            curves,
            f"holding effort of {name} before and after, joint by joint",
            "Left: along one joint, the others where the joint's worst sample has them; with several payloads a band, "
            "its strong edge the upper one. Right: the magnitude that a share of the sweep exceeds.",
        ),
        (
            "Where the load is",
            residual_map,
            f"largest holding effort of {name} over two joints, before and after",
            "The largest magnitude among the counted joints (and payloads) over the two joints that change it most; "
            "the cross marks the worst sample, where the other joints are held.",
        ),
        (
            "Energy ledger",
            ledger,
            f"energy of gravity, of each part and their sum along a joint of {name}",
            "Each curve counts from its own least value; a motor holds the slope of the total, so a level total needs "
            "no motor. The other joints stay at the worst sample, with its payload.",
        ),
    ]
    if design.sweep.moves is not None:
        wanted = [wanted[0], (
            "Over the motion",
            cycle,
            f"force, moment and drive of {name} over time, before and after",
            "The wrench of the base on the mechanism, weight left out, and what the motors supply. Right: the path of "
            "the force's tip.",
        ), (
            "Force in the bearings",
            bearing_curves,
            f"force in the bearings and pins of {name} over time, before and after",
            "The most loaded bearings and pins; the force is the magnitude, weight and springs included.",
        )]  # fmt: skip
    elif design.cables is not None:
        wanted = [wanted[0], *_of_cables(name)]
    made = []
    for title, draw, alternative, caption in wanted:
        with style.styled():
            figure = draw(sample)
        if figure is not None:
            made.append(Picture(title, style.picture(figure), alternative, caption))
    return made


def _of_cables(name: str) -> list[Wanted]:
    return [
        (
            "Resultant over the workspace",
            resultant_map,
            f"resultant on the platform of {name} over two coordinates, with its equilibria",
            "Left: what cables and weight pull on the platform, the other coordinates in the middle of the sweep; with "
            "several payloads the largest. Marks: where it rests with the motors off. Right: over the whole sweep.",
        ),
        (
            "Tension over cable length",
            tension_curves,
            f"tension of each spring of {name} over the length of its cable",
            "Shaded: the lengths of the sweep; dashed lines: limits. The tension is the cable's own, whatever "
            "sits between reel and spring.",
        ),
        (
            "What the motors still do",
            motor_tensions,
            f"motor tensions of {name} along the trajectory without and with springs",
            "Tensions that hold the platform along the trajectory, less what the springs pull; energy is the sum of "
            "|tension x change of length|, nothing recovered.",
        ),
    ]


def part_picture(part: Part) -> Picture:
    """A cam or drum drawn, and the force that it makes."""
    with style.styled():
        figure = cam_drawing(part)
    return Picture(
        f"Part to make: {part.name}",
        style.picture(figure),
        f"profile of {part.name} and the force that it makes",
        "The profile in its own frame at angle 0, with the cord at the start, the middle and the end of the travel.",
    )


def draw_part(part: Part, folder: Path) -> Path:
    """`<name>.svg`: the drawing of a cam or drum."""
    with style.styled():
        return style.save(cam_drawing(part), folder / f"{part.name}.svg")


__all__ = [
    "Picture",
    "curves",
    "draw_map",
    "draw_part",
    "drawing",
    "ledger",
    "part_picture",
    "pictures",
    "residual_map",
]
