"""The energy ledger: what gravity takes and the parts give back along the main joint."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from equipoise.affine import Affine, Array
from equipoise.reporting import style
from equipoise.reporting.glyphs import part_colour
from equipoise.reporting.numbers import sig
from equipoise.reporting.sample import Sample

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def ledger(sample: Sample) -> Figure | None:
    """Energy of gravity, of every part and of their sum along the main joint, the others at its worst pose.

    Every curve counts from its own least value; a level total means that nothing is left to hold.
    """
    entries = balance_sheet(sample)
    if entries is None:
        return None
    x, gravity, parts, total = entries
    made = style.figure(10.4, 3.7)
    ax = made.subplots()
    ax.plot(x, gravity, color=style.BEFORE, label="gravity")
    for number, (name, energy) in enumerate(parts.items()):
        ax.plot(x, energy, color=part_colour(number), lw=1.5, label=name)
    ax.plot(x, total, color=style.AFTER, lw=2.6, label="total")
    ax.set_xlim(x[0], x[-1])
    ax.margins(y=0.08)
    if not sample.is_slide(sample.main):
        style.degree_ticks(ax.xaxis, x[0], x[-1])
    ax.set_xlabel(sample.axis_label(sample.main))
    ax.set_ylabel("energy above its least [J]")
    ax.set_title(
        f"The total varies by {sig(float(np.ptp(total)), 3)} J, gravity alone by {sig(float(np.ptp(gravity)), 3)} J"
    )
    made.legend(loc="outside right upper")
    return made


def balance_sheet(sample: Sample) -> tuple[Array, Array, dict[str, Array], Array] | None:
    """Joint positions (M,) in deg or mm, and energies (M,), J, above their least: gravity, parts by name, total."""
    design, joint = sample.design, sample.main
    if not sample.moves(joint):
        return None
    pose, scenario = sample.worst(sample.before, joint)
    poses = sample.line(joint, design.sweep.poses[pose])
    answer = sample.at(poses)
    if answer is None:
        return None
    states = answer[0]
    rows = slice(scenario * len(poses), (scenario + 1) * len(poses))

    def energy(affine: Affine) -> Array:
        return _value(affine, design.values)[rows]

    gravity = energy(design.mechanism.effort(states, "energy"))
    parts = {balancer.name: energy(balancer.effort(states, "energy")) for balancer in design.balancers}
    total = gravity + sum(parts.values(), np.zeros(len(poses)))
    lifted = {name: values - values.min() for name, values in parts.items()}
    return sample.position(joint, poses[:, joint]), gravity - gravity.min(), lifted, total - total.min()


def _value(affine: Affine, values: Mapping[str, float]) -> Array:
    return affine.at(np.array([values[unknown.name] for unknown in affine.unknowns]))[:, 0]
