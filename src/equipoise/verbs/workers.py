"""One piece of work shared among processes: pieces finish in any order, a stop waits for what runs."""

from __future__ import annotations

import io
import os
import pickle
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass, fields
from importlib import import_module
from multiprocessing import get_context
from typing import Any, TypeVar

from equipoise.mechanism import Mechanism

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")

Piece = TypeVar("Piece")
Answer = TypeVar("Answer")


def shared(
    work: Callable[[Piece], Answer],
    pieces: Sequence[Piece],
    workers: int,
    prepare: Callable[[], object] = lambda: None,
) -> Iterator[Answer]:
    """The answers to all pieces as they finish, by so many processes; by this one where that is as good.

    prepare runs here while the processes start; what it leaves in the work goes with it. Ctrl-C hands over what the
    processes are at before it is raised. What cannot be sent to another process, or a process that dies, leaves the
    work to this one.
    """
    if not (workers > 1 and len(pieces) > 1 and _packed(work)):
        yield from map(work, pieces)
        return
    left = list(range(len(pieces)))
    with processes(min(workers, len(pieces)), initializer=_leave_ctrl_c) as pool:
        running: dict[Future[Any], int] = {}
        waiting = iter(range(len(pieces)))
        try:
            for _ in range(min(workers, len(pieces))):
                pool.submit(_wake, type(work).__module__)
            prepare()
            sent = _packed(work) or b""
            for index in waiting:
                running[pool.submit(_answer, sent, pieces[index])] = index
                if len(running) < workers:
                    continue
                yield from _finished(running, left)
            while running:
                yield from _finished(running, left)
        except KeyboardInterrupt:
            while running:
                yield from _finished(running, left)
            raise
        except BrokenProcessPool:
            pass
    yield from map(work, [pieces[index] for index in left])


def _finished(running: dict[Future[Any], int], left: list[int]) -> Iterator[Any]:
    """The answers of what finishes next; left loses them."""
    for future in wait(running, return_when=FIRST_COMPLETED).done:
        index = running.pop(future)
        answer = future.result()
        left.remove(index)
        yield answer


@contextmanager
def processes(workers: int, **options: Any) -> Iterator[ProcessPoolExecutor]:
    """Processes with one thread of linear algebra each: more would only get in each other's way."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update({name: value or "1" for name, value in before.items()})
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), **options)
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


@dataclass
class _Held:
    """The work that a process was sent last."""

    sent: bytes = b""
    work: Callable[[Any], Any] | None = None


_held = _Held()


def _leave_ctrl_c() -> None:
    """What a process does first: it leaves Ctrl-C to the one that shares the work out."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _wake(module: str) -> None:
    """Import what the work needs, before the work comes."""
    import_module(module)


def _answer(sent: bytes, piece: Any) -> Any:
    work = _held.work if _held.sent == sent else None
    if work is None:
        work = pickle.loads(sent)
        _held.sent, _held.work = sent, work
    return work(piece)


class _Pickler(pickle.Pickler):
    """Mechanisms go without the source of their file, which is for saving, and without MuJoCo's own memory."""

    def reducer_override(self, obj: Any) -> Any:
        if not isinstance(obj, Mechanism):
            return NotImplemented
        kept = {field.name: getattr(obj, field.name) for field in fields(obj) if not field.name.startswith("_")}
        return _mechanism, (kept | {"spec": None},)


def _mechanism(kept: dict[str, Any]) -> Mechanism:
    return Mechanism(**kept)


def _packed(work: Any) -> bytes | None:
    """The work as bytes; None where something in it can only live in this process."""
    stream = io.BytesIO()
    try:
        _Pickler(stream).dump(work)
    except (pickle.PicklingError, TypeError, AttributeError):
        return None
    return stream.getvalue()
