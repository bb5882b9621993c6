"""From a file to one design: `balance`, `shape` and `design`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from equipoise.cli.answers import concluded, default_out, design_answer, reported, told, write_design, written
from equipoise.cli.cases import cases_answer, cases_reported
from equipoise.cli.core import File, Json, Out, Seed, Starts
from equipoise.cli.real import with_parts
from equipoise.console import progress_bar, staging
from equipoise.errors import InputError, nearest

if TYPE_CHECKING:
    from equipoise.design import Design
    from equipoise.problem import Problem
    from equipoise.solve.program import Norm


def balance(file: File, json: Json = False, out: Out = None) -> int:
    """The best values of all unknowns at the geometry of the file."""
    from equipoise.solving import balanced, served, solvable_problem

    problem = solvable_problem(file, "balance")
    if problem.cases and not problem.bounds:
        cases, stopped = served(problem, None, None)
        return cases_answer(cases, problem, json, out, stopped)
    return design_answer(balanced(problem), problem, json, out, stopped=False)


def shape(
    file: File,
    *,
    json: Json = False,
    out: Out = None,
    seed: Seed = None,
    starts: Starts = None,
    over: Annotated[
        tuple[str, str] | None,
        typer.Option("--map", metavar="A B", help="Draw the norm over two free parameters into the folder."),
    ] = None,
    norm: Annotated[str | None, typer.Option("--norm", help="Norm of the map: rms, peak or mean.")] = None,
    certify: Annotated[
        bool, typer.Option("--certify", help="Bound what any geometry within the bounds could reach (up to four free).")
    ] = False,
) -> int:
    """Geometry within its bounds and all unknowns together."""
    from equipoise.solving import bracketed, served, shaped, solvable_problem

    problem = solvable_problem(file, "shape")
    if problem.cases and not over:
        cases, stopped = served(problem, seed, starts)
        return cases_answer(cases, problem, json, out, stopped)
    if not problem.bounds:
        raise InputError(
            "no geometry is free",
            where=f"{problem.document.name}, shape",
            hint="add a block such as `shape: {s1.path.line.0.z: [5 cm, 25 cm]}`, or use `equipoise balance`",
        )
    for name in over or ():
        if name not in problem.bounds:
            hint = nearest(name, list(problem.bounds))
            raise InputError(f"{name!r} is no free parameter", where=f"{problem.document.name}, --map", hint=hint)
    found, stopped = shaped(problem, seed, starts)
    if certify and not stopped:
        found, stopped = bracketed(found, problem)
    if not over or stopped:
        return design_answer(found, problem, json, out, stopped)
    return _mapped(found, problem, json, out or default_out(problem), over=over, norm=norm)


def design(file: File, json: Json = False, out: Out = None, seed: Seed = None, starts: Starts = None) -> int:
    """Shape, balance or discover, verify and report in one go."""
    from equipoise.solving import balanced, designed, served, shaped, solvable_problem

    chosen = designed(file)
    if chosen is not None:
        found, problem, stopped = chosen
    else:
        problem = solvable_problem(file, "design")
        if problem.cases:
            cases, stopped = served(problem, seed, starts)
            return cases_reported(cases, problem, json, out or default_out(problem), stopped)
        found, stopped = shaped(problem, seed, starts) if problem.bounds else (balanced(problem), False)
    out = out or default_out(problem)
    if problem.content.pick is not None and not stopped:
        return with_parts(found, problem, problem.content.pick, json, out, seed)
    return reported(found, problem, json, out, stopped)


def _mapped(found: Design, problem: Problem, json: bool, out: Path, *, over: tuple[str, str], norm: str | None) -> int:
    from equipoise.verbs.geometry_map import geometry_map

    found = told(found, problem, out)
    with staging(out) as stage, progress_bar("map", "lines", "") as progress:
        assert stage is not None
        write_design(found, stage)
        made = geometry_map(found, *over, norm=cast("Norm | None", norm), progress=progress)
        files = made.write(stage)
    lines = [*written(out, found), *(f"map         {out / file.name}" for file in files)]
    return concluded(found, json, False, lines)
