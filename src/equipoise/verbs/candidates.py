"""Candidates for one spring, many side by side: sifted in closed form, fitted, judged over all states."""

from __future__ import annotations

from collections.abc import Callable
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
from equipoise.solve.program import Program
from equipoise.solve.shape import Freedom
from equipoise.solve.sift import Sifted, evenly, sift
from equipoise.states import States
from equipoise.tasks import Task
from equipoise.thinning import Few, thin
from equipoise.units import Mass

GEOMETRIES = 8192
ALONG, ACROSS = 12, 96
"""States that stand for all, of one joint and of several."""
SOUNDED = 130_000
"""Geometries times states that are sifted, at most GEOMETRIES of them."""
PRICE, SAFE = 3.0, 300.0
"""Of leaving the working range, in loads per share of it: of what may still get back, and of what must keep it."""


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
        return self.sifted(low + evenly(count, len(low), self.seed) * (high - low))

    def sifted(self, gamma: Array) -> Sifted:
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

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """Bounds (G + P,) of the geometry and of the unknowns that other balancers keep."""
        low, high = self.bounds
        one = np.zeros(1, dtype=np.intp)
        sample = self.many(self.few, one, np.ones(1))(one, low[None])
        return np.concatenate([low, sample.lower]), np.concatenate([high, sample.upper])
