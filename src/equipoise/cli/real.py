"""Real parts in the place of ideal springs: `pick` and `survey`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from equipoise.cli.answers import default_out, reported
from equipoise.cli.core import Catalogue, Columns, File, Json, Made, Out, Parallel, Seed, Units
from equipoise.console import STOPPED, emit, say, staging

if TYPE_CHECKING:
    from equipoise.design import Design
    from equipoise.parts.request import Pick
    from equipoise.problem import Problem


def pick(
    file: Made,
    *,
    catalogue: Catalogue = None,
    units: Units = None,
    column: Columns = None,
    parallel: Parallel = None,
    json: Json = False,
    out: Out = None,
    seed: Seed = None,
) -> int:
    """Real parts in the place of ideal springs: from a catalogue, or wound; shaped anew, verified, reported."""
    from equipoise.picking import requested
    from equipoise.solving import found_design

    from_file, problem, stopped = found_design(file, "pick")
    request = requested(problem, catalogue, units, column or (), parallel)
    out = out or default_out(problem)
    return (
        reported(from_file, problem, json, out, stopped)
        if stopped
        else with_parts(from_file, problem, request, json, out, seed)
    )


def survey(
    file: File,
    *,
    catalogue: Catalogue = None,
    spring: Annotated[str | None, typer.Option("--spring", help="The spring to find a part for.")] = None,
    units: Units = None,
    column: Columns = None,
    parallel: Parallel = None,
    json: Json = False,
    out: Out = None,
    seed: Seed = None,
) -> int:
    """Every spring of a catalogue at its own best geometry, ranked; goes on where it was stopped."""
    from equipoise.objective import leading
    from equipoise.picking import requested, survey_json, survey_words, surveyed
    from equipoise.solving import solvable_problem

    problem = solvable_problem(file, "survey")
    request = requested(problem, catalogue, units, column or (), parallel or 1)
    folder = out or default_out(problem)
    found, stopped = surveyed(problem, request, spring, folder, seed)
    unit = leading(problem.objective).unit(problem.mechanism)
    say(survey_words(found, unit, folder))
    if json:
        emit(survey_json(found))
    if stopped:
        return STOPPED
    return 0 if found.ranked else 1


def with_parts(found: Design, problem: Problem, request: Pick, json: bool, out: Path, seed: int | None) -> int:
    """The design again with parts that exist, its problem beside it, and the candidates of every spring."""
    from equipoise.picking import FILE, picked, write_problem

    chosen, real = picked(problem, found, request, seed)
    with staging(out) as stage:
        assert stage is not None
        write_problem(real, stage / FILE)
        for spring, ranking in chosen.rankings.items():
            (stage / f"candidates_{spring}.csv").write_text(ranking.table(), encoding="utf-8")
    say(f"{chosen}\n")
    return reported(chosen.design, real, json, out, stopped=False)
