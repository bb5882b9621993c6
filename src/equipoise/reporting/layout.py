"""Lines for the terminal: labelled and wrapped text, tables whose last column is a remark."""

from __future__ import annotations

import re
import shutil
import sys
import textwrap
from collections.abc import Mapping, Sequence

WIDEST, NARROWEST = 110, 60
LABEL = 12
REMARK = 24
"""Columns that a remark has at least."""
UNIT = re.compile(r"(?<=\d) (?=(?:%|[^\W\d]{1,3})(?![^\W\d]))|(?<=\bN) (?=m\b)")
"""The space between a number and its unit, and within N m, where no line ends."""
GLUE = "\u00a0"


def width() -> int:
    """Columns to fill: the terminal's, where prose goes to one, between 60 and 110."""
    if not sys.stderr.isatty():
        return WIDEST
    return max(NARROWEST, min(WIDEST, shutil.get_terminal_size((WIDEST, 24)).columns))


def labelled(label: str, text: str) -> list[str]:
    """Text beside a label, wrapped."""
    return wrapped(text, label.ljust(LABEL) if len(label) < LABEL else f"{label}  ")


def wrapped(text: str, lead: str = "") -> list[str]:
    """Text behind a lead, continued below the labels."""
    lines = textwrap.wrap(
        UNIT.sub(GLUE, text), width(), initial_indent=lead, subsequent_indent=" " * min(len(lead), LABEL) or "  ",
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip
    return [line.replace(GLUE, " ") for line in lines]


def blank_repeats(lines: Sequence[str]) -> list[str]:
    """Blank a label that repeats the one above it, so that lists read as lists."""
    shown, last = [], ""
    for line in lines:
        label = line[:LABEL] if line[:1].strip() and len(line) > LABEL and line[LABEL - 1] == " " else ""
        repeated = bool(label) and label == last
        shown.append(" " * LABEL + line[LABEL:] if repeated else line)
        last = label or ("" if line[:1].strip() else last)
    return shown


def table(
    names: Sequence[str],
    head: Sequence[str],
    body: Sequence[Sequence[str]],
    groups: Mapping[int, str] | None = None,
    group: int = 1,
) -> list[str]:
    """Right-aligned columns under their heads; the last column is a remark and reads from the left.

    groups {column: word} stand above the heads, each over `group` columns, with more room before them.
    """
    above = groups or {}
    first = max(len(name) for name in names)
    widths = [max(7, len(head[i]), *(len(row[i]) for row in body)) for i in range(len(head) - 1)]
    beyond = max(above, default=-1) + group
    gaps = [4 if index in above or (above and index == beyond) else 2 for index in range(len(widths))]
    lines = []
    top = " " * (2 + first)
    for index, word in above.items():
        start = 2 + first + sum(gaps[: index + 1]) + sum(widths[:index])
        top = top.ljust(start + widths[index] - len(head[index])) + word
    lines += [top] if above else []
    for name, cells in zip(["", *names], [head, *body], strict=True):
        numbers = "".join(
            " " * gap + cell.rjust(size) for cell, size, gap in zip(cells[:-1], widths, gaps, strict=True)
        )
        lead = f"  {name.ljust(first)}{numbers}   "
        remark = textwrap.wrap(cells[-1], max(REMARK, width() - len(lead)), break_on_hyphens=False) or [""]
        lines.append(f"{lead}{remark[0]}".rstrip())
        lines += [" " * len(lead) + more for more in remark[1:]]
    return lines
