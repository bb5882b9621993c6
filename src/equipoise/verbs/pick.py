"""pick: real parts in the place of ideal springs, the geometry shaped anew around each."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from equipoise.assemble import Balancer
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.errors import EquipoiseError, InfeasibleError, InputError, nearest
from equipoise.objective import leading
from equipoise.parameters import read, write
from equipoise.parts.catalogue import Catalogue
from equipoise.parts.choice import Choice, Tried
from equipoise.parts.part import Part
from equipoise.parts.ranking import Line, Ranking
from equipoise.parts.request import Pick
from equipoise.scattering import Scatter, tolerance
from equipoise.verbs.balance import balance
from equipoise.verbs.shape import shape
from equipoise.verbs.survey import fittings, survey_catalogue

MOST = 200
"""Candidates that are optimised for one spring; the closed form ranks what is left out."""

Progress = Callable[[str, int, int, float], None]


@dataclass(frozen=True, eq=False)
class Picked:
    """A design whose springs are parts, how each was chosen, and the design with ideal springs that it came from.

    rankings {spring: every candidate, ranked} are what each choice was made from.
    """

    design: Design
    ideal: Design
    rankings: Mapping[str, Ranking]

    @property
    def choices(self) -> tuple[Choice, ...]:
        """How each part was chosen, which the design holds."""
        return self.design.choices

    def __str__(self) -> str:
        lines = []
        for choice in self.choices:
            others = [f"{one.name} {_reached(one)}" for one in choice.tried[1:]]
            lines.append(f"{choice.spring.ljust(11)} {choice.order}")
            lines.append(f"            {'; '.join(choice.counted())}")
            beside = f"; next: {', '.join(others)}" if others else ""
            lines.append(f"            reached {_reached(choice.taken)}{beside}")
            lines += [f"            {remark}" for remark in choice.remarks]
        return "\n".join(lines)


def _reached(one: Tried) -> str:
    return f"{one.value:.4g}" + (f" (95 %: {one.high:.4g})" if one.high is not None else "")


def pick(
    design: Design,
    request: Pick | None = None,
    *,
    scatter: Scatter | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Picked:
    """Put a real part in the place of every ideal spring of a design, and shape the geometry around it.

    Springs are taken one after another, the one with the most stored energy first; while one is chosen, those not yet
    chosen stay ideal. For each, every candidate is optimised over the design's free geometry, the best few are shaped
    with the objective's own norm and limits, and the best of those stays: by value or, where the objective is judged by
    its band, by the 95 % value under the scatter. A part's rest length, initial tension,
    working range and own mass all count. Raises InfeasibleError where no candidate keeps the limits, with
    what refused how many.
    """
    request = request or Pick()
    catalogue, removed = request.table()
    names = _chosen(design, request)
    free = dict(design.bounds)
    balancers = write(design.balancers, design.geometry)
    if request.leader is not None:
        free |= {f"{name}.law.leader": request.leader for name in names}
    found, choices, rankings = design, [], {}
    for name in names:
        search = _Search(
            found, balancers, free, catalogue, removed, request.parallel, request.keep, scatter or Scatter(), seed
        )
        found, balancers, choice, rankings[name] = search.best(name, progress)
        choices.append(choice)
    return Picked(replace(found, choices=tuple(choices)), design, rankings)


def _chosen(design: Design, request: Pick) -> list[str]:
    """The springs that get parts, the one with the most stored energy first."""
    ideal = [b for b in design.balancers if isinstance(b, Spring) and b.path.unit == "m" and b.like is None]
    ideal = [spring for spring in ideal if not isinstance(spring.law, Part)]
    known = [spring.name for spring in ideal]
    for name in request.springs or ():
        if name not in known:
            raise InputError(
                f"there is no ideal spring {name!r} along a length", where="pick", hint=nearest(name, known)
            )
    wanted = [spring for spring in ideal if request.springs is None or spring.name in request.springs]
    if not wanted:
        raise InputError(
            "no spring of this design waits for a part",
            where="pick",
            hint="springs along a length whose law is no part yet can be picked",
        )
    energy = {part["name"]: part["energy"][1] for part in design.parts() if part["kind"] == "spring"}
    return [spring.name for spring in sorted(wanted, key=lambda spring: -energy[spring.name])]


@dataclass(frozen=True, eq=False)
class _Search:
    """What stands when one more spring is to get its part."""

    design: Design
    balancers: Sequence[Balancer]
    free: Mapping[str, tuple[float, float]]
    catalogue: Catalogue
    removed: Mapping[str, int]
    parallel: int
    keep: int
    scatter: Scatter
    seed: int

    def best(self, name: str, progress: Progress | None) -> tuple[Design, tuple[Balancer, ...], Choice, Ranking]:
        """The best part for one spring: the design and the balancers with it, how it was chosen, and from what."""
        free = {key: ends for key, ends in self.free.items() if not _of_a_law(key, self.balancers, name)}
        ranking = self._ranking(name, free, progress)
        if not ranking.ranked:
            raise InfeasibleError(_none_left(name, ranking), where=f"spring {name}", hint=_nearest_miss(ranking))
        tried: list[tuple[Tried, Design, tuple[Balancer, ...]]] = []
        failed: list[str] = []
        for line in _apart(ranking.ranked, self.keep):
            placed = tuple(_placed(ranking, line, self.balancers, name))
            open_ones = {key: ends for key, ends in free.items() if _readable(placed, key)}
            try:
                made = _shaped(self.design, placed, open_ones)
            except EquipoiseError as error:
                failed.append(str(error))
            else:
                tried.append((self._judged(line, made), made, write(placed, made.geometry)))
        if not tried:
            told = f"the best {len(failed)} candidates for {name} fail: {failed[0]}"
            raise InfeasibleError(told, where="pick", hint="raise `keep`")
        tried.sort(key=lambda entry: (entry[0].judged, entry[0].number))
        made, placed = tried[0][1:]
        part = next(one.law for one in placed if isinstance(one, Spring) and one.name == name)
        assert isinstance(part, Part)
        choice = Choice(
            spring=name,
            order=part.order_line(),
            source=self.catalogue.name,
            candidates=len(ranking.lines) + ranking.outranked,
            outranked=ranking.outranked,
            removed=self.removed,
            refused=ranking.refused,
            tried=tuple(one for one, *_ in tried),
            remarks=self.catalogue.remarks,
        )
        return made, placed, choice, ranking

    def _judged(self, line: Line, made: Design) -> Tried:
        banded = leading(made.objective).judged == "band"
        high = tolerance(made, self.scatter).band.high if banded else None
        return Tried(line.part, line.number, made.certificate.primal, high)

    def _ranking(self, name: str, free: Mapping[str, tuple[float, float]], progress: Progress | None) -> Ranking:
        return survey_catalogue(
            self.design.mechanism,
            self.balancers,
            self.design.sweep,
            free,
            self.catalogue,
            spring=name,
            parallel=self.parallel,
            most=MOST,
            objective=self.design.objective,
            limits=self.design.limits,
            seed=self.seed,
            progress=None if progress is None else partial(progress, name),
        )


def _of_a_law(key: str, balancers: Sequence[Balancer], name: str) -> bool:
    """Whether a free parameter belongs to a law that a part replaces; leaders stay, of this spring and of parts."""
    head, _, rest = key.partition(".")
    if rest == "law.leader":
        return head != name and not any(b.name == head and isinstance(getattr(b, "law", None), Part) for b in balancers)
    return head == name and rest.startswith("law.")


def _readable(balancers: Sequence[Balancer], key: str) -> bool:
    try:
        return read(balancers, key) is not None
    except InputError:
        return False


def _placed(ranking: Ranking, line: Line, balancers: Sequence[Balancer], name: str) -> Iterator[Balancer]:
    """The balancers with a line's part and geometry."""
    chosen = next(one for one in balancers if isinstance(one, Spring) and one.name == name)
    law = ranking.catalogue.spring(ranking.row(line), line.number)
    placed = tuple(
        replace(one, law=law, mass=fittings(one)) if isinstance(one, Spring) and one.owner == chosen.owner else one
        for one in balancers
    )
    yield from write(placed, dict(zip(ranking.free, line.geometry, strict=True)))


def _shaped(design: Design, balancers: Sequence[Balancer], free: Mapping[str, tuple[float, float]]) -> Design:
    """The design with these balancers, from where they are; with nothing free, balanced."""
    pieces = (design.mechanism, balancers, design.sweep)
    if not free:
        return balance(*pieces, objective=design.objective, limits=design.limits)
    inside = {key: float(np.clip(read(balancers, key) or 0.0, *bounds)) for key, bounds in free.items()}
    started = write(balancers, inside)
    return shape(*pieces[:1], started, design.sweep, free, objective=design.objective, limits=design.limits, starts=1)


def _apart(lines: Sequence[Line], count: int) -> list[Line]:
    """The best lines, one per part number."""
    found: dict[str, Line] = {}
    for line in lines:
        found.setdefault(line.part, line)
        if len(found) == count:
            break
    return list(found.values())


def _none_left(name: str, ranking: Ranking) -> str:
    told = "; ".join(f"{count} by {words}" for words, count in ranking.refused.items())
    return f"none of {len(ranking.lines)} candidates can stand in for {name}: refused {told}"


def _nearest_miss(ranking: Ranking) -> str:
    line = min(ranking.lines, key=lambda line: line.excess)
    name = Tried(line.part, line.number, line.value).name
    return (
        f"{name} comes nearest and misses {line.refused} by {100 * line.excess:.3g} %: "
        "widen the bounds, allow more in parallel, or take another catalogue"
    )
