"""Maps: the residual over two joints, and a norm over two geometry parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from equipoise.affine import Array
from equipoise.reporting import style
from equipoise.reporting.numbers import sig
from equipoise.reporting.sample import Sample

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

GRID = 61
LEVELS = 9


def residual_map(sample: Sample) -> Figure | None:
    """The worst counted |effort| over the two joints that move it most, before and after, on one colour scale.

    The other joints stay where each map's worst sample has them. None for mechanisms with one moving joint.
    """
    pair = leading_pair(sample)
    if pair is None:
        return None
    unit, columns = _counted(sample)
    found = []
    for effort in (sample.before, sample.after):
        pose = _worst_pose(effort, columns, len(sample.design.sweep.poses))
        found.append((pose, _grid(sample, pair, sample.design.sweep.poses[pose], columns)))
    if any(values is None for _, values in found):
        return None
    made = style.figure(10.4, 4.5)
    axes = made.subplots(1, 2, sharey=True)
    x, y = (sample.position(joint, sample.ticks(joint, GRID)) for joint in pair)
    top = max(float(np.max(values[index])) for index, (_, values) in enumerate(found) if values is not None)
    for index, (ax, word) in enumerate(zip(axes, ("before", "after"), strict=True)):
        pose, values = found[index]
        assert values is not None
        draw_field(ax, x, y, values[index], top)
        worst = sample.design.sweep.poses[pose][list(pair)]
        ax.plot(*(sample.position(j, v) for j, v in zip(pair, worst, strict=True)), "X", ms=10, mfc=style.BEFORE,
                mec="white", mew=1.3, clip_on=False, zorder=5)  # fmt: skip
        ax.set_title(f"{word}: at most {sig(float(np.max(values[index])), 3)} {unit}")
        ax.set_xlabel(sample.axis_label(pair[0]))
        for axis, joint, ticks in ((ax.xaxis, pair[0], x), (ax.yaxis, pair[1], y)):
            if not sample.is_slide(joint):
                style.degree_ticks(axis, ticks[0], ticks[-1])
    axes[0].set_ylabel(sample.axis_label(pair[1]))
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import BoundaryNorm

    colours = ScalarMappable(BoundaryNorm(_levels(top), style.ramp().N), style.ramp())
    made.colorbar(colours, ax=axes, label=f"largest of the counted joints [{unit}]", shrink=0.92, pad=0.02)
    return made


def leading_pair(sample: Sample) -> tuple[int, int] | None:
    """The two joints along which the worst counted effort, before and after, varies most at the worst pose."""
    _, columns = _counted(sample)
    if not columns:
        return None
    pose = sample.design.sweep.poses[_worst_pose(sample.before, columns, len(sample.design.sweep.poses))]
    moving = [joint for joint in range(len(sample.box)) if sample.moves(joint)]
    if len(moving) < 2:
        return None
    answer = sample.at(np.vstack([sample.line(joint, pose, 25) for joint in moving]))
    if answer is None:
        return None
    levels = [np.abs(effort[:, :, columns]).max(axis=(0, 2)).reshape(len(moving), 25) for effort in answer[1:]]
    change = sum(np.ptp(level, axis=1) for level in levels)
    order = np.argsort(-np.asarray(change), kind="stable")
    return moving[order[0]], moving[order[1]]


def _counted(sample: Sample) -> tuple[str, list[int]]:
    """The counted joints that share the main joint's unit, so that one scale serves."""
    units = sample.design.mechanism.driven_units
    unit = units[sample.main]
    return unit, [joint for joint in sample.counted if units[joint] == unit]


def _worst_pose(effort: Array, columns: list[int], count: int) -> int:
    return int(np.abs(effort[:, columns]).max(axis=1).argmax()) % count


def _grid(sample: Sample, pair: tuple[int, int], pose: Array, columns: list[int]) -> tuple[Array, Array] | None:
    """Worst |effort| (ny, nx) before and after over two joints; None where the loops do not close."""
    ticks = [sample.ticks(joint, GRID) for joint in pair]
    poses = np.tile(pose, (GRID * GRID, 1))
    mesh = np.meshgrid(*ticks)
    for joint, values in zip(pair, mesh, strict=True):
        poses[:, joint] = values.ravel()
    answer = sample.at(poses)
    if answer is None:
        return None
    before, after = (np.abs(effort[:, :, columns]).max(axis=(0, 2)).reshape(GRID, GRID) for effort in answer[1:])
    return before, after


def draw_field(ax: Axes, x: Array, y: Array, values: Array, top: float) -> Any:
    """Filled levels of values (ny, nx) from 0 to `top` and beyond, nan left out; what a colour bar is made of."""
    from matplotlib.colors import BoundaryNorm

    levels, colours = _levels(top), style.ramp()
    shown = np.ma.masked_invalid(values)
    beyond = "max" if np.nanmax(values) > levels[-1] else "neither"
    norm = BoundaryNorm(levels, colours.N, extend=beyond)
    drawn = ax.contourf(x, y, shown, levels, cmap=colours, norm=norm, extend=beyond)
    ax.contour(x, y, shown, levels[1:-1], colors="white", linewidths=0.5, alpha=0.7)
    ax.grid(visible=False)
    return drawn


def _levels(top: float) -> Array:
    from matplotlib.ticker import MaxNLocator

    return np.asarray(MaxNLocator(LEVELS).tick_values(0.0, max(top, 1e-12)))


def draw_map(
    ax: Axes,
    x: Array,
    y: Array,
    Z: Array,
    *,
    labels: tuple[str, str],
    optimum: tuple[float, float] | None,
    unit: str,
) -> None:
    """A norm over two geometry parameters, with the optimum, the bounds and what no design can keep.

    x (nx,) and y (ny,) span the bounds, in the units that the labels name; Z (ny, nx) in `unit`, nan where the
    limits conflict; optimum (x, y) is marked with its value's place, None leaves it out.
    """
    finite = np.isfinite(Z)
    ax.set_facecolor(style.FAINT)
    ax.grid(visible=False)
    if finite.any() and min(Z.shape) > 1:
        from matplotlib.ticker import MaxNLocator

        low, high = float(Z[finite].min()), float(np.quantile(Z[finite], 0.98))
        levels = MaxNLocator(11).tick_values(low, max(high, low + 1e-9 * abs(low) + 1e-300))
        masked = np.ma.masked_invalid(Z)
        filled = ax.contourf(x, y, masked, levels, cmap=style.ramp(), extend="max")
        lines = ax.contour(x, y, masked, levels, colors="white", linewidths=0.6)
        ax.clabel(lines, fontsize=8, fmt=lambda value: sig(value, 3))
        figure = ax.get_figure()
        if figure is not None:
            figure.colorbar(filled, ax=ax, label=unit, pad=0.02)
    if not finite.all():
        ax.contourf(x, y, (~finite).astype(float), [0.5, 1.5], colors="none", hatches=["///"])
        ax.plot([], [], "s", ms=10, mfc=style.FAINT, mec=style.MUTED, label="limits conflict")
    if optimum is not None:
        ax.plot(*optimum, "*", ms=16, mfc=style.BEFORE, mec="white", mew=1.2, label="optimum", zorder=5, clip_on=False)
    ax.set_xlim(float(np.min(x)), float(np.max(x)))
    ax.set_ylim(float(np.min(y)), float(np.max(y)))
    for spine in ax.spines.values():
        spine.set_visible(True)
        spine.set_color(style.INK)
        spine.set_linewidth(1.2)
    ax.set_xlabel(labels[0])
    ax.set_ylabel(labels[1])
    if ax.get_legend_handles_labels()[0]:
        ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
