"""discover: which springs at all, from a dictionary of candidates; the front of number of springs against residual."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from equipoise.design import Design
from equipoise.discovery.alternative import Alternative
from equipoise.discovery.collect import Collection, collect
from equipoise.discovery.contest import ALIKE, NOTHING, Contest
from equipoise.discovery.front import Discovery, bounds_of
from equipoise.discovery.growing import Found, grow
from equipoise.discovery.refine import Refiner
from equipoise.discovery.request import Discover
from equipoise.discovery.stage import Tell, untold
from equipoise.discovery.subsets import Ranked, Search
from equipoise.errors import EquipoiseError, InfeasibleError, InputError
from equipoise.interference import shell
from equipoise.interference.findings import clashes
from equipoise.limits import Limit
from equipoise.mechanism import Mechanism
from equipoise.objective import Aim, as_objective
from equipoise.scattering import Scatter
from equipoise.solve.program import Norm
from equipoise.sweep import Sweep
from equipoise.verbs.shape import thinned

JUDGED = 40
"""Subsets per number of springs that are judged by the objective's own norm."""
FEW = 256
"""Poses over which contenders are refined."""

Progress = Callable[[int, int, float], None]


def discover(
    mechanism: Mechanism,
    sweep: Sweep | None = None,
    request: Discover | None = None,
    *,
    norm: Norm | None = None,
    objective: Aim | Sequence[Aim] | None = None,
    limits: Sequence[Limit] = (),
    scatter: Scatter | None = None,
    progress: Progress | None = None,
    tell: Tell = untold,
) -> Discovery:
    """Find which springs to add, where, and how big: the front of their number against what motors still hold.

    A dictionary of candidates is compressed to its rank and searched for the best subsets (pairs exhaustively, more
    by a beam with exchange); those that the objective's own norm ranks best, and the design before with the best
    candidate added, are refined by sequential convex programming; the best of each number is shaped over the whole
    sweep (default: 2048 Sobol poses; default norm: peak). Where the objective is judged by its band under the scatter,
    refined contenders, and numbers of parts, are ranked by that. progress is called with (numbers done, numbers,
    value), tell with every `Stage` on the way; Ctrl-C returns what is finished. Raises InputError for an objective
    that is not the holding effort, InfeasibleError where filters leave no candidate, naming what removed how many.
    """
    request = request or Discover()
    sweep = sweep or Sweep.sobol(mechanism)
    aims = as_objective(norm or ("peak" if objective is None else None), objective)
    counted = [aim for aim in aims if aim.cap is None]
    if len(counted) > 1 or counted[0].goal != "hold":
        raise InputError(
            "discover makes the holding effort small, and nothing else beside it",
            where="objective",
            hint="give one aim with goal hold; others as caps",
        )
    aim = counted[0]
    collection = collect(mechanism, sweep, request, aim)
    compressed = collection.dictionary.compressed
    search = Search.of(compressed, collection.dictionary.spots)
    ranked = search.best(request.springs, keep=JUDGED)
    bounds = bounds_of(collection, sweep, aim)
    few = thinned(sweep, mechanism.states(sweep), FEW) if len(sweep.poses) > FEW else sweep
    refiner = Refiner(mechanism, few, aims, limits)
    found = Found(Contest(refiner, scatter or Scatter(), sweep, tell=tell))
    found.notes += _mixed(collection, aim)
    found.floor = max([bound.value for bound in bounds] + [NOTHING * refiner.bare])
    try:
        for count in range(1, request.springs + 1):
            if found.values and found.values[-1] <= found.floor * (1 + ALIKE):
                found.notes.append(f"the floor is reached with {len(found.designs[-1].balancers)}: no more were tried")
                break
            if count in ranked:
                _grow(found, collection, ranked[count], count, sweep, aim)
            if progress:
                progress(count, request.springs, found.values[-1] if found.values else float("nan"))
    except KeyboardInterrupt:
        if not found.designs:
            raise
        found.stopped = True
    if not found.designs:
        reasons = [one.reason for one in found.contest.lost if not any(one.reason in note for note in found.notes)]
        told = "".join(f"; {note}" for note in dict.fromkeys((*found.notes, *reasons)))
        raise InfeasibleError(
            f"no subset of the candidates gains anything within the limits{told}",
            where="discover",
            hint="try other `kinds`, widen `margin` or list `points` farther out, or relax the limits",
        )
    return Discovery(
        designs=_considered(found),
        aim=aim,
        unit=aim.unit(mechanism),
        before=found.designs[0].bare(aim),
        bounds=bounds,
        candidates=len(collection.dictionary),
        poses=len(collection.states),
        rank=compressed.rank,
        lost=compressed.lost,
        spacing=collection.spacing,
        margin=collection.margin,
        refused=collection.refused,
        pairs=tuple(dict.fromkeys(batch.place for batch in collection.dictionary.batches)),
        notes=(*found.notes, f"clashes are judged by capsules {shell(mechanism, request.radius).words}"),
        clashes=tuple(clashes(design, request.radius) for design in found.designs),
        stopped=found.stopped,
        values=tuple(found.values),
    )


def _grow(found: Found, collection: Collection, ranked: Ranked, count: int, sweep: Sweep, aim: Aim) -> None:
    """As `grow`, but what is finished is not lost to a number of parts that fails."""
    try:
        grow(found, collection, ranked, count, sweep, aim)
    except EquipoiseError as error:
        if not found.designs:
            raise
        found.notes.append(f"with {count}: no design, {error.message}")


def _mixed(collection: Collection, aim: Aim) -> list[str]:
    """That efforts of hinges and slides count alike, where they do."""
    rows, mechanism = collection.analysis.rows, collection.scene.ground.mechanism
    units = {rows[name].unit for name in aim.counted(mechanism) if name in collection.analysis.worth}
    if aim.divisor or len(units) < 2:
        return []
    hint = "`divisor: motor` weighs joints by their motors, `joints` names those of one kind"
    return [f"1 N at a slide counts as 1 N m at a hinge: {hint}"]


def _considered(found: Found) -> tuple[Design, ...]:
    """The designs with the choices that lost to them; where no design has so many parts, to the one with fewer."""
    counts = [len(design.balancers) for design in found.designs]
    lost: dict[int, list[Alternative]] = {count: [] for count in counts}
    for one in found.contest.lost:
        lost[max((count for count in counts if count <= one.springs), default=counts[0])].append(one)
    return tuple(
        replace(design, alternatives=tuple(lost[count])) for count, design in zip(counts, found.designs, strict=True)
    )
