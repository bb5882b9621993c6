"""Coil springs that lie along a link and pull by a cable through a guide: zero free length, realised."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.balancers.laws import Coil, Law
from equipoise.balancers.paths import Cable, Pulley
from equipoise.balancers.spring import Spring
from equipoise.discovery.ground import Group
from equipoise.discovery.kinds.kind import Batch, Kind, Proposal, Scene
from equipoise.discovery.kinds.lines import FAINT, LineKind, Lines
from equipoise.discovery.lattice import Spots
from equipoise.errors import InputError
from equipoise.limits import Elongation, Extension, Force, Limit
from equipoise.mechanism import Point
from equipoise.parts.makeable import Makeable
from equipoise.units import Force as Newtons
from equipoise.units import Length, Number

LEAST = 0.02
"""m: the shortest spring worth a thought; also the least share of its extension that keeps it taut."""
STRAIGHT = 1e-6
LEAST_WRAP, MOST_WRAP = 0.1, 2.2
"""rad: what a pulley with a radius is wrapped by at all poses."""
TACKLES = (1.0, 1 / 2, 1 / 3, 1 / 4)
"""Ratios of tackles of one to four falls."""
STRONG = 0.5
"""Share of the rate behind the best tackle that one of fewer falls has to reach."""


@dataclass(frozen=True)
class CableSprings(LineKind):
    """Coils along a link whose cable runs through a guide on that link to a hook on the other body.

        f = k (l - L0),   l = ratio L + offset,   L0 = (room - fittings) / (1 + elongation),   l <= L0 (1 + elongation)

    L is the cable's length from the spring's far end over the guide to the hook, which the offset (the cable's own
    length, cut to measure) makes the spring's length l; with l - L0 = ratio d, d from guide to hook, it acts as a
    spring of zero free length. room, m, is what the link offers from the guide to its end (default: by the link's
    skeleton), rooms {body: room} that of single links, such as a housing on the base; fittings, m, what hooks and
    thimbles take of it; elongation the largest of the spring, a share of L0;
    ratio that of a tackle, 1 / falls where the spring moves less than the cable, or several to choose from: the fewest
    falls with at least half the rate, at zero free length, of the best of them; force in N the most of the spring.
    radius, m, is that of a guide pulley, on planar pairs and where the cable keeps to one side of it; 0 is an eye, or
    a fairlead of small rollers. Each link of a pair is tried as the one that carries the spring. With make, what can be
    wound into the room decides (a `WindableSpring` each) in the place of elongation.
    """

    elongation: Number = 1.0
    ratio: Number | tuple[Number, ...] = TACKLES
    room: Length | None = None
    rooms: Mapping[str, Length] | None = None
    fittings: Length = 0.04
    radius: Length = 0.0
    force: Newtons = 5000.0
    make: Makeable | None = None

    def __post_init__(self) -> None:
        if not self.ratios:
            raise InputError("no ratio is given", where="discover", hint="ratio: 1/2 is that of a tackle of two falls")
        numbers = [("elongation", self.elongation), ("force", self.force), *(("ratio", ratio) for ratio in self.ratios)]
        for name, number in numbers:
            if not number > 0:
                raise InputError(f"{name} is {number:g}, it must be positive", where="discover")
        for name in ("fittings", "radius"):
            if getattr(self, name) < 0:
                raise InputError(f"{name} is {getattr(self, name):g} m, it cannot be negative", where="discover")

    @property
    def words(self) -> str:
        """Coil and cable."""
        return "coil along a link with a cable through a guide"

    @property
    def ratios(self) -> tuple[float, ...]:
        """The tackles to choose from, those of the fewest falls first."""
        given = self.ratio if isinstance(self.ratio, tuple) else (self.ratio,)
        return tuple(sorted(given, reverse=True))

    @property
    def most(self) -> float:
        """The largest force of the spring, N."""
        return self.force

    def made(self, make: Makeable) -> Kind:
        """The same with springs that can be wound."""
        return replace(self, make=make)

    def batches(self, scene: Scene) -> list[Batch]:
        """Two batches per pair: each body carries the spring once."""
        found = []
        for pair in [order for a, b in scene.pairs for order in ((a, b), (b, a))]:
            lines = Lines.of(scene, pair)
            group = scene.ground.group_of(pair[0].body)
            room = self.along(group, lines.a)[0] - self.fittings - self.radius
            ratio, extension = self.tackle(lines, room)
            reasons = {
                "no motion changes its length": lines.longest - lines.shortest <= FAINT * lines.longest,
                "no room for a spring along the link": room < (1 + self.elongation) * LEAST,
                "stroke above what a spring in the link's room can stretch": (
                    ratio * (lines.longest - lines.shortest) > extension
                ),
                "the cable does not keep to one side of the pulley and in its plane": self._winds(
                    scene, pair, lines, group
                ),
            }
            kept = scene.sift(len(lines), {**reasons, **scene.keep(lines.bodies, lines.a, lines.b)})
            if kept.any():
                found.append(self._carried(scene, lines.take(kept), (room[kept], ratio[kept], extension[kept]), group))
        return found

    def tackle(self, lines: Lines, room: Array) -> tuple[Array, Array]:
        """Ratio (C,) of every couple's tackle, and the largest extension (C,), m, of the spring behind it."""
        none = np.zeros(len(lines))
        strokes = [ratio * (lines.longest - lines.shortest) for ratio in self.ratios]
        reach = np.stack([self.extension(room, stroke) for stroke in strokes])
        rates = []
        for ratio, stroke, most in zip(self.ratios, strokes, reach, strict=True):
            law = {"free_length": none, "room": room, "stroke": stroke, "ratio": np.full(len(lines), ratio)}
            fits = ratio * lines.longest <= most
            rates.append(np.where(fits, self.allowed(lines, law, self.force / lines.longest), 0.0))
        strong = np.array(rates) >= STRONG * np.max(rates, axis=0)
        chosen = np.where(np.any(rates, axis=0), strong.argmax(axis=0), len(self.ratios) - 1)
        return np.array(self.ratios)[chosen], reach[chosen, np.arange(len(lines))]

    def extension(self, room: Array, stroke: Array) -> Array:
        """The largest extension (C,), m, of springs in rooms (C,) over strokes (C,)."""
        if self.make is not None:
            return self.make.longest_behind(stroke, room)
        return self.elongation * room / (1 + self.elongation)

    def along(self, group: Group, places: Array) -> tuple[Array, Array]:
        """Room (C,), m, along the link from a guide to the link's farther end, and the way there (C, 3)."""
        given = (self.rooms or {}).get(group.body, self.room)
        pieces = group.skeleton[:, 1] - group.skeleton[:, 0]
        lengths = np.linalg.norm(pieces, axis=1)
        longest = int(lengths.argmax())
        if lengths[longest] < STRAIGHT:
            return np.full(len(places), given or 0.0), np.tile([0.0, 0.0, -1.0], (len(places), 1))
        unit = pieces[longest] / lengths[longest]
        at = np.clip((places - group.skeleton[longest, 0]) @ unit, 0.0, lengths[longest])
        outwards = lengths[longest] - at >= at
        room = np.where(outwards, lengths[longest] - at, at)
        return (
            np.full(len(places), given) if given is not None else room,
            np.where(outwards, 1.0, -1.0)[:, None] * unit,
        )

    def _winds(self, scene: Scene, pair: tuple[Spots, Spots], lines: Lines, group: Group) -> NDArray[np.bool_]:
        """Whether a pulley with a radius is not wrapped on one and the same side at all poses."""
        if not self.radius:
            return np.zeros(len(lines), dtype=bool)
        flat = scene.ground.normal(pair[0].body, pair[1].body)
        if flat is None:
            return np.ones(len(lines), dtype=bool)
        # A pulley does not lead a cable out of its plane: a link that leaves it carries no spring behind one.
        if (np.abs(self.along(group, lines.a)[1] @ flat[0]) > STRAIGHT).any():
            return np.ones(len(lines), dtype=bool)
        wrap = self._wraps(scene, lines, group, flat[0])
        sided = (wrap > LEAST_WRAP).all(axis=0) | (wrap < -LEAST_WRAP).all(axis=0)
        return np.asarray(~sided | (np.abs(wrap) > MOST_WRAP).any(axis=0))

    def _wraps(self, scene: Scene, lines: Lines, group: Group, normal: Array) -> Array:
        """Signed angle (N, C) by which the cable turns at the guide, counter-clockwise about the normal."""
        states, (one, other) = scene.states, lines.bodies
        turn = states.rotation(one)[0]
        ends = [states.point(Point.many(body, p))[0] for body, p in ((one, lines.a), (other, lines.b))]
        onwards = np.einsum("nij,cni->cnj", turn, ends[1] - ends[0])
        inwards = -self.along(group, lines.a)[1][:, None, :]
        sine = (np.cross(inwards, onwards) * normal).sum(-1)
        return np.arctan2(sine, (inwards * onwards).sum(-1)).T

    def _carried(self, scene: Scene, lines: Lines, seats: tuple[Array, Array, Array], group: Group) -> Batch:
        """The batch of couples whose first body carries the spring."""
        room, ratio, extension = seats
        reach, stroke = extension / ratio, ratio * (lines.longest - lines.shortest)
        slack = np.maximum(lines.longest - reach, 0.0)
        tight = np.minimum(lines.shortest, lines.longest - LEAST * reach)
        starts = (slack, tight) if self.make is None else (slack, (slack + tight) / 2, tight)
        laws = [{"free_length": start, "room": room, "stroke": stroke, "ratio": ratio} for start in starts]
        columns, upper, mass, spot = self.dense(scene, lines, laws)
        rooms, way = self.along(group, lines.a)
        flat = scene.ground.normal(*lines.bodies)
        side = np.ones(len(lines))
        if self.radius and flat is not None:
            side = self._wraps(scene, lines, group, flat[0])[0]

        def propose(index: int, name: str) -> Proposal:
            at = index % len(lines)
            start = float(starts[index // len(lines)][at])
            law = self._law(stroke[[at]], room[[at]], ratio[at] * (lines.longest[at] - start))
            seat = (float(rooms[at]), way[at], float(room[at]), start, float(ratio[at]))
            return replace(self._spring(name, lines, at, seat, side[at], flat, law), mass=float(mass[index]))

        place = f"{lines.place}, spring along {lines.bodies[0]}"
        return Batch(place, columns, None, upper, spot, propose)

    def allowed(self, lines: Lines, law: Mapping[str, Array], most: Array) -> Array:
        """Rates (C,), N/m, of the pull over the distance, under the force limit and of what can be wound."""
        ratio = law["ratio"]
        if self.make is None:
            return ratio * most
        extension = ratio * (lines.longest - law["free_length"])
        return np.minimum(ratio * most, ratio**2 * self.make.most_behind(law["stroke"], law["room"], extension)[0])

    def masses(self, lines: Lines, law: Mapping[str, Array], most: Array) -> Array:
        """Own mass (C,), kg, of what can be wound."""
        if self.make is None:
            return super().masses(lines, law, most)
        extension = law["ratio"] * (lines.longest - law["free_length"])
        rate, option = self.make.most_behind(law["stroke"], law["room"], extension)
        return self.make.mass_at(option, rate) * most / np.maximum(law["ratio"] ** 2 * rate, 1e-300)

    def weighing(self, scene: Scene, lines: Lines) -> tuple[tuple[str, Array, float], ...]:
        """The coil lies along its link, from its far end towards the guide."""
        rooms, way = self.along(scene.ground.group_of(lines.bodies[0]), lines.a)
        return ((lines.bodies[0], lines.a + rooms[:, None] * way, 0.5), (lines.bodies[0], lines.a, 0.5))

    def _law(self, stroke: Array, room: Array, extension: float) -> Law:
        """A coil with rate and free length open; of what can be wound the wire that allows most."""
        if self.make is None:
            return Coil(free_length=None)
        option = self.make.most_behind(stroke, room, np.array([extension]))[1]
        return self.make.start(option, float(room[0]))

    def _spring(
        self,
        name: str,
        lines: Lines,
        at: int,
        room: tuple[float, Array, float, float, float],
        side: float,
        flat: tuple[Array, Array, float] | None,
        law: Law,
    ) -> Proposal:
        run, way, inside, start, ratio = room
        free = inside / (1 + self.elongation)
        one, other = lines.bodies
        guide, hook = Point.of(one, lines.a[at].tolist()), Point.of(other, lines.b[at].tolist())
        anchor = Point.of(one, (lines.a[at] + run * way).tolist())
        options: dict[str, Any] = {} if flat is None else {"axis": tuple(flat[0].tolist())}
        pulley = Pulley(one, guide.at, self.radius, "left" if side > 0 else "right", **options)
        # l - L0 = ratio (d - start) for the free length that the room leaves.
        offset = free - ratio * (run + start)
        path = Cable((anchor, pulley, hook), ratio, offset)
        moving: dict[str, tuple[float, float]] = {}
        for number, spots, across in ((1, lines.pair[0], np.abs(way) < STRAIGHT), (2, lines.pair[1], np.full(3, True))):
            for axis, (low, high), may in zip("xyz", spots.box, across, strict=True):
                if may and high - low > 1e-12:
                    word = f"at.{axis}" if number == 1 else axis
                    moving[f"{name}.path.through.{number}.{word}"] = (float(low), float(high))
        force = Force(name, max=self.force)
        if self.make is not None:
            return Proposal(Spring(name, path, law), (force,), {**moving, **self.make.freed(name)})
        stretched = Extension(name, max=self.elongation * free)

        def measured(spring: Spring, values: Mapping[str, float]) -> tuple[Spring, tuple[Limit, ...]]:
            found = spring.parameters(values).get("free_length", free)
            cut = replace(spring.path, offset=spring.path.offset + free - found)  # type: ignore[attr-defined]
            limit = Elongation(name, max=self.elongation, min=0.0)
            return replace(spring, path=cut, law=Coil(free_length=free)), (force, limit)

        limits = (force, stretched, Elongation(name, min=0.0))
        return Proposal(Spring(name, path, law), limits, moving, measured)

    def open(self, numbers: Mapping[str, Array]) -> Law:
        """The pull of the cable over the distance from guide to hook."""
        return Coil(free_length=numbers["free_length"])  # type: ignore[arg-type]

    def settled(self, one: Lines) -> Law:  # noqa: ARG002 - a chosen one is made by `_spring`
        """A coil."""
        return Coil(free_length=None)

    def limits(self, name: str, one: Lines) -> tuple[Limit, ...]:  # noqa: ARG002
        """Force."""
        return (Force(name, max=self.force),)
