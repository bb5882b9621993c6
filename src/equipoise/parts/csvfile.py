"""A CSV file as text and as rows of cells, whatever wrote it."""

from __future__ import annotations

import codecs
import csv
from collections.abc import Sequence
from pathlib import Path

from equipoise.errors import InputError

MAX_BYTES = 64 * 1024 * 1024


def text_of(path: Path, name: str) -> str:
    """What a file says: UTF-8, UTF-16 with its mark, or else what Windows writes."""
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError("the file is larger than 64 MB", where=name)
        raw = path.read_bytes()
    except (OSError, ValueError) as error:
        said = f"the catalogue cannot be read: {getattr(error, 'strerror', None) or error}"
        raise InputError(said, where=name, hint="paths in a problem file count from the file") from None
    wide = raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        text = raw.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("cp1252", errors="replace")
    if "\0" in text:
        raise InputError("this is no text file", where=name, hint="save the table as CSV")
    return text


def rows_of(kept: Sequence[tuple[int, str]], delimiter: str, name: str) -> list[tuple[int, list[str]]]:
    """Cells of every row with the number of its first line, for a quoted cell may go over several."""
    reader = csv.reader((f"{line}\n" for _, line in kept), delimiter=delimiter, strict=True)
    found, start = [], 0
    try:
        for cells in reader:
            found.append((kept[start][0], [" ".join(cell.split("\n")) for cell in cells]))
            start = reader.line_num
    except csv.Error as error:
        long = "field limit" in str(error)
        said = f"a cell has more than {csv.field_size_limit()} characters" if long else f"a quote is amiss: {error}"
        where, hint = f"{name}, row {kept[start][0]}", "close every quote, and write one inside a cell twice"
        raise InputError(said, where=where, hint=hint) from None
    return found
