"""Random numbers that a seed repeats."""

from __future__ import annotations

import numpy as np

from equipoise.errors import InputError


def generator(seed: int) -> np.random.Generator:
    """The generator of a seed, an integer of at least 0; raises InputError for any other."""
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0:
        raise InputError(f"the seed is {seed!r}", where="seed", hint="use a whole number of at least 0")
    return np.random.default_rng(seed)
