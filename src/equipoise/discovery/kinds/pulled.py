"""Lines whose spring may pull and stretch only so far."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from equipoise.discovery.kinds.lines import LineKind, Lines
from equipoise.limits import Force, Limit, Stroke
from equipoise.units import Force as Newtons
from equipoise.units import Length, text


@dataclass(frozen=True)
class PulledLine(LineKind):
    """A spring on a line under a largest force, N, and a largest stroke, m, where there is one."""

    force: Newtons
    stroke: Length | None = None

    @property
    def most(self) -> float:
        """The largest force, N."""
        return self.force

    def refuses(self, lines: Lines) -> Mapping[str, NDArray[np.bool_]]:
        """The stroke."""
        if self.stroke is None:
            return {}
        return {f"stroke above {text(self.stroke, 'm')}": lines.longest - lines.shortest > self.stroke}

    def limits(self, name: str, one: Lines) -> tuple[Limit, ...]:  # noqa: ARG002
        """Force and stroke."""
        found: tuple[Limit, ...] = (Force(name, max=self.force),)
        return found if self.stroke is None else (*found, Stroke(name, max=self.stroke))
