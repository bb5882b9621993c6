"""One design for several cases as it is told: a design each, and the settings that lead from one to the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from equipoise.cases import Adjuster, Settings
from equipoise.certificate import Certificate
from equipoise.design import Design
from equipoise.objective import leading
from equipoise.parameters import write
from equipoise.solve.shape import Optima
from equipoise.tasks.certificate import active_limits, is_exact
from equipoise.tasks.family import Family
from equipoise.tasks.finish import finish
from equipoise.tasks.task import Balanced


@dataclass(frozen=True, eq=False)
class Adjusted:
    """One design that serves several cases: what it is in each, and the settings that lead from one to the next."""

    labels: tuple[str, ...]
    designs: tuple[Design, ...]

    @property
    def adjusters(self) -> tuple[Adjuster, ...]:
        """What is set anew for each case."""
        settings = self.designs[0].settings
        return () if settings is None else settings.adjusters

    @property
    def hardest(self) -> int:
        """Number of the case that loads the mechanism most."""
        return int(np.argmax([max(row.peak for row in design.before.values()) for design in self.designs]))

    def json(self) -> dict[str, Any]:
        """The hardest case's design.json, with the settings and every case's design."""
        cases = [{"case": label} | design.json() for label, design in zip(self.labels, self.designs, strict=True)]
        return self.designs[self.hardest].json() | {"cases": cases}

    def __str__(self) -> str:
        from equipoise.reporting.settings import summary

        return summary(self)


def finished(family: Family, optima: Optima) -> Adjusted:
    """The designs of all cases at the best of all optima, under one certificate."""
    best = optima.best
    parts = family.parted(best)
    names = [f.name for f in (*family.shared, *family.adjusted)]
    bounds = {f.name: (f.lower, f.upper) for f in (*family.shared, *family.adjusted)}
    units = {f.name: f.unit for f in (*family.shared, *family.adjusted)}
    certificate = _certificate(family, optima, parts)
    designs = [
        finish(
            balanced,
            certificate,
            {name: float(v) for name, v in zip(names, best.gamma[family.columns(i)], strict=True)},
            bounds,
            units,
            optima.seed,
        )
        for i, balanced in enumerate(parts)
    ]
    every = (*family.unknowns, *(f.name for f in family.adjusted))
    adjusters = tuple(_adjuster(family, designs, name) for name in every)
    counted = {row for aim in family.tasks[0].objective for row in aim.counted(family.tasks[0].mechanism)}
    peaks = tuple(max(design.after[row].peak for row in counted) for design in designs)
    shown = [replace(design, settings=Settings(i, family.labels, adjusters, peaks)) for i, design in enumerate(designs)]
    return Adjusted(family.labels, tuple(shown))


def _certificate(family: Family, optima: Optima, parts: Sequence[Balanced]) -> Certificate:
    """`exact` where every case is, else `local` over free geometry or `convex`."""
    best, aim = optima.best, leading(family.tasks[0].objective)
    unit = aim.unit(family.tasks[0].mechanism)
    program = best.solution.program
    merits = [local.merit for local in optima.found]
    exact = all(is_exact(part) for part in parts)
    return Certificate(
        kind="exact" if exact else "local" if family.freedoms else "convex",
        primal=program.objective(best.solution.theta),
        dual=min(best.solution.gap.dual, program.objective(best.solution.theta)),
        unit=unit,
        violation=max(0.0, program.violation(best.solution.theta)),
        starts=len(optima.found) if family.freedoms else 0,
        optima=optima.distinct if family.freedoms else 0,
        spread=float(max(merits) - min(merits)),
        stationarity=best.stationarity,
        active=active_limits(program, best.solution, unit),
    )


def _adjuster(family: Family, designs: Sequence[Design], name: str) -> Adjuster:
    """Values of one adjuster, and the work that turning it takes with everything else held."""
    values = tuple({**d.geometry, **d.values}[name] for d in designs)
    if name in family.unknowns:
        return Adjuster(name, designs[0].units[name], values)
    work = tuple(_work(designs[0], design, name) for design in designs)
    return Adjuster(name, designs[0].units[name], values, work)


def _work(first: Design, then: Design, name: str) -> tuple[float, float]:
    """Least and greatest change of the stored energy over the poses, J, as one parameter goes to another case's."""
    from equipoise.assemble import storage

    moved = write(first.balancers, {name: then.geometry[name]})
    energies = []
    for balancers in (first.balancers, moved):
        stored = storage(balancers, first.states)
        theta = np.array([first.values[unknown.name] for unknown in stored.unknowns])
        energies.append((stored.b + stored.A @ theta).sum(axis=-1))
    change = energies[1] - energies[0]
    return float(change.min()), float(change.max())
