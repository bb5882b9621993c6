"""Sum the efforts, stack the rows: the builder of every program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from equipoise import chunks
from equipoise.affine import Affine, Array, Block, merge_unknowns
from equipoise.balancers.counter_rotor import CounterRotor
from equipoise.balancers.counterweight import Counterweight
from equipoise.balancers.flywheel import Flywheel
from equipoise.balancers.shapes import Plate, Solid
from equipoise.balancers.spring import STORAGE, Spring
from equipoise.errors import InputError
from equipoise.frames import skew
from equipoise.limits import Limit, MassCap, Setting, implied, realisable
from equipoise.mechanism import Mechanism
from equipoise.objective import ORIGIN, Aim, goal_blocks, joint_goal, pole_of
from equipoise.platform import resultant
from equipoise.regressor import free_states
from equipoise.solve.program import Program
from equipoise.states import States
from equipoise.sweep import Sweep

SUMMED = ("hold", "wrench")
"""Goals whose rms and residual over very many states are summed in chunks."""

FREE = 48
"""Random admissible states, at least, that stand for all motions."""

Balancer = Spring | Counterweight | CounterRotor | Flywheel


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


def effort(
    mechanism: Mechanism,
    balancers: Sequence[Balancer],
    states: States,
    goal: str = "hold",
    pole: Sequence[float] = ORIGIN,
) -> Affine:
    """The whole residual of a goal: the mechanism's share plus every balancer's.

    A moment is counted about the pole (world axes, m), M_o = M - o x F, and then relieved by flywheels;
    a `wrench` on a platform follows from `hold`.
    """
    if goal == "wrench":
        return resultant(states, effort(mechanism, balancers, states))
    total = Affine.total([mechanism.effort(states, goal), *(balancer.effort(states, goal) for balancer in balancers)])
    if goal != "moment":
        return total
    if any(pole):
        force = effort(mechanism, balancers, states, "force").expand(total.unknowns)
        lever = skew(np.asarray(pole, dtype=float))
        A = total.A - np.einsum("ij,...njp->...nip", lever, force.A)
        total = replace(total, b=total.b - force.b @ lever.T, A=A)
    for balancer in balancers:
        if isinstance(balancer, Flywheel):
            total = balancer.relieve(total)
    return total


def settled(balancers: Sequence[Balancer], values: Mapping[str, float]) -> tuple[Balancer, ...]:
    """The balancers with whatever found its place fixed there, so that every goal can be answered."""
    return tuple(b.settled(values) if isinstance(b, Counterweight) else b for b in balancers)


def account(
    mechanism: Mechanism,
    balancers: Sequence[Balancer],
    states: States,
    objective: Sequence[Aim],
    values: Mapping[str, float],
) -> tuple[tuple[Block, ...], Array]:
    """What a design reports of its states: blocks and residual (N, R) at values of the unknowns.

    Efforts of the driven joints, in motion force and moment, and the resultant on a platform where it counts.
    """
    fixed, moving = settled(balancers, values), states.rates is not None
    goals = [joint_goal(objective, moving), *(("force", "moment") if moving else ())]
    goals += ["wrench"] if any(aim.goal == "wrench" for aim in objective) else []
    unknowns = merge_unknowns([balancer.unknowns for balancer in fixed])
    theta = np.array([values[unknown.name] for unknown in unknowns])
    pole = pole_of(objective)
    blocks: list[Block] = []
    rows = []
    for goal in goals:
        blocks += goal_blocks(mechanism, goal)
        if goal in SUMMED and chunks.is_big(fixed, states, len(theta)):
            rows.append(chunks.residual(mechanism, fixed, states, goal, theta))
        else:
            rows.append(effort(mechanism, fixed, states, goal, pole).expand(unknowns).at(theta))
    return tuple(blocks), np.concatenate(rows, axis=-1)


def without_wheels(
    mechanism: Mechanism,
    balancers: Sequence[Balancer],
    states: States,
    values: Mapping[str, float],
    pole: Sequence[float],
) -> tuple[Array, Array]:
    """Moment and angular momentum (N, 3) about a pole of all but the flywheels."""
    others = [balancer for balancer in balancers if not isinstance(balancer, Flywheel)]
    moving = (effort(mechanism, others, at, "moment", pole) for at in (states, states.momenta))
    moment, momentum = (part.at(np.array([values[u.name] for u in part.unknowns])) for part in moving)
    return moment, momentum


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

    _insist_on_caps(balancers, objective, limits)
    setting = setting_of(mechanism, balancers, sweep, states)
    rows = [row for limit in limits for row in limit.rows(setting)]
    rows += implied(balancers, setting)
    terms = []
    for aim in objective:
        summed = aim.norm == "rms" and aim.goal in SUMMED and aim.divisor != "before"
        if summed and chunks.is_big(balancers, states, len(unknowns)):
            terms.append(chunks.rms_term(mechanism, balancers, states, aim))
            continue
        whole = effort(mechanism, balancers, states, aim.goal, aim.pole).expand(unknowns)
        bare = effort(mechanism, (), states, aim.goal, aim.pole) if aim.divisor == "before" else None
        terms.append(aim.term(mechanism, whole, states.weight, bare))
    definite = tuple(one.expand(unknowns) for one in realisable(balancers))
    return Program(unknowns, tuple(terms), tuple(row.expand(unknowns) for row in rows), definite)


def setting_of(mechanism: Mechanism, balancers: Sequence[Balancer], sweep: Sweep, states: States) -> Setting:
    """What limits may ask of a mechanism with its balancers."""

    def hold_at(poses: Array) -> Affine:
        return effort(mechanism, balancers, mechanism.states(sweep.at_poses(poses)))

    def momentum(goal: str) -> Affine:
        columns = sum(len(balancer.unknowns) for balancer in balancers)
        return effort(mechanism, balancers, free_states(mechanism, sweep, max(FREE, columns)), goal)

    return Setting({balancer.name: balancer for balancer in balancers}, states, hold_at, momentum)


def _insist_on_caps(balancers: Sequence[Balancer], objective: Sequence[Aim], limits: Sequence[Limit]) -> None:
    """A body of given first moment and vanishing inertia has infinite mass: something must keep the mass down."""
    if not {"moment", "drive"} & {aim.goal for aim in objective} or any(aim.goal == "mass" for aim in objective):
        return
    kept = {limit.counterweight for limit in limits if isinstance(limit, MassCap)}
    for balancer in balancers:
        free = isinstance(balancer, Counterweight) and isinstance(balancer.shape, Plate | Solid)
        if free and balancer.mass is None and balancer.owner not in kept and balancer.name not in kept:
            raise InputError(
                f"nothing keeps the mass of {balancer.name} down: little inertia at a given first moment asks for more",
                where=f"counterweight {balancer.name}",
                hint=f"add the limit {{mass: {balancer.name}, max: 2 kg}}, or an aim {{goal: mass, cap: 2 kg}}",
            )


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
        weight=np.ones(stored.b.shape[-2]),
        sizes=(1,) * len(stored.blocks),
        factor=1.0,
        cap=None,
    )
    kept = [term if term.cap is not None else replace(term, cap=value / term.factor) for term in program.terms]
    return replace(program, terms=(saving, *kept))
