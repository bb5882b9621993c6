"""What the project itself can say: `reproduce` and `schema`."""

from __future__ import annotations

import os
from typing import Annotated

import typer

from equipoise.cli.core import Json, Out
from equipoise.console import emit, say, staging


def reproduce(
    paper: Annotated[str | None, typer.Argument(metavar="[PAPER]", help="A paper, or a part of its name.")] = None,
    json: Json = False,
    out: Out = None,
) -> int:
    """The papers' printed numbers, ours beside them, and a verdict for each."""
    from equipoise.verbs.reproduce import reproduce as run

    found = run(paper, workers=os.cpu_count() or 1, progress=lambda slug: say(f"recomputing {slug}"))
    with staging(out) as stage:
        written = [path for one in found for path in (one.write(stage) if stage is not None else [])]
    if json:
        emit([row for one in found for row in one.json()])
    else:
        say("\n\n".join(f"\n{one}" for one in found))
    if out is not None:
        say("\n".join(["", *(f"written     {out / path.name}" for path in written)]))
    return 0


def schema() -> int:
    """The JSON Schema of problem files, on stdout."""
    from equipoise.problem import schema as whole

    emit(whole())
    return 0
