"""Holding torque before and after, joint by joint: along the joint and over the whole sweep."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from equipoise.affine import Array
from equipoise.reporting import style
from equipoise.reporting.numbers import effort_word, plain, sig
from equipoise.reporting.sample import Sample

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST = 6
OFF_SCALE = 1.7
WIDTHS = (3.0, 1.5)
"""Before is drawn wider than after, so that both show where nothing changed."""


def curves(sample: Sample) -> Figure | None:
    """Two graphs for each joint that matters: effort along the joint, and what share of the sweep exceeds it."""
    joints = sample.matter[:MOST]
    if not joints:
        return None
    made = style.figure(10.4, 2.75 * len(joints) + 0.35)
    axes = made.subplots(len(joints), 2, squeeze=False, gridspec_kw={"width_ratios": (3, 2)})
    for row, joint in zip(axes, joints, strict=True):
        _along(row[0], sample, joint)
        _duration(row[1], sample, joint)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    if sample.scenarios > 1:
        from matplotlib.patches import Patch

        handles, labels = [*handles, Patch(color=style.MUTED, alpha=0.3)], [*labels, "band: all payloads"]
    made.legend(handles, labels, loc="outside upper right", ncols=len(handles))
    return made


def _along(ax: Axes, sample: Sample, joint: int) -> None:
    """Effort at a joint against its own position; over several payloads a band with its outer edges."""
    name = sample.design.mechanism.driven[joint]
    row = sample.design.before[name]
    pose, _ = sample.worst(sample.before, joint)
    poses = sample.line(joint, sample.design.sweep.poses[pose])
    answer = sample.at(poses) if sample.moves(joint) else None
    if answer is None:
        x = sample.position(joint, sample.design.states.driven[:, joint])
        for effort, colour, label in _pairs(sample.before, sample.after):
            ax.plot(x, effort[:, joint], ".", ms=3, color=colour, alpha=0.5, label=label)
    else:
        x = sample.position(joint, poses[:, joint])
        for (effort, colour, label), width in zip(_pairs(*answer[1:]), WIDTHS, strict=True):
            low, high = effort[:, :, joint].min(axis=0), effort[:, :, joint].max(axis=0)
            if sample.scenarios > 1:
                ax.fill_between(x, low, high, color=colour, alpha=0.18, lw=0)
                ax.plot(x, low, color=colour, lw=1.0)
            ax.plot(x, high, color=colour, lw=width, ls=_dash(sample, joint, colour), label=label)
        ax.set_xlim(x[0], x[-1])
    ax.axhline(0.0, color=style.MUTED, lw=0.8)
    span = ax.get_xlim()
    if not sample.is_slide(joint):
        style.degree_ticks(ax.xaxis, *span)
    ax.set_title(name)
    ax.set_xlabel(sample.axis_label(joint))
    ax.set_ylabel(f"holding {effort_word(row.unit)} [{row.unit}]")
    _limit(ax, row.limit, row.unit, max(row.peak, sample.design.after[name].peak))


def _unchanged(sample: Sample, joint: int) -> bool:
    """Whether the parts leave a joint's effort as it was."""
    change = np.abs(sample.after[:, joint] - sample.before[:, joint]).max()
    return bool(change <= 1e-6 * np.abs(sample.before[:, joint]).max())


def _dash(sample: Sample, joint: int, colour: str) -> Any:
    """Dashes for `after` where it lies on `before`, so that both colours show."""
    return (0, (4, 4)) if colour == style.AFTER and _unchanged(sample, joint) else "-"


def _pairs(before: Array, after: Array) -> list[tuple[Array, str, str]]:
    return [(before, style.BEFORE, "before"), (after, style.AFTER, "after")]


def _limit(ax: Axes, limit: float | None, unit: str, peak: float) -> None:
    """The motor limit as a line where it fits on the graph, else in words."""
    if limit is None:
        words = "no motor limit in the file"
    elif limit <= OFF_SCALE * peak:
        for side in (-limit, limit):
            ax.axhline(side, color=style.LIMIT, lw=1.2, ls=(0, (5, 3)))
        words = f"motor limit ±{plain(limit)} {unit}"
    else:
        words = f"motor limit {plain(limit)} {unit}, beyond the graph"
    ax.set_title(words, loc="right", fontsize=8.5, color=style.LIMIT if limit else style.MUTED, weight="normal")


def _duration(ax: Axes, sample: Sample, joint: int) -> None:
    """|effort| that a given share of the sweep exceeds: the area under the curve is the mean."""
    design = sample.design
    name = design.mechanism.driven[joint]
    weight = design.states.weight / design.states.weight.sum()
    for (effort, colour, _), width in zip(_pairs(sample.before, sample.after), WIDTHS, strict=True):
        size = np.abs(effort[:, joint])
        order = np.argsort(-size)
        dash = _dash(sample, joint, colour)
        share = np.concatenate([[0.0], 100 * np.cumsum(weight[order])])
        ax.step(share, np.concatenate([size[order][:1], size[order]]), color=colour, lw=width, ls=dash, where="pre")
    after, before = design.after[name], design.before[name]
    ax.set_xlim(0, 100)
    ax.set_ylim(bottom=0)
    ax.set_xlabel("share of the sweep that exceeds it [%]")
    ax.set_ylabel(f"|{effort_word(before.unit)}| [{before.unit}]")
    same = _unchanged(sample, joint)
    words = f"{sig(before.rms, 3)} {before.unit}, unchanged"
    words = words if same else f"{sig(before.rms, 3)} → {sig(after.rms, 3)} {before.unit}"
    ax.set_title(f"rms {words}", fontsize=9.5, weight="normal")


__all__ = ["curves"]
