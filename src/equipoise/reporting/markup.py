"""HTML in pieces. Text is escaped unless it is `Raw`, so that no name out of a file can become markup."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Sequence


class Raw(str):
    """Text that is HTML already."""

    __slots__ = ()


def clean(text: str) -> Raw:
    """Text as HTML; `Raw` passes unchanged."""
    return text if isinstance(text, Raw) else Raw(html.escape(str(text), quote=True))


def prose(text: str) -> Raw:
    """A sentence of ours as HTML: what stands between backticks is code."""
    return Raw(re.sub(r"`([^`]*)`", r"<code>\1</code>", clean(text)))


def join(parts: Iterable[str], between: str = "") -> Raw:
    """Pieces one after the other."""
    return Raw(between.join(clean(part) for part in parts))


def element(name: str, *content: str, **attributes: str) -> Raw:
    """`<name key="value">content</name>`; a trailing underscore keeps Python's words free (`class_`)."""
    written = "".join(f' {key.rstrip("_")}="{clean(value)}"' for key, value in attributes.items())
    return Raw(f"<{name}{written}>{join(content)}</{name}>")


def small(text: str) -> Raw:
    """A second line in a table's cell."""
    return element("span", text, class_="sub")


def table(
    head: Sequence[str], rows: Iterable[Sequence[str]], *, numbers: int = 0, groups: str = "", kind: str = ""
) -> Raw:
    """A table that scrolls sideways on a narrow screen; all but the first `numbers` columns read as figures."""

    def cell(kind: str, index: int, content: str) -> Raw:
        return element(kind, content, class_="n") if index >= numbers else element(kind, content)

    top = element("tr", *[cell("th", index, content) for index, content in enumerate(head)])
    body = [element("tr", *[cell("td", index, content) for index, content in enumerate(row)]) for row in rows]
    heads = element("thead", Raw(groups), top) if any(head) else ""
    return element("div", element("table", heads, element("tbody", *body)), class_=f"scroll {kind}".strip())


def listing(items: Iterable[str]) -> Raw:
    """A bullet list."""
    return element("ul", *[element("li", item) for item in items])


def section(title: str, *content: str, lead: str = "") -> Raw:
    """A titled part of the page."""
    return element("section", element("h2", title), element("p", lead, class_="lead") if lead else "", *content)


def image(address: str, alternative: str, caption: str = "") -> Raw:
    """A picture that is part of the file, with what it shows in words."""
    picture = Raw(f'<img src="{clean(address)}" alt="{clean(alternative)}">')
    return element("figure", picture, element("figcaption", caption) if caption else "")
