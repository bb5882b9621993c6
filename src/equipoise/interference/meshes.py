"""Corner points of collision meshes: STL, binary and text, and OBJ."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from equipoise.affine import Array
from equipoise.errors import ModelError

HEADER, COUNT, FACET = 80, 4, 50
LARGEST = 64 * 1024 * 1024
READABLE = (".stl", ".obj")


def corners(path: Path) -> Array:
    """Corner points (V, 3) of a mesh file in its own units; raises ModelError for a file that is none."""
    try:
        if path.stat().st_size > LARGEST:
            raise ModelError("the mesh is larger than 64 MB", where=str(path))
        data = path.read_bytes()
    except OSError as error:
        raise ModelError(f"the mesh cannot be read: {error.strerror or error}", where=str(path)) from None
    try:
        found = _obj(data) if path.suffix.lower() == ".obj" else _stl(data)
    except (ValueError, IndexError):
        raise ModelError("this is no STL or OBJ mesh", where=str(path)) from None
    if not len(found) or not np.isfinite(found).all():
        raise ModelError("the mesh holds no points, or some that are not finite", where=str(path))
    return np.unique(found, axis=0)


def _stl(data: bytes) -> Array:
    """Text files begin with `solid`, and so do some binary ones: the size decides."""
    count = int.from_bytes(data[HEADER : HEADER + COUNT], "little") if len(data) >= HEADER + COUNT else -1
    if len(data) == HEADER + COUNT + FACET * count:
        facets = np.frombuffer(data, dtype=np.uint8, offset=HEADER + COUNT).reshape(-1, FACET)
        return facets[:, 12:48].copy().view("<f4").reshape(-1, 3).astype(float)
    words = [line.split()[1:4] for line in data.decode("utf-8").splitlines() if line.split()[:1] == ["vertex"]]
    return np.array(words, dtype=float).reshape(-1, 3)


def _obj(data: bytes) -> Array:
    words = [line.split()[1:4] for line in data.decode("utf-8").splitlines() if line.startswith("v ")]
    return np.array(words, dtype=float).reshape(-1, 3)
