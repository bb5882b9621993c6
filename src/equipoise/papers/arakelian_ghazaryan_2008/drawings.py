"""Figures 2 to 6 from our computation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from equipoise.affine import Array
from equipoise.papers.arakelian_ghazaryan_2008 import model
from equipoise.papers.arakelian_ghazaryan_2008.improved import RATE, found_design
from equipoise.papers.arakelian_ghazaryan_2008.model import WIRE_2, coil, heavy_rate, light_rate, moment
from equipoise.papers.paper import Drawing
from equipoise.reporting import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Curve = tuple[str, Array, str, str]
GRAVITY, HEAVY, SPRING = style.BEFORE, "#7a3d12", style.AFTER


def graph(curves: Sequence[Curve], label: str) -> Figure:
    """Moments over the link's angle: (label, moment (N,), colour, dash) per curve."""
    made = style.figure(7.2, 3.6)
    ax = made.subplots()
    angle = np.degrees(model.states(0.1).driven[:, 0])
    for name, values, colour, dash in curves:
        ax.plot(angle, values, dash, color=colour, label=name)
    ax.axhline(0.0, color=style.MUTED, lw=0.8)
    ax.set_xlim(angle[0], angle[-1])
    style.degree_ticks(ax.xaxis, angle[0], angle[-1])
    ax.set_xlabel("angle of the link from straight up [deg]")
    ax.set_ylabel(f"{label} [N m]")
    made.legend(loc="outside upper left", ncols=1)
    return made


def _weight(k: float) -> Array:
    """Moment of the link's weight and of the wire mass that belongs to the rate k, N m."""
    return moment(coil(0.0, float(WIRE_2.of(k))))


def _elastic(k: float) -> Array:
    """Moment of the spring's force alone, N m."""
    return moment(coil(k)) - moment()


def figure_2() -> Figure:
    """Balancing moments of the two springs of zero free length."""
    light, heavy = light_rate(), heavy_rate()
    return graph(
        [
            (
                f"weightless spring, k = {light:.1f} N/m",
                moment(model.zero_free_length(light)) - moment(),
                GRAVITY,
                "--",
            ),
            (f"spring with mass, k = {heavy:.1f} N/m", moment(model.zero_free_length(heavy)) - moment(), SPRING, "-"),
        ],
        "balancing moment",
    )


def figure_3() -> Figure:
    """Moments of gravity and of the spring of 990 N/m."""
    return graph(
        [
            ("weight of the link", moment(), GRAVITY, "--"),
            (f"weight of the link and of the spring, {float(WIRE_2.of(990)):.2f} kg", _weight(990), HEAVY, "-"),
            ("balancing moment with its sign reversed, k = 990 N/m", -_elastic(990), SPRING, "-"),
        ],
        "moment",
    )


def figure_4() -> Figure:
    """What the spring of 990 N/m leaves."""
    return graph(
        [
            ("spring taken as weightless, k = 990 N/m", moment(coil(990)), GRAVITY, "--"),
            (f"with its mass, {float(WIRE_2.of(990)):.2f} kg", moment(coil(990, WIRE_2)), SPRING, "-"),
        ],
        "unbalanced moment",
    )


def figure_5() -> Figure:
    """Moments of gravity and of the spring of 1114 N/m."""
    return graph(
        [
            (f"weight of the link and of the spring, {float(WIRE_2.of(1114)):.2f} kg", _weight(1114), HEAVY, "-"),
            ("balancing moment with its sign reversed, k = 1114 N/m", -_elastic(1114), SPRING, "--"),
        ],
        "moment",
    )


def figure_6() -> Figure:
    """What the spring of 1114 N/m leaves, and what the least peak leaves."""
    best = found_design(RATE, "peak", 1.0).geometry["s.law.k"]
    return graph(
        [
            ("k = 1114 N/m, as printed", moment(coil(1114, WIRE_2)), SPRING, "-"),
            (f"k = {best:.0f} N/m, least peak", moment(coil(best, WIRE_2)), style.PARTS[0], "--"),
        ],
        "unbalanced moment",
    )


DRAWINGS = (
    Drawing(
        "Figure 2", "Balancing moments of the spring of zero free length, without and with its own mass.", figure_2
    ),
    Drawing(
        "Figure 3", "Moments of gravity, without and with the spring's mass, and of the spring of 990 N/m.", figure_3
    ),
    Drawing("Figure 4", "Unbalanced moment of the 990 N/m spring: as its design assumes, and with its mass.", figure_4),
    Drawing("Figure 5", "Moment of gravity with the spring's mass, and of the spring of 1114 N/m.", figure_5),
    Drawing(
        "Figure 6", "Unbalanced moment with the spring's mass: the printed rate, and the rate of least peak.", figure_6
    ),
)
