"""Robot files as XML: read once, refused when they could do harm, numbers that are numbers."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import cast

from equipoise.errors import ModelError

BIGGEST_FILE = 32_000_000
"""Bytes: the largest robot description seen has a fiftieth of this."""

_DECLARATION = re.compile(rb"<!\s*(DOCTYPE|ENTITY|ELEMENT|ATTLIST|NOTATION)", re.IGNORECASE)
_ENCODING = re.compile(rb"^\s*<\?xml[^>]*?encoding\s*=\s*[\"']([^\"']*)[\"']")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_DEEPEST = 400
_MOST_ELEMENTS = 1_000_000


def read_xml(path: Path, where: str, drop: re.Pattern[bytes] | None = None) -> ET.Element:
    """The root element of an XML file, its comments dropped.

    Raises ModelError for a file that cannot be read, is not XML, is too large or too deep, or declares a
    document type or entities: those could expand without bound or point outside the file. drop is what a known
    format declares harmlessly; it is removed first, its lines kept.
    """
    data = _read_bytes(path, where)
    if drop is not None:
        data = drop.sub(lambda found: b"\n" * found[0].count(b"\n"), data, count=1)
    if not data.strip():
        raise ModelError("the file is empty", where=where)
    if b"\0" in data or data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise ModelError("this is not UTF-8 text", where=where, hint="give a URDF or MJCF file saved as UTF-8")
    encoding = _ENCODING.match(data.removeprefix(b"\xef\xbb\xbf"))
    # Any other encoding could hide a declaration from the search below.
    if encoding and encoding[1].lower() not in (b"utf-8", b"utf8", b"us-ascii", b"ascii"):
        name = encoding[1][:40].decode("ascii", "replace")
        raise ModelError(f"the encoding {name!r} is not read", where=where, hint="save the file as UTF-8")
    if found := _DECLARATION.search(data):
        line = data.count(b"\n", 0, found.start()) + 1
        raise ModelError(
            f"line {line} declares {found[1].decode().upper()}, which is refused",
            where=where,
            hint="remove the declaration and write the entities out",
        )
    return _parse(data, where)


def _read_bytes(path: Path, where: str) -> bytes:
    try:
        # Reading stops at the limit: a pipe or device has no size to ask for beforehand.
        if not path.is_file():
            raise ModelError("there is no such file", where=where)
        with path.open("rb") as file:
            data = file.read(BIGGEST_FILE + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ModelError(f"the file cannot be read: {reason}", where=where) from None
    if len(data) > BIGGEST_FILE:
        raise ModelError(f"the file is larger than {BIGGEST_FILE // 1_000_000} MB", where=where)
    return data


def _parse(data: bytes, where: str) -> ET.Element:
    depth = count = 0
    root: ET.Element | None = None
    parser = ET.XMLPullParser(("start", "end"))
    try:
        for start in range(0, len(data), 1 << 16):
            parser.feed(data[start : start + (1 << 16)])
            for event, element in cast("Iterator[tuple[str, ET.Element]]", parser.read_events()):
                depth += 1 if event == "start" else -1
                count += event == "start"
                root = element if root is None else root
                if depth > _DEEPEST:
                    raise ModelError(f"elements are nested more than {_DEEPEST} deep", where=where)
                if count > _MOST_ELEMENTS:
                    raise ModelError(f"the file holds more than {_MOST_ELEMENTS:,} elements", where=where)
        parser.close()
    except (ET.ParseError, ValueError, LookupError) as error:
        raise ModelError(
            f"this is not well-formed XML: {error}", where=where, hint="give a URDF or MJCF file; expand xacro first"
        ) from None
    if root is None:
        raise ModelError("the file holds no element", where=where)
    return root


def number(text: str | None, default: float, what: str, where: str, most: float = 1e6) -> float:
    """One finite number of magnitude at most `most`; the default where the attribute is absent.

    Raises ModelError naming `what` for other text, NaN, infinity and magnitudes no mechanism has.
    """
    if text is None:
        return default
    word = text.strip()
    if not _NUMBER.fullmatch(word):
        hint = "this is a xacro template: run xacro on it first" if "${" in word else "write a plain decimal number"
        raise ModelError(f"{what} is {_short(word)!r}, not a finite number", where=where, hint=hint)
    value = float(word)
    if not abs(value) <= most:
        raise ModelError(f"{what} is {_short(word)}, beyond {most:g}", where=where, hint="check its unit and exponent")
    return value


def numbers(text: str | None, default: tuple[float, ...], what: str, where: str) -> tuple[float, ...]:
    """As many finite numbers, separated by spaces, as the default has."""
    if text is None:
        return default
    words = text.split()
    if len(words) != len(default):
        raise ModelError(f"{what} needs {len(default)} numbers, got {_short(text)!r}", where=where)
    return tuple(number(word, 0.0, what, where) for word in words)


def not_finite(text: str) -> bool:
    """Whether one word of an attribute is NaN or an infinity, as a C library would read it."""
    for word in text.split():
        try:
            if not math.isfinite(float(word)):
                return True
        except ValueError:
            return False
    return False


def _short(text: str) -> str:
    return text if len(text) <= 40 else text[:40] + "..."
