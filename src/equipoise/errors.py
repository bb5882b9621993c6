"""The error tree: every message says what, where and what to try next."""

from __future__ import annotations


class EquipoiseError(Exception):
    """A failure that names its place and the next step; `exit_code` is what the command line returns."""

    exit_code = 1

    def __init__(self, message: str, *, where: str = "", hint: str = "") -> None:
        self.message = message
        self.where = where
        self.hint = hint
        super().__init__(message)

    def __str__(self) -> str:
        place = f"{self.where}: " if self.where else ""
        step = f"\n  -> {self.hint}" if self.hint else ""
        return f"{place}{self.message}{step}"


class InputError(EquipoiseError):
    """Bad input: a file, a field, a name or a number that cannot mean anything."""

    exit_code = 2


class ModelError(InputError):
    """A robot file that cannot be read, or that no statics can be done with."""


class ProblemError(InputError):
    """A problem file whose field, unit or value is wrong."""


class LoopError(InputError):
    """A closed loop that does not close, or closes within the margin of a singularity."""


class InfeasibleError(EquipoiseError):
    """Limits that no design can keep together."""


class DisagreementError(EquipoiseError):
    """A verification that does not confirm the design."""


def nearest(word: str, known: list[str] | tuple[str, ...]) -> str:
    """A hint that names the closest known words, or lists what there is."""
    import difflib

    close = difflib.get_close_matches(word, known, n=3, cutoff=0.5)
    if close:
        return "did you mean " + " or ".join(close) + "?"
    listed = ", ".join(known[:12]) + (", ..." if len(known) > 12 else "")
    return f"known: {listed}" if known else "there is none to choose from"
