"""Arakelian & Ghazaryan 2008: springs that have mass, and a leg orthosis [arakelian_ghazaryan_2008]."""

from equipoise.papers.arakelian_ghazaryan_2008.claims import claims
from equipoise.papers.paper import Paper

PAPER = Paper(
    slug="arakelian-ghazaryan-2008",
    about="A rotating link, and a human leg, are balanced by springs whose own mass counts.",
    given="",
    findings=(),
    claims=claims,
)
