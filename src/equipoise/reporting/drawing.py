"""The mechanism drawn with its springs in two poses."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.spring import Spring
from equipoise.reporting import style
from equipoise.reporting.glyphs import draw
from equipoise.reporting.numbers import UNSEEN, plain, sig
from equipoise.reporting.sample import Sample
from equipoise.reporting.scene import Scene, scene
from equipoise.reporting.view import View, is_planar, side

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 10.4
TALLEST = 4.6
"""inches of the whole drawing's width and of one view's height."""

LISTED = 4


@dataclass(frozen=True, eq=False)
class Posed:
    """A pose worth drawing: its scene, its view, a title and what the joints hold there."""

    scene: Scene
    view: View
    title: str
    caption: str
    planar: bool


def drawing(sample: Sample) -> Figure | None:
    """The heaviest pose and one far from it, from the side and, for spatial arms, from a corner; one scale."""
    poses = posed(sample)
    if not poses:
        return None
    corners = [False] if all(pose.planar for pose in poses) else [False, True]
    frames = [[_frame(pose, corner) for pose in poses] for corner in corners]
    widths = np.max([[high[0] - low[0] for low, high in row] for row in frames], axis=0)
    widths = np.maximum(widths, 0.7 * widths.sum() / len(poses))
    heights = np.array([max(high[1] - low[1] for low, high in row) for row in frames])
    inch = min(WIDTH / widths.sum(), TALLEST / heights.max())
    lines = max(pose.caption.count("\n") + 1 for pose in poses)
    made = style.figure(WIDTH, float(inch * heights.sum()) + 0.05 * len(corners) + 0.35 + 0.18 * lines)
    axes = made.subplots(
        len(corners), len(poses), squeeze=False, gridspec_kw={"width_ratios": widths, "height_ratios": heights}
    )
    for row, corner in enumerate(corners):
        for column, pose in enumerate(poses):
            ax = axes[row, column]
            draw(ax, sample, pose.scene, pose.view.corner() if corner else pose.view)
            _fit(ax, frames[row][column], (float(widths[column]), float(heights[row])))
            if row == 0:
                ax.set_title(pose.title, fontsize=11, pad=8 + 12.5 * lines)
                ax.annotate(pose.caption, (0, 1), xycoords="axes fraction", xytext=(0, 3), textcoords="offset points",
                            va="bottom", color=style.MUTED, fontsize=9)  # fmt: skip
            if column == 0:
                _furniture(ax)
    return made


def posed(sample: Sample) -> list[Posed]:
    """The pose that loads the main joint most without the parts, and one well away from it."""
    design = sample.design
    pose, scenario = sample.worst(sample.before, sample.main)
    other, title = _apart(sample, pose, scenario)
    if design.cables is not None:
        chosen, other, pose = _of_platform(sample), None, 0
    else:
        chosen = [(sample.calm(design.sweep.poses[pose]), "Heaviest pose")]
        chosen += [] if other is None else [(sample.calm(design.sweep.poses[other]), title)]
    answer = sample.at(np.array([pose for pose, _ in chosen]))
    if answer is None:
        # Loops may not close with the idle joints at rest; the sampled poses themselves do.
        answer = sample.at(design.sweep.poses[[pose] if other is None else [pose, other]])
    if answer is None:
        return []
    states, before, after = answer
    found = []
    for index, (_, title) in enumerate(chosen):
        row = scenario * len(chosen) + index
        view = side(design, states, row, sample.main)
        caption = _caption(sample, states.driven[row], before[scenario, index], after[scenario, index])
        found.append(Posed(scene(design, states, row), view, title, caption, is_planar(states, view)))
    return found


def _of_platform(sample: Sample) -> list[tuple[Array, str]]:
    """The middle of the sweep, and its pose farthest from there in the slides."""
    design = sample.design
    assert design.cables is not None
    middle = np.array(list(design.cables.middle.values()))
    slides = [joint for joint in range(len(middle)) if sample.is_slide(joint)]
    poses = design.sweep.poses[design.sweep.weight > 0]
    far = poses[np.linalg.norm(poses[:, slides] - middle[slides], axis=1).argmax()]
    return [(middle, "Middle of the sweep"), (far, "Near its edge")]


def _apart(sample: Sample, pose: int, scenario: int) -> tuple[int | None, str]:
    """The sampled pose where the first spring's length is farthest from the heaviest pose's, feet on the ground."""
    design = sample.design
    count = len(design.sweep.poses)
    if count == 1:
        return None, ""
    rows = slice(scenario * count, (scenario + 1) * count)
    xpos = design.states.kin.xpos[rows]
    springs = [balancer for balancer in design.balancers if isinstance(balancer, Spring)]
    height = (xpos @ -design.mechanism.gravity).min(axis=1)
    if springs:
        length = springs[0].path.deform(design.states)[0][rows]
        measure = np.abs(length - length[pose])
        word = "shortest" if length[measure.argmax()] < length[pose] else "longest"
        title = f"{springs[0].name} near its {word}"
    else:
        measure, title = np.abs(xpos - xpos[pose]).sum(axis=(1, 2)), "A pose far from it"
    if measure.max() <= 0:
        return None, ""
    near = np.flatnonzero(measure >= 0.9 * measure.max())
    return int(near[height[near].argmax()]), title


def _caption(sample: Sample, driven: Array, before: Array, after: Array) -> str:
    lines = []
    for joint in sample.matter[:LISTED]:
        name = sample.design.mechanism.driven[joint]
        unit = sample.design.before[name].unit
        position = round(float(sample.position(joint, driven[joint])), 3) + 0.0
        where = f"{position:.0f} mm" if sample.is_slide(joint) else f"{position:.1f}°"
        rows = sample.design.before[name], sample.design.after[name]
        floor = max(UNSEEN, 1e-9 * max(row.peak for row in rows))
        was, left = (sig(0.0 if abs(v) <= floor else float(v) + 0.0, 3) for v in (before[joint], after[joint]))
        lines.append(f"{name} at {where}: {was} → {left} {unit}".replace("-", "\u2212"))
    return "\n".join(lines)


def _frame(pose: Posed, corner: bool) -> tuple[Array, Array]:
    """Lower left and upper right of a pose on paper, m, with room for labels."""
    points = (pose.view.corner() if corner else pose.view).flat(pose.scene.points)
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.1 * float((high - low).max()) + 1e-3
    # Names of wound springs stand below them.
    below = 2.6 if any(sketch.spirals for _, sketch in pose.scene.paths) else 1.4
    return low - margin * np.array([1.0, below]), high + margin


def _fit(ax: Axes, frame: tuple[Array, Array], size: tuple[float, float]) -> None:
    """Show a frame, widened to the panel's size so that every panel has the same scale."""
    middle = (frame[0] + frame[1]) / 2
    bottom = frame[0][1]
    ax.set_xlim(middle[0] - size[0] / 2, middle[0] + size[0] / 2)
    ax.set_ylim(bottom, bottom + size[1])
    style.quiet(ax)


def _furniture(ax: Axes) -> None:
    """Scale bar and the direction of gravity, lower left."""
    low, high = ax.get_xlim()
    floor, top = ax.get_ylim()
    raw = 0.2 * (high - low)
    step = 10.0 ** math.floor(math.log10(raw))
    length = max(s * step for s in (1, 2, 5) if s * step <= raw * 1.0001)
    y = floor + 0.02 * (top - floor)
    ax.plot([low, low + length], [y, y], color=style.INK, lw=2.5, solid_capstyle="butt", clip_on=False)
    words = f"{plain(1e3 * length)} mm" if length < 1 else f"{plain(length)} m"
    ax.annotate(words, (low + length, y), xytext=(6, 0), textcoords="offset points", va="center", fontsize=9)
    arrow = {"arrowstyle": "-|>", "color": style.INK, "lw": 1.2, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", xy=(low, y), xytext=(0, 52), textcoords="offset points", arrowprops=arrow)
    ax.annotate("g", (low, y), xytext=(6, 40), textcoords="offset points", style="italic", fontsize=10)
