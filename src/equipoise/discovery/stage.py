"""What a discovery is at, for those who wait."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Stage:
    """The number of parts that is being looked for, what is done for it, and with which of how many contenders."""

    parts: int
    doing: str
    contender: int = 0
    contenders: int = 0

    def __str__(self) -> str:
        """`3 parts: contender 2 of 4, winding`."""
        whose = f"contender {self.contender} of {self.contenders}, " if self.contenders else ""
        return f"{self.parts} part{'s' if self.parts > 1 else ''}: {whose}{self.doing}"


Tell = Callable[[Stage], None]


def untold(stage: Stage) -> None:
    """Nobody waits."""
