"""survey_catalogue: every spring of a catalogue at its own best geometry, many side by side."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.assemble import Balancer
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError, nearest
from equipoise.limits import Limit
from equipoise.mechanism import Mechanism
from equipoise.objective import Aim
from equipoise.parts.catalogue import Catalogue
from equipoise.parts.ranking import Line, Ranking
from equipoise.solve.program import Norm
from equipoise.sweep import Sweep
from equipoise.tasks import task_of
from equipoise.verbs.candidates import Work
from equipoise.verbs.searching import Search
from equipoise.verbs.shape import freedom_of, load_of
from equipoise.verbs.workers import shared

CHUNK = 325

Chunk = tuple[NDArray[np.intp], Array]
Progress = Callable[[int, int, float], None]
Store = Callable[[Sequence[Line]], None]


def survey_catalogue(
    mechanism: Mechanism,
    balancers: Sequence[Balancer],
    sweep: Sweep,
    free: Mapping[str, tuple[float, float]],
    catalogue: Catalogue,
    *,
    spring: str | None = None,
    parallel: int = 1,
    most: int | None = None,
    norm: Norm | None = None,
    objective: Aim | Sequence[Aim] | None = None,
    limits: Sequence[Limit] = (),
    seed: int = 0,
    workers: int = 1,
    done: Sequence[Line] = (),
    store: Store | None = None,
    progress: Progress | None = None,
) -> Ranking:
    """Every spring of a catalogue in the place of `spring`, at the geometry within bounds that suits it best.

    free {parameter: (low, high)}, SI, are the geometry's; what of it belongs to the spring's own law falls away, for a
    part's numbers are given. Up to `parallel` springs of a row side by side are tried. Each candidate is started from
    the best of many geometries, judged in closed form, and from where its likes came to rest; it descends by batched
    quadratic programming on the rms and goes on by the objective's norm. The values that count are taken over all
    states, in every norm, and ranked by the objective's own. Working ranges, limits and own masses count. workers
    processes share the work, whose answer does not depend on how many they are; a script that asks for more than one
    needs the usual guard of multiprocessing. done are lines of an earlier run, which are not worked on again; store is
    handed every chunk of finished lines; progress is called with (done, all, best). Of more than `most` candidates only
    those are worked on that the closed form ranks first. Ctrl-C ends with the ranking of what is done.
    """
    name, placed = _placed(balancers, spring, catalogue)
    kept = {
        key: ends for key, ends in free.items() if not key.startswith(f"{name}.law.") or key.endswith(".law.leader")
    }
    freedoms = tuple(freedom_of(placed, key, ends) for key, ends in kept.items())
    task = task_of(mechanism, placed, sweep, norm, objective, limits)
    states = mechanism.states(sweep)
    load = load_of(task, states)
    if not load > 0:
        raise InputError("nothing loads what counts", where="survey", hint="check gravity and joints")
    work = Work(task, name, freedoms, catalogue, states, load, seed, parallel)
    search = Search(work)
    jobs = [(row, number) for number in range(1, parallel + 1) for row in range(len(catalogue))]
    known, outranked = {(line.part, line.number) for line in done}, 0
    if most is not None and len(jobs) > most:
        outranked, jobs = len(jobs) - most, search.promising(jobs, most)
    # Chunks are those of the whole survey, so that a survey that goes on finds what it would have found.
    chunks = [chunk for chunk in _chunks(catalogue, jobs) if not _parts(catalogue, chunk) <= known]
    lines = list(done)
    try:
        for whole in shared(search, chunks, workers, search.scout):
            found = [line for line in whole if (line.part, line.number) not in known]
            lines += found
            if store:
                store(found)
            if progress:
                best = min((line.value for line in lines if not line.refused), default=np.inf)
                progress(len(lines), len(jobs), best)
    except KeyboardInterrupt:
        if not lines:
            raise
    names = tuple(freedom.name for freedom in freedoms)
    return Ranking(catalogue, name, names, work.units, work.norm, tuple(lines), outranked)


def _chunks(catalogue: Catalogue, jobs: Sequence[tuple[int, int]]) -> Iterator[Chunk]:
    for form in dict.fromkeys(catalogue.form):
        same = [(row, number) for row, number in jobs if catalogue.form[row] == form]
        for start in range(0, len(same), CHUNK):
            rows, numbers = zip(*same[start : start + CHUNK], strict=True)
            yield np.array(rows, dtype=np.intp), np.array(numbers, dtype=float)


def _parts(catalogue: Catalogue, chunk: Chunk) -> set[tuple[str, int]]:
    return {(catalogue.part[row], int(number)) for row, number in zip(*chunk, strict=True)}


def _placed(
    balancers: Sequence[Balancer], spring: str | None, catalogue: Catalogue
) -> tuple[str, tuple[Balancer, ...]]:
    """The spring that a part is sought for, and the balancers with the first part in its place."""
    springs = [one for one in balancers if isinstance(one, Spring) and one.path.unit == "m"]
    names = [one.name for one in springs]
    if not springs:
        raise InputError("there is no spring along a length to find a part for", where="survey")
    if spring is None and len(springs) > 1:
        raise InputError("which spring?", where="survey", hint=f"name one of {', '.join(names)}")
    if spring is not None and spring not in names:
        raise InputError(f"there is no spring {spring!r} along a length", where="survey", hint=nearest(spring, names))
    chosen = springs[0] if spring is None else springs[names.index(spring)]
    law = catalogue.spring(0)
    return chosen.name, tuple(
        replace(one, law=law, mass=fittings(one)) if isinstance(one, Spring) and one.owner == chosen.owner else one
        for one in balancers
    )


def fittings(spring: Spring) -> float:
    """Fittings keep their mass; the mass of an ideal spring's wire gives way to the part's own."""
    return float(spring.mass) if isinstance(spring.mass, int | float) else 0.0
