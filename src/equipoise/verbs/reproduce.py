"""reproduce: the papers' printed numbers, ours beside them, and a verdict for each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from equipoise.claim import Claim
from equipoise.papers.paper import Improvement, Paper


@dataclass(frozen=True)
class Reproduction:
    """One paper recomputed: its claims with verdicts, and what the same parts can do."""

    paper: Paper
    claims: Sequence[Claim]
    improved: Sequence[Improvement]

    def write(self, out: Path) -> list[Path]:
        """Write the page, a PNG file per figure and the improved results to a folder; the page comes last."""
        from equipoise.papers import pages
        from equipoise.reporting.jsonfile import dumps

        page, data = out / f"{self.paper.slug}.html", out / f"{self.paper.slug}.json"
        page.write_text(pages.html(self.paper, self.claims, self.improved, out), encoding="utf-8")
        both = {"claims": [c.json() for c in self.claims], "improved": [i.json() for i in self.improved]}
        data.write_text(dumps(both), encoding="utf-8")
        return [*(out / pages.file_name(self.paper, drawing) for drawing in self.paper.drawings), data, page]

    def json(self) -> list[dict[str, Any]]:
        """The claims as `equipoise reproduce --json` prints them."""
        return [claim.json() for claim in self.claims]

    def __str__(self) -> str:
        from equipoise.papers.words import whole

        return whole(self.paper, self.claims, self.improved)


def reproduce(paper: str | None = None, *, progress: Callable[[str], None] | None = None) -> tuple[Reproduction, ...]:
    """Recompute one paper, named by its slug or an unambiguous part of it, or all of them.

    progress is told each slug before its computation begins.
    Raises InputError for a name that fits no paper, or several.
    """
    from equipoise.papers import find
    from equipoise.papers import paper as load

    found = []
    for slug in find(paper):
        if progress is not None:
            progress(slug)
        one = load(slug)
        found.append(Reproduction(one, one.claims(), one.improved()))
    return tuple(found)
