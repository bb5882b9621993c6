"""Several answers beside each other: `front`, `side-by-side` and `compare`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from equipoise.cli.answers import answer
from equipoise.cli.core import File, Json, Out, Starts
from equipoise.console import emit, say, staging

if TYPE_CHECKING:
    from equipoise.design import Design
    from equipoise.problem import Problem


def front(
    file: File,
    json: Json = False,
    out: Out = None,
    against: Annotated[str, typer.Option("--against", help="What it costs: mass, or another goal's peak.")] = "mass",
    caps: Annotated[str | None, typer.Option("--caps", help="Growing caps, such as '26 kg, 28 kg, 30 kg'.")] = None,
    points: Annotated[int, typer.Option("--points", min=2, help="How many caps where none are given.")] = 8,
) -> int:
    """The objective's best value for every amount of added mass (or of another goal), each with its proof."""
    from equipoise.objective import goal_blocks
    from equipoise.solving import solvable_problem
    from equipoise.units import to_si
    from equipoise.verbs.front import front as run

    problem = solvable_problem(file, "front")
    unit = goal_blocks(problem.mechanism, against)[0].unit
    given = None if caps is None else [to_si(_number(text), unit, "--caps") for text in caps.split(",")]
    with problem.at_names():
        found = run(
            problem.mechanism, problem.balancers, problem.sweep, objective=problem.objective, against=against,
            caps=given, points=points, limits=problem.limits,
        )  # fmt: skip
    say(str(found))
    with staging(out) as stage:
        files = found.write(stage) if stage is not None else []
    for one in files:
        say(f"front       {one.name}")
    if json:
        emit(found.json())
    return 0


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text.strip()


def side_by_side(
    files: Annotated[list[str], typer.Argument(metavar="FILE...", help="Problem files or designs of one mechanism.")],
    json: Json = False,
    out: Out = None,
) -> int:
    """Several designs over one motion: mass, inertia, shaking, torque, power and work beside each other."""
    from equipoise.solving import found_design
    from equipoise.verbs.side_by_side import side_by_side as run

    designs = {Path(file).stem: found_design(file, "side-by-side")[0] for file in files}
    found = run(designs)
    return answer(found, "side_by_side.json", json, out)


def compare(file: File, json: Json = False, out: Out = None, starts: Starts = None) -> int:
    """A working member of every family of balancers for one joint, side by side and ranked, as problem files too."""
    from equipoise.families.judge import Chance
    from equipoise.objective import leading
    from equipoise.picking import write_problem
    from equipoise.reporting.comparison import file_name, markdown
    from equipoise.reporting.comparison_page import page
    from equipoise.targets import target_of
    from equipoise.verbs.compare import STARTS
    from equipoise.verbs.compare import compare as run

    problem = target_of(file).problem
    aim = leading(problem.objective)
    with problem.at_names():
        found = run(
            problem.mechanism,
            problem.sweep,
            problem.content.compare,
            norm=aim.norm,
            judged=aim.judged,
            chance=Chance(problem.content.tolerances, problem.content.friction),
            starts=starts or STARTS,
            progress=lambda name: say(f"designing {name}"),
        )

    def beside(folder: Path) -> None:
        (folder / "comparison.md").write_text(markdown(found) + "\n", encoding="utf-8")
        for entry in found.entries:
            if entry.design is not None:
                write_problem(_problem(entry.design, problem), folder / file_name(entry))
        (folder / "report.html").write_text(page(found), encoding="utf-8")

    code = answer(found, "comparison.json", json, out, beside=beside)
    if out is not None:
        say(f"next        equipoise design {out / file_name(found.entries[0])}")
        say(f"report      {out / 'report.html'}")
    return code


def _problem(design: Design, problem: Problem) -> Problem:
    """A member of a family as a problem of its own, judged as it was: by the joint that was compared."""
    from equipoise.discovery.ask import design_problem
    from equipoise.discovery.plain import plain
    from equipoise.objective import leading
    from equipoise.problem import problem_of
    from equipoise.yamlfile import Document

    made, aim = design_problem(design, problem), leading(design.objective)
    joints = {} if aim.joints is None else {"joints": plain(aim.joints)}
    content = {**made.raw, "objective": {"goal": aim.goal, "norm": aim.norm, **joints}}
    return problem_of(Document(problem.document.name, content), problem.folder)
