"""place: of a design's equal places, the one that stays out of the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from equipoise.affine import Array
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.errors import InfeasibleError, InputError, nearest
from equipoise.placement.equals import plane_of, turned
from equipoise.placement.request import Placing
from equipoise.placement.sweeping import Hit, Limb, Raster, hits, limbs, links, raster
from equipoise.states import States

FEW, MANY = 13, 61
FINALISTS = 12


@dataclass(frozen=True)
class Placed:
    """Where a spring was put: turned by an angle, rad, distances swapped or not; what that takes.

    area is what spring, rods and guides sweep, m^2; lost is how much of the links' own sweep that covers, m^2, and
    share the same as a share of it.
    """

    turn: float
    swapped: bool
    area: float
    lost: float
    share: float

    def json(self) -> dict[str, Any]:
        """The place as design.json holds it."""
        return vars(self).copy()


def place(design: Design, placing: Placing) -> Design:
    """The design with every spring at that of its equal places that keeps out of the zones and loses least workspace.

    Equal are all turns of crank and pivot together, and the swap of their distances where there are two: residual,
    rates and forces are the same to rounding. A zone must not be reached by half a part's width; then the least of
    the links' own sweep decides, then the least area. Raises InfeasibleError naming part, zone, pose and depth where
    no place is free, InputError for a spring that is none.
    """
    springs = {balancer.name: balancer for balancer in design.balancers if isinstance(balancer, Spring)}
    for name in placing.springs:
        if name not in springs:
            hint = nearest(name, list(springs))
            raise InputError(f"there is no spring {name!r} to place", where="placement.springs", hint=hint)
    chosen = placing.springs or tuple(springs)
    few, many = (_taken(design.states, count) for count in (FEW, MANY))
    found: dict[str, tuple[Spring, Placed]] = {}
    for name in chosen:
        found[name] = _placed(springs[name], few, many, placing)
    balancers = tuple(found[b.name][0] if b.name in found else b for b in design.balancers)
    places = {name: entry[1] for name, entry in found.items()}
    return replace(design, balancers=balancers, places=places)


def put(balancers: Sequence[Any], states: States, places: Mapping[str, Placed]) -> tuple[Any, ...]:
    """Balancers at places found before."""
    found = []
    for balancer in balancers:
        known = places.get(balancer.name)
        moved = None if known is None else turned(balancer, states, known.turn, known.swapped)
        found.append(balancer if moved is None else moved)
    return tuple(found)


def _taken(states: States, count: int) -> States:
    return states.take(np.unique(np.linspace(0, len(states) - 1, min(count, len(states))).astype(int)))


def _placed(spring: Spring, few: States, many: States, placing: Placing) -> tuple[Spring, Placed]:
    turns = np.arange(0.0, 2 * np.pi - 1e-9, placing.step)
    tried = [(turn, swapped, turned(spring, many, turn, swapped)) for swapped in (False, True) for turn in turns]
    equal = [(float(turn), swapped, item) for turn, swapped, item in tried if item is not None]
    swept = links(few)
    plane = plane_of(spring, many)
    margin = 0.5 * placing.width
    free, blocked = [], []
    grid = None
    for turn, swapped, item in equal:
        parts = limbs(item, few)
        struck = hits(parts, placing.zones, margin)
        if struck:
            blocked.append((max(hit.depth for hit in struck), turn, swapped, item))
            continue
        grid = grid or _grid(plane, swept, [limbs(other, few) for _, _, other in equal])
        area, lost, _ = _areas(grid, parts, swept, placing)
        rank = (round(lost / max(area, 1e-9), 2), round(area, 4), abs(_folded(turn)), swapped)
        free.append((rank, turn, swapped, item))
    free.sort(key=lambda entry: entry[0])
    whole = links(many)
    for _, turn, swapped, item in free[:FINALISTS]:
        parts = limbs(item, many)
        struck = hits(parts, placing.zones, margin)
        if struck:
            blocked.append((max(hit.depth for hit in struck), turn, swapped, item))
            continue
        assert grid is not None
        area, lost, share = _areas(grid, parts, whole, placing)
        return item, Placed(_folded(turn), swapped, area, lost, share)
    raise _no_room(spring, min(blocked, key=lambda entry: entry[0])[3], many, placing, len(equal))


def _grid(plane: tuple[Array, Array], swept: Limb, others: Sequence[Sequence[Limb]]) -> Raster:
    return raster(plane, [swept, *(part for parts in others for part in parts)])


def _areas(grid: Raster, parts: Sequence[Limb], swept: Limb, placing: Placing) -> tuple[float, float, float]:
    """Area that the parts sweep, how much of the links' sweep that is, and its share."""
    own, other = grid.cover(parts, placing.width), grid.cover([swept], placing.link_width)
    cell = grid.cell**2
    lost = float((own & other).sum()) * cell
    return float(own.sum()) * cell, lost, lost / max(float(other.sum()) * cell, 1e-300)


def _folded(turn: float) -> float:
    """An angle between -pi and pi."""
    return float((turn + np.pi) % (2 * np.pi) - np.pi)


def _no_room(spring: Spring, best: Spring, states: States, placing: Placing, count: int) -> InfeasibleError:
    struck: Hit = max(hits(limbs(best, states), placing.zones, 0.5 * placing.width), key=lambda hit: hit.depth)
    pose = ", ".join(
        f"{joint} = {np.degrees(q):.4g} deg" if unit == "N m" else f"{joint} = {1e3 * q:.4g} mm"
        for joint, q, unit in zip(
            states.mechanism.driven, states.driven[struck.row], states.mechanism.driven_units, strict=True
        )
    )
    where = ", ".join(f"{1e3 * value:.4g}" for value in struck.place)
    others = f"; none of its {count} equal places is free" if count > 1 else "; it has no other equal place"
    return InfeasibleError(
        f"the {struck.part} of {spring.name} reaches {1e3 * struck.depth:.3g} mm into zone {struck.zone} at {pose}, at "
        f"({where}) mm{others}",
        where=f"placement, spring {spring.name}",
        hint="make the zone or the parts smaller, or free the geometry in `shape`",
    )
