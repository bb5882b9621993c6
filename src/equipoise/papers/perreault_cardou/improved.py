"""The same robot with tensions kept at every length."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from equipoise.papers.paper import Improvement

if TYPE_CHECKING:
    pass
from equipoise.papers.perreault_cardou.model import solved, tension


def improved() -> Sequence[Improvement]:
    """What the same robot can do with tensions kept at every length."""
    published = solved(5)
    cases = [
        ("k = 5, every length kept", solved(5, True), "the paper's choice, with the limit certified between samples"),
        ("k = 20", solved(20, True), "near the floor; conditioning is no obstacle in Legendre's basis"),
        ("k = 10 with a convex cam of one turn (159 mm drum)", solved(10, True, drum=0.159), "can be cut as one cam"),
    ]
    return [
        Improvement(
            what=what,
            over="the triangle, t >= 1 N for every cable length",
            norm="rms",
            published=published.after["resultant"].rms,
            ours=design.after["resultant"].rms,
            unit="N",
            values={"peak tension": f"{tension(design, np.linspace(0, 1, 2001)).max():.3g} N"},
            certificate=design.certificate.kind,
            note=note,
        )
        for what, design, note in cases
    ]
