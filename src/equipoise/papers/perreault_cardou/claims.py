"""Every printed number and checkable sentence of Perreault & Cardou."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from equipoise.cables import closure, equilibria
from equipoise.claim import Claim, Reason

if TYPE_CHECKING:
    from equipoise.affine import Array
    from equipoise.design import Design
from equipoise.papers.perreault_cardou.model import (
    AREA,
    FLOOR,
    HEIGHT,
    SIDE,
    S,
    least,
    light,
    objective,
    resultants,
    solved,
    tension,
)


def claims() -> Sequence[Claim]:
    """Every printed number and checkable sentence."""
    f = {k: objective(solved(k)) for k in range(1, 11)}
    kinds = {k: Counter(one.kind for one in equilibria(solved(k))) for k in (1, 2, 5)}
    lowest = min(range(1, 11), key=lambda k: least(solved(k)))
    third = "the printed values are a third of Eqs. 14 and 16: the integral of |f_r|^2 over one sixth, 6/2 left out"
    centre = {k: min(min(e.stiffness) for e in equilibria(solved(k)) if e.stiffness) for k in (1, 2)}
    other = objective(solved(5, t_min=7.0)) / 49 / f[5] - 1
    sixth = 6 * (SIDE / 2) * (HEIGHT / 3) / 2 - AREA
    by_mean = solved(5, norm="mean").after["resultant"].mean
    size, weight = _on(solved(5, norm="mean"), solved(5))
    square = float(weight @ size / weight.sum())
    return [
        S.sentence(
            "n + 1 = 3 cables hold the point inside their triangle",
            "1",
            float(closure(solved(1).states.take(slice(0, 200))).margin.min()),
            lambda margin: margin > 0,
            note="least share of the smallest tension in the largest, 200 poses",
        ),
        S.sentence(
            "six times the integral over 0 <= x <= a/2, -sqrt(3) a/6 <= y <= -sqrt(3) x/3 is that over the triangle",
            "2.3, Eq. 16",
            sixth,
            lambda x: abs(x) < 1e-12,
            "m^2",
            note="six times its area less that of the triangle; identical springs see six equal parts",
        ),
        S.sentence(
            "P is positive definite for 1 <= k <= 10",
            "2.3",
            min(_least_eigenvalue(k) for k in range(1, 11)),
            lambda x: x > 0,
            "N^2 m^2",
            note="least eigenvalue over k, Legendre basis; docs/cables.md proves it for every k",
        ),
        S.sentence(
            "the least f decreases as the degree increases",
            "3.1, Fig. 2",
            max(f[k + 1] - f[k] for k in range(1, 10)),
            lambda x: x < 0,
            "N^2 m^2",
            note="largest step from k to k + 1; from 9 to 10 it is small",
        ),
        S.underspecified(
            "f for each degree, in the legend",
            "3.1, Fig. 2",
            "legend",
            note="not legible in the copy examined; ours, a third of Eq. 14: "
            + ", ".join(f"{value / 3:.5f}" for value in f.values()),
        ),
        S.sentence(
            "10 k lengths suffice: all tensions lie above 1 N",
            "3.1, Fig. 2",
            least(solved(lowest)),
            lambda t: t >= 1 - 1e-9,
            "N",
            note=f"least tension over all lengths and k, at k = {lowest}; with every length kept f rises by up to "
            f"{100 * max(objective(solved(k, True)) / f[k] - 1 for k in (3, 4, 5, 6)):.2f} % (k = 3 to 6)",
        ),
        S.sentence(
            "constant (k = 1) and linear (k = 2) springs keep the least tension",
            "3.1",
            min(least(solved(k)) for k in (1, 2)),
            lambda t: t >= 1 - 1e-9,
            "N",
            note="least tension over all lengths",
        ),
        S.number("equilibria with k = 1", "3.1, Fig. 3", "1", sum(kinds[1].values())),
        S.number(
            "approximate equilibria with k = 2",
            "3.1, Fig. 4",
            "4",
            sum(kinds[2].values()),
            slip=Reason("counting the three corners, where |f_r| falls to 0.023 N along the bisector only", 4),
            note="|f_r| has no limit at a corner: it depends on the direction",
        ),
        S.sentence(
            "with k = 1 and 2 the point always goes back to the centroid",
            "3.1",
            min(centre.values()),
            lambda x: x > 0,
            "N/m",
            note="least stiffness at the only equilibrium",
        ),
        S.sentence(
            "with k = 5 the resultant is closer to zero over a considerable portion",
            "3.1, Fig. 5",
            light(solved(5)),
            lambda x: x > 40,
            "%",
            note=f"share of the area with |f_r| < 0.1 N; k = 1 {light(solved(1)):.2f} %. Unsaid: the centroid is then "
            f"unstable, with {kinds[5]['minimum']} minima, {kinds[5]['saddle']} saddles, {kinds[5]['maximum']} maxima",
        ),
        S.sentence(
            "with k = 5 the resultant near the winches is high beside k = 1 and 2",
            "3.1, Fig. 5",
            float(resultants(solved(5))[0].max()),
            lambda x: x > max(float(resultants(solved(k))[0].max()) for k in (1, 2)),
            "N",
            note="largest at a corner; unsaid: the tension itself reaches "
            f"{tension(solved(5), np.linspace(0, 1, 2001)).max():.2f} N for a least tension of 1 N",
        ),
        S.number(
            "f(k=5) - f(k=4)", "3.1", "-0.0076", f[5] - f[4], "N^2 m^2", correction=Reason(third, (f[5] - f[4]) / 3)
        ),
        S.number(
            "f(k=10) - f(k=5)", "3.1", "-0.0035", f[10] - f[5], "N^2 m^2", correction=Reason(third, (f[10] - f[5]) / 3)
        ),
        S.sentence(
            "beyond k = 5 the improvement is light",
            "3.1",
            100 * (f[5] / FLOOR - 1),
            lambda x: x < 10,
            "%",
            note="how far k = 5 lies above the floor of all identical springs, 0.019903 N^2 m^2; k = 10 "
            f"{100 * (f[10] / FLOOR - 1):.0f} %: the plateau is one of polynomials, splines reach the floor",
        ),
        S.sentence(
            "any other t_min leads to very similar results",
            "3.1",
            other,
            lambda x: abs(x) < 1e-7,
            note="f(7 N) / 49 f(1 N) - 1: exactly proportional",
        ),
        S.sentence(
            "the square has the same minimiser, so the integral of |f_r| is minimised too",
            "2.1",
            100 * (square / by_mean - 1),
            lambda x: abs(x) < 0.01,
            "%",
            note="excess of int |f_r| at the square's optimum over its own least value, k = 5: what holds at one pose "
            "does not hold for the integral",
        ),
    ]


def _on(design: Design, other: Design) -> tuple[Array, Array]:
    """|f_r| of another design's springs at this design's poses, and the weights."""
    force = other.residual(design.states, "wrench")
    return np.linalg.norm(force, axis=1), design.states.weight


def _least_eigenvalue(k: int) -> float:
    from equipoise.assemble import effort

    design = solved(k)
    A = effort(design.mechanism, design.balancers, design.states, "wrench").A
    return float(np.linalg.eigvalsh(np.einsum("n,nri,nrj->ij", design.states.weight, A, A))[0])
