"""What MuJoCo says: warnings collected instead of logged, errors turned into ours."""

from __future__ import annotations

import contextlib
import contextvars
import logging
import warnings
from collections.abc import Iterable, Iterator
from typing import Any

import mujoco

from equipoise.errors import EquipoiseError, ModelError

_log = logging.getLogger("equipoise.mujoco")
_heard: contextvars.ContextVar[list[str] | None] = contextvars.ContextVar("heard", default=None)
_LONGEST = 500


class _Ear:
    """MuJoCo's warning callback: whoever listens hears it, else the handler that was there before."""

    def __init__(self, before: Any) -> None:
        self.before = before

    def __call__(self, message: str) -> None:
        if _heard.get() is None and self.before is not None:
            self.before(message)
        else:
            _tell(message)


def _tell(message: str) -> None:
    """To whoever listens, else to the log."""
    listener = _heard.get()
    if listener is not None:
        listener.append(tidy(message))
    else:
        _log.warning("%s", tidy(message))


def install() -> None:
    """Catch MuJoCo's warnings, once; without a handler MuJoCo writes a log file where the user stands."""
    before = mujoco.get_mju_user_warning()
    if not isinstance(before, _Ear):
        mujoco.set_mju_user_warning(_Ear(before))


@contextlib.contextmanager
def listen() -> Iterator[list[str]]:
    """Collect MuJoCo's warnings of this block, in order, instead of letting them out."""
    install()
    said: list[str] = []
    token = _heard.set(said)
    try:
        yield said
    finally:
        _heard.reset(token)


@contextlib.contextmanager
def refusals(where: str, hint: str = "") -> Iterator[None]:
    """Turn whatever MuJoCo or its binding raises in this block into a ModelError at `where`, and hear its warnings."""
    install()
    # The compiler speaks through Python's warnings, everything else of MuJoCo through the callback.
    with warnings.catch_warnings(record=True) as caught, errors(where, hint):
        warnings.simplefilter("always")
        yield
    for warning in caught:
        _tell(str(warning.message))


@contextlib.contextmanager
def errors(where: str, hint: str = "") -> Iterator[None]:
    """Turn what MuJoCo or its binding raises in this block into a ModelError at `where`."""
    kinds = (ValueError, RuntimeError, TypeError, KeyError, OverflowError, OSError, mujoco.FatalError)
    try:
        yield
    except EquipoiseError:
        raise
    except MemoryError:
        raise ModelError("the model needs more memory than there is", where=where, hint=hint) from None
    except (*kinds, mujoco.UnexpectedError) as error:
        raise ModelError(f"MuJoCo refuses the model: {tidy(str(error))}", where=where, hint=hint) from None


def tidy(message: str) -> str:
    """One line of MuJoCo's text, without its prefix and of bounded length."""
    line = " ".join(message.split())
    for prefix in ("Error: ", "XML Error: ", "WARNING: "):
        line = line.removeprefix(prefix)
    return line if len(line) <= _LONGEST else line[:_LONGEST] + "..."


def some(names: Iterable[str], most: int = 5) -> str:
    """A list of names for a sentence: up to `most`, then "and 14 more"."""
    every = list(dict.fromkeys(names))
    shown = ", ".join(every[:most])
    return f"{shown} and {len(every) - most} more" if len(every) > most else shown
