"""reproduce: the papers' printed numbers, ours beside them, and a verdict for each."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from equipoise.claim import Claim
from equipoise.errors import InputError
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


def reproduce(
    paper: str | None = None, *, workers: int = 1, progress: Callable[[str], None] | None = None
) -> tuple[Reproduction, ...]:
    """Recompute one paper, named by its slug or an unambiguous part of it, or all of them.

    workers processes share the work; a script that asks for more than one needs the usual guard of
    multiprocessing. progress is told each slug before its computation begins.
    Raises InputError for a name that fits no paper, or several, or for no worker.
    """
    from equipoise.papers import find
    from equipoise.papers import paper as load

    if workers < 1:
        raise InputError(f"{workers} workers", where="reproduce", hint="use at least one")
    slugs = find(paper)
    parts = [(slug, part) for slug in slugs for part in ("claims", "improved")]
    with _mapped(min(workers, len(parts))) as run:
        found = run(_recompute, parts)
        answers = []
        for slug in slugs:
            if progress is not None:
                progress(slug)
            answers.append(Reproduction(load(slug), next(found), next(found)))
    return tuple(answers)


def _recompute(part: tuple[str, str]) -> Sequence[Any]:
    """The claims or the improvements of a paper."""
    from equipoise.papers import paper

    slug, which = part
    return tuple(getattr(paper(slug), which)())


@contextmanager
def _mapped(workers: int) -> Iterator[Callable[..., Iterator[Any]]]:
    """map over that many processes; in this one where one is enough."""
    if workers == 1:
        yield map
        return
    from equipoise.verbs.workers import processes

    with processes(workers) as pool:
        yield pool.map
