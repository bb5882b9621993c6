"""From a request to its dictionary: pairs, places, states, columns."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.balancers.paths import Cable, Line
from equipoise.balancers.spring import Spring
from equipoise.discovery.dictionary import Dictionary
from equipoise.discovery.ground import Ground
from equipoise.discovery.kinds import Proposal, Scene
from equipoise.discovery.lattice import Spots, lattice, listed
from equipoise.discovery.request import Discover
from equipoise.errors import InfeasibleError, InputError
from equipoise.interference.axes import passed
from equipoise.limits.avoid import Avoid, beside, rooms
from equipoise.mechanism import Mechanism, Point
from equipoise.objective import Aim
from equipoise.parts import WindableSpring
from equipoise.states import States
from equipoise.sweep import Sweep
from equipoise.verbs.analyze import Analysis, analyze
from equipoise.verbs.shape import thinned

FINEST = 0.125
COARSER = 1.1
"""The lattice starts at this share of the margin and coarsens by this factor until the candidates fit."""
LOOKED_AT = 96
TOGETHER = 400
"""States at which candidates are looked at for what they run into, and candidates at once."""
MARGIN = 0.1
"""Margin about the links as a share of the mechanism's size."""


@dataclass(frozen=True, eq=False)
class Collection:
    """A dictionary with what it was made from: scene, states of all scenarios, the bare loads, spacing, margin (m)."""

    request: Discover
    scene: Scene
    dictionary: Dictionary
    states: States
    analysis: Analysis
    spacing: float
    margin: float

    def propose(self, index: int, number: int, share: float = 1.0) -> Proposal:
        """A candidate as the number-th balancer of a design at a share of its most, with what is asked of all."""
        found = self.dictionary.propose(index, number)
        if found.mass:
            found = replace(found, balancer=replace(found.balancer, mass=share * found.mass))
        spring, what = found.balancer, self.request.avoid
        if what == "nothing" or not (isinstance(spring, Spring) and isinstance(spring.path, Line | Cable)):
            return found
        law = spring.law
        wide = law.width if isinstance(law, WindableSpring) and law.room is None else None
        gap = 0.0 if wide is None else wide / 2
        return replace(found, limits=(*found.limits, Avoid(spring.name, self.request.radius, gap, what)))

    @property
    def reached(self) -> set[int]:
        """Numbers of the joints that some candidate acts on."""
        mechanism = self.scene.ground.mechanism
        if mechanism.model.neq or not all(kind.lines for kind in self.request.tried):
            return set(range(mechanism.model.njnt))
        pairs = [(a.body, b.body) for a, b in self.scene.pairs]
        return {joint for pair in pairs for joint in self.scene.ground.between(*pair)}

    @property
    def refused(self) -> dict[str, int]:
        """How many candidates each filter removed."""
        return dict(self.scene.refused)


def collect(mechanism: Mechanism, sweep: Sweep, request: Discover, aim: Aim) -> Collection:
    """All candidates of a request over a sweep.

    Raises InputError where there is nothing to pair, InfeasibleError, naming what removed how many, where no
    candidate is left.
    """
    if sweep.moves is not None:
        raise InputError("discover looks for springs that hold a mechanism at rest", where="sweep", hint="sweep poses")
    whole = mechanism.states(sweep)
    few = thinned(sweep, whole, request.poses) if len(sweep.poses) > request.poses else sweep
    states = mechanism.states(few)
    found = analyze(mechanism, few)
    ground = Ground(mechanism, np.abs(whole.holding).max(axis=0), found.worth)
    pairs = _pairs(ground, request)
    margin = request.margin or MARGIN * ground.mechanism.size
    spots, spacing = _spots(ground, pairs, request, margin)
    bare = mechanism.states(replace(few, payloads=(), scenarios=np.zeros((1, 0))))
    columns, scale = aim.columns(mechanism)
    used = _used(ground, pairs, request, columns, states)
    columns, scale = columns[used], scale[used]

    def counted(effort: Array) -> Array:
        rows = effort[..., columns] * scale
        return rows.reshape(*rows.shape[:-2], -1)

    moving = tuple(body for body in ground.groups if ground.between("world", body) and _carries(ground, body))
    bodies = _bodies(ground, moving, request, margin, spacing)
    scene = Scene(
        ground,
        bare,
        counted,
        spots,
        found.worth,
        bodies,
        _keeper(ground, request, bare),
        _lying(request, bare),
        Counter(),
    )
    batches = tuple(batch for kind in request.tried for batch in kind.batches(scene))
    if not batches:
        raise InfeasibleError(
            f"no candidate is left: {removed(scene.refused)}",
            where="discover",
            hint="widen the margin, refine the spacing, allow more stretch or other kinds",
        )
    loads = counted(states.holding.reshape(len(few.scenarios), -1, states.holding.shape[1]))
    weight = np.repeat(bare.weight / bare.weight.sum(), len(columns))
    return Collection(request, scene, Dictionary(batches, loads, weight, len(columns)), states, found, spacing, margin)


def removed(refused: Mapping[str, int]) -> str:
    """What removed how many candidates, in words."""
    parts = [f"{count} by {reason!r}" for reason, count in refused.items() if count]
    return "; ".join(parts) or "there was none to begin with"


def _pairs(ground: Ground, request: Discover) -> tuple[tuple[str, str], ...]:
    if len(ground.groups) < 2:
        raise InputError(
            f"{ground.mechanism.name} has one usable body, a spring needs two that move against each other",
            where="discover",
            hint="check the joints of the file",
        )
    if request.pairs is None and not ground.worth:
        raise InputError("gravity loads no joint enough to be worth a spring", where="discover", hint="name `pairs`")
    found = ground.pairs() if request.pairs is None else request.pairs
    forbidden = {frozenset(ground.group_of(body).body for body in pair) for pair in request.forbid}
    for pair in found:
        if request.pairs is not None and not ground.between(*pair):
            raise InputError(
                f"{pair[0]} and {pair[1]} move as one", where="discover.pairs", hint=", ".join(ground.groups)
            )
    kept = tuple(pair for pair in found if frozenset(ground.group_of(b).body for b in pair) not in forbidden)
    if not kept:
        raise InputError(
            f"all {len(found)} pairs are forbidden", where="discover.forbid", hint="forbid fewer, or name `pairs`"
        )
    return kept


def _spots(
    ground: Ground, pairs: Sequence[tuple[str, str]], request: Discover, margin: float
) -> tuple[tuple[tuple[Spots, Spots], ...], float]:
    """Places on both bodies of all pairs, as fine as the number of candidates admits."""
    own = _own(ground, request, margin)
    spacing = request.spacing or FINEST * margin
    # Beside the links there is room on either side.
    default = (margin, -margin) if request.avoids("bodies") else (0.0,)
    asides = default if request.aside is None else (request.aside,)
    while True:
        found = []
        for pair in pairs:
            for aside in asides if ground.normal(*pair) else asides[:1]:
                one, other = lattice(ground, pair, spacing, margin, aside)
                names = [ground.group_of(body).body for body in pair]
                found.append((own.get(names[0], one), own.get(names[1], other)))
        count = sum(len(a.places) * len(b.places) for a, b in found)
        if count <= request.candidates:
            return tuple(found), spacing
        if request.spacing is not None or all(ground.group_of(body).body in own for pair in pairs for body in pair):
            raise InputError(
                f"{count} candidates, the most is {request.candidates}",
                where="discover.spacing" if request.spacing else "discover.points",
                hint="widen the spacing, list fewer points, or raise `candidates`",
            )
        if spacing > 4 * margin + ground.mechanism.size:
            raise InputError(
                f"{len(pairs)} pairs do not fit into {request.candidates} candidates",
                where="discover.candidates",
                hint="raise `candidates` or name `pairs`",
            )
        spacing *= COARSER


def _bodies(
    ground: Ground, moving: Sequence[str], request: Discover, margin: float, spacing: float
) -> tuple[Spots, ...]:
    """Places on every moving body, for weights."""
    own = _own(ground, request, margin)
    return tuple(
        own[body] if body in own else lattice(ground, (body, body), spacing, margin, 0.0)[0] for body in moving
    )


def _own(ground: Ground, request: Discover, margin: float) -> dict[str, Spots]:
    """The user's lists of points by the rigid group that they are on."""
    given = (request.points or {}).items()
    return {ground.group_of(body).body: listed(ground, body, points, margin) for body, points in given}


def _carries(ground: Ground, body: str) -> bool:
    """Whether a joint that is worth something lies between the base and a body."""
    ids = {ground.mechanism.joint_id(joint) for joint in ground.worth}
    return bool(ids & set(ground.between("world", body)))


def _used(
    ground: Ground, pairs: Sequence[tuple[str, str]], request: Discover, columns: NDArray[np.int_], states: States
) -> NDArray[np.intp]:
    """Which counted rows are loaded, or may become so."""
    mechanism = ground.mechanism
    spanned = {joint for pair in pairs for joint in ground.between(*pair)}
    weights = not all(kind.lines for kind in request.tried)
    loads = np.abs(states.holding).max(axis=0)
    return np.array(
        [
            place
            for place, column in enumerate(columns)
            if weights
            or int(mechanism.driven_ids[column]) in spanned
            or loads[column] > 1e-9 * loads.max()
            or mechanism.model.neq
        ],
        dtype=int,
    )


def _keeper(ground: Ground, request: Discover, states: States) -> Callable[..., Mapping[str, NDArray[np.bool_]]]:
    """What refuses candidates whatever their kind: regions, bodies in the way, axes passed."""
    few = states.take(slice(None, None, 1 + len(states) // LOOKED_AT))

    def keep(pair: tuple[str, str], a: Array, b: Array, gap: float = 0.0) -> Mapping[str, NDArray[np.bool_]]:
        reasons: dict[str, NDArray[np.bool_]] = {}
        if request.keep_out:
            bad = np.zeros(len(a), dtype=bool)
            for region in request.keep_out:
                for body, places in zip(pair, (a, b), strict=True):
                    if ground.group_of(region.body) is ground.group_of(body):
                        bad |= region.holds(ground.seen_from(region.body, body, places))
            reasons["keep out"] = bad
        if pair[0] == pair[1]:
            return reasons
        if request.avoids("bodies"):
            reasons["a body in the way"] = _blocked(few, pair, a, b, request.radius, gap)
        if request.avoids("axes"):
            over = [passed(few, pair, a[part], b[part]) for part in _parts(len(a))]
            reasons["it passes a joint's axis"] = np.concatenate(
                [np.any(list(one.values()), axis=0) if one else np.zeros(0, dtype=bool) for one in over]
            )
        return reasons

    return keep


def _lying(request: Discover, states: States) -> Callable[[str, Array, Array, float], NDArray[np.bool_]]:
    """Whether coils on a body from a to b (C, 3), with half a width, m, meet other bodies, where these are avoided."""
    few = states.take(slice(None, None, 1 + len(states) // LOOKED_AT))

    def meets(body: str, a: Array, b: Array, wide: float) -> NDArray[np.bool_]:
        if not request.avoids("bodies"):
            return np.zeros(len(a), dtype=bool)
        # Many hooks share a guide, and so the coil behind it.
        places, couple = np.unique(np.hstack([a, b]), axis=0, return_inverse=True)
        bad = np.zeros(len(places), dtype=bool)
        for part in _parts(len(places)):
            line = Line(Point.many(body, places[part, :3]), Point.many(body, places[part, 3:]))
            for _, room in beside(few, line, request.radius):
                bad[part] |= (room < wide).any(axis=-1)
        return bad[couple.ravel()]

    return meets


def _blocked(
    states: States, pair: tuple[str, str], a: Array, b: Array, radius: float | None, gap: float
) -> NDArray[np.bool_]:
    found = []
    for part in _parts(len(a)):
        ends = (Point.many(body, p[part]) for body, p in zip(pair, (a, b), strict=True))
        blocked = np.zeros(len(a[part]), dtype=bool)
        for _, room in rooms(states, Line(*ends), radius):
            blocked |= (room < gap).any(axis=-1)
        found.append(blocked)
    return np.concatenate(found)


def _parts(count: int) -> list[slice]:
    return [slice(start, start + TOGETHER) for start in range(0, count, TOGETHER)]
