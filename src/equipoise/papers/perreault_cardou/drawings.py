"""Figures 2 to 6 of Perreault & Cardou."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from equipoise.cables import equilibria
from equipoise.papers.paper import Drawing
from equipoise.reporting import glyphs, maps, platform_plots, style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

from equipoise.papers.perreault_cardou.model import CORNERS, SIDE, light, objective, resultants, solved, tension

GRID = 161


def _tensions() -> Figure:
    figure = style.figure(9.2, 4.4)
    axes = figure.subplots()
    c = np.linspace(0, SIDE, 601)
    for k in range(1, 11):
        dash = "-" if k <= 5 else (0, (5, 1.5))
        label = f"k = {k}: f = {objective(solved(k)):.5f}, f / 3 = {objective(solved(k)) / 3:.5f}"
        axes.plot(c, tension(solved(k), c), color=glyphs.part_colour(k - 1), ls=dash, lw=1.5, label=label)
    axes.axhline(1.0, color=style.LIMIT, lw=1.0, ls=(0, (2, 2)), label="t_min = 1 N")
    axes.set_xlim(0, SIDE)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("cable length c [m]")
    axes.set_ylabel("tension t [N]")
    figure.legend(loc="outside right upper", title="f = 1/2 int |f_r|^2 dA [N^2 m^2]", fontsize=8.5)
    return figure


def _map(k: int) -> Figure:
    from matplotlib.patches import Polygon

    design = solved(k)
    low, high = np.array(CORNERS).min(axis=0), np.array(CORNERS).max(axis=0)
    x, y = (np.linspace(low[i], high[i], GRID) for i in (0, 1))
    poses = np.stack([axis.ravel() for axis in np.meshgrid(x, y)], axis=1)
    inside = design.sweep.holds(poses)
    states = design.mechanism.states(design.sweep.at_poses(poses))
    size = np.linalg.norm(design.residual(states, "wrench"), axis=1)
    figure = style.figure(6.4, 5.2)
    axes = figure.subplots()
    drawn = maps.draw_field(axes, x, y, size.reshape(GRID, GRID), float(np.quantile(size[inside], 0.97)))
    edge = Polygon(np.array(CORNERS), closed=True, fill=False, ec=style.MUTED, lw=1.0)
    axes.add_patch(edge)
    for layer in axes.collections:
        layer.set_clip_path(edge)
    figure.colorbar(drawn, ax=axes, label="resultant |f_r| [N]", shrink=0.85, pad=0.02)
    platform_plots.mark(axes, equilibria(design), ("x", "z"), 1.0)
    largest = float(resultants(design)[0].max())
    axes.set_title(f"k = {k}: at most {largest:.2f} N, |f_r| < 0.1 N over {light(design):.0f} % of the area")
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    return figure


DRAWINGS = (
    Drawing("Figure 2", "Tension over cable length for k = 1 to 10.", _tensions),
    Drawing("Figure 3", "Resultant over the triangle for k = 1, and where the point rests.", lambda: _map(1)),
    Drawing("Figure 4", "Resultant over the triangle for k = 2, and where the point rests.", lambda: _map(2)),
    Drawing("Figure 5", "Resultant over the triangle for k = 5, and where the point rests.", lambda: _map(5)),
    Drawing("Figure 6", "Resultant over the triangle for k = 10, and where the point rests.", lambda: _map(10)),
)
