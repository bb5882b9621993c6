"""Pictures of cable platforms: resultant over the workspace with its equilibria, tension curves, motors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from equipoise.affine import Array, Mask
from equipoise.balancers.spring import Spring
from equipoise.cables.behaviour import Motors
from equipoise.cables.distribution import reel_of
from equipoise.cables.equilibria import Equilibrium
from equipoise.limits import Force, Tension
from equipoise.platform import transform
from equipoise.reporting import style
from equipoise.reporting.cablewords import LEAST_WORDS, plural
from equipoise.reporting.glyphs import part_colour
from equipoise.reporting.maps import draw_field
from equipoise.reporting.numbers import sig
from equipoise.reporting.sample import Sample

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

GRID = 121
QUANTILE = 0.97
"""Share of the map that the colours tell apart."""
FINE = 801
DASH = 5
"""Dashes of a curve that lies on another, shifted, so that both show."""
DASHES = ("-", "--")
"""Of cables that share a colour."""
MARKS = {
    "minimum": ("o", "white", "black"),
    "corner sink": ("D", "white", "black"),
    "saddle": ("X", "#e8b04a", "black"),
    "maximum": ("^", "#c2703d", "black"),
    "flat": ("s", "#bbbbbb", "black"),
}
"""Marker, face and edge of each kind of equilibrium."""


def resultant_map(sample: Sample) -> Figure | None:
    """|(F, M / l)| over two slides, the other coordinates in the middle, with the equilibria; and over the whole sweep.

    None for a sweep that moves fewer than two slides.
    """
    pair = _slides(sample)
    design = sample.design
    if pair is None or design.cables is None:
        return None
    x, y, inside, poses = _grid(sample, pair)
    states = design.mechanism.states(design.sweep.at_poses(poses))
    size = _size(design.residual(states, "wrench")).reshape(sample.scenarios, -1).max(axis=0)
    made = style.figure(10.4, 4.9)
    left, right = made.subplots(1, 2, gridspec_kw={"width_ratios": (5, 4)})
    _map(left, sample, pair, (x, y), np.where(inside | (design.sweep.outline is not None), size, np.nan), inside)
    _share(right, sample)
    return made


def _map(
    ax: Axes, sample: Sample, pair: tuple[int, int], ticks: tuple[Array, Array], size: Array, inside: Mask
) -> None:
    from matplotlib.patches import Polygon

    # At anchors the resultant jumps; what lies above is of one colour.
    top = float(np.quantile(size[inside], QUANTILE))
    drawn = draw_field(ax, 1e3 * ticks[0], 1e3 * ticks[1], size.reshape(GRID, GRID), top)
    outline = sample.design.sweep.outline
    if outline is not None and outline[0] == pair:
        edge = Polygon(1e3 * outline[1], closed=True, fill=False, ec=style.MUTED, lw=1.0)
        ax.add_patch(edge)
        for layer in ax.collections:
            layer.set_clip_path(edge)
    ax.set_title(f"resultant with the springs, here at most {sig(float(size[inside].max()), 3)} N")
    ax.set_aspect("equal")
    ax.set_xlabel(sample.axis_label(pair[0]))
    ax.set_ylabel(sample.axis_label(pair[1]))
    figure = ax.get_figure()
    assert figure is not None
    figure.colorbar(drawn, ax=ax, label=_label(sample), shrink=0.9, pad=0.02)
    cables = sample.design.cables
    assert cables is not None
    driven = sample.design.mechanism.driven
    mark(ax, cables.equilibria, (driven[pair[0]], driven[pair[1]]), 1e3)


def _share(ax: Axes, sample: Sample) -> None:
    """The resultant that a share of the sweep exceeds, with the springs and of the weight alone."""
    states = sample.design.states
    weight = 100 * states.weight / states.weight.sum()
    for residual, colour, label in (
        (transform(states)(states.holding), style.BEFORE, "weight alone"),
        (sample.design.residual(states, "wrench"), style.AFTER, "with the springs"),
    ):
        size = _size(residual)
        if size.max() < 1e-9:
            continue
        order = np.argsort(-size)
        share = np.concatenate([[0.0], np.cumsum(weight[order])])
        ax.step(share, np.concatenate([size[order][:1], size[order]]), color=colour, where="pre", label=label)
    ax.set_xlim(0, 100)
    ax.set_ylim(bottom=0)
    ax.set_xlabel("share of the sweep that exceeds it [%]")
    ax.set_ylabel(_label(sample))
    ax.legend(loc="upper right")


def _size(residual: Array) -> Array:
    return np.linalg.norm(residual, axis=-1)


def _label(sample: Sample) -> str:
    turns = any(unit != "N" for unit in sample.design.mechanism.driven_units)
    return "resultant |(F, M / l)| [N]" if turns else "resultant |F| [N]"


def tension_curves(sample: Sample) -> Figure | None:
    """t(c) of every law over the lengths that its limits speak of, with those limits."""
    design = sample.design
    springs = [b for b in design.balancers if isinstance(b, Spring) and reel_of(b) is not None and b.like is None]
    if not springs:
        return None
    made = style.figure(10.4, 3.4)
    ax = made.subplots()
    shaded, drawn = (np.inf, -np.inf), []
    for number, spring in enumerate(springs):
        used = _lengths(sample, spring)
        low, high = _interval(sample, spring, used)
        c = np.linspace(low, high, FINE)
        t = _tension(sample, spring, c)
        names = [b.name for b in design.balancers if isinstance(b, Spring) and spring.name in (b.name, b.like)]
        label = names[0] if len(names) == 1 else f"{names[0]} to {names[-1]}"
        hidden = any(other.shape == t.shape and np.allclose(other, t, rtol=1e-3) for other in drawn)
        drawn.append(t)
        dash = (number * DASH, (DASH, DASH)) if hidden else "-"
        ax.plot(
            1e3 * c, t, color=part_colour(number), ls=dash, label=f"{label}: {sig(t.min(), 3)} to {sig(t.max(), 3)} N"
        )
        shaded = min(shaded[0], used[0]), max(shaded[1], used[1])
    ax.axvspan(1e3 * shaded[0], 1e3 * shaded[1], color=style.MUTED, alpha=0.1, lw=0)
    bounds = {
        float(bound)
        for limit in design.limits
        if isinstance(limit, Force | Tension) and reel_of(_named(sample, limit.spring)) is not None
        for bound in (limit.min, limit.max)
        if isinstance(bound, int | float)
    }
    reach = ax.get_ylim()[1]
    for bound in sorted(bound for bound in bounds if bound <= 1.3 * reach):
        ax.axhline(bound, color=style.LIMIT, lw=1.1, ls=(0, (5, 3)))
    ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]))
    ax.set_xlabel("cable length c [mm]")
    ax.set_ylabel("tension t [N]")
    made.legend(loc="outside upper right", ncols=min(4, len(springs)))
    return made


def motor_tensions(sample: Sample) -> Figure | None:
    """Motor tension of every cable along the trajectory, alone and with the springs; least norm above, peak below."""
    found = sample.design.cables.motors if sample.design.cables is not None else None
    if found is None:
        return None
    made = style.figure(10.4, 5.4)
    axes = made.subplots(len(found.alone), 2, sharex=True, sharey=True, squeeze=False)
    cables = sample.design.mechanism.platform.cables  # type: ignore[union-attr]
    along, label = _along(found)
    for row, least in zip(axes, found.alone, strict=True):
        for ax, part, title in zip(row, (found.alone, found.helped), ("motors alone", "with springs"), strict=True):
            told = part[least]
            for number, cable in enumerate(cables):
                ax.plot(
                    along,
                    told.motors[:, number],
                    color=part_colour(number),
                    lw=1.2,
                    ls=DASHES[number // len(style.PARTS) % 2],
                    label=cable,
                )
            ax.axhline(0.0, color=style.MUTED, lw=0.8)
            ax.set_title(
                f"{title}, {LEAST_WORDS[least]}: {sig(told.work, 3)} J, peak {sig(told.peak, 3)} N", fontsize=9.5
            )
        row[0].set_ylabel("motor tension [N]")
    for ax in axes[-1]:
        ax.set_xlabel(label)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    made.legend(handles, labels, loc="outside upper right", ncols=min(8, len(cables)))
    return made


def _along(found: Motors) -> tuple[Array, str]:
    """Where on the trajectory: share of the path, since poses have no clock."""
    return np.linspace(0.0, 100.0, len(found.states)), "along the trajectory [%]"


def _slides(sample: Sample) -> tuple[int, int] | None:
    """The first slide that the sweep moves, and the last: upright where there is one."""
    moved = [joint for joint in range(len(sample.box)) if sample.is_slide(joint) and sample.moves(joint)]
    return (moved[0], moved[-1]) if len(moved) > 1 else None


def _grid(sample: Sample, pair: tuple[int, int]) -> tuple[Array, Array, Mask, Array]:
    """Ticks of two slides, which points of their grid lie in the sweep's region (M,), and the poses (M, nd)."""
    design = sample.design
    assert design.cables is not None
    ticks = [np.linspace(low, high, GRID) for low, high in sample.box[list(pair)]]
    mesh = np.meshgrid(*ticks)
    poses = np.tile(np.array(list(design.cables.middle.values())), (GRID * GRID, 1))
    for joint, values in zip(pair, mesh, strict=True):
        poses[:, joint] = values.ravel()
    return ticks[0], ticks[1], design.sweep.holds(poses), poses


def mark(ax: Axes, found: Sequence[Equilibrium], names: tuple[str, str], scale: float) -> None:
    """Mark equilibria by two of their coordinates, times a scale, with a legend that counts each kind."""
    for kind, (marker, face, edge) in MARKS.items():
        places = [one.pose for one in found if one.kind == kind]
        if places:
            x, y = (scale * np.array([pose[name] for pose in places]) for name in names)
            label = f"{len(places)} {plural(kind, len(places))}"
            ax.plot(x, y, marker, ms=7, mfc=face, mec=edge, mew=1.0, ls="none", label=label, clip_on=False, zorder=6)
    if ax.get_legend_handles_labels()[0]:
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=4, handletextpad=0.2, columnspacing=1.2)


def _named(sample: Sample, name: str) -> object:
    return next(balancer for balancer in sample.design.balancers if balancer.name == name)


def _lengths(sample: Sample, spring: Spring) -> tuple[float, float]:
    """The cable lengths of all springs of one law over the sweep."""
    from equipoise.balancers.paths import Reel

    alike = [b for b in sample.design.balancers if isinstance(b, Spring) and spring.name in (b.name, b.like)]
    lengths = [Reel(cable).deform(sample.design.states)[0] for b in alike if (cable := reel_of(b)) is not None]
    return float(np.min(lengths)), float(np.max(lengths))


def _interval(sample: Sample, spring: Spring, used: tuple[float, float]) -> tuple[float, float]:
    spans = [
        limit.over
        for limit in sample.design.limits
        if isinstance(limit, Force | Tension) and limit.spring == spring.name and limit.over is not None
    ]
    return (min(float(low) for low, _ in spans), max(float(high) for _, high in spans)) if spans else used


def _tension(sample: Sample, spring: Spring, c: Array) -> Array:
    turned, rate = spring.path.along(c)
    basis, known = spring.law.force_basis(turned)
    theta = np.array([sample.design.values[unknown.name] for unknown in spring.unknowns])
    return (basis @ theta + known) * rate
