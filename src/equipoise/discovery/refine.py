"""From chosen candidates to designs: subsets judged by the objective's own norm, then shaped."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from equipoise.affine import Array, Geometry, Unknown
from equipoise.assemble import Balancer, effort, storage
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.discovery.collect import Collection
from equipoise.discovery.kinds import Proposal
from equipoise.discovery.reach import with_extremes
from equipoise.discovery.subsets import Subset
from equipoise.limits import Limit
from equipoise.mechanism import Mechanism
from equipoise.objective import Aim
from equipoise.parameters import candidates, read, unit_of, write
from equipoise.scattering import Scatter, tolerance
from equipoise.solve.exchange import Solution, solve
from equipoise.solve.program import Norm, Program, Term
from equipoise.solve.ratios import descend_by_ratios
from equipoise.solve.shape import Freedom
from equipoise.sweep import Sweep
from equipoise.tasks import Task, task_of
from equipoise.verbs.balance import balance
from equipoise.verbs.shape import descended, load_of

ITERATIONS = 40
PRECISION = 1e-5
ELASTIC = 30.0
"""What a limit that is not kept costs, per unit of relative excess, in units of the load."""
DETOUR = 1e-3
"""Share of the bare value by which a design may get worse on its way to less stored energy."""


@dataclass(frozen=True, eq=False)
class Parts:
    """Balancers with the limits they must keep and the geometry {parameter: (low, high)} that may move."""

    balancers: tuple[Balancer, ...]
    limits: tuple[Limit, ...]
    free: Mapping[str, tuple[float, float]]
    proposals: tuple[Proposal, ...] = ()

    @staticmethod
    def of(proposals: Sequence[Proposal]) -> Parts:
        """Several proposals together."""
        free = {name: bounds for proposal in proposals for name, bounds in proposal.free.items()}
        limits = tuple(limit for proposal in proposals for limit in proposal.limits)
        return Parts(tuple(proposal.balancer for proposal in proposals), limits, free, tuple(proposals))

    def at(self, values: Mapping[str, float]) -> Parts:
        """The same parts at another geometry."""
        return replace(self, balancers=write(self.balancers, values))

    def with_one(self, proposal: Proposal) -> Parts:
        """The parts and one more, where they stand."""
        one = Parts.of([proposal])
        free = {**self.free, **one.free}
        balancers, limits = (*self.balancers, *one.balancers), (*self.limits, *one.limits)
        return Parts(balancers, limits, free, (*self.proposals, proposal))


def built(parts: Parts, design: Design) -> Design:
    """The shaped design with what the search left open cut to measure; unchanged where nothing is."""
    if not any(proposal.measured for proposal in parts.proposals):
        return design
    balancers, own = [], set()
    limits: list[Limit] = []
    for proposal, balancer in zip(parts.proposals, design.balancers, strict=True):
        if proposal.measured and isinstance(balancer, Spring):
            own |= {id(limit) for limit in proposal.limits}
            cut, new = proposal.measured(balancer, design.values)
            limits += new
            balancers.append(cut)
        else:
            balancers.append(balancer)
    kept = [limit for limit in design.limits if id(limit) not in own]
    return again(design, balancers, (*kept, *limits))


def again(design: Design, balancers: Sequence[Balancer], limits: Sequence[Limit]) -> Design:
    """The same design with its parts said anew; how sure it is stays."""
    found = balance(design.mechanism, balancers, design.sweep, objective=design.objective, limits=limits)
    return replace(
        found,
        certificate=design.certificate,
        geometry=design.geometry,
        bounds=design.bounds,
        units=dict(found.units) | {name: design.units[name] for name in design.geometry},
        refined=design.refined,
    )


def judge(collection: Collection, subset: Subset, norm: Norm) -> tuple[float, tuple[float, ...]]:
    """The objective's own norm of a subset at the best 0 <= k <= most, and k as shares of the most."""
    dictionary = collection.dictionary
    A = dictionary.columns(subset).reshape(-1, dictionary.blocks, len(subset))
    scenarios = len(dictionary.loads)
    b = dictionary.loads.reshape(-1, dictionary.blocks)
    weight = np.tile(dictionary.weight[:: dictionary.blocks], scenarios)
    unknowns = tuple(Unknown(str(index), "", 0.0, 1.0) for index in subset)
    term = Term("hold", norm, b, np.tile(A, (scenarios, 1, 1)), weight / weight.sum(), (1,) * dictionary.blocks)
    found = solve(Program(unknowns, (term,)))
    # A solver keeps bounds to rounding; a spring of less than nothing has no mass.
    return found.objective, tuple(float(share) for share in np.clip(found.theta, 0.0, 1.0))


@dataclass(frozen=True, eq=False)
class Refined:
    """Parts shaped over few poses: geometry, unknowns, the objective's value, and the energy, J, they exchange."""

    parts: Parts
    geometry: Mapping[str, float]
    theta: Array
    value: float
    excess: float
    energy: float
    values: Mapping[str, float]

    def of(self, balancer: Balancer) -> dict[str, float]:
        """The unknowns of one balancer by parameter."""
        return {u.name.removeprefix(f"{balancer.name}."): self.values[u.name] for u in balancer.unknowns}


class Refiner:
    """Shapes parts over few of the sweep's poses, from where they stand."""

    def __init__(self, mechanism: Mechanism, few: Sweep, objective: Sequence[Aim], limits: Sequence[Limit]) -> None:
        self.mechanism, self.few = mechanism, few
        self.objective, self.limits = tuple(objective), tuple(limits)
        self.states = mechanism.states(few)
        bare = effort(mechanism, (), self.states)
        aim = next(aim for aim in self.objective if aim.cap is None)
        self.bare = aim.weight * aim.term(mechanism, bare, self.states.weight, bare).value(np.zeros(0))

    def with_extremes(self, parts: Parts) -> Refiner:
        """The same over the poses, too, at which springs are shortest, longest, or nearest to what they avoid."""
        sweep = with_extremes(self.mechanism, parts.balancers, self.few, (*self.limits, *parts.limits))
        return Refiner(self.mechanism, sweep, self.objective, self.limits)

    def task(self, parts: Parts) -> Task:
        """The question that parts pose."""
        return task_of(self.mechanism, parts.balancers, self.few, None, self.objective, (*self.limits, *parts.limits))

    def refine(self, parts: Parts, patience: float = 0.0) -> Refined:
        """Sequential convex programming from the present geometry; without geometry to move, one convex solve.

        patience is the share of the value that the last few steps together must have gained for the next.
        """
        task = self.task(parts)
        load = load_of(task, self.states)
        if not parts.free:
            solution = solve(task.program(self.states), elastic=ELASTIC * load)
            return self._refined(parts, {}, solution, solution.excess)
        names = list(parts.free)
        freedoms = [Freedom(n, unit_of(parts.balancers, n), *parts.free[n]) for n in names]
        start = np.array([read(parts.balancers, name) for name in names], dtype=float)

        def build(gamma: Geometry) -> Program:
            return task.program(self.states, candidates(task.balancers, names, gamma))

        # Numbers of a law limit each other by products of powers.
        which = np.array([".law." in freedom.name and freedom.lower > 0 for freedom in freedoms])
        options = {"iterations": ITERATIONS, "precision": PRECISION, "patience": patience}
        local = descend_by_ratios(build, freedoms, start, load, which, **options)
        geometry = {name: float(value) for name, value in zip(names, local.gamma, strict=True)}
        return self._refined(parts.at(geometry), geometry, local.solution, local.excess)

    def shaped(self, parts: Parts, sweep: Sweep) -> Design:
        """The design over a sweep that refined parts lead to; raises EquipoiseError where limits cannot be kept."""
        limits = (*self.limits, *parts.limits)
        if not parts.free:
            return balance(self.mechanism, parts.balancers, sweep, objective=self.objective, limits=limits)
        return descended(
            self.mechanism,
            parts.balancers,
            sweep,
            parts.free,
            objective=self.objective,
            limits=limits,
            precision=PRECISION,
            detour=DETOUR,
        )

    def banded(self, refined: Refined, scatter: Scatter, samples: int) -> Refined:
        """The same parts where their optimum is settled, over few poses, with the 95 % value as their value."""
        design = self.shaped(refined.parts, self.few)
        return replace(
            refined,
            parts=refined.parts.at(design.geometry),
            geometry=design.geometry,
            theta=np.array(list(design.values.values())),
            values=design.values,
            value=tolerance(design, scatter, samples=samples).band.high,
        )

    def _refined(self, parts: Parts, geometry: Mapping[str, float], solution: Solution, excess: float) -> Refined:
        energy = storage(parts.balancers, self.states)
        place = {unknown.name: value for unknown, value in zip(solution.program.unknowns, solution.theta, strict=True)}
        stored = energy.at(np.array([place[unknown.name] for unknown in energy.unknowns])).sum(axis=-1)
        return Refined(parts, geometry, solution.theta, solution.objective, excess, float(np.ptp(stored)), place)


def addition(collection: Collection, refined: Refined) -> tuple[int, float] | None:
    """The candidate that best joins parts already refined, whose own unknowns stay free, and the share of its most.

    What the parts' columns can do is taken out of load and candidates; each candidate then stands alone.
    """
    scene, compressed = collection.scene, collection.dictionary.compressed
    total = effort(scene.ground.mechanism, refined.parts.balancers, scene.states)
    there = compressed.turn @ scene.counted(np.moveaxis(total.A, -1, 0)).T
    load = compressed.load + compressed.turn @ scene.counted(total.b - scene.states.holding)
    own = np.linalg.qr(there / np.maximum(np.linalg.norm(there, axis=0), 1e-300))[0]
    beside, left = compressed.columns - own @ (own.T @ compressed.columns), load - own @ (own.T @ load)
    size = np.einsum("rc,rc->c", beside, beside)
    sound = size > 1e-9 * np.maximum(np.einsum("rc,rc->c", compressed.columns, compressed.columns), 1e-300)
    slope = left @ beside
    k = np.where(sound, np.clip(-slope / np.where(sound, size, 1.0), 0.0, 1.0), 0.0)
    gain = k * (2 * slope + k * size)
    best = int(gain.argmin())
    return (best, float(k[best])) if gain[best] < 0 else None
