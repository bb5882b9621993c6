"""Friction and the dead band in words and as a part of the page."""

from __future__ import annotations

from equipoise.design import Design
from equipoise.reporting.markup import Raw, element, prose, section, table
from equipoise.reporting.numbers import percent, quantity, sig, sort_out
from equipoise.rubbing import DeadBand

NOTE = (
    "Coulomb friction of pins, guides, ropes, meshes and seals under the springs' own forces, each joint moved by "
    "itself, with the friction loss that the robot's file states. The mechanism stays where friction is at least what "
    "balancing leaves; it drifts where the rest shrinks on the way and runs away where it grows. Set the coefficients "
    "with `friction` in the problem file; the defaults are unsourced."
)


def friction_words(design: Design) -> str:
    """The largest friction, and what becomes of the mechanism when motors let go; nothing where nothing rubs."""
    found = design.dead_band
    if found is None or not found.parts:
        return ""
    joint, row = max(found.rows.items(), key=lambda item: item[1].peak)
    return f"up to {sig(row.peak, 3)} {row.unit} at {joint}; motors off, it {_shares(found)}"


def friction_section(design: Design) -> Raw | str:
    """The page's part on friction; nothing where nothing rubs."""
    found = design.dead_band
    if found is None or not found.parts:
        return ""
    rows = []
    matter = sort_out(design.before, design.after)[0]
    for joint in [joint for joint in found.rows if joint in matter]:
        row, left = found.rows[joint], design.after[joint]
        low, high = (sig(max(0.0, left.peak + side * row.peak), 3) for side in (-1, 1))
        rows.append([f"{joint} [{row.unit}]", sig(left.peak, 3), sig(row.peak, 3), sig(row.rms, 3), f"{low} to {high}"])
    parts = ", ".join(f"{name} {sig(value, 3)}" for name, value in found.parts.items())
    f = found.friction
    used = (
        f"Coefficients: pins {f.pin:g} at a radius of {quantity(f.pin_radius, 'm')}, guides {f.slide:g}; lost: ropes "
        f"{percent(f.rope)} per half turn, meshes {percent(f.mesh)}, seals {percent(f.seal)}. Largest by part: {parts}."
    )
    return section(
        "Friction and the dead band",
        table(["joint", "left, peak", "friction, peak", "friction, rms", "peak, moving down to up"], rows, numbers=1),
        element("p", used),
        element("p", prose(NOTE), class_="note"),
        lead=f"With the motors off the mechanism {_shares(found)} ({found.poses} rows of poses).",
    )


def _shares(found: DeadBand) -> str:
    told = (("stays", found.stays), ("drifts to a rest", found.drifts), ("runs away", found.runs))
    words = [f"{what} in {percent(share)}" for what, share in told if share > 0]
    return ", ".join(words) + " of the poses"
