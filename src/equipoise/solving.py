"""From the file a command is pointed at to a solved design."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from math import isnan, nan
from typing import TYPE_CHECKING, Any

from equipoise.console import Interrupts, progress_bar, say
from equipoise.design import Design
from equipoise.errors import InputError
from equipoise.make.synthesis import Part
from equipoise.objective import leading
from equipoise.problem import Problem
from equipoise.reporting.numbers import quantity
from equipoise.targets import Target, needs_problem, target_of
from equipoise.verbs import balance as verbs_balance
from equipoise.verbs import shape as verbs_shape

if TYPE_CHECKING:
    from equipoise.discovery.front import Discovery
    from equipoise.discovery.stage import Stage
    from equipoise.verbs.adjusted import Adjusted


def solvable_problem(file: str, verb: str) -> Problem:
    """A problem that may be solved; raises InputError for a bare robot, or one that adds nothing."""
    return _solvable(_target(file), file, verb).problem


def _target(file: str) -> Target:
    target = target_of(file)
    for remark in target.remarks:
        say(f"note: {remark}")
    return target


def _solvable(target: Target, file: str, verb: str) -> Target:
    if target.bare:
        raise needs_problem(target.problem.mechanism, file, verb)
    if not target.problem.balancers:
        raise InputError(
            "nothing is added to the mechanism",
            where=f"{file}, balancers",
            hint="add `balancers:` with a spring or a counterweight; `equipoise analyze` says which joints ask for one",
        )
    return target


def found_design(file: str, verb: str) -> tuple[Design, Problem, bool]:
    """The design that a file holds, or that its problem leads to; whether Ctrl-C cut the search short."""
    target = _solvable(_target(file), file, verb)
    if target.design is not None:
        return _behaving(target.design, target.problem), target.problem, False
    if target.problem.cases:
        served_all, stopped = served(target.problem, None, None)
        return served_all.designs[served_all.hardest], target.problem, stopped
    if target.problem.bounds:
        found, stopped = shaped(target.problem, None, None)
        return found, target.problem, stopped
    return balanced(target.problem), target.problem, False


def made_parts(file: str) -> tuple[list[Part], Problem]:
    """What a file asks to be made; its springs are solved for first where a part needs one."""
    target = _target(file)
    asked = target.problem.content.make
    if not asked:
        raise InputError(
            "the file asks for nothing to be made",
            where=f"{file}, make",
            hint="add `make:` with a drum, cam, constant_force_cam or arm_cam",
        )
    needs_design = any(hasattr(request, "spring") for request in asked)
    design = found_design(file, "make")[0] if needs_design else None
    return cut(target.problem, design), target.problem


def cut(problem: Problem, design: Design | None) -> list[Part]:
    """The cams and drums that a problem asks for; errors name the request."""
    parts = []
    for index, request in enumerate(problem.content.make):
        with problem.at("make", index):
            parts.append(request.part(problem.mechanism, design))
    return parts


def served(problem: Problem, seed: int | None, starts: int | None) -> tuple[Adjusted, bool]:
    """One design for all cases of a file, with progress on stderr; whether Ctrl-C cut the search short."""
    from equipoise.verbs.adjust import adjust

    with _searching(problem, "adjust", seed, starts) as (interrupts, options):
        found = adjust(
            problem.cases,
            problem.balancers,
            problem.adjusters,
            problem.bounds,
            objective=problem.objective,
            limits=problem.limits,
            **options,
        )
    return found, interrupts.hit


def bracketed(design: Design, problem: Problem) -> tuple[Design, bool]:
    """The design with a bound over all geometry, with progress on stderr; whether Ctrl-C cut the search short."""
    from equipoise.verbs.certify import certify

    said = [0]

    def tell(boxes: int, low: float, high: float) -> None:
        if boxes >= 2 * said[0] + 500:
            said[0] = boxes
            unit = design.certificate.unit
            say(f"certify: {boxes} boxes, between {low:.5g} and {high:.5g} {unit}")

    with problem.at_names(), Interrupts() as interrupts:
        found, bracket = certify(design, progress=tell)
    if bracket.stopped:
        say("the branch and bound was stopped by hand: the bound so far holds")
    return found, interrupts.hit


def discovery(
    file: str, payload: str | None, at: str | None, springs: int | None, kinds: str | None, make: str | None
) -> Problem:
    """The problem that a discovery works on: a file's own `discover` block, or a robot's, changed by what was said."""
    from equipoise.discovery.ask import asked

    problem = asked(_target(file), payload, at, springs, kinds, make)
    if leading(problem.objective).divisor == "motor" and len(set(problem.mechanism.driven_units)) > 1:
        say("note: hinges (N m) and slides (N) are loaded: each joint counts as a share of its motor's limit")
    return problem


def discovered(problem: Problem) -> tuple[Discovery, bool]:
    """The front of a problem, with progress on stderr; whether Ctrl-C cut the search short."""
    from equipoise.discovery.request import Discover
    from equipoise.verbs.discover import discover

    request = problem.content.discover or Discover()
    unit = leading(problem.objective).unit(problem.mechanism)
    with problem.at_names(), Interrupts() as interrupts, progress_bar("discover", "numbers of parts", unit) as progress:
        reached: tuple[int, int, float] = 0, request.springs, nan

        def show(done: int, most: int, value: float) -> None:
            nonlocal reached
            reached = done, most, value
            if progress is None:
                best = "nothing gained yet" if isnan(value) else quantity(value, unit, 3)
                say(f"discover    {done} of {most} numbers of parts done, {best}")
            else:
                progress(*reached)

        def tell(stage: Stage) -> None:
            if progress is None:
                say(f"discover    {stage}")
            else:
                progress(*reached, str(stage))

        front = discover(
            problem.mechanism,
            problem.sweep,
            request,
            objective=problem.objective,
            limits=problem.limits,
            scatter=problem.content.tolerances,
            progress=show,
            tell=tell,
        )
    if interrupts.hit:
        say("the search was stopped by hand: what was finished follows")
    return front, interrupts.hit


def designed(file: str) -> tuple[Design, Problem, bool] | None:
    """The recommended design of a file with a `discover` block; None for any other."""
    target = _target(file)
    if target.bare or target.design is not None or target.problem.content.discover is None:
        return None
    from equipoise.discovery.ask import design_problem, for_parts

    front, stopped = discovered(target.problem)
    say(str(front))
    design = front.designs[front.recommended]
    if target.problem.content.pick is not None:
        design = for_parts(design)
    return design, design_problem(design, target.problem), stopped


def balanced(problem: Problem) -> Design:
    """All unknowns at the geometry of the file."""
    with problem.at_names():
        return _behaving(
            verbs_balance.balance(
                problem.mechanism, problem.balancers, problem.sweep, objective=problem.objective, limits=problem.limits
            ),
            problem,
        )


def _behaving(design: Design, problem: Problem) -> Design:
    """The design with its springs out of the way where zones are given, and how a cable platform behaves."""
    if problem.content.placement is not None and not design.places:
        from equipoise.verbs.place import place

        design = place(design, problem.content.placement)
    platform = design.mechanism.platform
    if platform is None or not platform.cables:
        return design
    from equipoise.cables.behaviour import behaviour

    return replace(design, cables=behaviour(design, problem.trajectory))


def judged(design: Design, problem: Problem) -> Design:
    """The design with what scatter and friction make of it, by the problem's own figures."""
    from equipoise.rubbing import dead_band, held
    from equipoise.scattering import followed, tolerance

    if followed(design):
        design = replace(design, tolerance=tolerance(design, problem.content.tolerances))
    return replace(design, dead_band=dead_band(design, problem.content.friction)) if held(design) else design


def banded(design: Design, problem: Problem) -> Design:
    """The design with its tolerance band where the objective is judged by it; else unchanged."""
    asked = any(aim.judged == "band" for aim in problem.objective)
    return judged(design, problem) if asked and design.tolerance is None else design


def shaped(problem: Problem, seed: int | None, starts: int | None) -> tuple[Design, bool]:
    """Geometry and unknowns, with progress on stderr; whether Ctrl-C cut the search short."""
    with _searching(problem, "shape", seed, starts) as (interrupts, options):
        found = verbs_shape.shape(
            problem.mechanism,
            problem.balancers,
            problem.sweep,
            problem.bounds,
            objective=problem.objective,
            limits=problem.limits,
            **options,
        )
    if interrupts.hit:
        say(f"the search was stopped by hand: the best of {found.certificate.starts} starts")
    return _behaving(found, problem), interrupts.hit


@contextmanager
def _searching(
    problem: Problem, verb: str, seed: int | None, starts: int | None
) -> Iterator[tuple[Interrupts, dict[str, Any]]]:
    """Names of the file before errors, Ctrl-C remembered, progress on stderr; with the search's own options."""
    search, unit = problem.search, leading(problem.objective).unit(problem.mechanism)
    with problem.at_names(), Interrupts() as interrupts, progress_bar(verb, "starts", unit) as progress:
        yield (
            interrupts,
            {
                "starts": search.starts if starts is None else starts,
                "seed": search.seed if seed is None else seed,
                "progress": progress,
            },
        )
