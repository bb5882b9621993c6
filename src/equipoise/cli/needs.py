"""What a mechanism asks for: `analyze` and `conditions`."""

from __future__ import annotations

from typing import Annotated, Any, cast

import typer

from equipoise.cli.answers import answer
from equipoise.cli.core import File, Json, Out


def analyze(file: File, json: Json = False, out: Out = None) -> int:
    """What the motors hold against gravity, and which joints are worth a spring."""
    from equipoise.targets import target_of
    from equipoise.verbs.analyze import analyze as run

    problem = target_of(file).problem
    found = run(problem.mechanism, problem.sweep)
    cables = found.cables
    return answer(
        found, "analysis.json", json, out, beside=None if cables is None else lambda to: cables.write(to / "cables.csv")
    )


def conditions(
    file: File,
    json: Json = False,
    out: Out = None,
    goal: Annotated[
        str, typer.Option("--goal", help="What shall vanish in all motions: force, moment or both.")
    ] = "force",
    solve_for: Annotated[
        list[str] | None,
        typer.Option("--for", metavar="NAME", help="Body or parameter to solve for first; repeatable."),
    ] = None,
    on: Annotated[
        list[str] | None, typer.Option("--on", metavar="BODY", help="Body that may carry added mass; repeatable.")
    ] = None,
    reach: Annotated[str | None, typer.Option("--reach", help="How far from its joint, such as '50 mm'.")] = None,
) -> int:
    """What masses must keep so that nothing shakes in any motion, and whether added mass alone can do it."""
    from equipoise.targets import target_of
    from equipoise.units import to_si
    from equipoise.verbs.conditions import conditions as run

    mechanism = target_of(file).problem.mechanism
    far = None if reach is None else to_si(reach, "m", "--reach")
    found = run(mechanism, cast("Any", goal), solve_for=solve_for or (), on=on, reach=far)
    return answer(found, "conditions.json", json, out)
