"""How links, springs, counterweights, payloads and ground look on paper."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import Sketch
from equipoise.reporting import style
from equipoise.reporting.numbers import plain
from equipoise.reporting.sample import Sample
from equipoise.reporting.scene import Scene
from equipoise.reporting.view import View

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COILS = 9
RING, WOUND = 49, 3
"""Points of a circle, and turns of a wound spring."""

SHARES = tuple(i / 8 for i in range(9))
"""Where a line is looked at to keep names off it."""

REACH = 0.09
"""How far a name's middle stands off its line, in sizes of the drawing."""


def draw(ax: Axes, sample: Sample, scene: Scene, view: View) -> None:
    """Links, joints, springs, counterweights and payloads of one scene in one view."""
    for width, colour in ((9.5, style.MUTED), (7.5, style.LINK)):
        for bar in scene.bars:
            ax.plot(*view.flat(np.stack(bar)).T, color=colour, lw=width, solid_capstyle="round", zorder=2)
    for strut in scene.struts:
        ax.plot(*view.flat(np.stack(strut)).T, color=style.MUTED, lw=2.2, zorder=1.5)
    for place in scene.grounded:
        ax.plot(*view.flat(place), marker=_ground(), ms=16, mfc="none", mec=style.MUTED, mew=1.2, zorder=1.2)
    for place in scene.feet:
        ax.plot(*view.flat(place), marker=_ground(), ms=30, mfc="none", mec=style.INK, mew=1.3, zorder=1.2)
    joints = view.flat(scene.joints)
    for place, driven in zip(joints, scene.driven, strict=True):
        face = style.INK if driven else "white"
        ax.plot(*place, "o", ms=6.5, mfc=face, mec=style.INK, mew=1.2, zorder=4)
    size = float(np.ptp(view.flat(scene.points), axis=0).max())
    solid = _trail(scene, view)
    for number, sketch in scene.paths:
        _leads(ax, sketch, view, size, sample.design.balancers[number].name, part_colour(number))
    for number, a, b in scene.springs:
        _spring(ax, view.flat(a), view.flat(b), 0.012 * size, part_colour(number))
        label = (sample.design.balancers[number].name, part_colour(number))
        others = [
            view.flat(c + share * (d - c)) for other, c, d in scene.springs if other != number for share in SHARES
        ]
        _label(ax, (view.flat(a), view.flat(b)), np.vstack([solid, *others]) / size, label, size)
    heaviest = max((mass for _, mass, _ in scene.weights), default=1.0)
    for number, mass, place in scene.weights:
        label = (f"{sample.design.balancers[number].name}, {plain(mass, 3)} kg", part_colour(number))
        _weight(ax, view.flat(place), mass / (heaviest or 1.0), label)
    for mass, place in scene.payloads:
        if mass > 0:
            ax.plot(*view.flat(place), "s", ms=8, color=style.INK, zorder=5)
            _note(ax, view.flat(place), solid, f"payload {plain(mass, 3)} kg", size)


def part_colour(number: int) -> str:
    """The colour of a part in every picture."""
    return style.PARTS[number % len(style.PARTS)]


def coil(a: Array, b: Array, width: float) -> Array:
    """A zigzag (P, 2) of `width` to both sides of the line from a to b, straight over its ends."""
    along = b - a
    length = float(np.hypot(*along)) or 1.0
    across = np.array([-along[1], along[0]]) / length
    share = np.concatenate([[0.0, 0.12], np.linspace(0.12, 0.88, 2 * COILS + 1)[1:-1], [0.88, 1.0]])
    side = np.concatenate([[0, 0], [(-1) ** i for i in range(2 * COILS - 1)], [0, 0]])
    return a + share[:, None] * along + width * side[:, None] * across


def _leads(ax: Axes, sketch: Sketch, view: View, size: float, name: str, colour: str) -> None:
    """Cranks, rods, cables, pulleys and wound springs of a path."""
    for bar in sketch.bars:
        line = view.flat(bar).T
        ax.plot(*line, color="white", lw=4.6, zorder=4.3, solid_capstyle="round")
        ax.plot(*line, color=colour, lw=3.0, alpha=0.75, zorder=4.4, solid_capstyle="round", solid_joinstyle="round")
        ax.plot(*line, "o", ms=3.2, mfc="white", mec=colour, mew=1.0, zorder=4.5)
    for line in sketch.lines:
        ax.plot(*view.flat(line).T, color=colour, lw=1.1, zorder=4.6)
    for centre, radius, axis in sketch.discs:
        ring = view.flat(_ring(centre, axis, np.full(RING, radius)))
        ax.fill(*ring.T, facecolor="white", edgecolor=colour, lw=1.2, zorder=4.2)
        ax.plot(*view.flat(centre), "o", ms=2.4, color=colour, zorder=4.3)
    for centre, axis in sketch.spirals:
        growth = 0.045 * size * np.linspace(0.25, 1.0, WOUND * RING)
        ax.plot(*view.flat(_ring(centre, axis, growth, WOUND)).T, color=colour, lw=1.7, zorder=5.1)
        ax.annotate(
            name, _pair(view.flat(centre)), xytext=(0, -20), textcoords="offset points", color=colour, weight="bold",
            ha="center", va="top", path_effects=style.halo(), zorder=7,
        )  # fmt: skip


def _ring(centre: Array, axis: Array, radius: Array, turns: int = 1) -> Array:
    """Points (P, 3) at radii (P,) around an axis."""
    first = np.asarray(np.cross(axis, np.eye(3)[int(np.abs(axis).argmin())]), dtype=float)
    first /= np.linalg.norm(first)
    second = np.asarray(np.cross(axis / np.linalg.norm(axis), first), dtype=float)
    angle = np.linspace(0.0, 2 * np.pi * turns, len(radius))[:, None]
    return centre + radius[:, None] * (np.cos(angle) * first + np.sin(angle) * second)


def _spring(ax: Axes, a: Array, b: Array, width: float, colour: str) -> None:
    line = coil(a, b, width + 0.025 * float(np.hypot(*(b - a))))
    ax.plot(*line.T, color="white", lw=3.6, zorder=5, solid_joinstyle="round")
    ax.plot(*line.T, color=colour, lw=1.7, zorder=5.1, solid_joinstyle="round")
    for end in (a, b):
        ax.plot(*end, "o", ms=5.5, mfc="white", mec=colour, mew=1.8, zorder=5.2)


def _trail(scene: Scene, view: View) -> Array:
    """Points (P, 2) all along the links, which labels keep away from."""
    share = np.array(SHARES)[:, None]
    lines = [a + share * (b - a) for a, b in [*scene.bars, *scene.struts]]
    return view.flat(np.vstack([*lines, scene.joints]))


def _label(ax: Axes, ends: tuple[Array, Array], solid: Array, label: tuple[str, str], size: float) -> None:
    """A part's name beside its line, where the links (solid, in drawing sizes) leave most room."""
    a, b = ends
    along = b - a
    across = np.array([-along[1], along[0]]) / (float(np.hypot(*along)) or 1.0)
    places = [(a + share * along, side * across) for share in (0.5, 0.35, 0.65) for side in (1.0, -1.0)]
    room = [float(np.hypot(*(solid - middle / size - REACH * side).T).min()) for middle, side in places]
    middle, across = places[int(np.argmax(room))]
    ax.annotate(
        label[0], _pair(middle), xytext=_pair(16 * across), textcoords="offset points", color=label[1], weight="bold",
        ha="left" if across[0] > 0.3 else "right" if across[0] < -0.3 else "center",
        va="bottom" if across[1] > 0.3 else "top" if across[1] < -0.3 else "center",
        path_effects=style.halo(), zorder=7,
    )  # fmt: skip


def _ground() -> Any:
    """A pivot on hatched ground, as a marker."""
    from matplotlib.path import Path

    strokes = [((-1.0, -0.5), (1.0, -0.5))] + [((x, -0.5), (x - 0.35, -0.9)) for x in (-0.6, -0.1, 0.4, 0.9)]
    strokes += [((0.0, 0.0), (-0.45, -0.5)), ((0.0, 0.0), (0.45, -0.5))]
    return Path([point for stroke in strokes for point in stroke], [Path.MOVETO, Path.LINETO] * len(strokes))


def _weight(ax: Axes, place: Array, share: float, label: tuple[str, str]) -> None:
    size = 22.0 * math.sqrt(max(share, 0.0))
    ax.plot(*place, "o", ms=max(size, 5.0), mfc=label[1], mec="white", mew=1.2, zorder=5)
    ax.annotate(
        label[0], _pair(place), xytext=(0, -max(size, 5.0) / 2 - 5), textcoords="offset points",
        color=label[1], weight="bold", ha="center", va="top", path_effects=style.halo(), zorder=7,
    )  # fmt: skip


def _note(ax: Axes, place: Array, solid: Array, text: str, size: float) -> None:
    """A payload's label on the side of it where the links (solid) leave most room."""
    sides = (0, -1, "center", "top"), (1, 0, "left", "center"), (-1, 0, "right", "center"), (0, 1, "center", "bottom")
    room = [float(np.hypot(*(solid - place - REACH * size * np.array(side[:2])).T).min()) for side in sides]
    x, y, across, upright = sides[int(np.argmax(room))]
    ax.annotate(
        text, _pair(place), xytext=(9 * x, 9 * y), textcoords="offset points", color=style.INK, ha=across, va=upright,
        path_effects=style.halo(), zorder=7,
    )  # fmt: skip


def _pair(place: Array) -> tuple[float, float]:
    return float(place[0]), float(place[1])
