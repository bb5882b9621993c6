"""What is done with a design: `verify`, `make` and `report`."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from equipoise.cli.answers import concluded, default_out, reported, told, write_design, written
from equipoise.cli.core import Json, Made, Out
from equipoise.console import emit, say, staging


def verify(
    file: Made,
    json: Json = False,
    out: Out = None,
    seed: Annotated[int | None, typer.Option("--seed", min=0, help="Seed of the unseen poses.")] = None,
    poses: Annotated[int, typer.Option("--poses", min=1, help="Number of unseen poses.")] = 10_000,
) -> int:
    """The design in MuJoCo at poses it never saw, its energies, and the poses between the samples."""
    from equipoise.solving import banded, found_design
    from equipoise.verbs.verify import verify as run

    found, problem, stopped = found_design(file, "verify")
    options: dict[str, Any] = {"poses": poses} if seed is None else {"poses": poses, "seed": seed}
    with staging(out) as stage:
        found = run(banded(told(found, problem, out), problem), out=stage, **options)
        write_design(found, stage)
    return concluded(found, json, stopped, written(out, found))


def make(file: Made, json: Json = False, out: Out = None) -> int:
    """Cams and drums of the file's `make` block: profiles as DXF, CSV and SVG, with the wrapped cord simulated."""
    from equipoise.reporting.plots import draw_part
    from equipoise.solving import made_parts

    parts, problem = made_parts(file)
    folder = out or default_out(problem)
    with staging(folder) as stage:
        assert stage is not None
        names = [path.name for part in parts for path in (*part.write(stage), draw_part(part, stage))]
    say("\n".join([*map(str, parts), *(f"file        {folder / name}" for name in names)]))
    if json:
        emit({"parts": [part.facts() for part in parts]})
    return 0


def report(file: Made, json: Json = False, out: Out = None) -> int:
    """One HTML file to look at, with the data and the model beside it."""
    from equipoise.solving import found_design

    found, problem, stopped = found_design(file, "report")
    return reported(found, problem, json, out or default_out(problem), stopped)
