"""MJCF files: looked through with all they include, then read by MuJoCo."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from pathlib import Path

import mujoco

from equipoise.errors import ModelError
from equipoise.models.notices import refusals, some
from equipoise.models.xmlfile import not_finite, read_xml

_MOST = 10_000
_MOST_FILES = 200
_WORDS = frozenset({"name", "class", "model", "prefix", "file", "content_type"})
_SIZES: dict[str, tuple[str, ...]] = {
    "size": ("njmax", "nconmax", "nuserdata", "nkey", "nuser_body", "nuser_jnt", "nuser_geom", "nuser_site",
             "nuser_cam", "nuser_tendon", "nuser_actuator", "nuser_sensor"),
    "hfield": ("nrow", "ncol"),
    "texture": ("width", "height", "gridsize"),
    "numeric": ("size",),
    "camera": ("resolution",),
    "mesh": ("params",),
    "user": ("dim",),
}  # fmt: skip
_REPEATS = ("replicate", "composite", "flexcomp")


def read_mjcf(path: Path, root: ET.Element, where: str) -> tuple[mujoco.MjSpec, list[str]]:
    """The MuJoCo spec of an MJCF file with its includes, and remarks on names that had to be made up.

    Raises ModelError for plugins, soft bodies, sizes that no mechanism has, and for what MuJoCo refuses.
    """
    if path.suffix.lower() != ".xml":
        raise ModelError("MJCF is read only from files that end in .xml", where=where, hint="rename the file")
    _look_through(path, root, where)
    with refusals(where, "MuJoCo names the element and the line"):
        spec = mujoco.MjSpec.from_file(str(path))
        if spec.plugins:
            raise ModelError("plugins in a file are refused", where=where)
        if spec.flexes:
            raise ModelError("soft bodies (flex) cannot be balanced", where=where, hint="remove them from the file")
        remarks = list(_name_all(spec))
    return spec, remarks


def _look_through(path: Path, root: ET.Element, where: str) -> None:
    """Refuse what must not reach MuJoCo, in this file and in all that it includes or attaches."""
    seen = {path.resolve()}
    waiting = [(path, root, where)]
    while waiting:
        file, element, place = waiting.pop()
        _check(element, place)
        for name in _referred(element):
            # MuJoCo has looked beside the main and beside the including file: both are looked through.
            for folder in dict.fromkeys([path.parent, file.parent]):
                inner = folder / name
                if not inner.is_file() or inner.resolve() in seen:
                    continue
                seen.add(inner.resolve())
                if len(seen) > _MOST_FILES:
                    raise ModelError(f"more than {_MOST_FILES} files are included", where=where)
                waiting.append((inner, read_xml(inner, f"{where}, included {name}"), f"{where}, included {name}"))


def _referred(root: ET.Element) -> Iterator[str]:
    """XML files that an element brings in: includes, and models to attach wherever they are kept."""
    folders = [""]
    for compiler in root.iter("compiler"):
        folders += [value for key in ("assetdir", "meshdir") if (value := compiler.get(key))]
    for element in (*root.iter("include"), *root.iter("model")):
        if name := element.get("file"):
            yield from (f"{folder}/{name}" if folder else name for folder in folders if "\0" not in name)


def _check(root: ET.Element, where: str) -> None:
    stack: list[tuple[ET.Element, int]] = [(root, 1)]
    while stack:
        element, copies = stack.pop()
        if element.tag in ("plugin", "extension"):
            raise ModelError("plugins in a file are refused", where=where, hint=f"remove the <{element.tag}> element")
        for key, value in element.items():
            if key not in _WORDS and not_finite(value):
                raise ModelError(f"{key} of {_called(element)} is not finite: {value[:40]!r}", where=where)
        for key in _SIZES.get(element.tag, ()):
            _product(element, key, 1, where)
        if element.tag in _REPEATS:
            copies = _product(element, "count", copies, where)
        stack.extend((child, copies) for child in element)


def _product(element: ET.Element, key: str, start: int, where: str) -> int:
    """The number of copies that a count makes; MuJoCo would allocate any."""
    total = start
    for word in element.get(key, "").split():
        try:
            size = float(word)
        except ValueError:
            continue  # MuJoCo says it better
        many = key == "count"
        total = math.ceil(max(1.0, size) * total) if many and math.isfinite(size) else total
        if not size <= _MOST or total > _MOST:
            raise ModelError(
                f"{key} of {_called(element)} makes {max(size, total):g}, beyond {_MOST:,}",
                where=where,
                hint="reduce it: no mechanism needs so many",
            )
    return total


def _called(element: ET.Element) -> str:
    name = element.get("name")
    return f"<{element.tag}>" if name is None else f"<{element.tag}> {name!r}"


def _name_all(spec: mujoco.MjSpec) -> Iterator[str]:
    """Give every body and joint a name, for all are spoken of by name."""
    for kind, items in (("body", list(spec.bodies)[1:]), ("joint", list(spec.joints))):
        taken = {item.name for item in items} | {"world"}
        made = []
        for index, item in enumerate(items):
            if not item.name:
                item.name = _fresh(f"{kind}{index + 1}", taken.__contains__)
                taken.add(item.name)
                made.append(item.name)
        if made:
            plural = {"body": "bodies", "joint": "joints"}[kind]
            yield f"{plural} without a name in the file are called {some(made)}"


def _fresh(name: str, taken: Callable[[str], bool]) -> str:
    while taken(name):
        name += "_"
    return name
