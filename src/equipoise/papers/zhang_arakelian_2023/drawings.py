"""Figures 2 and 3 from our computation."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np

from equipoise.papers.paper import Drawing
from equipoise.papers.zhang_arakelian_2023 import model
from equipoise.papers.zhang_arakelian_2023.model import MANY, THREE, Dyad, design
from equipoise.reporting import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def figure(positions: tuple[float, ...]) -> Figure:
    """Moment of gravity (a) and what is left after balancing (b)."""
    states = model.states(0.1)
    angle = np.degrees(states.driven[:, 0])
    dyad = design(positions)[1]
    made = style.figure(8.6, 3.6)
    left, right = made.subplots(1, 2)
    left.plot(angle, -states.holding[:, 0], color=style.BEFORE)
    left.set_title("(a) gravity")
    right.plot(angle, dyad.moment(states), color=style.AFTER, label="as the mechanism is")
    mirrored = Dyad(dyad.r, dyad.l, -dyad.beta).moment(states)
    right.plot(angle, mirrored, "--", color=style.MUTED, label="with beta's sign reversed, as printed")
    right.set_title("(b) left after balancing")
    for ax in (left, right):
        ax.axhline(0.0, color=style.MUTED, lw=0.8)
        ax.set_xlim(angle[0], angle[-1])
        style.degree_ticks(ax.xaxis, angle[0], angle[-1])
        ax.set_xlabel("angle of the link from straight up [deg]")
    left.set_ylim(0, None)
    left.set_ylabel("moment [N m]")
    right.set_ylabel("moment [N m]")
    made.legend(loc="outside upper right", ncols=2)
    return made


DRAWINGS = (
    Drawing(
        "Figure 2",
        "Three prescribed positions: moment of gravity, and what the compensator leaves of it.",
        functools.partial(figure, THREE),
    ),
    Drawing(
        "Figure 3",
        "121 prescribed positions: moment of gravity, and what the compensator leaves of it.",
        functools.partial(figure, MANY),
    ),
)
