"""What a mechanism asks for: `analyze`, `conditions` and `substitute`."""

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
    from equipoise.targets import mechanism_of
    from equipoise.units import to_si
    from equipoise.verbs.conditions import conditions as run

    mechanism = mechanism_of(file)
    far = None if reach is None else to_si(reach, "m", "--reach")
    found = run(mechanism, cast("Any", goal), solve_for=solve_for or (), on=on, reach=far)
    return answer(found, "conditions.json", json, out)


def substitute(
    file: File,
    body: Annotated[str, typer.Argument(metavar="BODY", help="The body whose mass is taken apart.")],
    json: Json = False,
    out: Out = None,
    kind: Annotated[
        str, typer.Option("--kind", help="dynamic: the same momentum in every motion; static: the same weight.")
    ] = "dynamic",
    point: Annotated[
        list[str] | None,
        typer.Option("--point", help="Where a mass sits in the body's frame: '50 mm, 0, 0'; default: pins and joints."),
    ] = None,
) -> int:
    """A body's mass as point masses at its pins, or at given points: the same momentum in every motion."""
    from equipoise.errors import InputError, nearest
    from equipoise.substitution import substitute as run
    from equipoise.targets import mechanism_of

    kinds = ("dynamic", "static")
    if kind not in kinds:
        raise InputError(f"there is no substitution {kind!r}", where="--kind", hint=nearest(kind, kinds))
    places = [[_coordinate(part) for part in one.split(",")] for one in point or ()]
    if any(len(place) != 3 for place in places):
        raise InputError("a point has three coordinates", where="--point", hint="--point '50 mm, 0, 0'")
    found = run(mechanism_of(file), body, cast("Any", kind), places or None)
    return answer(found, "substitution.json", json, out)


def _coordinate(text: str) -> float:
    """A number in m, or text with its unit."""
    from equipoise.units import to_si

    try:
        return to_si(float(text), "m", "--point")
    except ValueError:
        return to_si(text.strip(), "m", "--point")
