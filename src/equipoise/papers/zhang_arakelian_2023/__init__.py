"""Zhang & Arakelian 2023: a slider-crank compensator with an ordinary spring [zhang_arakelian_2023]."""

from equipoise.papers.paper import Paper
from equipoise.papers.zhang_arakelian_2023.claims import claims
from equipoise.papers.zhang_arakelian_2023.drawings import DRAWINGS
from equipoise.papers.zhang_arakelian_2023.improved import improved

PAPER = Paper(
    slug="zhang-arakelian-2023",
    about="A crank on the rotating link pushes, through a rod, a vertically guided slider against an ordinary spring "
    "on the base. Crank, rod and offset angle follow from a linear system, so that the slider stands at prescribed "
    "positions of the link where constant energy wants it.",
    given="k = 1000 N/m, l0 = 1 m (height of zero force), G = 75 N, s = 0.84 m; angles count from straight up.",
    findings=(
        "The printed designs come out to the last digit, but for other positions than printed (30, 90, 150 deg instead "
        "of 30, 60, 120), and with the energy that makes the largest moment at those positions least.",
        "The printed residuals belong to the design with the sign of beta reversed; the mechanism itself is better: "
        "1.67 and 1.73 N m. Three positions then give the smaller peak, 121 the smaller rms.",
        "Eq. 26 multiplies by the cosine where it must divide, Eq. 30 adds what must be subtracted, and Eqs. 31 and 32 "
        "minimise a sum of signed moments.",
        "The spring's mass does load the link: 0.67 N m per kg of spring. A longer preload takes it away exactly.",
        "Of Eq. 6 only the minus sign, a compression spring, suits rods this short.",
        "Three decimals of r and l move the peak by up to 0.12 N m, a rate 1 % off by 0.6 N m: an adjuster is needed.",
    ),
    claims=claims,
    improved=improved,
    drawings=DRAWINGS,
)
