"""Strict JSON: no NaN, no Infinity, no NumPy, whatever a design holds."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np


def strict(value: Any) -> Any:
    """The same data with numbers that are not finite as null, arrays as lists and paths as text."""
    if isinstance(value, Mapping):
        return {str(key): strict(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [strict(item) for item in value]
    if isinstance(value, np.ndarray | np.generic):
        return strict(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return str(value) if isinstance(value, Path) else value


def dumps(value: Any) -> str:
    """Strict JSON text, indented, keys in the order given."""
    return json.dumps(strict(value), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
