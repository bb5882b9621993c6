"""Problem files as plain data that knows its lines: YAML 1.2 without tags, objects or bombs."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from equipoise.errors import ProblemError

MAX_BYTES = 256 * 1024
MAX_VALUES = 50_000
MAX_DEPTH = 40
MAX_TEXT = 2000

_CORE = "tag:yaml.org,2002:"
# Dates and `=` are what ruamel sees in plain text; they stay text.
_PLAIN = ("map", "seq", "str", "int", "float", "bool", "null", "timestamp", "value")
_INT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_SPECIAL = {".inf": float("inf"), "+.inf": float("inf"), "-.inf": float("-inf"), ".nan": float("nan")}
_WORDS = {"null": None, "~": None, "": None, "true": True, "false": False}


@dataclass(frozen=True, eq=False)
class Document:
    """Plain data of a file, and the line of every entry by the identity of the container that holds it."""

    name: str
    data: Any
    lines: dict[int, dict[Any, int]] = field(default_factory=dict)

    def line(self, container: Any, key: Any) -> int | None:
        """The line, counted from 1, where an entry of a mapping or list stands."""
        return self.lines.get(id(container), {}).get(key)


def read_yaml(path: Path, name: str = "") -> Document:
    """Read a YAML file; raises ProblemError naming file and line for everything that is not plain YAML 1.2."""
    name = name or str(path)
    try:
        with path.open("rb") as stream:
            content = stream.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise ProblemError("there is no such file", where=name, hint=_beside(path)) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ProblemError(f"the file cannot be read: {reason}", where=name, hint="name a readable file") from None
    if len(content) > MAX_BYTES:
        raise ProblemError(
            f"the file is larger than {MAX_BYTES // 1024} kB",
            where=name,
            hint="a problem file is short; put long lists of poses into a CSV: `sweep: {poses: file.csv}`",
        )
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise ProblemError("the file is not UTF-8 text", where=f"{name}, line {line}") from None
    return parse_yaml(text, name)


def parse_yaml(text: str, name: str) -> Document:
    """Parse YAML text; raises ProblemError naming file and line."""
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    try:
        _refuse_towers(text)
        node = YAML(typ="safe", pure=True).compose(text)
    except YAMLError as error:
        raise _syntax(error, name) from None
    except RecursionError:
        raise ProblemError("the blocks are nested too deeply", where=name) from None
    except Exception as error:  # the parser has failures of its own on malformed text
        raise ProblemError(f"the file is not YAML ({type(error).__name__})", where=name) from None
    if node is None:
        return Document(name, None)
    reader = _Reader(name)
    return Document(name, reader.read(node, 0), reader.lines)


def _refuse_towers(text: str) -> None:
    """Raise RecursionError for towers of brackets, which the parser would take seconds to fall off."""
    depth = 0
    for letter in text:
        depth += (letter in "[{") - (letter in "]}")
        if depth > 5 * MAX_DEPTH:
            raise RecursionError


class _Reader:
    """Turns composed nodes into data; an alias counts each time it is used, so bombs run into the bound."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.lines: dict[int, dict[Any, int]] = {}
        self.count = 0

    def read(self, node: Any, depth: int) -> Any:
        self.count += 1
        if self.count > MAX_VALUES or depth > MAX_DEPTH:
            raise ProblemError(
                f"the file holds more than {MAX_VALUES} values or {MAX_DEPTH} levels once its aliases are written out",
                where=self._where(node),
                hint="write the values out, without anchors and aliases",
            )
        if str(node.tag).removeprefix(_CORE) not in _PLAIN:
            shown = str(node.tag).removeprefix(_CORE)[:40]
            what = f"the tag !{shown.lstrip('!')} is not allowed"
            raise ProblemError(what, where=self._where(node), hint="remove it")
        if isinstance(node.value, str):
            if len(node.value) > MAX_TEXT:
                what = f"a text of {len(node.value)} characters"
                raise ProblemError(what, where=self._where(node), hint="shorten it")
            return self._scalar(node)
        place = self.lines.setdefault
        if str(node.tag) == f"{_CORE}seq":
            items = [self.read(child, depth + 1) for child in node.value]
            place(id(items), {i: child.start_mark.line + 1 for i, child in enumerate(node.value)})
            return items
        found: dict[str, Any] = {}
        lines: dict[Any, int] = {}
        for key, value in node.value:
            word = self._scalar(key) if isinstance(key.value, str) else None
            if not isinstance(word, str):
                raise ProblemError("a field's name must be text", where=self._where(key), hint="put it in quotes")
            if word in found:
                raise ProblemError(
                    f"the field {word!r} is given twice, first on line {lines[word]}",
                    where=self._where(key),
                    hint="remove one of the two",
                )
            found[word] = self.read(value, depth + 1)
            lines[word] = key.start_mark.line + 1
        place(id(found), lines)
        return found

    def _scalar(self, node: Any) -> Any:
        """A scalar by the core schema of YAML 1.2, whatever version the file claims."""
        text = node.value
        if node.style not in (None, ""):
            return text
        if text.lower() in _WORDS and text in (text.lower(), text.upper(), text.capitalize()):
            return _WORDS[text.lower()]
        if len(text) > 64:
            return text
        if _INT.fullmatch(text):
            return int(text, 0) if text[:2] in ("0o", "0x") else int(text)
        if _FLOAT.fullmatch(text):
            return float(text)
        return _SPECIAL.get(text.lower(), text)

    def _where(self, node: Any) -> str:
        return f"{self.name}, line {node.start_mark.line + 1}"


def _syntax(error: Any, name: str) -> ProblemError:
    mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
    where = f"{name}, line {mark.line + 1}, column {mark.column + 1}" if mark is not None else name
    problem = getattr(error, "problem", None) or str(error).splitlines()[0]
    context = getattr(error, "context", None)
    said = " ".join(f"{context + ', ' if context else ''}{problem}".split())
    hint = "check indentation, brackets, colons and tabs near this place"
    return ProblemError(f"not valid YAML: {said}"[:300], where=where, hint=hint)


def _beside(path: Path) -> str:
    from equipoise.errors import nearest

    try:
        names = sorted(entry.name for entry in path.parent.iterdir() if entry.suffix in (".yaml", ".yml"))
    except OSError:
        return f"there is no folder {path.parent} either"
    return nearest(path.name, names) if names else "check the path"
