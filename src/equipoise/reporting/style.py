"""One look for all pictures: warm for before, blue for after, muted colours for the added parts."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BEFORE = "#c2703d"
AFTER = "#1f5fa8"
INK = "#22303c"
MUTED = "#6b7780"
FAINT = "#d9dee2"
LINK = "#c3ccd3"
LIMIT = "#8a1c2b"
PARTS = ("#00806b", "#9a4f8f", "#6f7d12", "#b07d00", "#4b8fc0", "#7a5c4a")
"""Colours of springs and counterweights in order; distinct for the colour-blind together with their labels."""

RAMP = ("#fbfaf6", "#d3e1ea", "#93b7d3", "#4b85b6", "#1f5490", "#12264d")

SETTINGS: dict[str, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 9.5,
    "axes.titlesize": 10.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titlepad": 8,
    # A fixed height: finding one that clears the ticks takes a fifth of the drawing time.
    "axes.titley": 1.0,
    "axes.labelsize": 9.5,
    "axes.labelcolor": INK,
    "axes.edgecolor": MUTED,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": FAINT,
    "grid.linewidth": 0.7,
    "text.color": INK,
    "text.parse_math": False,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
    "xtick.major.size": 3,
    "ytick.major.size": 3,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "lines.linewidth": 1.8,
    "lines.solid_capstyle": "round",
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "svg.fonttype": "path",
    "svg.hashsalt": "equipoise",
}


@contextmanager
def styled() -> Iterator[None]:
    """The pictures' settings, without touching those of the caller's own plots."""
    import matplotlib as mpl

    with mpl.rc_context(SETTINGS):  # pyright: ignore[reportArgumentType]
        yield


def figure(width: float, height: float) -> Figure:
    """An empty figure, inches, that needs no display and no global state."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    made = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(made)
    engine = made.get_layout_engine()
    if engine is not None:
        engine.set(h_pad=0.1, hspace=0.04)  # pyright: ignore[reportCallIssue]
    return made


def save(figure: Figure, place: Path) -> Path:
    """A figure as an SVG file."""
    place.write_bytes(_svg(figure))
    return place


def _svg(figure: Figure) -> bytes:
    stream = io.BytesIO()
    with styled():
        figure.savefig(
            stream, format="svg", bbox_inches="tight", pad_inches=0.06, metadata={"Date": None, "Creator": None}
        )
    return stream.getvalue()


def picture(figure: Figure) -> str:
    """A figure as a data address that an <img> shows without a network: SVG, sharp at any size."""
    return "data:image/svg+xml;base64," + base64.b64encode(_svg(figure)).decode()


def ramp() -> Any:
    """The colours of maps, light for little and dark for much; its lightness alone tells the order."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("equipoise", RAMP)


def halo(width: float = 3.0) -> list[Any]:
    """A white rim that keeps letters readable on lines."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=width, foreground="white")]


def degree_ticks(axis: Any, low: float, high: float) -> None:
    """Ticks at round angles, deg, where the range is a good part of a turn."""
    from matplotlib.ticker import MultipleLocator

    span = high - low
    for step in (5, 10, 15, 30, 45, 60, 90, 180):
        if span / step <= 8.01:
            axis.set_major_locator(MultipleLocator(step))
            return


def quiet(ax: Axes) -> None:
    """No frame, ticks or grid: a drawing, not a graph."""
    ax.set_axis_off()
    ax.set_aspect("equal", adjustable="box", anchor="SW")
