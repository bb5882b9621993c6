"""The command line: one function per verb. Heavy libraries are imported when a command runs."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from equipoise.console import STOPPED, emit, guarded, progress_bar, say, staging
from equipoise.errors import DisagreementError, InputError, nearest

if TYPE_CHECKING:
    from equipoise.design import Design
    from equipoise.problem import Problem
    from equipoise.solve.program import Norm
    from equipoise.verbs.adjust import Adjusted

app = typer.Typer(
    name="equipoise",
    help="Designs balanced mechanisms: which springs and counterweights, where, how big, and how good the answer is.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

File = Annotated[str, typer.Argument(metavar="FILE", help="Problem file (YAML), or a robot: URDF, MJCF, package://...")]
Made = Annotated[
    str, typer.Argument(metavar="FILE", help="design.json of an earlier run, or a problem file, which is solved first.")
]
Json = Annotated[bool, typer.Option("--json", help="Print machine output on stdout, and nothing else there.")]
Out = Annotated[Path | None, typer.Option("--out", help="Folder to write to.")]
Seed = Annotated[int | None, typer.Option("--seed", min=0, help="Seed of the search; the same seed, the same design.")]
Starts = Annotated[int | None, typer.Option("--starts", min=1, help="Starts of the search.")]


@app.callback(invoke_without_command=True)
def _root(
    version: Annotated[bool, typer.Option("--version", help="Print the version.", is_eager=True)] = False,
) -> None:
    if version:
        from equipoise import __version__

        typer.echo(f"equipoise {__version__}")
        raise typer.Exit


@app.command()
@guarded
def analyze(file: File, json: Json = False, out: Out = None) -> int:
    """What the motors hold against gravity, and which joints are worth a spring."""
    from equipoise.reporting.jsonfile import dumps
    from equipoise.targets import target_of
    from equipoise.verbs.analyze import analyze as run

    problem = target_of(file).problem
    found = run(problem.mechanism, problem.sweep)
    say(str(found))
    with staging(out) as stage:
        if stage is not None:
            (stage / "analysis.json").write_text(dumps(found.json()), encoding="utf-8")
            if found.cables is not None:
                found.cables.write(stage / "cables.csv")
    if json:
        emit(found.json())
    return 0


@app.command()
@guarded
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
    from equipoise.reporting.jsonfile import dumps
    from equipoise.targets import target_of
    from equipoise.units import to_si
    from equipoise.verbs.conditions import conditions as run

    mechanism = target_of(file).problem.mechanism
    far = None if reach is None else to_si(reach, "m", "--reach")
    found = run(mechanism, cast("Any", goal), solve_for=solve_for or (), on=on, reach=far)
    say(str(found))
    with staging(out) as stage:
        if stage is not None:
            (stage / "conditions.json").write_text(dumps(found.json()), encoding="utf-8")
    if json:
        emit(found.json())
    return 0


@app.command()
@guarded
def balance(file: File, json: Json = False, out: Out = None) -> int:
    """The best values of all unknowns at the geometry of the file."""
    from equipoise.solving import balanced, served, solvable_problem

    problem = solvable_problem(file, "balance")
    if problem.cases and not problem.bounds:
        return _serve(*served(problem, None, None), problem, json, out, full=False)
    return _answer(balanced(problem), problem, json, out, stopped=False)


@app.command()
@guarded
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
        return _serve(*served(problem, seed, starts), problem, json, out, full=False)
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
        return _answer(found, problem, json, out, stopped)
    return _mapped(found, problem, json, out or _default_out(problem), over=over, norm=norm)


@app.command()
@guarded
def design(file: File, json: Json = False, out: Out = None, seed: Seed = None, starts: Starts = None) -> int:
    """Shape (or balance), verify and report in one go."""
    from equipoise.solving import balanced, served, shaped, solvable_problem

    problem = solvable_problem(file, "design")
    if problem.cases:
        return _serve(*served(problem, seed, starts), problem, json, out or _default_out(problem), full=True)
    found, stopped = shaped(problem, seed, starts) if problem.bounds else (balanced(problem), False)
    return _reported(found, problem, json, out or _default_out(problem), stopped)


@app.command()
@guarded
def verify(
    file: Made,
    json: Json = False,
    out: Out = None,
    seed: Annotated[int | None, typer.Option("--seed", min=0, help="Seed of the unseen poses.")] = None,
    poses: Annotated[int, typer.Option("--poses", min=1, help="Number of unseen poses.")] = 10_000,
) -> int:
    """The design in MuJoCo at poses it never saw, its energies, and the poses between the samples."""
    from equipoise.solving import found_design
    from equipoise.verbs.verify import verify as run

    found, problem, stopped = found_design(file, "verify")
    options: dict[str, Any] = {"poses": poses} if seed is None else {"poses": poses, "seed": seed}
    with staging(out) as stage:
        found = run(_told(found, problem, out), out=stage, **options)
        _write(found, stage)
    return _conclude(found, json, stopped, _written(out, found))


@app.command()
@guarded
def make(file: Made, json: Json = False, out: Out = None) -> int:
    """Cams and drums of the file's `make` block: profiles as DXF and CSV, with the wrapped cord simulated."""
    from equipoise.solving import made_parts

    parts, problem = made_parts(file)
    folder = out or _default_out(problem)
    with staging(folder) as stage:
        assert stage is not None
        names = [path.name for part in parts for path in part.write(stage)]
    say("\n".join([*map(str, parts), *(f"file        {folder / name}" for name in names)]))
    if json:
        emit({"parts": [part.facts() for part in parts]})
    return 0


@app.command()
@guarded
def report(file: Made, json: Json = False, out: Out = None) -> int:
    """One HTML file to look at, with the data and the model beside it."""
    from equipoise.solving import found_design

    found, problem, stopped = found_design(file, "report")
    return _reported(found, problem, json, out or _default_out(problem), stopped)


@app.command()
@guarded
def side_by_side(
    files: Annotated[list[str], typer.Argument(metavar="FILE...", help="Problem files or designs of one mechanism.")],
    json: Json = False,
    out: Out = None,
) -> int:
    """Several designs over one motion: mass, inertia, shaking, torque, power and work beside each other."""
    from equipoise.reporting.jsonfile import dumps
    from equipoise.solving import found_design
    from equipoise.verbs.side_by_side import side_by_side as run

    designs = {Path(file).stem: found_design(file, "side-by-side")[0] for file in files}
    found = run(designs)
    say(str(found))
    with staging(out) as stage:
        if stage is not None:
            (stage / "side_by_side.json").write_text(dumps(found.json()), encoding="utf-8")
    if json:
        emit(found.json())
    return 0


@app.command()
@guarded
def compare(file: File, json: Json = False, out: Out = None, starts: Starts = None) -> int:
    """A working member of every family of balancers for one joint, side by side and ranked."""
    from equipoise.reporting.comparison import markdown
    from equipoise.reporting.jsonfile import dumps
    from equipoise.targets import target_of
    from equipoise.verbs.compare import STARTS
    from equipoise.verbs.compare import compare as run

    problem = target_of(file).problem
    norm = next(aim.norm for aim in problem.objective if aim.cap is None)
    with problem.at_names():
        found = run(
            problem.mechanism,
            problem.sweep,
            problem.content.compare,
            norm=norm,
            starts=starts or STARTS,
            progress=lambda name: say(f"designing {name}"),
        )
    say(str(found))
    with staging(out) as stage:
        if stage is not None:
            (stage / "comparison.json").write_text(dumps(found.json()), encoding="utf-8")
            (stage / "comparison.md").write_text(markdown(found) + "\n", encoding="utf-8")
    if json:
        emit(found.json())
    return 0


@app.command()
@guarded
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


@app.command()
@guarded
def schema() -> int:
    """The JSON Schema of problem files, on stdout."""
    from equipoise.problem import schema as whole

    emit(whole())
    return 0


def _told(found: Design, problem: Problem, out: Path | None) -> Design:
    from equipoise.designfile import with_problem

    return with_problem(found, problem, out)


def _default_out(problem: Problem) -> Path:
    return Path("out") / (Path(problem.document.name.split(",")[0]).stem or "design")


def _write(found: Design, stage: Path | None) -> None:
    from equipoise.reporting.jsonfile import dumps

    if stage is not None:
        (stage / "design.json").write_text(dumps(found.json()), encoding="utf-8")


def _written(out: Path | None, found: Design) -> list[str]:
    """Lines that say where the files are, the most interesting last."""
    if out is None:
        return []
    lines = [f"design      {out / 'design.json'}"]
    if found.verification is not None and found.verification.model is not None:
        lines.insert(0, f"model       {out / Path(found.verification.model).name}")
    return lines


def _answer(found: Design, problem: Problem, json: bool, out: Path | None, stopped: bool) -> int:
    found = _told(found, problem, out)
    with staging(out) as stage:
        _write(found, stage)
    return _conclude(found, json, stopped, _written(out, found))


def _mapped(found: Design, problem: Problem, json: bool, out: Path, *, over: tuple[str, str], norm: str | None) -> int:
    from equipoise.verbs.geometry_map import geometry_map

    found = _told(found, problem, out)
    with staging(out) as stage, progress_bar("map", "lines", "") as progress:
        assert stage is not None
        _write(found, stage)
        made = geometry_map(found, *over, norm=cast("Norm | None", norm), progress=progress)
        files = made.write(stage)
    lines = [*_written(out, found), *(f"map         {out / file.name}" for file in files)]
    return _conclude(found, json, False, lines)


def _reported(found: Design, problem: Problem, json: bool, out: Path, stopped: bool) -> int:
    from equipoise.scattering import followed, tolerance
    from equipoise.solving import cut
    from equipoise.verbs.report import report as write_report
    from equipoise.verbs.verify import verify as run

    found = _told(found, problem, out)
    refused = None
    try:
        found = replace(found, made=tuple(cut(problem, found)))
    except InputError as error:
        # The springs are found all the same.
        refused = error
    try:
        with staging(out) as stage:
            assert stage is not None
            found = run(found, out=stage)
            if followed(found):
                found = replace(found, tolerance=tolerance(found, problem.content.tolerances))
            write_report(found, stage)
    except KeyboardInterrupt:
        # The design itself is finished work.
        with staging(out) as stage:
            _write(found, stage)
        say(f"stopped during verification and report; the design is in {out / 'design.json'}")
        return STOPPED
    parts = [f"part        {out / f'{part.name}.dxf'}" for part in found.made]
    code = _conclude(found, json, stopped, [*_written(out, found), *parts, f"report      {out / 'report.html'}"])
    if refused is not None:
        raise refused
    return code


def _serve(found: Adjusted, stopped: bool, problem: Problem, json: bool, out: Path | None, *, full: bool) -> int:
    """One design for several cases: verified in each, reported in the hardest, a folder for every case."""
    from equipoise.reporting.jsonfile import dumps
    from equipoise.scattering import followed, tolerance
    from equipoise.verbs.report import report as write_report
    from equipoise.verbs.verify import insist
    from equipoise.verbs.verify import verify as run

    designs = list(found.designs)
    with staging(out) as stage:
        for index, design in enumerate(found.designs):
            folder = f"case_{index + 1}"
            designs[index] = _told(design, problem, None if out is None else out / folder)
            if full and stage is not None:
                (stage / folder).mkdir()
                designs[index] = run(designs[index], out=stage / folder)
                _write(designs[index], stage / folder)
        found = replace(found, designs=tuple(designs))
        if stage is not None:
            if full:
                shown = _told(designs[found.hardest], problem, out)
                if followed(shown):
                    shown = replace(shown, tolerance=tolerance(shown, problem.content.tolerances))
                write_report(shown, stage)
            (stage / "design.json").write_text(dumps(found.json()), encoding="utf-8")
    say("\n".join([str(found), *([] if out is None else [f"design      {out / 'design.json'}"])]))
    if full and out is not None:
        say(f"report      {out / 'report.html'}")
    if json:
        emit(found.json())
    if stopped:
        return STOPPED
    labelled = list(zip(found.labels, designs, strict=True))
    reasons = [f"target missed in {label}: {design.missed}" for label, design in labelled if design.missed]
    try:
        for design in designs:
            insist(design)
    except DisagreementError as error:
        reasons.append(str(error))
    for reason in reasons:
        say(f"error: {reason}")
    return 1 if reasons else 0


def _conclude(found: Design, json: bool, stopped: bool, lines: Sequence[str]) -> int:
    """Print what there is to say and decide the exit code."""
    from equipoise.verbs.verify import insist

    say("\n".join([str(found), *lines]))
    if json:
        emit(found.json())
    if stopped:
        return STOPPED
    reasons = [f"target missed: {found.missed}"] if found.missed else []
    try:
        insist(found)
    except DisagreementError as error:
        reasons.append(str(error))
    for reason in reasons:
        say(f"error: {reason}")
    return 1 if reasons else 0


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    try:
        app(args=None if arguments is None else list(arguments), prog_name="equipoise")
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 1 if end.code else 0
    return 0
