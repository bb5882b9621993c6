"""How parts of a catalogue find their geometries: from many beginnings side by side, and from where scouts ended."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.parts.ranking import Line
from equipoise.solve.batch import STEPS, Fitted, fit
from equipoise.solve.sift import Sifted
from equipoise.states import States
from equipoise.verbs.candidates import PRICE, SAFE, Work
from equipoise.verbs.judging import KEPT, Best, Judged
from equipoise.verbs.pressing import pressed, weighted

BEGINNINGS = ((3, 0.2), (6, 0.05))
"""(how many, how far apart in shares of the bounds): beginnings from even geometries, and from where scouts ended."""
RANKED = 256
"""Best geometries that are looked at for beginnings."""
SCOUTS, WAYS = 96, 4
"""Rows of the catalogue that go ahead, and from how many beginnings each."""
NEARLY = 1e-3
"""Excess up to which where a scout came to rest is a beginning."""
PASSES, LATE = 5, 20
"""How often states join where a limit was passed between the few, and the steps of a part that goes on then."""
ROUNDS, SHARP = 8, 4
"""How often weights follow the residuals where the objective is no rms, and the steps between."""
MISSED = 0.01
"""Excess of a limit beyond which a part is given up."""
GLANCES = ((5, 4), (2, 6))
"""(how many, steps): after so many steps each, so many of a part's beginnings go on."""
SCORED = 325
"""Candidates that are scored at once."""

Rows = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Search:
    """A chunk of parts -> their lines; what a chunk finds follows from the work and from itself alone."""

    work: Work

    @cached_property
    def scouted(self) -> Sifted:
        """Where some rows of the catalogue, evenly chosen, came to rest: geometries that suit their neighbours too."""
        ends = []
        for form in dict.fromkeys(self.work.catalogue.form):
            same = np.flatnonzero(np.array(self.work.catalogue.form) == form)
            rows = same[np.unique(np.linspace(0, len(same) - 1, SCOUTS).astype(int))]
            number = np.asarray(1 + np.arange(len(rows)) % self.work.parallel, dtype=float)
            starts = _best(self.work.even, self.work.scores(self.work.even, rows, number), WAYS, 0.2, self.work.bounds)
            found = self._descended(rows, number, starts)[1]
            ends.append(found.gamma[found.excess <= NEARLY])
        return self.work.sifted(np.concatenate(ends) if sum(map(len, ends)) else self.work.even.gamma[:1])

    def scout(self) -> None:
        """Send the scouts ahead: what they find goes with the search wherever it is sent."""
        _ = self.scouted

    def promising(self, jobs: Sequence[tuple[int, int]], most: int) -> list[tuple[int, int]]:
        """The jobs whose best geometry scores best."""
        best = []
        for start in range(0, len(jobs), SCORED):
            rows, numbers = zip(*jobs[start : start + SCORED], strict=True)
            chunk = np.array(rows, dtype=np.intp), np.array(numbers, dtype=float)
            found = [self.work.scores(sifted, *chunk).min(axis=1) for sifted in (self.work.even, self.scouted)]
            best.append(np.minimum(*found))
        order = np.argsort(np.concatenate(best), kind="stable")[:most]
        return [jobs[i] for i in np.sort(order)]

    def __call__(self, chunk: tuple[Rows, Array]) -> list[Line]:
        """A chunk's parts, each at the best of its optima, judged over all states."""
        rows, number = chunk
        even, sources = self.work.even, zip((self.work.even, self.scouted), BEGINNINGS, strict=True)
        starts = [_best(one, self.work.scores(one, rows, number), *how, self.work.bounds) for one, how in sources]
        safe = even.gamma[self.work.scores(even, rows, number, SAFE).argmin(axis=1)]
        which, found = self._descended(rows, number, np.concatenate([*starts, safe[:, None]], axis=1))
        best = self._sharpened(rows, number, self._settled(rows, number, which, found))
        parts = zip(rows, number, strict=True)
        return [best.judged.line(k, self.work.catalogue.part[row], n, best.gamma) for k, (row, n) in enumerate(parts)]

    def _descended(self, rows: Rows, number: Array, starts: Array) -> tuple[Rows, Fitted]:
        """The last few of each part's beginnings (K, B, G) over the few states, and whose they are."""
        count, ways, _ = starts.shape
        which, gamma = np.repeat(np.arange(count), ways), starts.reshape(count * ways, -1)
        theta = np.zeros((len(gamma), len(self.work.box[0]) - gamma.shape[1]))
        rough = Fitted(gamma, theta, np.zeros(len(gamma)), np.zeros(len(gamma)))
        for kept, steps in GLANCES:
            rough = self._fit(self.work.few, rows[which], number[which], rough.gamma, rough.theta, steps)
            order = np.lexsort((self._promise(rough, count), which)).reshape(count, -1)[:, :kept].ravel()
            which, rough = which[order], rough.take(order)
        # What passes a limit by far after so many steps will not keep it.
        todo = np.flatnonzero(rough.excess <= MISSED)
        if not len(todo):
            return which, rough
        further = rough.take(todo)
        found = self._fit(self.work.few, rows[which[todo]], number[which[todo]], further.gamma, further.theta)
        return which, rough.updated(todo, found)

    def _fit(self, states: States, rows: Rows, number: Array, gamma: Array, theta: Array, steps: int = STEPS) -> Fitted:
        """Where these parts come to rest over these states."""
        return fit(self.work.many(states, rows, number), *self.work.box, gamma, theta, self.work.load, steps)

    def _promise(self, found: Fitted, count: int) -> Array:
        """What ranks the ends of `count` parts, alike many of each: excess at a low price, but first the safest end."""
        beyond = self.work.load * np.maximum(found.excess - KEPT, 0.0)
        promise = found.value + PRICE * beyond
        safest = (found.value + SAFE * beyond).reshape(count, -1).argmin(axis=1)
        promise.reshape(count, -1)[np.arange(count), safest] = -np.inf
        return promise

    def _settled(self, rows: Rows, number: Array, which: Rows, found: Fitted) -> Best:
        """Where parts came to rest from any of their beginnings, each part's best; those without one are refused."""
        judged = self._judged(rows[which], number[which], found)
        gamma, theta, few = found.gamma.copy(), found.theta.copy(), self.work.chosen
        excess = found.excess.copy()
        for _ in range(PASSES):
            # Between the few states a limit was passed: the worst ones join them, and those parts go on from there.
            todo = np.flatnonzero((judged.excess > KEPT) & ((judged.excess > 2 * excess) | (judged.excess < 10 * KEPT)))
            if not len(todo):
                break
            few = few.joined(judged.worst[todo][judged.worst[todo] >= 0])
            again = rows[which[todo]], number[which[todo]]
            found = self._fit(few.of(self.work.states), *again, gamma[todo], theta[todo], LATE)
            gamma[todo], theta[todo], excess[todo] = found.gamma, found.theta, found.excess
            judged = judged.updated(todo, self._judged(*again, found))
        return Best.of(len(rows), which, gamma, theta, judged)

    def _sharpened(self, rows: Rows, number: Array, best: Best) -> Best:
        """The parts by the objective's own norm: rounds of least squares whose weights follow the residuals.

        For the peak, weights grow with the residuals (Lawson, unsourced); for the mean they fall with them.
        """
        if all(aim.norm == "rms" for aim in self.work.task.objective if aim.cap is None):
            return best
        which, few, gamma, theta = np.arange(len(rows)), self.work.chosen, best.gamma, best.theta
        pressure = None
        for _ in range(ROUNDS):
            many = self.work.many(few.of(self.work.states), rows, number)
            pressure = pressed(many(which, gamma), theta, pressure)
            found = fit(partial(weighted, many, pressure), *self.work.box, gamma, theta, self.work.load, SHARP)
            gamma, theta = found.gamma, found.theta
            judged = self._judged(rows, number, found)
            best = Best(gamma, theta, judged).better_of(best)
            passed = judged.worst[(judged.excess > KEPT) & (found.excess <= KEPT)]
            few = few.joined(passed[passed >= 0])
        return best

    def _judged(self, rows: Rows, number: Array, found: Fitted) -> Judged:
        """Candidates over all states."""
        states = self.work.states
        return Judged.over(self.work.many(states, rows, number), len(states), found.gamma, found.theta)


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
