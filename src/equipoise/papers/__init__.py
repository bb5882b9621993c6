"""The papers: every printed number and checkable sentence, ours beside it, and a verdict."""

from __future__ import annotations

import importlib

from equipoise.errors import InputError, nearest
from equipoise.papers.paper import Paper

SLUGS: tuple[str, ...] = (
    "arakelian-ghazaryan-2008",
    "quaglia-yin-2015",
    "arakelian-smith-2008",
    "zhang-arakelian-2023",
    "perreault-cardou",
)
"""Papers in the order in which they are shown; the module and the key in references.bib have underscores."""


def find(part: str | None = None) -> tuple[str, ...]:
    """Slugs of all papers, or of the one that `part` names.

    Raises InputError for a part that fits none or several.
    """
    if part is None:
        return SLUGS
    word = part.strip().lower().replace("_", "-").replace(" ", "-").strip("-")
    fitting = [slug for slug in SLUGS if word == slug] or [slug for slug in SLUGS if word and word in slug]
    if len(fitting) != 1:
        what = f"fits {' and '.join(fitting)}" if fitting else "fits no paper"
        hint = "give more of its name" if fitting else nearest(word, SLUGS)
        raise InputError(f"{part!r} {what}", where="reproduce", hint=hint)
    return tuple(fitting)


def paper(slug: str) -> Paper:
    """The paper of a slug, loaded on demand."""
    return importlib.import_module(f"equipoise.papers.{slug.replace('-', '_')}").PAPER
