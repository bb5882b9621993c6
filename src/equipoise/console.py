"""What the commands share: prose to stderr, progress, Ctrl-C, files that appear whole, exit codes."""

from __future__ import annotations

import functools
import os
import shutil
import signal
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import isnan
from pathlib import Path
from typing import Any, Protocol

from equipoise.errors import EquipoiseError, InputError

STOPPED = 130
BUG = 70
DEBUG = "EQUIPOISE_DEBUG"


def say(text: str) -> None:
    """Prose, always on stderr."""
    print(text, file=sys.stderr, flush=True)


def emit(data: Any) -> None:
    """Machine output, alone on stdout."""
    from equipoise.reporting.jsonfile import dumps

    sys.stdout.write(dumps(data))
    sys.stdout.flush()


def guarded(command: Callable[..., int | None]) -> Callable[..., None]:
    """A command whose failures are a message and an exit code; the traceback shows with EQUIPOISE_DEBUG=1."""

    @functools.wraps(command)
    def run(*args: Any, **options: Any) -> None:
        import typer

        try:
            code = command(*args, **options) or 0
        except EquipoiseError as error:
            code = _failed(f"error: {error}", error.exit_code)
        except KeyboardInterrupt:
            code = _failed("stopped before anything was finished; nothing was written", STOPPED)
        except BrokenPipeError:
            # Whoever read the output has what they wanted; what is left must not complain at exit.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            code = 0
        except MemoryError:
            code = _failed("error: out of memory\n  -> use fewer poses or points", 2)
        except typer.Exit:
            raise
        except Exception as error:
            what = f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"
            hint = f"this is a bug in equipoise, please report it; {DEBUG}=1 shows where it happened"
            code = _failed(f"internal error: {what}\n  -> {hint}", BUG)
        raise typer.Exit(code)

    return run


def _failed(text: str, code: int) -> int:
    if os.environ.get(DEBUG) == "1":
        import traceback

        traceback.print_exc()
    say(text)
    return code


@contextmanager
def staging(out: Path | None) -> Iterator[Path | None]:
    """A folder beside `out` whose files move there when all are finished; None where nothing is to be written.

    Raises InputError where `out` is a file or cannot be written.
    """
    if out is None:
        yield None
        return
    out = Path(out)
    try:
        if out.exists() and not out.is_dir():
            raise InputError("this is a file, a folder is needed", where=str(out), hint="choose another --out")
        above = next(folder for folder in (out, *out.absolute().parents) if folder.is_dir())
        stage = Path(tempfile.mkdtemp(prefix=".equipoise-", dir=above))
    except OSError as error:
        raise _unwritable(out, error) from None
    try:
        yield stage
        _move(stage, out)
    except OSError as error:
        raise _unwritable(out, error) from None
    finally:
        shutil.rmtree(stage, ignore_errors=True)


def _move(stage: Path, out: Path) -> None:
    for source in sorted(stage.rglob("*")):
        target = out / source.relative_to(stage)
        if source.is_dir():
            target.mkdir(parents=True, exist_ok=True)
        else:
            target.parent.mkdir(parents=True, exist_ok=True)
            os.replace(source, target)


def _unwritable(out: Path, error: OSError) -> InputError:
    return InputError(f"cannot write: {error.strerror or error}", where=str(out), hint="choose another --out")


class Interrupts:
    """Remembers a first Ctrl-C, which a search answers with the best it has."""

    def __init__(self) -> None:
        self.hit = False

    def __enter__(self) -> Interrupts:
        self._before: Any = None
        if threading.current_thread() is threading.main_thread():
            self._before = signal.signal(signal.SIGINT, self._stop)
        return self

    def __exit__(self, *_: object) -> None:
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)

    def _stop(self, *_: object) -> None:
        if not self.hit:
            say("stopping: finishing the best design so far (Ctrl-C again to leave)")
        self.hit = True
        raise KeyboardInterrupt


class Show(Protocol):
    """Shows how far a search is."""

    def __call__(self, done: int, starts: int, best: float, stage: str = "") -> None:
        """Show what is done, of how many, the best value so far, and what is going on."""


@contextmanager
def progress_bar(verb: str, what: str, unit: str) -> Iterator[Show | None]:
    """A bar of what is done, the best value and the stage on stderr; None where stderr is no terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn(verb),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn(what + ", best {task.fields[best]}"),
        TimeElapsedColumn(),
        TextColumn("{task.fields[stage]}"),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(verb, total=None, best="...", stage="")

        def show(done: int, starts: int, best: float, stage: str = "") -> None:
            value = "..." if isnan(best) else f"{best:.5g} {unit}".rstrip()
            bar.update(task, completed=done, total=starts, best=value, stage=stage)

        yield show
