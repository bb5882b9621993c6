"""The contest for one number of parts: who stands for it, who wins, and what the others lost by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from equipoise.discovery.alternative import Alternative
from equipoise.discovery.making import wound
from equipoise.discovery.refine import ELASTIC, Parts, Refined, Refiner
from equipoise.discovery.stage import Stage, Tell, untold
from equipoise.errors import EquipoiseError
from equipoise.objective import leading
from equipoise.parts.makeable import Makeable
from equipoise.peaks import STARTS
from equipoise.reporting.numbers import quantity
from equipoise.scattering import Scatter, tolerance
from equipoise.solve.exchange import solve
from equipoise.sweep import Sweep
from equipoise.tasks import Task, certify, finish
from equipoise.tasks.between import between
from equipoise.tasks.task import Balanced
from equipoise.verbs.shape import load_of

EXCESS = 1e-5
"""Relative excess of a limit above which a choice is no design."""
NOTHING = 1e-6
"""Share of the bare value below which nothing is left."""
BRIEFLY = 10_000
"""Specimens by which contenders are judged."""
WOUND = 2
"""Refined choices per number of springs that are wound, where that is asked for, if they are within reach."""
REACH = 0.2
"""Share by which a choice may be worse than the best and still be taken further."""
ALIKE = 0.01
"""Share by which values may differ and still be called alike; the stored energy then decides."""


@dataclass(frozen=True, eq=False)
class Contender:
    """A choice of candidates: where they are, what refinement made of them, and, where they were wound, what before."""

    places: tuple[str, ...]
    refined: Refined
    unwound: Refined | None = None


@dataclass(eq=False)
class Contest:
    """Contenders over the refinement's few poses, judged by the objective's value, or its band, under a scatter."""

    refiner: Refiner
    scatter: Scatter
    sweep: Sweep
    lost: list[Alternative] = field(default_factory=list)
    tell: Tell = untold

    @property
    def banded(self) -> bool:
        """Whether the 95 % value judges."""
        return leading(self.refiner.objective).judged == "band"

    def lose(self, contender: Contender, reason: str) -> None:
        """Tell what a contender reaches over the whole sweep, and why it lost all the same."""
        refined = contender.refined
        try:
            value, excess = self._whole(refined.parts)
        except EquipoiseError as error:
            # A cable that no pulley can lead at some pose of the sweep has no value there.
            value, excess = refined.value, refined.excess
            reason += f"; over all poses {error.message}"
        if excess > EXCESS >= refined.excess:
            reason += f"; over all poses it breaks a limit by {100 * excess:.2g} %"
        self.lost.append(Alternative(len(refined.parts.balancers), contender.places, value, reason))

    def winner(self, tried: Sequence[Contender], make: Makeable | None) -> Contender | None:
        """The best of refined contenders that keep their limits, wound where that is asked for; else nothing."""
        ranked = self._ranked([one for one in map(self._judged, tried) if one is not None])
        if make is None:
            return self._best(ranked)
        near = [one for one in ranked[:WOUND] if one.refined.value <= (1 + REACH) * self._level(ranked)]
        for one in ranked[len(near) :]:
            self.lose(one, f"{self._against(one, ranked[0])}, and so was not wound")
        made = []
        for number, one in enumerate(near, 1):
            self.tell(Stage(len(one.refined.parts.balancers), "winding", number, len(near)))
            made += [wound for wound in [self._wound(one, make)] if wound is not None]
        return self._best(sorted(made, key=lambda one: one.refined.value))

    def _whole(self, parts: Parts) -> tuple[float, float]:
        """The value of parts over the whole sweep where they stand, and the excess of a limit."""
        task = replace(self.refiner.task(parts), sweep=self.sweep)
        found = _elastic(task)
        if self.banded:
            # A band is read at the design's own states, of which the highest lie between the samples.
            higher = between(task, found.states, found.program, found.solution, STARTS)
            found = _elastic(replace(task, sweep=self.sweep.extended(higher))) if len(higher) else found
        design = finish(found, certify(found))
        if self.banded:
            design = replace(design, tolerance=tolerance(design, self.scatter, samples=BRIEFLY))
        return design.judged, found.solution.excess

    def _judged(self, one: Contender) -> Contender | None:
        """The contender with the value that judges it; nothing where it breaks a limit."""
        if one.refined.excess > EXCESS:
            rounded = "" if one.unwound is None else "wound to round sizes "
            self.lose(one, f"{rounded}it breaks a limit by {100 * one.refined.excess:.2g} %")
            return None
        if not self.banded:
            return one
        try:
            return replace(one, refined=self.refiner.banded(one.refined, self.scatter, BRIEFLY))
        except EquipoiseError as error:
            self.lose(one, error.message)
            return None

    def _wound(self, one: Contender, make: Makeable) -> Contender | None:
        """The contender with springs of round sizes; nothing where they cannot be wound."""
        try:
            made = wound(self.refiner, one.refined, make)
        except EquipoiseError as error:
            self.lose(one, error.message)
            return None
        return self._judged(Contender(one.places, made, one.refined))

    def _ranked(self, sound: Sequence[Contender]) -> list[Contender]:
        """Contenders in order: those as good as the best first, by what they store."""
        level = self._level(sound)
        return sorted(sound, key=lambda one: (one.refined.value > level, one.refined.energy))

    def _level(self, sound: Sequence[Contender]) -> float:
        """The value up to which contenders are alike."""
        least = min((one.refined.value for one in sound), default=0.0)
        return max(least * (1 + ALIKE), NOTHING * self.refiner.bare)

    def _best(self, ranked: Sequence[Contender]) -> Contender | None:
        """The first of ranked contenders, to whom the others lose; nothing of none."""
        if not ranked:
            return None
        best, level = ranked[0], self._level(ranked)
        for one in ranked[1:]:
            mine, least = one.refined.energy, best.refined.energy
            if one.refined.value > level:
                self.lose(one, self._against(one, best))
            elif mine > least * (1 + ALIKE):
                self.lose(one, f"as good, but it stores {mine:.3g} J against {least:.3g} J")
            else:
                self.lose(one, "as good: the search came to the same at another place")
        return best

    def _against(self, one: Contender, best: Contender) -> str:
        """What a contender came to over the refinement's poses, beside what won there."""
        unit = leading(self.refiner.objective).unit(self.refiner.mechanism)
        mine, won = (
            quantity(value if value > NOTHING * self.refiner.bare else 0.0, unit, 3)
            for value in (one.refined.value, best.refined.value)
        )
        return f"refined as far as it promised it came to {mine}, the winner to {won}"


def _elastic(task: Task) -> Balanced:
    """A task solved at its geometry, limits exceeded where they cannot be kept."""
    states = task.mechanism.states(task.sweep)
    solution = solve(task.program(states), elastic=ELASTIC * load_of(task, states))
    return Balanced(task, states, solution.program, solution, 0)
