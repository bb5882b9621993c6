"""Writes the documentation's pages: `python -m equipoise.papers docs/papers`."""

from __future__ import annotations

import sys
from pathlib import Path

from equipoise.papers import SLUGS, paper
from equipoise.papers.pages import markdown


def write(folder: Path) -> None:
    """A page per paper, named by its slug."""
    folder.mkdir(parents=True, exist_ok=True)
    for slug in SLUGS:
        one = paper(slug)
        (folder / f"{slug}.md").write_text(markdown(one, one.claims(), one.improved()), encoding="utf-8")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
