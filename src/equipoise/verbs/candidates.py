"""Candidates for one spring, many side by side: sifted in closed form, fitted, judged over all states."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.assemble import Balancer
from equipoise.balancers.laws import Law, Linear, WireMass
from equipoise.balancers.spring import Spring
from equipoise.objective import leading
from equipoise.parameters import candidates, unit_of, write
from equipoise.parts.catalogue import Catalogue
from equipoise.parts.ranking import Line
from equipoise.solve.batch import Fitted, fit
from equipoise.solve.program import Program
from equipoise.solve.shape import Freedom
from equipoise.solve.sift import Sifted, evenly, sift
from equipoise.states import States
from equipoise.tasks import Task
from equipoise.thinning import Few, thin
from equipoise.units import Mass
from equipoise.verbs.judging import KEPT, Best, Judged

GEOMETRIES = 8192
BEGINNINGS = ((3, 0.2), (6, 0.05))
"""(how many, how far apart in shares of the bounds): beginnings from even geometries, and from where scouts ended."""
RANKED = 256
"""Best geometries that are looked at for beginnings."""
SCOUTS, WAYS = 96, 4
"""Rows of the catalogue that go ahead, and from how many beginnings each."""
ALONG, ACROSS = 12, 96
"""States that stand for all, of one joint and of several."""
SOUNDED = 130_000
"""Geometries times states that are sifted, at most GEOMETRIES of them."""
PRICE, SAFE = 3.0, 300.0
"""Of leaving the working range, in loads per share of it: of what may still get back, and of what must keep it."""
NEARLY = 1e-3
"""Excess up to which where a scout came to rest is a beginning."""
PASSES, LATE = 5, 20
"""How often states join where a limit was passed between the few, and the steps of a part that goes on then."""
SWEEPS = 1
MISSED = 0.01
"""Excess of a limit beyond which a part is given up."""
LENT, NEIGHBOURS = 0.08, 0.03
"""A part goes on from where another one came to rest, where that is worse by so much as it stands, and so far away."""
GLANCES = ((5, 4), (3, 6))
"""(how many, steps): after so many steps each, so many of a part's beginnings go on."""

SCORED = 325
"""Candidates that are scored at once."""

Rows = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Work:
    """What all chunks share: the task with a stand-in part, what is free, the catalogue and the states."""

    task: Task
    name: str
    freedoms: tuple[Freedom, ...]
    catalogue: Catalogue
    states: States
    load: float
    seed: int
    parallel: int = 1

    @property
    def spring(self) -> Spring:
        """The spring with the stand-in part."""
        return next(one for one in self.task.balancers if isinstance(one, Spring) and one.name == self.name)

    @property
    def norm(self) -> str:
        """The norm that ranks."""
        return leading(self.task.objective).norm

    @property
    def units(self) -> tuple[str, ...]:
        """SI units of what is free."""
        return tuple(unit_of(self.task.balancers, freedom.name) for freedom in self.freedoms)

    @cached_property
    def chosen(self) -> Few:
        """Which states stand for all."""
        return thin(self.states, ALONG if self.states.driven.shape[1] == 1 else ACROSS)

    @cached_property
    def few(self) -> States:
        """The few states that stand for all."""
        return self.chosen.of(self.states)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper ends of what is free (G,)."""
        return np.array([f.lower for f in self.freedoms]), np.array([f.upper for f in self.freedoms])

    @cached_property
    def even(self) -> Sifted:
        """Geometries that are evenly spread, and what they make of any part."""
        low, high = self.bounds
        count = min(GEOMETRIES, max(512, SOUNDED // len(self.few))) if len(low) else 1
        return self._sifted(low + evenly(count, len(low), self.seed) * (high - low))

    @cached_property
    def scouted(self) -> Sifted:
        """Where some rows of the catalogue, evenly chosen, came to rest: geometries that suit their neighbours too."""
        ends = []
        for form in dict.fromkeys(self.catalogue.form):
            same = np.flatnonzero(np.array(self.catalogue.form) == form)
            rows = same[np.unique(np.linspace(0, len(same) - 1, SCOUTS).astype(int))]
            number = 1.0 + np.arange(len(rows)) % self.parallel
            starts = _best(self.even, self.scores(self.even, rows, number), WAYS, 0.2, self.bounds)
            found = self._descended(rows, number, starts)[1]
            ends.append(found.gamma[found.excess <= NEARLY])
        return self._sifted(np.concatenate(ends) if sum(map(len, ends)) else self.even.gamma[:1])

    def _sifted(self, gamma: Array) -> Sifted:
        """What geometries (S, G) make of any part, but for its numbers."""
        names = [freedom.name for freedom in self.freedoms if not freedom.name.endswith(".law.leader")]
        columns = [i for i, freedom in enumerate(self.freedoms) if freedom.name in names]
        lead = np.delete(gamma, columns, axis=1).sum(axis=1)
        found = []
        for part in np.array_split(np.arange(len(gamma)), max(1, len(gamma) // 256)):
            at = gamma[part][:, columns]
            placed = candidates(self._with(Linear(), 0.0), names, at)
            program = self.task.program(self.few, placed)
            heavy = self.task.program(self.few, candidates(self._with(Linear(0.0, 0.0), 1.0), names, at))
            sag = heavy.terms[0].b - program.terms[0].b
            own = next(one for one in placed if one.name == self.spring.name)
            assert isinstance(own, Spring)
            count = len(at)
            length = np.broadcast_to(np.atleast_2d(own.path.deform(self.few)[0]), (count, len(self.few)))
            names_of = [unknown.name for unknown in program.unknowns]
            columns_of = np.array([names_of.index(f"{self.spring.owner}.{what}") for what in ("preload", "k")])
            sag = np.broadcast_to(sag, (count, *sag.shape[-2:]))
            found.append(sift(program, columns_of, sag, length, gamma[part], lead[part]))
        return Sifted(*(np.concatenate([getattr(one, what) for one in found]) for what in Sifted.__dataclass_fields__))

    def _with(self, law: Law, mass: Mass | WireMass) -> tuple[Balancer, ...]:
        """The balancers with another law and mass in the spring's place, limits on its law left to the descent."""
        return tuple(
            replace(one, law=law, mass=mass) if isinstance(one, Spring) and one.owner == self.spring.owner else one
            for one in self.task.balancers
        )

    def many(self, states: States, rows: Rows, number: Array) -> Callable[[Rows, Array], Program]:
        """(which of the chunk, geometries) -> the program of those parts at those geometries."""
        names = [freedom.name for freedom in self.freedoms]

        def build(which: Rows, gamma: Array) -> Program:
            law = self.catalogue.law(rows[which], number[which])
            values = {name: gamma[:, [index]] for index, name in enumerate(names)}
            return self.task.program(states, write(self._with(law, self.spring.mass), values))

        return build

    def scores(self, sifted: Sifted, rows: Rows, number: Array, price: float = PRICE) -> Array:
        """What each part of a chunk makes of each geometry (K, S), in closed form, at a price of leaving its range."""
        cat = self.catalogue
        rest, travel, rate = cat.free_length[rows], cat.travel[rows], number * cat.rate[rows]
        pressed = np.array([cat.form[row] == "compression" for row in rows])
        low, high = np.where(pressed, rest - travel, rest), np.where(pressed, rest, rest + travel)
        tension = number * cat.initial_tension[rows] - rate * rest
        mass = number * cat.mass[rows]
        coefficients = np.stack([np.ones(len(rows)), mass, tension, rate], axis=1)
        return sifted.scores(coefficients, low, high, travel, self.load, price)

    def promising(self, jobs: Sequence[tuple[int, int]], most: int) -> list[tuple[int, int]]:
        """The jobs whose best geometry scores best."""
        best = []
        for start in range(0, len(jobs), SCORED):
            rows, numbers = zip(*jobs[start : start + SCORED], strict=True)
            chunk = np.array(rows, dtype=np.intp), np.array(numbers, dtype=float)
            found = [self.scores(sifted, *chunk).min(axis=1) for sifted in (self.even, self.scouted)]
            best.append(np.minimum(*found))
        order = np.argsort(np.concatenate(best), kind="stable")[:most]
        return [jobs[i] for i in np.sort(order)]

    def _descended(self, rows: Rows, number: Array, starts: Array) -> tuple[Rows, Fitted]:
        """The last few of each part's beginnings (K, B, G) over the few states, and whose they are."""
        count, ways, _ = starts.shape
        which, gamma = np.repeat(np.arange(count), ways), starts.reshape(count * ways, -1)
        theta = np.zeros((len(gamma), len(self.box[0]) - gamma.shape[1]))
        for kept, steps in GLANCES:
            rough = fit(self.many(self.few, rows[which], number[which]), *self.box, gamma, theta, self.load, steps)
            order = np.lexsort((self._promise(rough, count), which)).reshape(count, -1)[:, :kept].ravel()
            which, gamma, theta = which[order], rough.gamma[order], rough.theta[order]
        return which, fit(self.many(self.few, rows[which], number[which]), *self.box, gamma, theta, self.load)

    def _promise(self, found: Fitted, count: int) -> Array:
        """What ranks the ends of `count` parts, alike many of each: excess at a low price, but first the safest end."""
        beyond = self.load * np.maximum(found.excess - KEPT, 0.0)
        promise = found.value + PRICE * beyond
        safest = (found.value + SAFE * beyond).reshape(count, -1).argmin(axis=1)
        promise.reshape(count, -1)[np.arange(count), safest] = -np.inf
        return promise

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """Bounds (G + P,) of the geometry and of the unknowns that other balancers keep."""
        low, high = self.bounds
        one = np.zeros(1, dtype=np.intp)
        sample = self.many(self.few, one, np.ones(1))(one, low[None])
        return np.concatenate([low, sample.lower]), np.concatenate([high, sample.upper])

    def __call__(self, chunk: tuple[Rows, Array]) -> list[Line]:
        """A chunk's parts, each at the best of its optima, judged over all states."""
        rows, number = chunk
        sources = zip((self.even, self.scouted), BEGINNINGS, strict=True)
        starts = [_best(one, self.scores(one, rows, number), *how, self.bounds) for one, how in sources]
        starts.append(self.even.gamma[self.scores(self.even, rows, number, SAFE).argmin(axis=1)][:, None])
        which, found = self._descended(rows, number, np.concatenate(starts, axis=1))
        best = self._settled(rows, number, which, found)
        for _ in range(SWEEPS):
            which, gamma = self._lent(rows, number, best)
            if not len(which):
                break
            theta = best.theta[which]
            found = fit(self.many(self.few, rows[which], number[which]), *self.box, gamma, theta, self.load)
            best = self._settled(rows, number, which, found).better_of(best)
        parts = zip(rows, number, strict=True)
        return [best.judged.line(k, self.catalogue.part[row], n, best.gamma) for k, (row, n) in enumerate(parts)]

    def _lent(self, rows: Rows, number: Array, best: Best) -> tuple[Rows, Array]:
        """Which parts of a chunk go on from where others came to rest, and the geometries, apart from their own."""
        kept = best.judged.excess <= KEPT
        if not kept.any() or not self.freedoms:
            return np.zeros(0, dtype=np.intp), best.gamma[:0]
        pool = self._sifted(best.gamma[kept])
        scores = self.scores(pool, rows, number)
        span = np.maximum(self.bounds[1] - self.bounds[0], 1e-300)
        away = np.abs((pool.gamma - best.gamma[:, None]) / span).max(axis=2)
        hopeless = best.judged.excess > MISSED
        mine = np.where(kept, best.judged.value * (1 + LENT), np.where(hopeless, -np.inf, np.inf))
        scores = np.where((away > NEIGHBOURS) & (scores < mine[:, None]), scores, np.inf)
        which, there = np.nonzero(np.isfinite(scores) & (scores == scores.min(axis=1, keepdims=True)))
        which, first = np.unique(which, return_index=True)
        return which, pool.gamma[there[first]]

    def _settled(self, rows: Rows, number: Array, which: Rows, found: Fitted) -> Best:
        """Where parts came to rest from any of their beginnings, each part's best; those without one are refused."""
        judged = self._judged(rows[which], number[which], found)
        gamma, theta, few = found.gamma.copy(), found.theta.copy(), self.chosen
        excess = found.excess.copy()
        for _ in range(PASSES):
            # Between the few states a limit was passed: the worst ones join them, and those parts go on from there.
            todo = np.flatnonzero((judged.excess > KEPT) & ((judged.excess > 2 * excess) | (judged.excess < 10 * KEPT)))
            if not len(todo):
                break
            few = few.joined(judged.worst[todo][judged.worst[todo] >= 0])
            again = rows[which[todo]], number[which[todo]]
            found = fit(self.many(few.of(self.states), *again), *self.box, gamma[todo], theta[todo], self.load, LATE)
            gamma[todo], theta[todo], excess[todo] = found.gamma, found.theta, found.excess
            judged = judged.updated(todo, self._judged(*again, found))
        return Best.of(len(rows), which, gamma, theta, judged)

    def _judged(self, rows: Rows, number: Array, found: Fitted) -> Judged:
        """Candidates over all states."""
        return Judged.over(self.many(self.states, rows, number), len(self.states), found.gamma, found.theta)


def _best(sifted: Sifted, scores: Array, count: int, apart: float, bounds: tuple[Array, Array]) -> Array:
    """The best geometries (K, count, G) for each part, scores (K, S), apart from each other where there are such."""
    limit = min(RANKED, scores.shape[1])
    top = np.argpartition(scores, limit - 1, axis=1)[:, :limit]
    order = np.take_along_axis(top, np.argsort(np.take_along_axis(scores, top, 1), axis=1, kind="stable"), 1)
    unit = sifted.gamma / np.maximum(bounds[1] - bounds[0], 1e-300)
    parts, taken = np.arange(len(scores)), np.zeros((len(scores), count), dtype=np.intp)
    distance = np.full(order.shape, np.inf)
    for k in range(1, count):
        step = np.abs(unit[order] - unit[order[parts, taken[:, k - 1]]][:, None]).max(axis=2, initial=0.0)
        distance = np.minimum(distance, step)
        taken[:, k] = (distance > apart).argmax(axis=1)
    return sifted.gamma[order[parts[:, None], taken]]
