"""The literature: references.bib read into sentences."""

from __future__ import annotations

import functools
import re
from importlib.resources import files


@functools.cache
def entries() -> dict[str, dict[str, str]]:
    """{key: {field: text}} of data/references.bib, which keeps to `field = {text}` on one line."""
    text = (files("equipoise") / "data" / "references.bib").read_text(encoding="utf-8")
    found = {}
    for key, body in re.findall(r"@\w+\{([\w-]+),(.*?)\n\}", text, flags=re.DOTALL):
        found[key] = dict(re.findall(r"^\s*(\w+)\s*=\s*\{(.*)\},?$", body, flags=re.MULTILINE))
    return found


def reference(key: str) -> str:
    """The full reference of a key: `V. Arakelian, S. Ghazaryan: Title. Journal 43(5), 565-575, 2008. doi:...`.

    Raises KeyError for a key that references.bib does not hold.
    """
    entry = entries()[key]
    place = entry.get("journal") or entry.get("booktitle") or entry.get("publisher") or ""
    volume = entry.get("volume", "") + (f"({entry['number']})" if "number" in entry else "")
    pages = f"pp. {entry['pages'].replace('--', '–')}" if "pages" in entry else ""
    where = ", ".join(part for part in (f"{place} {volume}".strip(), pages, entry.get("year", "")) if part)
    doi = f"doi:{entry['doi']}" if "doi" in entry else ""
    authors = entry["author"].replace(" and ", ", ").strip("{}")
    parts = (f"{authors}: {entry['title']}", where, entry.get("note", ""), doi)
    return ". ".join(part for part in parts if part) + "."
