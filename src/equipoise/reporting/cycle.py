"""A motion in time: shaking force and moment, what the motors supply, the hodograph of the force."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from equipoise.affine import Array
from equipoise.reporting import style
from equipoise.reporting.sample import Sample

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST = 6


def cycle(sample: Sample) -> Figure | None:
    """Force, moment and drive over time before and after; beside them the force in the plane that it fills most."""
    design = sample.design
    instants = design.sweep.instants
    if instants is None:
        return None
    first = slice(0, len(instants.time))  # scenarios follow one another
    order = np.argsort(instants.time, kind="stable")
    time = 1e3 * instants.time[order]
    before, after = (
        {name: rows[first][order] for name, rows in design.account(design.states, bare=bare).items()}
        for bare in (True, False)
    )
    names = ["force", "moment", *[joint for joint in design.mechanism.driven if joint in before][:MOST]]
    made = style.figure(10.4, 2.1 * len(names) + 0.35)
    grid = made.add_gridspec(len(names), 2, width_ratios=(3, 2))
    for row, name in enumerate(names):
        ax = made.add_subplot(grid[row, 0])
        for rows, colour, label in ((before, style.BEFORE, "before"), (after, style.AFTER, "after")):
            values = rows[name][:, 0] if rows[name].shape[1] == 1 else np.linalg.norm(rows[name], axis=1)
            ax.plot(time, values, color=colour, lw=1.4, label=label)
        bars = "" if before[name].shape[1] == 1 else "|"
        ax.set_ylabel(f"{bars}{name}{bars} [{design.before[name].unit}]")
        ax.axhline(0.0, color=style.FAINT, lw=0.8)
        if row == len(names) - 1:
            ax.set_xlabel("time [ms]")
    _hodograph(made.add_subplot(grid[: max(2, len(names) // 2), 1]), before["force"], after["force"])
    handles, labels = made.axes[0].get_legend_handles_labels()
    made.legend(handles, labels, loc="outside upper right", ncols=2)
    return made


def bearing_curves(sample: Sample) -> Figure | None:
    """Force in the most loaded bearings and pins over time, before and after."""
    from equipoise.machinery import bearing_forces

    design = sample.design
    instants = design.sweep.instants
    if instants is None:
        return None
    order = np.argsort(instants.time, kind="stable")  # scenarios follow one another: the first is drawn
    time, some = 1e3 * instants.time[order], design.states.take(slice(0, len(order)))
    before = bearing_forces(some)
    after = bearing_forces(some, design.balancers, design.values)
    sizes = [found.magnitude[order] for found in (before, after)]
    loads = np.maximum(*[size.max(axis=0) for size in sizes])
    most = np.argsort(-loads, kind="stable")[:MOST]
    most = most[loads[most] > 0]
    if not most.size:
        return None
    made = style.figure(10.4, 1.9 * ((len(most) + 1) // 2) + 0.35)
    axes = made.subplots((len(most) + 1) // 2, 2, squeeze=False, sharex=True).ravel()
    for ax, index in zip(axes, sorted(most), strict=False):
        for size, colour, label in zip(sizes, (style.BEFORE, style.AFTER), ("before", "after"), strict=True):
            ax.plot(time, size[:, index], color=colour, lw=1.4, label=label)
        bearing = before.bearings[index]
        ax.set_title(f"{bearing.name}: {bearing.between[0]} to {bearing.between[1]}")
        ax.set_ylabel("|F| [N]")
        ax.set_ylim(bottom=0.0)
    for ax in axes[len(most) :]:
        ax.set_visible(False)
    for ax in axes[max(0, len(most) - 2) : len(most)]:
        ax.set_xlabel("time [ms]")
    handles, labels = axes[0].get_legend_handles_labels()
    made.legend(handles, labels, loc="outside upper right", ncols=2)
    return made


def _hodograph(ax: Axes, before: Array, after: Array) -> None:
    """The tip of the force, along the two world axes that it uses most."""
    first, second = sorted(np.argsort(-np.ptp(before, axis=0), kind="stable")[:2].tolist())
    for rows, colour in ((before, style.BEFORE), (after, style.AFTER)):
        ax.plot(rows[:, first], rows[:, second], color=colour, lw=1.4)
    label: Any = "xyz"
    ax.set_xlabel(f"force along {label[first]} [N]")
    ax.set_ylabel(f"along {label[second]} [N]")
    ax.set_aspect("equal", adjustable="datalim")
