"""Arakelian & Ghazaryan 2008: springs that have mass, and a leg orthosis [arakelian_ghazaryan_2008]."""

from equipoise.papers.arakelian_ghazaryan_2008.claims import claims
from equipoise.papers.arakelian_ghazaryan_2008.drawings import DRAWINGS
from equipoise.papers.arakelian_ghazaryan_2008.improved import improved
from equipoise.papers.paper import Paper

PAPER = Paper(
    slug="arakelian-ghazaryan-2008",
    about="A rotating link, and a human leg, are balanced by springs that hang on them and therefore weigh on them. "
    "The wire's mass grows with the root of the rate, so the rate follows from a quadratic (zero free length) or is "
    "sought by a cubic (other free lengths).",
    given="link m1 = 8 kg, s1 = 0.183 m, psi = 0, 120 to 180 deg; Y_B = 0.16 m, X_B = 0, r = 0.3 m; wire G = 81,000 "
    "N/mm^2, rho = 7800 kg/m^3, D = 0.04 m, n = 80, L_w = 10.38 m (zero free length) and 8 m (l0 = 0.3 m, F0 = 0); "
    "leg l1 = 0.4322 m, l2 = 0.421 m, 7.39, 3.11 and 0.97 kg, centres at 0.41 l1 and 0.44 l2; its springs n = 66 and "
    "62, L_w = 8.6 and 7.8 m. g = 9.81 m/s^2; angles count from straight up.",
    findings=(
        "Half the spring's mass at its moving end is the right static model; with zero free length it is exact.",
        "The cubic minimises the square of the summed moment, not the sum of squares: it only makes the mean moment "
        "zero. The right cubic has sums of products in place of products of sums. The printed 1114 N/m, from an "
        "arithmetic slip, happens to lie near the true optimum of a fine grid.",
        "Results depend on the grid: the rms optimum is 1131 N/m on the paper's 5 deg grid and 1119 N/m on 1 deg.",
        "The spring of section 3.2 cannot be wound: 80 coils of 4.9 mm wire are 390 mm long, its free length is "
        "300 mm, and 8 m of wire make 61 coils.",
        "The leg's balance needs a spring of negative rate between hip and shank. No passive coil has one; a real "
        "spring there can take the mean pull off the knee, see the last table.",
        "D = 0.4 m of the leg's springs is a misprint of 0.04 m, and Eq. 45 lost a factor 2 under the root.",
        "Moments are printed in N/m; they are N m.",
    ),
    claims=claims,
    improved=improved,
    drawings=DRAWINGS,
)
