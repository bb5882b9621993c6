"""Coil springs that lie along a link and pull by a cable through a guide: zero free length, realised."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.balancers.laws import Coil, Law
from equipoise.balancers.paths import Cable, Pulley, Swivel
from equipoise.balancers.spring import Spring
from equipoise.discovery.kinds.kind import Batch, Kind, Proposal, Scene
from equipoise.discovery.kinds.lines import FAINT, LineKind, Lines
from equipoise.discovery.kinds.seats import (
    GAP,
    LEAST_WRAP,
    MOST_WRAP,
    STRAIGHT,
    Fan,
    Seated,
    Way,
    in_plane,
    outwards,
)
from equipoise.discovery.lattice import Spots
from equipoise.errors import InputError
from equipoise.limits import Elongation, Extension, Force, Limit, Wrap
from equipoise.mechanism import Point
from equipoise.parts.makeable import Makeable
from equipoise.units import Force as Newtons
from equipoise.units import Length, Number

LEAST = 0.02
"""m: the shortest spring worth a thought; also the least share of its extension that keeps it taut."""
TACKLES = (1.0, 1 / 2, 1 / 3, 1 / 4)
"""Ratios of tackles of one to four falls."""
STRONG = 0.8
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
    falls with four fifths of the rate, at zero free length, of the best of them; force in N the most of the spring.
    radius, m, is that of a guide pulley, on planar pairs and where the cable keeps to one side of it, which a limit
    `Wrap` holds; the spring then lies towards either end of its link, a housing in any of four ways in the plane. 0 is
    an eye. guide `swivel` turns the pulley about the run from the spring, so that it follows the hook to any side, out
    of a plane too (a ring of rollers does the same); it only must not be led straight back. Each link of a pair is
    tried as the one that carries the spring. With make, what can be wound into the room decides (a `WindableSpring`
    each) in the place of elongation.
    """

    elongation: Number = 1.0
    ratio: Number | tuple[Number, ...] = TACKLES
    room: Length | None = None
    rooms: Mapping[str, Length] | None = None
    fittings: Length = 0.04
    radius: Length = 0.0
    guide: Literal["pulley", "swivel"] = "pulley"
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
    def astray(self) -> str:
        """Why a pulley cannot lead the cable."""
        if self.guide == "swivel":
            return "the cable would be led back, or its hook meets the pulley"
        return "the cable does not keep to one side of the pulley and in its plane"

    @property
    def most(self) -> float:
        """The largest force of the spring, N."""
        return self.force

    @property
    def ratios(self) -> tuple[float, ...]:
        """The tackles to choose from, those of the fewest falls first."""
        given = self.ratio if isinstance(self.ratio, tuple) else (self.ratio,)
        return tuple(sorted(given, reverse=True))

    def made(self, make: Makeable) -> Kind:
        """The same with springs that can be wound."""
        return replace(self, make=make)

    def batches(self, scene: Scene) -> list[Batch]:
        """Two batches per pair: each body carries the spring once."""
        found = []
        for pair in [order for a, b in scene.pairs for order in ((a, b), (b, a))]:
            lines = Lines.of(scene, pair)
            keep = scene.keep(lines.bodies, lines.a, lines.b)
            choices = []
            for way, side in self._seats(scene, pair, lines):
                room = self.inside(way[0])
                ratio, extension = self.tackle(lines, room)
                reasons = {
                    "no motion changes its length": lines.longest - lines.shortest <= FAINT * lines.longest,
                    "no room for a spring along the link": room < (1 + self.elongation) * LEAST,
                    "stroke above what a spring in the link's room can stretch": (
                        ratio * (lines.longest - lines.shortest) > extension
                    ),
                    self.astray: side == 0,
                    "another body in the way of its coil": self._meets(scene, lines, way),
                }
                kept = scene.sift(len(lines), {**reasons, **keep})
                choices.append((np.flatnonzero(kept), way, side, ratio))
            if any(len(kept) for kept, *_ in choices):
                found.append(self._carried(scene, Seated.seated(lines, choices)))
        return found

    @property
    def slim(self) -> float:
        """Half the width, m, that a coil has at least where it lies; what its bundle needs the limit `avoid` knows."""
        return 0.0 if self.make is None else self.make.width / 2

    def _meets(self, scene: Scene, lines: Lines, way: Way) -> NDArray[np.bool_]:
        """Whether coils (C,) from guides along ways meet another body, where bodies are avoided."""
        return scene.meets(lines.bodies[0], lines.a, lines.a + way[0][:, None] * way[1], self.slim)

    def inside(self, room: Any) -> Any:
        """What a spring has, m, of rooms (C,) or one."""
        return room - self.fittings - self.radius

    def extension(self, room: Array, stroke: Array) -> Array:
        """The largest extension (C,), m, of springs in rooms (C,) over strokes (C,)."""
        if self.make is not None:
            return self.make.longest_behind(stroke, room)
        return self.elongation * room / (1 + self.elongation)

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

    def _seats(self, scene: Scene, pair: tuple[Spots, Spots], lines: Lines) -> list[tuple[Way, Array]]:
        """Ways of the coils of all couples, each with the side (C,) of the pulley on which the cable runs, 0 for none.

        A pulley does not lead a cable out of its plane: a link that leaves it carries no spring behind one. A swivel
        does.
        """
        group = scene.ground.group_of(pair[0].body)
        housing = (self.rooms or {}).get(group.body)
        given = self.room if housing is None else housing
        straight = outwards(group, lines.a, given)
        if housing is not None:
            # A housing stands as well beyond the end of its link as along it: where it is in the way, beyond.
            straight = straight[0], np.where(self._meets(scene, lines, straight)[:, None], -straight[1], straight[1])
        if not self.radius:
            return [(straight, np.ones(len(lines)))]
        flat = scene.ground.normal(*lines.bodies)
        ways = [] if flat is None else in_plane(group, lines.a, given, housing is not None, flat[0])
        fan = Fan.of(scene, pair)
        if self.guide == "swivel":
            # The cable leaves in the plane of guide and hook where the coil stands square to it.
            square = flat is None or (np.abs(straight[1] @ flat[0]) > STRAIGHT).any()
            ways = [*([straight] if square else []), *ways]
            return [(way, fan.follows(way, self.radius)) for way in ways]
        if flat is None or not ways:
            return [(straight, np.zeros(len(lines)))]
        return [(way, fan.sides(way, self.radius, flat[0])) for way in ways]

    def _carried(self, scene: Scene, lines: Seated) -> Batch:
        """The batch of couples whose first body carries the spring."""
        room, ratio, stroke = self.inside(lines.room), lines.ratio, lines.ratio * (lines.longest - lines.shortest)
        reach = self.extension(room, stroke) / ratio
        slack = np.maximum(lines.longest - reach, 0.0)
        tight = np.minimum(lines.shortest, lines.longest - LEAST * reach)
        starts = (slack, tight) if self.make is None else (slack, (slack + tight) / 2, tight)
        laws = [{"free_length": start, "room": room, "stroke": stroke, "ratio": ratio} for start in starts]
        columns, upper, mass, spot = self.dense(scene, lines, laws)
        flat = scene.ground.normal(*lines.bodies)

        def propose(index: int, name: str) -> Proposal:
            at = index % len(lines)
            start = float(starts[index // len(lines)][at])
            one = lines.take(np.array([at]))
            return replace(self._spring(name, one, start, flat), mass=float(mass[index]))

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

    def weighing(self, scene: Scene, lines: Lines) -> tuple[tuple[str, Array, float], ...]:  # noqa: ARG002
        """The coil lies along its link, from its far end towards the guide."""
        assert isinstance(lines, Seated)
        far = lines.a + lines.room[:, None] * lines.way
        return ((lines.bodies[0], far, 0.5), (lines.bodies[0], lines.a, 0.5))

    def _law(self, one: Seated, start: float) -> Law:
        """A coil with rate and free length open; of what can be wound the wire that allows most."""
        if self.make is None:
            return Coil(free_length=None)
        room, stroke = self.inside(one.room), one.ratio * (one.longest - one.shortest)
        option = self.make.most_behind(stroke, room, one.ratio * (one.longest - start))[1]
        return self.make.start(option, float(room[0]))

    def _spring(self, name: str, one: Seated, start: float, flat: tuple[Array, Array, float] | None) -> Proposal:
        """A single couple as a spring behind a cable that has length `start`, m, to spare."""
        run, way, ratio = float(one.room[0]), one.way[0], float(one.ratio[0])
        free = self.inside(run) / (1 + self.elongation)
        carrier, other = one.bodies
        # A swivel off the plane by its radius lets the cable leave in the plane, square to the coil.
        off = self.radius if self.guide == "swivel" and flat is not None and abs(way @ flat[0]) > STRAIGHT else 0.0
        guide, hook = Point.of(carrier, (one.a[0] + off * way).tolist()), Point.of(other, one.b[0].tolist())
        anchor = Point.of(carrier, (one.a[0] + run * way).tolist())
        limits: tuple[Limit, ...] = (Force(name, max=self.force),)
        pulley = self._pulley(guide, float(one.side[0]), flat)
        if self.radius:
            least = None if self.guide == "swivel" else LEAST_WRAP
            limits += (Wrap(name, least, MOST_WRAP, GAP * self.radius),)
        # l - L0 = ratio (d - start) for the free length that the room leaves.
        path = Cable((anchor, pulley, hook), ratio, free - ratio * (run + start))
        moving: dict[str, tuple[float, float]] = {}
        for number, spots, across in ((1, one.pair[0], np.abs(way) < STRAIGHT), (2, one.pair[1], np.full(3, True))):
            for axis, (low, high), may in zip("xyz", spots.box, across, strict=True):
                if may and high - low > 1e-12:
                    word = f"at.{axis}" if number == 1 else axis
                    moving[f"{name}.path.through.{number}.{word}"] = (float(low), float(high))
        law = self._law(one, start)
        if self.make is not None:
            return Proposal(Spring(name, path, law), limits, {**moving, **self.make.freed(name)})
        stretched = Extension(name, max=self.elongation * free)

        def measured(spring: Spring, values: Mapping[str, float]) -> tuple[Spring, tuple[Limit, ...]]:
            found = spring.parameters(values).get("free_length", free)
            cut = replace(spring.path, offset=spring.path.offset + free - found)  # type: ignore[attr-defined]
            limit = Elongation(name, max=self.elongation, min=0.0)
            return replace(spring, path=cut, law=Coil(free_length=free)), (*limits, limit)

        return Proposal(Spring(name, path, law), (*limits, stretched, Elongation(name, min=0.0)), moving, measured)

    def _pulley(self, guide: Point, side: float, flat: tuple[Array, Array, float] | None) -> Pulley | Swivel:
        """What leads the cable at a guide."""
        if self.radius and self.guide == "swivel":
            return Swivel(guide.body, guide.at, self.radius)
        options: dict[str, Any] = {} if flat is None else {"axis": tuple(flat[0].tolist())}
        if self.radius:
            options["nominal"] = (LEAST_WRAP + MOST_WRAP) / 2
        return Pulley(guide.body, guide.at, self.radius, "left" if side > 0 else "right", **options)

    def open(self, numbers: Mapping[str, Array]) -> Law:
        """The pull of the cable over the distance from guide to hook."""
        return Coil(free_length=numbers["free_length"])  # type: ignore[arg-type]

    def settled(self, one: Lines) -> Law:  # noqa: ARG002 - a chosen one is made by `_spring`
        """A coil."""
        return Coil(free_length=None)

    def limits(self, name: str, one: Lines) -> tuple[Limit, ...]:  # noqa: ARG002
        """Force."""
        return (Force(name, max=self.force),)
