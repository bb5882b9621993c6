"""Which springs at all: `discover`, and the folder of its front."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from equipoise.cli.answers import disagreements, ended, told, write_design, write_json, written
from equipoise.cli.core import File, Json, Out
from equipoise.console import say, staging

if TYPE_CHECKING:
    from equipoise.discovery.front import Discovery
    from equipoise.problem import Problem


def discover(
    file: File,
    *,
    json: Json = False,
    out: Out = None,
    payload: Annotated[str | None, typer.Option("--payload", metavar="MASSES", help="Masses to carry: 0,5kg.")] = None,
    at: Annotated[str | None, typer.Option("--at", metavar="BODY", help="The body that carries them.")] = None,
    springs: Annotated[int | None, typer.Option("--springs", min=1, help="The largest number of springs.")] = None,
    kinds: Annotated[str | None, typer.Option("--kinds", metavar="LIST", help="zero_free_length,coil,...")] = None,
    make: Annotated[str | None, typer.Option("--make", metavar="GRADE", help="Springs wound of a wire: SH.")] = None,
) -> int:
    """Which springs at all: the best designs with 1, 2, 3, ... of them, verified."""
    from equipoise.solving import discovered, discovery

    problem = discovery(file, payload, at, springs, kinds, make)
    front, stopped = discovered(problem)
    return _fronted(front, problem, json, out, stopped)


def _fronted(front: Discovery, problem: Problem, json: bool, out: Path | None, stopped: bool) -> int:
    """Verify the designs of a front, write them, and say what there is to say."""
    from equipoise.discovery.ask import design_problem
    from equipoise.discovery.words import summary
    from equipoise.reporting.front_page import page
    from equipoise.solving import judged
    from equipoise.verbs.verify import verify as run

    lines, made = [], []
    with staging(out) as stage:
        for design in front.designs:
            folder = None if stage is None else stage / front.folder(design)
            if folder is not None:
                folder.mkdir()
            place = None if out is None else out / front.folder(design)
            found = told(design, design_problem(design, problem), place)
            made.append(found if stopped else judged(run(found, out=folder), problem))
            write_design(made[-1], folder)
            lines += written(place, made[-1])
        front = front.with_designs(tuple(made))
        if stage is not None:
            write_json(front, stage / "front.json")
            if not stopped:
                (stage / "report.html").write_text(page(front), encoding="utf-8")
    lines += [f"front       {out / 'front.json'}"] if out is not None else []
    lines += [f"report      {out / 'report.html'}"] if out is not None and not stopped else []
    say("\n".join([summary(front, out), *lines]))
    missed = [design.missed for design in front.designs]
    reasons = [f"target missed by every design: {missed[-1]}"] if all(missed) else []
    return ended(front, json, stopped, [*disagreements(front.designs), *reasons])
