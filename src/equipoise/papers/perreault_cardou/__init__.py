"""Perreault & Cardou: nonlinear springs that keep the cables of a planar point taut [perreault_cardou]."""

from equipoise.papers.paper import Paper
from equipoise.papers.perreault_cardou.claims import claims
from equipoise.papers.perreault_cardou.drawings import DRAWINGS
from equipoise.papers.perreault_cardou.improved import improved

PAPER = Paper(
    slug="perreault-cardou",
    about="Three cables hold a point in their equilateral triangle. Identical nonlinear springs on the reels keep "
    "every cable taut without motors, and a quadratic program finds the polynomial whose resultant is least.",
    given="a = 1 m, t_min = 1 N, polynomials of degree k - 1 for k = 1 to 10, t >= t_min at q = 10 k equally spaced "
    "lengths (ends included), Eq. 16. Its (x, y) is (x, 0, z) here.",
    findings=(
        "The objective's printed differences are a third of what Eqs. 14 and 16 give.",
        "Ten k sample lengths let the tension fall up to 0.9 % below the limit in between; keeping every length costs "
        "at most 0.4 % of f.",
        "k = 5 is 96 % above what identical springs can reach, k = 10 still 43 %: the plateau is one of polynomials.",
        "From k = 5 on the centroid is no longer where the platform rests: with motors off it falls into one of "
        "several minima; the tension peaks at 7.4 times its least value.",
        "P is positive definite for every k; the proof is in docs/cables.md. Distinct springs or even powers on other "
        "robots can make it singular.",
    ),
    claims=claims,
    improved=improved,
    drawings=DRAWINGS,
)
