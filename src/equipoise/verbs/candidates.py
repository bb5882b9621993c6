"""Candidates for one spring, many side by side: sifted in closed form, fitted, judged over all states."""

from __future__ import annotations

import re
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
from equipoise.solve.batch import fit
from equipoise.solve.program import Program, norm_value
from equipoise.solve.shape import Freedom
from equipoise.solve.sift import Sifted, evenly, sift
from equipoise.states import States
from equipoise.tasks import Task
from equipoise.thinning import Few, thin
from equipoise.units import Mass

GEOMETRIES = 8192
BEGINNINGS = 4
RANKED, APART = 256, 0.2
"""Best geometries that are looked at for beginnings, and how far apart those lie, in shares of the bounds."""
ALONG, ACROSS = 12, 96
"""States that stand for all, of one joint and of several."""
SOUNDED = 130_000
"""Geometries times states that are sifted, at most GEOMETRIES of them."""
PRICE = 30.0
KEPT = 1e-6
"""Relative excess of a limit over all states up to which it is kept."""
PASSES = 3
GLANCES = ((2, 4), (1, 8))
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

    @cached_property
    def geometries(self) -> Array:
        """Geometries (S, G) to start from."""
        if not self.freedoms:
            return np.zeros((1, 0))
        low = np.array([freedom.lower for freedom in self.freedoms])
        high = np.array([freedom.upper for freedom in self.freedoms])
        count = min(GEOMETRIES, max(512, SOUNDED // len(self.few)))
        return low + evenly(count, len(low), self.seed) * (high - low)

    @cached_property
    def sifted(self) -> Sifted:
        """What the geometries make of any part, but for its numbers."""
        names = [freedom.name for freedom in self.freedoms if not freedom.name.endswith(".law.leader")]
        columns = [i for i, freedom in enumerate(self.freedoms) if freedom.name in names]
        found = []
        for gamma in np.array_split(self.geometries[:, columns], max(1, len(self.geometries) // 256)):
            placed = candidates(self._with(Linear(), 0.0), names, gamma)
            program = self.task.program(self.few, placed)
            heavy = self.task.program(self.few, candidates(self._with(Linear(0.0, 0.0), 1.0), names, gamma))
            sag = heavy.terms[0].b - program.terms[0].b
            own = next(one for one in placed if one.name == self.spring.name)
            assert isinstance(own, Spring)
            count = len(gamma)
            length = np.broadcast_to(np.atleast_2d(own.path.deform(self.few)[0]), (count, len(self.few)))
            names_of = [unknown.name for unknown in program.unknowns]
            part = np.array([names_of.index(f"{self.spring.owner}.{what}") for what in ("preload", "k")])
            found.append(sift(program, part, np.broadcast_to(sag, (count, *sag.shape[-2:])), length))
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

    def scores(self, rows: Rows, number: Array) -> Array:
        """What each part of a chunk makes of each geometry (K, S), in closed form."""
        cat = self.catalogue
        leader = next((i for i, f in enumerate(self.freedoms) if f.name.endswith(".law.leader")), None)
        lead = 0.0 if leader is None else self.freedoms[leader].lower
        rest, travel, rate = cat.free_length[rows] + lead, cat.travel[rows], number * cat.rate[rows]
        pressed = np.array([cat.form[row] == "compression" for row in rows])
        low, high = np.where(pressed, rest - travel, rest), np.where(pressed, rest, rest + travel)
        tension = number * cat.initial_tension[rows] - rate * rest
        mass = number * cat.mass[rows]
        coefficients = np.stack([np.ones(len(rows)), mass, tension, rate], axis=1)
        return self.sifted.scores(coefficients, low, high, travel, self.load, PRICE)

    def promising(self, jobs: Sequence[tuple[int, int]], most: int) -> list[tuple[int, int]]:
        """The jobs whose best geometry scores best."""
        best = []
        for start in range(0, len(jobs), SCORED):
            rows, numbers = zip(*jobs[start : start + SCORED], strict=True)
            best.append(self.scores(np.array(rows, dtype=np.intp), np.array(numbers, dtype=float)).min(axis=1))
        order = np.argsort(np.concatenate(best), kind="stable")[:most]
        return [jobs[i] for i in np.sort(order)]

    def beginnings(self, rows: Rows, number: Array) -> Array:
        """The best geometries (K, B, G) for each part of a chunk, apart from each other."""
        scores = self.scores(rows, number)
        top = np.argpartition(scores, min(RANKED, scores.shape[1] - 1), axis=1)[:, :RANKED]
        order = np.take_along_axis(top, np.argsort(np.take_along_axis(scores, top, 1), axis=1, kind="stable"), 1)
        span = np.array([max(f.upper - f.lower, 1e-300) for f in self.freedoms])
        chosen = np.empty((len(rows), BEGINNINGS), dtype=int)
        for k, ranked in enumerate(order):
            unit = self.geometries[ranked] / span
            taken = [0]
            distance = np.abs(unit - unit[0]).max(axis=1, initial=0.0)
            for _ in range(1, BEGINNINGS):
                taken.append(int((distance > APART).argmax()))
                distance = np.minimum(distance, np.abs(unit - unit[taken[-1]]).max(axis=1, initial=0.0))
            chosen[k] = ranked[taken]
        return self.geometries[chosen]

    def lines(self, rows: Rows, number: Array) -> list[Line]:
        """A chunk's parts, each at the better of its optima, judged over all states."""
        lower = np.array([freedom.lower for freedom in self.freedoms])
        upper = np.array([freedom.upper for freedom in self.freedoms])
        starts = self.beginnings(rows, number)
        count, ways = starts.shape[:2]
        which, few, states = np.repeat(np.arange(count), ways), self.chosen, self.few
        gamma = starts.reshape(count * ways, -1)
        sample = self.many(states, rows[:1], number[:1])(np.zeros(1, dtype=np.intp), gamma[:1])
        theta = np.zeros((len(gamma), len(sample.unknowns)))
        box = np.concatenate([lower, sample.lower]), np.concatenate([upper, sample.upper])
        for kept, steps in GLANCES:
            rough = fit(self.many(states, rows[which], number[which]), *box, gamma, theta, self.load, steps)
            promise = rough.value + PRICE * self.load * rough.excess
            order = np.lexsort((promise, which)).reshape(count, -1)[:, :kept].ravel()
            which, gamma, theta = which[order], rough.gamma[order], rough.theta[order]
        todo = np.arange(count)
        final, unknowns = np.zeros((count, len(lower))), np.zeros((count, theta.shape[1]))
        judged: Judged | None = None
        for _ in range(PASSES):
            found = fit(self.many(states, rows[which], number[which]), *box, gamma, theta, self.load)
            final[todo], unknowns[todo] = found.gamma, found.theta
            fresh = Judged.over(self, rows[todo], number[todo], final[todo], unknowns[todo])
            judged = fresh if judged is None else judged.updated(todo, fresh)
            # Between the few states a limit was passed: the worst ones join them, and those parts go on from there.
            passed = (fresh.excess > KEPT) & (found.excess <= KEPT)
            todo = todo[passed]
            if not len(todo):
                break
            few = few.joined(fresh.worst[passed][fresh.worst[passed] >= 0])
            which, gamma, theta, states = todo, final[todo], unknowns[todo], few.of(self.states)
        assert judged is not None
        return judged.lines(self, rows, number, final)


@dataclass(frozen=True, eq=False)
class Judged:
    """A chunk over all states: the norms (K, 3), the objective (K,), and the worst limit with its state."""

    norms: Array
    value: Array
    excess: Array
    limit: tuple[str, ...]
    worst: Rows

    @classmethod
    def over(cls, work: Work, rows: Rows, number: Array, gamma: Array, theta: Array) -> Judged:
        """Judge a chunk, a few parts at a time so that arrays stay small."""
        norms, value, excess, limit, worst = [], [], [], [], []
        size = max(1, 60_000 // len(work.states))
        for start in range(0, len(rows), size):
            part = slice(start, start + size)
            build = work.many(work.states, rows[part], number[part])
            program = build(np.arange(len(rows[part])), gamma[part])
            for k in range(len(rows[part])):
                one = program.take(k)
                terms = [term for term in one.terms if term.cap is None]
                at = theta[start + k]
                sizes = [term.magnitudes(term.residual(at)) for term in terms]
                norms.append([norm_value(n, sizes[0], terms[0].weight) for n in ("peak", "rms", "mean")])
                value.append(one.objective(at))
                gaps = [(row.excess(at).max() / row.scale, row.limit, row) for row in one.rows if row.h.size]
                gap, words, row = max(gaps, key=lambda entry: entry[0], default=(0.0, "", None))
                excess.append(max(gap, 0.0))
                limit.append(words)
                state = -1 if row is None or row.state is None else row.state[int(row.excess(at).argmax())]
                worst.append(state)
        return cls(np.array(norms), np.array(value), np.array(excess), tuple(limit), np.array(worst, dtype=np.intp))

    def updated(self, at: Rows, other: Judged) -> Judged:
        """These parts with some judged anew."""
        norms, value, excess, worst = self.norms.copy(), self.value.copy(), self.excess.copy(), self.worst.copy()
        norms[at], value[at], excess[at], worst[at] = other.norms, other.value, other.excess, other.worst
        limit = list(self.limit)
        for place, words in zip(at, other.limit, strict=True):
            limit[place] = words
        return Judged(norms, value, excess, tuple(limit), worst)

    def lines(self, work: Work, rows: Rows, number: Array, gamma: Array) -> list[Line]:
        """One line per part."""
        cat = work.catalogue
        return [
            Line(
                part=cat.part[row],
                number=int(number[k]),
                value=float(self.value[k]),
                peak=float(self.norms[k, 0]),
                rms=float(self.norms[k, 1]),
                mean=float(self.norms[k, 2]),
                geometry=tuple(float(v) for v in gamma[k]),
                refused=_reason(self.limit[k], cat.part[row]) if self.excess[k] > KEPT else "",
                excess=float(self.excess[k]),
            )
            for k, row in enumerate(rows)
        ]


def _reason(limit: str, part: str) -> str:
    """A limit in words that do not name the part's own numbers, so that reasons can be counted."""
    return re.split(r" \(| <= | >= ", limit, maxsplit=1)[0].replace(part, "").strip()
