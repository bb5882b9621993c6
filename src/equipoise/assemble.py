"""Sum the efforts, stack the rows: the builder of every program."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from equipoise import chunks
from equipoise.affine import Affine, Array, Block, merge_unknowns
from equipoise.balancers.counterweight import Counterweight
from equipoise.balancers.spring import STORAGE, Spring
from equipoise.errors import InputError
from equipoise.limits import Limit, Setting, implied
from equipoise.mechanism import Mechanism
from equipoise.objective import Aim
from equipoise.platform import resultant
from equipoise.solve.program import Program
from equipoise.states import States
from equipoise.sweep import Sweep

Balancer = Spring | Counterweight


def check(mechanism: Mechanism, balancers: Sequence[Balancer]) -> None:
    """Raise InputError for names used twice, `like` without its original, and balancers that cannot act."""
    seen: dict[str, Balancer] = {}
    for balancer in balancers:
        if balancer.name in seen:
            raise InputError(
                f"two balancers are called {balancer.name!r}",
                where="balancers",
                hint=f"name it anew, or say `like: {balancer.name}` to share its unknowns",
            )
        if balancer.like is not None and (
            type(seen.get(balancer.like)) is not type(balancer) or _kind(seen[balancer.like]) is not _kind(balancer)
        ):
            raise InputError(
                f"{balancer.name} is like {balancer.like!r}, which is no earlier balancer of its kind",
                where=f"balancer {balancer.name}",
            )
        balancer.check(mechanism)
        seen[balancer.name] = balancer


def _kind(balancer: Balancer) -> type:
    return type(balancer.law) if isinstance(balancer, Spring) else type(balancer)


def effort(mechanism: Mechanism, balancers: Sequence[Balancer], states: States, goal: str = "hold") -> Affine:
    """The whole residual of a goal: the mechanism's share plus every balancer's; `wrench` follows from `hold`."""
    if goal == "wrench":
        return resultant(states, effort(mechanism, balancers, states))
    return Affine.total([mechanism.effort(states, goal), *(balancer.effort(states, goal) for balancer in balancers)])


def storage(balancers: Sequence[Balancer], states: States) -> Affine:
    """Stored energy of each balancer, one block per balancer (N, K), J; what settles free directions."""
    parts = [balancer.effort(states, "storage") for balancer in balancers]
    unknowns = merge_unknowns([part.unknowns for part in parts])
    wide = [part.expand(unknowns) for part in parts]
    shape = np.broadcast_shapes(*[part.b.shape for part in wide])
    b = np.concatenate([np.broadcast_to(part.b, shape) for part in wide], axis=-1)
    A = np.concatenate([np.broadcast_to(part.A, (*shape, len(unknowns))) for part in wide], axis=-2)
    blocks = tuple(Block(f"{STORAGE.name} of {balancer.name}", STORAGE.unit) for balancer in balancers)
    return Affine(blocks, b, unknowns, A)


def build(
    mechanism: Mechanism,
    balancers: Sequence[Balancer],
    sweep: Sweep,
    states: States,
    objective: Sequence[Aim],
    limits: Sequence[Limit] = (),
) -> Program:
    """The convex program of a balancing problem at one geometry, or at all candidates the balancers carry.

    Raises InputError where a length of the states leaves the span of a spring's law; candidates get limits instead.
    An rms over very many states is summed in chunks.
    """
    for balancer in balancers:
        if isinstance(balancer, Spring):
            balancer.check_span(states)
    unknowns = merge_unknowns([balancer.unknowns for balancer in balancers])

    def hold_at(poses: Array) -> Affine:
        return effort(mechanism, balancers, mechanism.states(sweep.at_poses(poses)))

    setting = Setting({balancer.name: balancer for balancer in balancers}, states, hold_at)
    rows = [row for limit in limits for row in limit.rows(setting)]
    rows += implied(balancers, setting)
    efforts: dict[str, Affine] = {}
    terms = []
    for aim in objective:
        if aim.norm == "rms" and chunks.is_big(balancers, states, len(unknowns)):
            terms.append(chunks.rms_term(mechanism, balancers, states, aim))
        else:
            if aim.goal not in efforts:
                efforts[aim.goal] = effort(mechanism, balancers, states, aim.goal).expand(unknowns)
            terms.append(aim.term(mechanism, efforts[aim.goal], states.weight))
    return Program(unknowns, tuple(terms), tuple(row.expand(unknowns) for row in rows))


def thrift(program: Program, balancers: Sequence[Balancer], states: States, value: float) -> Program:
    """The program that keeps the objective's value and makes the peak stored energy least instead."""
    stored = storage(balancers, states).expand(program.unknowns)
    template = program.terms[0]
    saving = replace(
        template,
        name="stored energy",
        norm="peak",
        b=stored.b,
        A=stored.A,
        sizes=(1,) * len(stored.blocks),
        factor=1.0,
        cap=None,
    )
    kept = [term if term.cap is not None else replace(term, cap=value / term.factor) for term in program.terms]
    return replace(program, terms=(saving, *kept))
