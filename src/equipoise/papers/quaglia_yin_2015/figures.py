"""Figures 11, 12 and 14 to 21, drawn from our computation."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

import equipoise as eq
from equipoise.affine import Array
from equipoise.papers.paper import Drawing
from equipoise.papers.quaglia_yin_2015.robots import (
    ELBOW,
    HALF,
    LARGEST,
    along,
    at,
    constant_force,
    error,
    ideal,
    mean,
    workspace,
)
from equipoise.reporting import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE = (7.2, 4.2)
FEW = 721
RATIOS = (2.0, 3.0, 4.0, 5.0, 6.0)
ERROR = "torque error, % of the largest gravity torque"
MEAN = "mean |torque error|, %"

Law = Callable[[float], Any]


def _axes(across: str, up: str, low: float, high: float) -> tuple[Figure, Axes]:
    figure = style.figure(*SIZE)
    axes = figure.add_subplot()
    axes.set_xlabel(across)
    axes.set_ylabel(up)
    axes.set_xlim(low, high)
    style.degree_ticks(axes.xaxis, low, high)
    return figure, axes


def _shades(count: int) -> list[Any]:
    """Colours of an ordered family, light to dark."""
    return [style.ramp()(value) for value in np.linspace(0.35, 1.0, count)]


def _beside(axes: Axes, x: float, ends: Sequence[tuple[float, str, Any]], gap: float) -> None:
    """Labels right of the axes, each beside its curve's end, moved apart where they would touch."""
    placed = -math.inf
    for y, text, colour in sorted(ends, key=lambda end: end[0]):
        placed = max(y, placed + gap)
        axes.annotate(
            text, (x, placed), (5, 0), textcoords="offset points", color=colour, va="center", annotation_clip=False
        )


def _room(axes: Axes, share: float = 0.055) -> float:
    low, high = axes.get_ylim()
    return share * (high - low)


def _outside(axes: Axes, **options: Any) -> None:
    """A legend right of the axes, where it hides nothing."""
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), **options)


def stiffness() -> Figure:
    """Fig. 11: the error over the circle for several rates."""
    rates = (0.0, 0.5, 1.0, 1.5, 2.0)
    figure, axes = _axes("θ₁, deg", ERROR, -180, 180)
    sweep = along(-180.0, 180.0, FEW)
    degrees = np.degrees(sweep.poses[:, 0])
    for n, colour in zip(rates, _shades(len(rates)), strict=True):
        curve = error(1, ideal(1, 4.0, n), sweep, 90.0, 4.0)
        axes.plot(degrees, curve, color=colour, label=f"n = {n:g}")
    _outside(axes, title="rate / ideal rate")
    axes.set_title("pivot at α₅ = 90°, ra₁ = 4")
    return figure


def stiffness_mean() -> Figure:
    """Fig. 12: its mean over the rate."""
    rates, sweep = np.linspace(0.0, 3.0, 13), along(-180.0, 180.0, FEW)
    figure, axes = _axes("rate / ideal rate n", MEAN, 0.0, 3.0)
    axes.xaxis.set_major_locator(_every(0.5))
    ends = []
    for ra, colour in zip((2.0, 3.0, 4.0, 6.0, 10.0), reversed(_shades(5)), strict=True):
        curve = [mean(error(1, ideal(1, ra, n), sweep, 90.0, ra), sweep) for n in rates]
        axes.plot(rates, curve, color=colour)
        ends.append((curve[-1], f"ra₁ = {ra:g}", colour))
    axes.set_ylim(0, None)
    _beside(axes, 3.0, ends, _room(axes))
    axes.set_title("pivot at α₅ = 90°; n = 0 is the constant force")
    return figure


def _every(step: float) -> Any:
    from matplotlib.ticker import MultipleLocator

    return MultipleLocator(step)


def _torques(angles: Sequence[float], curve: Callable[[float, eq.Sweep], Array], title: str) -> Figure:
    """Spring torques on link 1 for several pivot angles with gravity's, dotted; below, what separates them."""
    sweep = along(*HALF, FEW)
    degrees = np.degrees(sweep.poses[:, 0])
    weight = LARGEST[0] * np.cos(sweep.poses[:, 0])
    figure = style.figure(SIZE[0], 1.4 * SIZE[1])
    above, below = figure.subplots(2, sharex=True, height_ratios=(3, 2))
    for alpha, colour in zip(angles, _shades(len(angles)), strict=True):
        gap = LARGEST[0] / 100 * curve(alpha, sweep)
        above.plot(degrees, weight + gap, color=colour, linewidth=1.3, label=f"α₅ = {alpha:g}°")
        below.plot(degrees, gap, color=colour, linewidth=1.3)
    for axes, line in ((above, weight), (below, 0 * weight)):
        axes.plot(degrees, line, color=style.BEFORE, linestyle=":", linewidth=2.4, label="gravity")
    _outside(above)
    above.set_ylabel("torque, N m")
    below.set_ylabel("spring − gravity, N m")
    below.set_xlabel("θ₁, deg")
    below.set_xlim(*HALF)
    style.degree_ticks(below.xaxis, *HALF)
    above.set_title(title)
    return figure


def constant_torque() -> Figure:
    """Fig. 14: constant force on link 1."""
    angles = (80.0, 82.0, 84.0, 86.0, 88.0, 90.0, 92.0)
    return _torques(angles, lambda alpha, sweep: constant_force(1, sweep, alpha), "constant force on link 1, ra₁ = 6")


def variable_torque() -> Figure:
    """Fig. 16: the ideal spring on link 1."""
    angles = (84.0, 86.0, 88.0, 90.0, 92.0, 94.0, 96.0)
    return _torques(angles, lambda alpha, sweep: error(1, ideal(1), sweep, alpha), "ideal spring on link 1, any ra₁")


def _means(link: int, sweep: eq.Sweep, low: float, high: float) -> Figure:
    """Mean error of the constant force over the pivot angle for several distances, the best angle of each marked."""
    alphas = np.arange(low, high + 0.1, 0.5)
    name = "₁₂"[link - 1]
    figure, axes = _axes(f"α{'₅₆'[link - 1]}, deg", MEAN, low, high)
    ends = []
    for ra, colour in zip(RATIOS, reversed(_shades(len(RATIOS))), strict=True):
        values = mean(constant_force(link, sweep, alphas[:, None], ra), sweep)
        best = int(np.argmin(values))
        axes.plot(alphas, values, color=colour)
        axes.plot(alphas[best], values[best], "o", color=colour, markersize=5)
        ends.append((values[-1], f"ra{name} = {ra:g}", colour))
    axes.set_ylim(0, None)
    _beside(axes, high, ends, _room(axes))
    axes.set_title(f"constant force on link {link}; dots: best angle of each ra{name}")
    return figure


def constant_mean() -> Figure:
    """Fig. 15: mean error of the constant force on link 1."""
    return _means(1, along(*HALF, FEW), 76.0, 96.0)


def constant_mean_2() -> Figure:
    """Fig. 19: mean error of the constant force on link 2."""
    return _means(2, workspace(1297), 80.0, 100.0)


def _variable_mean(link: int, sweep: eq.Sweep) -> Figure:
    alphas = np.arange(80.0, 100.1, 0.5)
    name = "₁₂"[link - 1]
    figure, axes = _axes(f"α{'₅₆'[link - 1]}, deg", MEAN, 80.0, 100.0)
    styles = (("-", 5.0, style.LINK), ("-", 2.2, style.AFTER), (":", 2.2, style.BEFORE))
    for ra, (line, width, colour) in zip((2.0, 4.0, 6.0), styles, strict=True):
        values = mean(error(link, ideal(link, ra), sweep, alphas[:, None], ra), sweep)
        axes.plot(alphas, values, line, color=colour, linewidth=width, label=f"ra{name} = {ra:g}")
    axes.set_ylim(0, None)
    axes.legend(loc="upper center")
    axes.set_title(f"ideal spring on link {link}: the distance does not matter")
    return figure


def variable_mean() -> Figure:
    """Fig. 17: mean error of the ideal spring on link 1."""
    return _variable_mean(1, along(*HALF, FEW))


def variable_mean_2() -> Figure:
    """Fig. 21: mean error of the ideal spring on link 2."""
    return _variable_mean(2, workspace(1297))


def _elbows(curve: Callable[[eq.Sweep], Array], title: str) -> Figure:
    """Torques on link 2 over the elbow angle for several poses of link 1, gravity's dotted."""
    phi, poses = np.linspace(*ELBOW, 145), (-90.0, -45.0, 0.0, 45.0, 90.0)
    figure, axes = _axes("φ, deg", "torque, N m", *ELBOW)
    axes.xaxis.set_major_locator(_every(18))
    ends = []
    for th1, colour in zip(poses, style.PARTS, strict=False):
        sweep = at(phi + th1 - 180.0)
        weight = LARGEST[1] * np.cos(sweep.poses[:, 0])
        torque = weight + LARGEST[1] / 100 * curve(sweep)
        axes.plot(phi, torque, color=colour, linewidth=1.4, label="spring" if th1 == 0 else None)
        axes.plot(phi, weight, color=colour, linestyle=":", linewidth=2.2, label="gravity" if th1 == 0 else None)
        ends.append((float(weight[-1]), f"θ₁ = {th1:g}°".replace("-", "−"), colour))
    _beside(axes, ELBOW[1], ends, _room(axes))
    axes.legend(loc="upper left")
    axes.set_title(title)
    return figure


def constant_torque_2() -> Figure:
    """Fig. 18: constant force on link 2."""
    return _elbows(lambda sweep: constant_force(2, sweep, 92.0), "constant force on link 2, α₆ = 92°, ra₂ = 6")


def variable_torque_2() -> Figure:
    """Fig. 20: the ideal spring on link 2."""
    return _elbows(lambda sweep: error(2, ideal(2), sweep, 92.0), "ideal spring on link 2, α₆ = 92°")


DRAWINGS = (
    Drawing(
        "Figure 11",
        "Error over the circle where the rate is n times the ideal one. With n = 2 it reaches 16.1 %, not 15 %; "
        "each curve is antisymmetric about ±90°.",
        stiffness,
    ),
    Drawing("Figure 12", "Mean of its magnitude over the circle: straight in |n − 1|.", stiffness_mean),
    Drawing("Figure 14", "Torque of the constant force for several pivot angles, and gravity's.", constant_torque),
    Drawing(
        "Figure 15",
        "Mean error of the constant force of Eq. 11 over (−90°, 90°). Farther pivots are better only if "
        "the angle follows: at a fixed 86° ra₁ = 20 is worse than ra₁ = 10.",
        constant_mean,
    ),
    Drawing("Figure 16", "Torque of the ideal spring for several pivot angles, and gravity's.", variable_torque),
    Drawing(
        "Figure 17", "Mean error of the ideal spring: 1.11 % for each degree, whatever the distance.", variable_mean
    ),
    Drawing(
        "Figure 18",
        "Torques on link 2 over the elbow angle for five poses of link 1; they follow θ₂ = φ + θ₁ − 180° alone.",
        constant_torque_2,
    ),
    Drawing(
        "Figure 19",
        "Mean error of the constant force on link 2 where θ₁ and φ cover (−90°, 90°) and (18°, 162°) evenly.",
        constant_mean_2,
    ),
    Drawing("Figure 20", "Torques on link 2 with the ideal spring, 2° off its best place.", variable_torque_2),
    Drawing("Figure 21", "Mean error of the ideal spring on link 2: the law of Figure 17.", variable_mean_2),
)
