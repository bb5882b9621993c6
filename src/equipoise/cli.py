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
    from equipoise.discovery.front import Discovery
    from equipoise.parts.request import Pick
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
Catalogue = Annotated[Path | None, typer.Option("--catalogue", help="CSV of springs; without it, what can be wound.")]
Units = Annotated[str | None, typer.Option("--units", help="Of columns that say none: metric or inch.")]
Columns = Annotated[
    list[str] | None, typer.Option("--column", help="What a column is: rate='Spring Rate'. Repeatable.")
]
Parallel = Annotated[int | None, typer.Option("--parallel", min=1, help="How many of a part may act side by side.")]
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
    from equipoise.targets import target_of
    from equipoise.units import to_si
    from equipoise.verbs.conditions import conditions as run

    mechanism = target_of(file).problem.mechanism
    far = None if reach is None else to_si(reach, "m", "--reach")
    found = run(mechanism, cast("Any", goal), solve_for=solve_for or (), on=on, reach=far)
    return _found(found, "conditions.json", json, out)


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
    """Shape, balance or discover, verify and report in one go."""
    from equipoise.solving import balanced, designed, served, shaped, solvable_problem

    chosen = designed(file)
    if chosen is not None:
        found, problem, stopped = chosen
        return _reported(found, problem, json, out or _default_out(problem), stopped)
    problem = solvable_problem(file, "design")
    if problem.cases:
        return _serve(*served(problem, seed, starts), problem, json, out or _default_out(problem), full=True)
    found, stopped = shaped(problem, seed, starts) if problem.bounds else (balanced(problem), False)
    out = out or _default_out(problem)
    if problem.content.pick is not None and not stopped:
        return _picked(found, problem, problem.content.pick, json, out, seed)
    return _reported(found, problem, json, out, stopped)


@app.command()
@guarded
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
    out = out or _default_out(problem)
    return (
        _reported(from_file, problem, json, out, stopped)
        if stopped
        else _picked(from_file, problem, request, json, out, seed)
    )


@app.command()
@guarded
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
    from equipoise.picking import requested, survey_json, survey_words, surveyed
    from equipoise.solving import solvable_problem

    problem = solvable_problem(file, "survey")
    request = requested(problem, catalogue, units, column or (), parallel or 1)
    folder = out or _default_out(problem)
    found, stopped = surveyed(problem, request, spring, folder, seed)
    unit = next(aim.unit(problem.mechanism) for aim in problem.objective if aim.cap is None)
    say(survey_words(found, unit, folder))
    if json:
        emit(survey_json(found))
    if stopped:
        return STOPPED
    return 0 if found.ranked else 1


@app.command()
@guarded
def discover(
    file: File,
    *,
    json: Json = False,
    out: Out = None,
    payload: Annotated[str | None, typer.Option("--payload", metavar="MASSES", help="Masses to carry: 0,5kg.")] = None,
    at: Annotated[str | None, typer.Option("--at", metavar="BODY", help="The body that carries them.")] = None,
    springs: Annotated[int | None, typer.Option("--springs", min=1, help="The largest number of springs.")] = None,
    kinds: Annotated[str | None, typer.Option("--kinds", metavar="LIST", help="zero_free_length,coil,...")] = None,
) -> int:
    """Which springs at all: the best designs with 1, 2, 3, ... of them, verified."""
    from equipoise.solving import discovered, discovery

    problem = discovery(file, payload, at, springs, kinds)
    front, stopped = discovered(problem)
    return _fronted(front, problem, json, out, stopped)


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
    """Cams and drums of the file's `make` block: profiles as DXF, CSV and SVG, with the wrapped cord simulated."""
    from equipoise.reporting.plots import draw_part
    from equipoise.solving import made_parts

    parts, problem = made_parts(file)
    folder = out or _default_out(problem)
    with staging(folder) as stage:
        assert stage is not None
        names = [path.name for part in parts for path in (*part.write(stage), draw_part(part, stage))]
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


@app.command()
@guarded
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
    return _found(found, "side_by_side.json", json, out)


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


def _picked(found: Design, problem: Problem, request: Pick, json: bool, out: Path, seed: int | None) -> int:
    from equipoise.picking import FILE, picked, write_problem

    chosen, real = picked(problem, found, request, seed)
    with staging(out) as stage:
        assert stage is not None
        write_problem(real, stage / FILE)
        for choice in chosen.choices:
            (stage / f"candidates_{choice.spring}.csv").write_text(choice.ranking.table(), encoding="utf-8")
    say(f"{chosen}\n")
    return _reported(chosen.design, real, json, out, stopped=False)


def _found(found: Any, name: str, json: bool, out: Path | None) -> int:
    """An answer that is no design: in words, as a file of that name where a folder is asked for, and as JSON."""
    from equipoise.reporting.jsonfile import dumps

    say(str(found))
    with staging(out) as stage:
        if stage is not None:
            (stage / name).write_text(dumps(found.json()), encoding="utf-8")
    if json:
        emit(found.json())
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
    from equipoise.solving import cut, judged
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
            found = judged(found, problem)
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
    from equipoise.solving import judged
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
                write_report(judged(shown, problem), stage)
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


def _fronted(front: Discovery, problem: Problem, json: bool, out: Path | None, stopped: bool) -> int:
    """Verify the designs of a front, write them, and say what there is to say."""
    from equipoise.discovery.ask import design_problem
    from equipoise.reporting.front_page import page
    from equipoise.reporting.jsonfile import dumps
    from equipoise.verbs.verify import insist
    from equipoise.verbs.verify import verify as run

    lines, reasons, made = [], [], []
    with staging(out) as stage:
        for design in front.designs:
            folder = None if stage is None else stage / front.folder(design)
            if folder is not None:
                folder.mkdir()
            place = None if out is None else out / front.folder(design)
            told = _told(design, design_problem(design, problem), place)
            found = told if stopped else run(told, out=folder)
            made.append(found)
            _write(found, folder)
            lines += _written(place, found)
            try:
                insist(found)
            except DisagreementError as error:
                reasons.append(str(error))
        front = front.with_designs(tuple(made))
        if stage is not None:
            (stage / "front.json").write_text(dumps(front.json()), encoding="utf-8")
            if not stopped:
                (stage / "report.html").write_text(page(front), encoding="utf-8")
    lines += [f"front       {out / 'front.json'}"] if out is not None else []
    lines += [f"report      {out / 'report.html'}"] if out is not None and not stopped else []
    say("\n".join([str(front), *lines]))
    if json:
        emit(front.json())
    if stopped:
        return STOPPED
    missed = [design.missed for design in front.designs]
    reasons += [f"target missed by every design: {missed[-1]}"] if all(missed) else []
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
