"""Candidates that run straight between two points of two bodies: lengths, columns, filters."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array, Indices
from equipoise.balancers.laws import Law
from equipoise.balancers.paths import Line, Path
from equipoise.balancers.spring import Spring
from equipoise.discovery.kinds.kind import Batch, Kind, Proposal, Scene
from equipoise.discovery.lattice import Spots
from equipoise.limits import Limit
from equipoise.mechanism import Point

CHUNK = 2_000_000
"""Numbers in a chunk of lengths (states x couples)."""
FAINT = 1e-9
"""Relative change of length below which a line does not move."""


@dataclass(frozen=True, eq=False)
class Bilinear:
    """What all lines between two bodies have in common: l^2 and l dl/dq are bilinear in their ends.

        l^2 = |a|^2 + |b|^2 + sum_ij a_i b_j Q_ij,   l dl/dq = sum_ij a_i b_j E_ij,   a = (1, a_x, a_y, a_z)

    Q (N, 16) over the states, E (rows, 16) over the rows that count; points a and b in their bodies' own frames, m.
    """

    square: Array
    pull: Array

    @staticmethod
    def of(scene: Scene, bodies: tuple[str, str]) -> Bilinear:
        """Both forms from their values at the 16 couples of origins and unit points."""
        corners = np.vstack([np.zeros(3), np.eye(3)])
        ends = (np.repeat(corners, 4, axis=0), np.tile(corners, (4, 1)))
        length, rate = _line(bodies, ends).deform(scene.states)
        own = sum((end * end).sum(axis=1) for end in ends)
        basis = np.linalg.inv(np.hstack([np.ones((4, 1)), corners]))

        def form(values: Array) -> Array:
            return np.einsum("nij,ki,lj->nkl", values.T.reshape(-1, 4, 4), basis, basis).reshape(-1, 16)

        square = form(length**2 - np.asarray(own)[:, None])
        return Bilinear(square, form(scene.counted(length[..., None] * rate)))


@dataclass(frozen=True, eq=False)
class Lines:
    """Couples of points on two bodies: places a and b (C, 3) with the least and largest length (C,), m."""

    pair: tuple[Spots, Spots]
    form: Bilinear
    a: Array
    b: Array
    shortest: Array
    longest: Array

    def __len__(self) -> int:
        return len(self.a)

    @staticmethod
    def of(scene: Scene, pair: tuple[Spots, Spots]) -> Lines:
        """Every point of one body with every point of the other, and how their distance varies over the states."""
        form = Bilinear.of(scene, (pair[0].body, pair[1].body))
        count = [len(spots.places) for spots in pair]
        a, b = np.repeat(pair[0].places, count[1], axis=0), np.tile(pair[1].places, (count[0], 1))
        bare = Lines(pair, form, a, b, np.zeros(len(a)), np.zeros(len(a)))
        lengths = [bare.lengths(part) for part in bare.parts()]
        return Lines(
            pair, form, a, b, np.hstack([one.min(axis=0) for one in lengths]),
            np.hstack([one.max(axis=0) for one in lengths]),
        )  # fmt: skip

    def take(self, kept: NDArray[np.bool_] | Indices) -> Self:
        """Some of the couples."""
        return replace(self, a=self.a[kept], b=self.b[kept], shortest=self.shortest[kept], longest=self.longest[kept])

    @property
    def bodies(self) -> tuple[str, str]:
        """Names of the two bodies."""
        return self.pair[0].body, self.pair[1].body

    @property
    def place(self) -> str:
        """The pair in words."""
        return f"{self.bodies[0]} to {self.bodies[1]}"

    def products(self, part: slice = slice(None)) -> Array:
        """a_i b_j (16, C) of the homogeneous places."""
        one, other = (np.hstack([np.ones((len(p), 1)), p]) for p in (self.a[part], self.b[part]))
        return np.einsum("ci,cj->ijc", one, other).reshape(16, -1)

    def lengths(self, part: slice = slice(None)) -> Array:
        """l (N, C) over the states."""
        own = (self.a[part] ** 2).sum(axis=1) + (self.b[part] ** 2).sum(axis=1)
        return np.sqrt(np.maximum(self.form.square @ self.products(part) + own, 0.0))

    def parts(self) -> list[slice]:
        """The couples in chunks that fit into memory."""
        step = max(1, CHUNK // len(self.form.square))
        return [slice(start, start + step) for start in range(0, len(self), step)]

    def at(self, index: int) -> Line:
        """One couple as a line."""
        one, other = self.bodies
        return Line(Point.of(one, self.a[index].tolist()), Point.of(other, self.b[index].tolist()))

    def free(self, name: str) -> dict[str, tuple[float, float]]:
        """Bounds of the coordinates that may move, by parameter."""
        found = {}
        for number, spots in enumerate(self.pair):
            for axis, (low, high) in zip("xyz", spots.box, strict=True):
                if high - low > 1e-12:
                    found[f"{name}.path.line.{number}.{axis}"] = (float(low), float(high))
        return found


def _line(bodies: tuple[str, str], ends: tuple[Array, Array]) -> Line:
    """Couples of points (C, 3) as one line with a candidate axis."""
    numbers = (tuple(np.moveaxis(end[:, :, None], 1, 0)) for end in ends)
    return Line(*(Point(body, end) for body, end in zip(bodies, numbers, strict=True)))


MEETING = 1e-6
"""Share of its longest length below which a line has no direction any more."""


class LineKind(Kind):
    """Springs on straight lines: a law per couple, with one unknown."""

    lines: ClassVar[bool] = True

    def batches(self, scene: Scene) -> list[Batch]:
        """One batch per pair of bodies."""
        found = []
        for pair in scene.pairs:
            lines = Lines.of(scene, pair)
            still = lines.longest - lines.shortest <= FAINT * lines.longest
            met = lines.shortest <= MEETING * lines.longest
            reasons = {"no motion changes its length": still, "its ends meet": met, **self.refuses(lines)}
            lines = lines.take(
                scene.sift(len(lines), {**reasons, **scene.keep(lines.bodies, lines.a, lines.b, self.gap)})
            )
            if len(lines):
                found.append(self.batch(scene, lines))
        return found

    def batch(self, scene: Scene, lines: Lines) -> Batch:
        """Columns f(l) dl/dq of all couples and variants, per unit of their unknown."""
        columns, upper, mass, spot = self.dense(scene, lines, self.laws(lines))

        def propose(index: int, name: str) -> Proposal:
            return replace(self.proposal(lines, index % len(lines), name), mass=float(mass[index]))

        return Batch(lines.place, columns, None, upper, spot, propose)

    def dense(
        self, scene: Scene, lines: Lines, laws: Sequence[Mapping[str, Array]]
    ) -> tuple[Array, Array, Array, NDArray[np.intp]]:
        """All variants: columns (rows, V C), the most of each unknown, the own mass, kg, there, and their spots (V C,).

        Springs that are to be wound weigh as much as the energy they store, so their weight is part of the column.
        """
        found = []
        for law in laws:
            columns, most = self._columns(lines, law)
            mass = self.masses(lines, law, most)
            if mass.any():
                heavy = mass / np.maximum(most, 1e-300)
                for body, places, share in self.weighing(scene, lines):
                    homogeneous = np.vstack([np.ones(len(lines)), places.T])
                    columns += share * (scene.weights(body) @ homogeneous) * heavy
            found.append((columns, most, mass))
        columns, most, mass = (np.concatenate(parts, axis=-1) for parts in zip(*found, strict=True))
        return columns, most, mass, np.tile(np.arange(len(lines)), len(laws))

    def masses(self, lines: Lines, law: Mapping[str, Array], most: Array) -> Array:  # noqa: ARG002 - kinds differ
        """Own mass (C,), kg, at the most of each unknown."""
        return np.zeros(len(lines))

    def weighing(self, scene: Scene, lines: Lines) -> tuple[tuple[str, Array, float], ...]:  # noqa: ARG002
        """Bodies and places (C, 3) that bear shares of the own mass."""
        return tuple((body, places, 0.5) for body, places in zip(lines.bodies, (lines.a, lines.b), strict=True))

    def _columns(self, lines: Lines, law: Mapping[str, Array]) -> tuple[Array, Array]:
        """Columns (rows, C) of massless springs and the most of each unknown (C,) under the force limit."""
        rows, count = len(lines.form.pull), len(lines)
        columns, most = np.empty((rows, count)), np.empty(count)
        blocks = rows // len(lines.form.square)
        for part in lines.parts():
            numbers = {name: np.asarray(value)[part] for name, value in law.items()}
            length = lines.lengths(part)
            force = self.open(numbers).force_basis(length)[0][..., 0]
            ratio = force / np.maximum(length, 1e-300)
            columns[:, part] = (lines.form.pull @ lines.products(part)) * np.repeat(ratio, blocks, axis=0)
            most[part] = self.most / np.maximum(np.abs(force).max(axis=0), 1e-300)
        return columns, self.allowed(lines, law, most)

    def allowed(self, lines: Lines, law: Mapping[str, Array], most: Array) -> Array:  # noqa: ARG002 - kinds differ
        """The most of each unknown (C,), where the force limit alone leaves `most`."""
        return most

    def proposal(self, lines: Lines, index: int, name: str) -> Proposal:
        """The spring on one couple."""
        one = lines.take(np.array([index]))
        free = {**one.free(name), **self.freed(name)}
        return Proposal(Spring(name, self.path(one), self.settled(one)), self.limits(name, one), free)

    def path(self, one: Lines) -> Path:
        """The path of a single couple."""
        return one.at(0)

    @property
    def gap(self) -> float:
        """Half of its width, m: how far its line keeps from bodies where these are avoided."""
        return 0.0

    @property
    @abstractmethod
    def most(self) -> float:
        """The largest force, N."""

    def refuses(self, lines: Lines) -> Mapping[str, NDArray[np.bool_]]:  # noqa: ARG002 - kinds differ
        """Reasons of this kind, each with the couples (C,) it refuses."""
        return {}

    def laws(self, lines: Lines) -> list[Mapping[str, Array]]:  # noqa: ARG002
        """Numbers (C,) that `open` takes, one mapping per variant."""
        return [{}]

    @abstractmethod
    def open(self, numbers: Mapping[str, Array]) -> Law:
        """The law with one unknown at the numbers of a variant."""

    @abstractmethod
    def settled(self, one: Lines) -> Law:
        """The law of a chosen couple, with everything open that the program can find."""

    def freed(self, name: str) -> Mapping[str, tuple[float, float]]:  # noqa: ARG002 - kinds differ
        """Bounds of numbers of the law that may move, by parameter."""
        return {}

    @abstractmethod
    def limits(self, name: str, one: Lines) -> tuple[Limit, ...]:
        """What a chosen spring must keep."""
