"""One design for several cases: verified in each, reported in the hardest, a folder for every case."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from equipoise.cli.answers import disagreements, ended, told, write_design, write_json
from equipoise.console import say, staging

if TYPE_CHECKING:
    from equipoise.problem import Problem
    from equipoise.verbs.adjusted import Adjusted


def cases_answer(found: Adjusted, problem: Problem, json: bool, out: Path | None, stopped: bool) -> int:
    """The designs as they were solved: neither verified nor reported."""
    found = _told(found, problem, out)
    with staging(out) as stage:
        if stage is not None:
            write_json(found, stage / "design.json")
    return _concluded(found, json, stopped, [] if out is None else [f"design      {out / 'design.json'}"])


def cases_reported(found: Adjusted, problem: Problem, json: bool, out: Path, stopped: bool) -> int:
    """The designs with all that can be done for them: each verified, the hardest reported."""
    from equipoise.solving import judged
    from equipoise.verbs.report import report as write_report
    from equipoise.verbs.verify import verify as run

    with staging(out) as stage:
        assert stage is not None
        designs = []
        for index, design in enumerate(found.designs):
            name = f"case_{index + 1}"
            (stage / name).mkdir()
            designs.append(run(told(design, problem, out / name), out=stage / name))
            write_design(designs[-1], stage / name)
        found = _told(replace(found, designs=tuple(designs)), problem, out)
        write_report(judged(found.designs[found.hardest], problem), stage)
        write_json(found, stage / "design.json")
    lines = [f"design      {out / 'design.json'}", f"report      {out / 'report.html'}"]
    return _concluded(found, json, stopped, lines)


def _told(found: Adjusted, problem: Problem, out: Path | None) -> Adjusted:
    from equipoise.solving import banded

    return replace(found, designs=tuple(banded(told(design, problem, out), problem) for design in found.designs))


def _concluded(found: Adjusted, json: bool, stopped: bool, lines: list[str]) -> int:
    say("\n".join([str(found), *lines]))
    labelled = zip(found.labels, found.designs, strict=True)
    missed = [f"target missed in {label}: {design.missed}" for label, design in labelled if design.missed]
    return ended(found, json, stopped, [*missed, *disagreements(found.designs)])
