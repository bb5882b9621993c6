"""Addresses of robot files: plain paths and `package://`, looked up without importing anything."""

from __future__ import annotations

import importlib.util
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path

from equipoise.errors import InputError, ModelError, nearest

_ADDRESS = re.compile(r"package:/{1,3}")
_ROBOT_FILES = (".urdf", ".xml", ".mjcf")
_EXAMPLE_DATA = "example-robot-data"


def resolve(address: str | Path, search: tuple[str | Path, ...] = ()) -> Path:
    """The file that a path or a `package://<package>/<path>` address means.

    A package is a folder in `search`, ROS_PACKAGE_PATH, AMENT_PREFIX_PATH/share, in a `share` folder of the
    Python installation, or an installed Python package (never imported). Without a path, the package's only
    robot file. Raises ModelError with the places looked at, or the nearest file names.
    """
    text = str(address)
    if not text.strip() or "\0" in text:
        raise InputError(f"{text!r} is not a file name", hint="give a path or package://<package>/<path>")
    if found := _ADDRESS.match(text):
        return _in_package(text, text[found.end() :], search)
    return _existing(Path(text).expanduser(), text)


def _in_package(address: str, rest: str, search: tuple[str | Path, ...]) -> Path:
    package, *parts = re.split(r"[/\\]", rest)
    if not package or package in (".", "..") or ":" in package:
        raise InputError("the address names no package", where=address, hint="write package://<package>/<path>")
    inside = os.path.normpath("/".join(parts)) if any(parts) else "."
    # Judged on the text alone: installed packages may hold links that lead elsewhere on purpose.
    if inside.startswith(("..", "/")) or (parts and ".." in parts and re.search(r"^[A-Za-z]:", inside)):
        raise ModelError("the path leaves the package's folder", where=address, hint="remove the `..`")
    folders = list(dict.fromkeys(_folders(package, search)))
    for folder in folders:
        if _is(folder / inside, "file"):
            return folder / inside
    if folders:
        only = _robots_in(folders[0]) if inside == "." else []
        return only[0] if len(only) == 1 else _existing(folders[0] / inside, address)
    looked = "; ".join(_places(search))
    raise ModelError(f"there is no package {package!r}; looked in {looked}", where=address, hint=_remedy(package))


def _remedy(package: str) -> str:
    if package == _EXAMPLE_DATA:
        return "pip install 'equipoise[robots]'"
    return f"name the folder that holds {package} in `search`, or in ROS_PACKAGE_PATH"


def _places(search: tuple[str | Path, ...]) -> list[str]:
    ros = os.environ.get("ROS_PACKAGE_PATH", "")
    ament = os.environ.get("AMENT_PREFIX_PATH", "")
    return [
        "search: " + (", ".join(map(str, search)) or "nothing given"),
        "ROS_PACKAGE_PATH: " + (ros or "not set"),
        "AMENT_PREFIX_PATH: " + (ament or "not set"),
        "the `share` folders and Python packages of this installation",
    ]


def _folders(package: str, search: tuple[str | Path, ...]) -> Iterator[Path]:
    """Folders that are this package, the most deliberate first."""
    for root in [*map(Path, search), *_listed("ROS_PACKAGE_PATH")]:
        yield from _under(root.expanduser(), package)
    for root in _listed("AMENT_PREFIX_PATH"):
        if _is(root / "share" / package, "folder"):
            yield root / "share" / package
    for share in _shares():
        for root in (share, share / _EXAMPLE_DATA / "robots"):
            if _is(root / package, "folder"):
                yield root / package
    yield from _python_package(package)


def _under(root: Path, package: str) -> Iterator[Path]:
    """A search entry may be the package, hold it, or hold repositories that hold it."""
    if root.name == package and _is(root, "folder"):
        yield root
    if _is(root / package, "folder"):
        yield root / package
    try:
        inner = sorted(entry for entry in root.iterdir() if not entry.name.startswith("."))
    except (OSError, ValueError):
        return
    yield from (entry / package for entry in inner if _is(entry / package, "folder"))


def _listed(variable: str) -> list[Path]:
    return [Path(entry) for entry in os.environ.get(variable, "").split(os.pathsep) if entry]


def _shares() -> Iterator[Path]:
    roots = [Path(entry) for entry in sys.path if entry]
    for root in dict.fromkeys([*roots, Path(sys.prefix)]):
        yield from (root / "cmeel.prefix" / "share", root / "share")


def _python_package(package: str) -> Iterator[Path]:
    name = package.replace("-", "_")
    if not name.isidentifier():
        return
    try:
        spec = importlib.util.find_spec(name)
    except (ImportError, ValueError, AttributeError):
        return
    if spec is not None and spec.submodule_search_locations:
        yield from (Path(entry) for entry in spec.submodule_search_locations)


def _existing(path: Path, address: str) -> Path:
    if _is(path, "file"):
        return path
    if _is(path, "folder"):
        names = ", ".join(str(file.relative_to(path)) for file in _robots_in(path)[:8]) or "no .urdf or .xml file"
        raise ModelError(f"this is a folder; it holds {names}", where=address, hint="name one file")
    folder = path.parent
    while not _is(folder, "folder") and folder != folder.parent:
        folder = folder.parent
    if folder != path.parent:
        raise ModelError(f"there is no folder {path.parent}", where=address, hint=f"{folder} is there; check the rest")
    names = sorted(file.name for file in folder.iterdir() if file.suffix.lower() in _ROBOT_FILES)
    raise ModelError(f"there is no file {path.name!r} in {folder}", where=address, hint=nearest(path.name, names))


def _robots_in(folder: Path) -> list[Path]:
    """Robot files of a folder, its own before those below; bounded, for a folder may be anything."""
    found: list[Path] = []
    for seen, (root, folders, files) in enumerate(os.walk(folder)):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        found += [Path(root) / name for name in sorted(files) if name.lower().endswith(_ROBOT_FILES)]
        if seen > 500 or len(found) > 50:
            break
    return [file for file in found if file.name != "package.xml"]


def _is(path: Path, kind: str) -> bool:
    try:
        return path.is_file() if kind == "file" else path.is_dir()
    except (OSError, ValueError):  # a name longer than the system allows
        return False
