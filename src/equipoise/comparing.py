"""The question that a comparison of families answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from equipoise.motion.drivers import Driver
from equipoise.units import Length, Time


@dataclass(frozen=True)
class Comparing:
    """What to compare: the joint (default: the most loaded), the room that there is, the motion that motors make.

    room, m, is how far cranks, springs and weights may reach from the joint (default: a third of the load's lever
    arm, of a slide its travel); motion {joint: driver} runs over duration, s (default: the joint once through its
    range, cycloidal); families picks rows by their names or class codes.
    """

    joint: str | None = None
    room: Length | None = None
    motion: Mapping[str, Driver | Any] | None = None
    duration: Time = 2.0
    families: tuple[str, ...] = ()
