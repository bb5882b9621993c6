"""What may drive a path: an angle."""

from __future__ import annotations

from typing import Any

from equipoise.balancers.paths.shaft import Shaft
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism


def check_angle(given: Any, mechanism: Mechanism, name: str, what: str, kind: type[Shaft] = Shaft) -> None:
    """Raise InputError where the input of a path is no angle, of a kind, that the mechanism has."""
    if not isinstance(given, kind) or given.unit != "rad":
        word = type(given).__name__.lower()
        raise InputError(
            f"the {what} of spring {name} is driven by a {word}, whose deformation is no angle",
            where=f"spring {name}",
            hint="the input is an angle, an absolute angle or a gear",
        )
    given.check(mechanism, name)
