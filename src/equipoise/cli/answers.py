"""What is written, said and returned once an answer is there."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from equipoise.console import STOPPED, emit, say, staging
from equipoise.errors import DisagreementError, InputError

if TYPE_CHECKING:
    from equipoise.design import Design
    from equipoise.problem import Problem


class Answer(Protocol):
    """What a command finds: words by `str`, and data."""

    def json(self) -> Any:
        """The answer as JSON's own types."""
        ...


def answer(
    found: Answer, name: str, json: bool, out: Path | None, beside: Callable[[Path], object] | None = None
) -> int:
    """An answer that is no design: in words, as a file of that name where a folder is asked for, and as JSON.

    beside(folder) writes what else belongs into the folder.
    """
    say(str(found))
    with staging(out) as stage:
        if stage is not None:
            write_json(found, stage / name)
            if beside is not None:
                beside(stage)
    if json:
        emit(found.json())
    return 0


def write_json(found: Answer, path: Path) -> None:
    """The answer's data as a file."""
    from equipoise.reporting.jsonfile import dumps

    path.write_text(dumps(found.json()), encoding="utf-8")


def told(found: Design, problem: Problem, out: Path | None) -> Design:
    """The design with the problem it answers, as a file in `out` would say it."""
    from equipoise.designfile import with_problem

    return with_problem(found, problem, out)


def default_out(problem: Problem) -> Path:
    """The folder of a command that always writes, where none is named."""
    return Path("out") / (Path(problem.document.name.split(",")[0]).stem or "design")


def write_design(found: Design, stage: Path | None) -> None:
    """`design.json`, where there is a folder for it."""
    if stage is not None:
        write_json(found, stage / "design.json")


def written(out: Path | None, found: Design) -> list[str]:
    """Lines that say where the files are, the most interesting last."""
    if out is None:
        return []
    lines = [f"design      {out / 'design.json'}"]
    if found.verification is not None and found.verification.model is not None:
        lines.insert(0, f"model       {out / Path(found.verification.model).name}")
    return lines


def design_answer(found: Design, problem: Problem, json: bool, out: Path | None, stopped: bool) -> int:
    """A design as it was solved: neither verified nor reported."""
    from equipoise.solving import banded

    found = banded(told(found, problem, out), problem)
    with staging(out) as stage:
        write_design(found, stage)
    return concluded(found, json, stopped, written(out, found))


def reported(found: Design, problem: Problem, json: bool, out: Path, stopped: bool) -> int:
    """A design with all that can be done for it: its parts cut, verified, judged, reported."""
    from equipoise.solving import cut, judged
    from equipoise.verbs.report import report as write_report
    from equipoise.verbs.verify import verify as run

    found = told(found, problem, out)
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
            write_design(found, stage)
        say(f"stopped during verification and report; the design is in {out / 'design.json'}")
        return STOPPED
    parts = [f"part        {out / f'{part.name}.dxf'}" for part in found.made]
    code = concluded(found, json, stopped, [*written(out, found), *parts, f"report      {out / 'report.html'}"])
    if refused is not None:
        raise refused
    return code


def concluded(found: Design, json: bool, stopped: bool, lines: Sequence[str]) -> int:
    """Print what there is to say of a design; the exit code."""
    say("\n".join([str(found), *lines]))
    missed = [f"target missed: {found.missed}"] if found.missed else []
    return ended(found, json, stopped, [*missed, *disagreements([found])])


def ended(found: Answer, json: bool, stopped: bool, reasons: Sequence[str]) -> int:
    """The data, where asked for, and the exit code: 1 where there are reasons against the answer, which are said."""
    if json:
        emit(found.json())
    if stopped:
        return STOPPED
    for reason in reasons:
        say(f"error: {reason}")
    return 1 if reasons else 0


def disagreements(designs: Iterable[Design]) -> list[str]:
    """Where the simulation of verified designs does not agree with them."""
    from equipoise.verbs.verify import insist

    reasons = []
    for design in designs:
        try:
            insist(design)
        except DisagreementError as error:
            reasons.append(str(error))
    return reasons
