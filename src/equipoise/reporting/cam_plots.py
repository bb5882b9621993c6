"""Drawings of cams and drums: the profile with its cord, and the force that it makes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from equipoise.make.synthesis import Part
from equipoise.reporting import style
from equipoise.reporting.numbers import sig

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MM = 1e3
ROOM = 1.3
"""Sizes of the profile that are drawn about the shaft."""
EVERY = 8
"""Of the wrapped cord's poses that are drawn."""


def cam_drawing(part: Part) -> Figure:
    """Left: the profile at angle 0 with shaft, round drum, guide and the cord at three angles. Right: its force."""
    made = style.figure(10.4, 4.6)
    left, right = made.subplots(1, 2, gridspec_kw={"width_ratios": (3, 2)})
    _profile(left, part)
    _force(right, part)
    return made


def _profile(ax: Axes, part: Part) -> None:
    profile = part.profile
    points = MM * profile.points
    ax.plot(*points.T, color=style.AFTER, lw=2.0, label="profile", zorder=4)
    ax.plot(0, 0, "+", color=style.INK, ms=12, mew=1.4, zorder=5)
    size = float(np.abs(points).max())
    drum = getattr(part.kind, "radius", None) if part.curve.unit == "m" else None
    if drum is not None and MM * drum < ROOM * size:
        turn = np.linspace(0, 2 * np.pi, 181)
        ring = MM * drum * np.stack([np.cos(turn), np.sin(turn)])
        ax.plot(*ring, color=style.MUTED, lw=1.0, ls=(0, (6, 3)), label="cable's drum")
    for share in (0.0, 0.5, 1.0):
        row = round(share * (len(points) - 1))
        theta = profile.winding.angle[row]
        # Seen from the body the guide turns backwards.
        away = np.array([np.cos(theta), -np.sin(theta)])
        if profile.guide is not None:
            eye = MM * profile.guide * away
            reach = eye - points[row]
            ends = points[row] + np.outer(np.array([0.0, min(1.0, 0.6 * size / float(np.linalg.norm(reach)))]), reach)
        else:
            across = np.array([away[1], -away[0]]) * profile.winding.off
            ends = points[row] + np.outer(np.array([0.0, 0.6 * size]), across)
        ax.plot(*ends.T, color=style.BEFORE, lw=1.1, label="free cord" if share == 0.0 else None)
        ax.plot(*points[row], "o", ms=4.5, mfc="white", mec=style.BEFORE, mew=1.3, zorder=6)
        ax.annotate(
            f"{MM * part.curve.c[row]:.0f} mm" if part.curve.unit == "m" else f"{np.degrees(part.curve.c[row]):.0f}°",
            ends[1], xytext=(3, 3), textcoords="offset points", fontsize=8.5, color=style.BEFORE,
            path_effects=style.halo(),
        )  # fmt: skip
    ax.set_aspect("equal", adjustable="box")
    ax.set_xlim(-ROOM * size, ROOM * size)
    ax.set_ylim(-ROOM * size, ROOM * size)
    ax.set_xlabel("x [mm]")
    ax.set_ylabel("y [mm]")
    ax.set_title(f"{part.name}: {sig(profile.turns, 3)} turns, least radius {sig(MM * profile.curvature.min(), 3)} mm")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=3)


def _force(ax: Axes, part: Part) -> None:
    curve, along = part.curve, part.curve.unit == "m"
    scale = MM if along else 180 / np.pi
    ax.plot(scale * curve.c, curve.force, color=style.AFTER, lw=2.4, label="asked for")
    words = "no guide, so no cord was wrapped"
    if part.wrapped is not None:
        wrapped = part.wrapped
        ax.plot(
            scale * wrapped.c[::EVERY],
            wrapped.force[::EVERY],
            "o",
            ms=4.0,
            mfc="white",
            color=style.BEFORE,
            label="wrapped cord",
            zorder=5,
        )
        words = f"wrapped cord within {sig(wrapped.error, 2)} {part.facts()['unit']}"
    ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]))
    ax.set_xlabel("travel of the cable [mm]" if along else "angle [deg]")
    ax.set_ylabel("tension [N]" if along else "torque [N m]")
    ax.set_title(words, fontsize=9.5, weight="normal")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=2)
