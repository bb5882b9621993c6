"""From the file a command is pointed at to parts: what `equipoise pick` and `equipoise survey` do."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from equipoise.console import Interrupts, progress_bar, say
from equipoise.errors import InputError
from equipoise.objective import leading
from equipoise.parts.ranking import Ledger, Ranking, cells, header
from equipoise.parts.request import Pick
from equipoise.problem import Problem, problem_of
from equipoise.yamlfile import Document

if TYPE_CHECKING:
    from equipoise.design import Design
    from equipoise.verbs.pick import Picked

SHOWN = 10
ROWS, RANKED, FILE = "survey.rows.csv", "survey.csv", "picked.yaml"


def requested(
    problem: Problem,
    catalogue: Path | None,
    units: str | None,
    columns: Sequence[str],
    parallel: int | None,
) -> Pick:
    """The file's `pick` block with what the command line says over it."""
    request = problem.content.pick or Pick()
    changed: dict[str, Any] = {}
    if catalogue is not None:
        changed |= {"catalogue": catalogue, "grid": None}
        if not catalogue.is_file():
            hint = "paths on the command line count from the folder it is given in"
            raise InputError("the catalogue cannot be read: there is no such file", where=str(catalogue), hint=hint)
    if units is not None:
        if units not in ("metric", "inch"):
            raise InputError(f"there is no system of units {units!r}", where="--units", hint="metric or inch")
        changed["units"] = units
    if parallel is not None:
        changed["parallel"] = parallel
    if columns:
        pairs = [said.partition("=") for said in columns]
        bad = [said for said, (_, sign, _) in zip(columns, pairs, strict=True) if not sign]
        if bad:
            raise InputError(f"cannot read {bad[0]!r}", where="--column", hint="write --column rate='Spring Rate'")
        changed["columns"] = {**(request.columns or {}), **{key.strip(): name.strip() for key, _, name in pairs}}
    return replace(request, **changed)


def picked(problem: Problem, design: Design, request: Pick, seed: int | None) -> tuple[Picked, Problem]:
    """Real parts for a design's springs, and the problem as it stands with them, rebuilt from plain data."""
    from equipoise.parts.part import Part
    from equipoise.parts.record import with_parts
    from equipoise.verbs.pick import pick

    unit = leading(problem.objective).unit(problem.mechanism)
    if request.catalogue is not None:
        # What is wrong with a catalogue is told of the catalogue, and before anything is solved.
        request.table()
    with problem.at_names(), Interrupts(), progress_bar("pick", "candidates", unit) as progress:
        show = None if progress is None else lambda _, done, count, best: progress(done, count, best)
        found = pick(design, request, scatter=problem.content.tolerances, seed=seed or 0, progress=show)
    names = {choice.spring for choice in found.choices}
    laws = {balancer.name: getattr(balancer, "law", None) for balancer in found.design.balancers}
    parts = {name: law for name, law in laws.items() if name in names and isinstance(law, Part)}
    content = with_parts(problem.raw, parts, found.design.bounds)
    return found, problem_of(Document(problem.document.name, content), problem.folder)


def write_problem(problem: Problem, path: Path) -> None:
    """The problem with its parts as a file that can be edited and run again; paths in it count from its folder."""
    from ruamel.yaml import YAML

    with path.open("w", encoding="utf-8") as stream:
        YAML().dump(_rooted(dict(problem.raw), problem.folder), stream)


def _rooted(content: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The same content with a robot file's path absolute, for the file moves to another folder."""
    mechanism = content.get("mechanism")
    if isinstance(mechanism, Mapping):
        model = mechanism.get("model")
        if isinstance(model, str) and not model.startswith("package:"):
            content["mechanism"] = {**dict(mechanism), "model": str((folder / model).resolve())}
    return content


def surveyed(problem: Problem, request: Pick, spring: str | None, out: Path, seed: int | None) -> tuple[Ranking, bool]:
    """Every row of the catalogue optimised, on disk as it is finished; whether Ctrl-C cut it short."""
    from equipoise.parameters import unit_of
    from equipoise.verbs.survey import survey_catalogue

    catalogue, removed = request.table()
    for words, count in removed.items():
        say(f"{count} springs left out by {words}")
    for remark in catalogue.remarks:
        say(f"note: {remark}")
    free = dict(problem.bounds)
    springs = [one.name for one in problem.balancers if hasattr(one, "path")]
    chosen = spring or (springs[0] if len(springs) == 1 else None)
    if request.leader is not None and chosen is not None:
        free[f"{chosen}.law.leader"] = request.leader
    names = [name for name in free if not name.startswith(f"{chosen}.law.") or name.endswith(".leader")]
    units = ["m" if name.endswith(".leader") else unit_of(problem.balancers, name) for name in names]
    numbers = [catalogue.rate, catalogue.free_length, catalogue.initial_tension, catalogue.travel, catalogue.mass]
    told = [problem.raw, chosen, seed or 0, request.leader, catalogue.part, [column.tolist() for column in numbers]]
    signature = hashlib.sha256(json.dumps(told, default=str, sort_keys=True).encode()).hexdigest()[:16]
    ledger = Ledger(out / ROWS, signature, names, units)
    done = ledger.load()
    # Where nothing can be written, it is better known before than after the first rows.
    ledger.append([])
    if done:
        say(f"{len(done)} candidates were finished before; going on from there")
    unit = leading(problem.objective).unit(problem.mechanism)
    with problem.at_names(), Interrupts() as interrupts, progress_bar("survey", "candidates", unit) as progress:
        found = survey_catalogue(
            problem.mechanism,
            problem.balancers,
            problem.sweep,
            free,
            catalogue,
            spring=chosen,
            parallel=request.parallel,
            objective=problem.objective,
            limits=problem.limits,
            seed=seed or 0,
            workers=os.cpu_count() or 1,
            done=done,
            store=ledger.append,
            progress=progress,
        )
    (out / RANKED).write_text(found.table(), encoding="utf-8")
    return found, interrupts.hit


def survey_words(found: Ranking, unit: str, out: Path) -> str:
    """The best of a survey in a table, what was refused, and where the files are."""
    head = f"{found.spring}: {len(found.lines)} candidates of {found.catalogue.name}, ranked by {found.norm}"
    lines = [head, f"  rank  {'part':<28}{'number':>6}{'peak':>12}{'rms':>12}{'mean':>12}   [{unit}]"]
    for rank, line in enumerate(found.ranked[:SHOWN], 1):
        norms = "".join(f"{value:>12.4g}" for value in (line.peak, line.rms, line.mean))
        lines.append(f"  {rank:>4}  {line.part[:28]:<28}{line.number:>6}{norms}")
    lines += [f"refused     {count}: {words}" for words, count in found.refused.items()]
    lines += [f"ranked      {out / RANKED}", f"rows        {out / ROWS}"]
    return "\n".join(lines)


def survey_json(found: Ranking) -> dict[str, Any]:
    """A survey as `--json` prints it."""
    names = header(found.free, found.units)
    return {
        "spring": found.spring,
        "catalogue": found.catalogue.name,
        "norm": found.norm,
        "candidates": len(found.lines),
        "refused": found.refused,
        "ranked": [dict(zip(names, cells(line), strict=True)) | _numbers(line) for line in found.ranked],
    }


def _numbers(line: Any) -> dict[str, Any]:
    return {key: getattr(line, key) for key in ("number", "value", "peak", "rms", "mean", "excess")}
