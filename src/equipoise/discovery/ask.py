"""Between files and discovery: what a command line asks for, and the designs as files that other verbs accept."""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np

from equipoise.design import Design
from equipoise.discovery.plain import plain_problem
from equipoise.errors import InputError
from equipoise.limits import Elongation, Extension
from equipoise.loops import ancestors
from equipoise.mechanism import Mechanism
from equipoise.problem import Problem, problem_of
from equipoise.reporting.numbers import loads
from equipoise.sweep import Sweep
from equipoise.targets import Target
from equipoise.units import to_si
from equipoise.verbs.analyze import analyze
from equipoise.yamlfile import Document

POSES = 2048
LOOKED = 256
"""Poses over which joints that gravity loads are looked for."""
TRACE, FAINT = 1e-9, 1e-6
"""Least effort, N m or N, and least share of the largest of its kind, of a joint that gravity loads."""
FOUND = ("balancers", "shape", "start")
"""What a discovery answers, so that no file need say it."""


def asked(
    target: Target, payload: str | None, at: str | None, springs: int | None, kinds: str | None, make: str | None
) -> Problem:
    """The problem of a discovery: the file's own, or a robot's over its joint limits, changed by options.

    payload lists masses (`0,5kg`), at names the body that carries them (default: the tip of the longest chain),
    kinds lists tags, make names the wire that springs are wound of. Raises InputError for masses that cannot be read.
    """
    problem = target.problem
    unchanged = (payload, springs, kinds, make) == (None, None, None, None)
    if problem.content.discover and unchanged and not any(key in problem.raw for key in FOUND):
        problem.check()
        return problem
    content: dict[str, Any] = copy.deepcopy(dict(problem.raw))
    if target.bare:
        content["sweep"] = {"sobol": POSES, "seed": 0}
        content["objective"] = {"goal": "hold", "norm": "peak", **counted(problem.mechanism)}
    elif not problem.content.discover and problem.content.balancers:
        raise InputError(
            "the file says its balancers, so there is nothing to discover",
            where=problem.document.name,
            hint="put `discover: {springs: 3}` in the place of `balancers`, or use `equipoise shape`",
        )
    changed: dict[str, Any] = dict(content.get("discover") or {})
    changed |= {"springs": springs} if springs is not None else {}
    changed |= {"kinds": [kind.strip() for kind in kinds.split(",")]} if kinds is not None else {}
    changed |= {"make": {**(changed.get("make") or {}), "grade": make}} if make is not None else {}
    content["discover"] = changed
    for key in FOUND:
        content.pop(key, None)
    if payload is not None:
        sweep = content.setdefault("sweep", {"sobol": POSES, "seed": 0})
        sweep["payload"] = [{"body": at or tip(problem.mechanism), "mass": masses(payload)}]
    made = problem_of(Document(problem.document.name, content), problem.folder)
    made.check()
    return made


def counted(mechanism: Mechanism) -> dict[str, Any]:
    """What an objective says of a robot with hinges and slides: N m and N are no two amounts of one thing.

    Where gravity loads one kind alone, joints of that kind count; where it loads both, each by its motor's limit if the
    file states them all.
    """
    if len(set(mechanism.driven_units)) == 1:
        return {}
    rows = analyze(mechanism, Sweep.sobol(mechanism, LOOKED)).rows
    loaded = [name for name, share in loads(rows).items() if rows[name].peak > TRACE and share > FAINT]
    kinds = {rows[name].unit for name in loaded}
    if len(kinds) == 1:
        return {"joints": [name for name, row in rows.items() if row.unit in kinds]}
    known = all(rows[name].limit for name in loaded)
    return {"joints": loaded, "divisor": "motor"} if kinds and known else {}


def masses(text: str) -> list[float]:
    """Masses, kg, from a list such as `0,5kg` or `0, 2.5 kg, 5 kg`; a bare number is kg."""
    found = []
    for word in text.split(","):
        try:
            found.append(float(word))
        except ValueError:
            found.append(to_si(word.strip(), "kg", where="--payload"))
    for mass in found:
        if not (np.isfinite(mass) and mass >= 0):
            raise InputError(f"a payload of {mass:g} kg", where="--payload", hint="for example 0,5kg")
    return found


def tip(mechanism: Mechanism) -> str:
    """The body at the end of the longest chain of hinges: where a payload is carried unless said otherwise."""
    model = mechanism.model
    reach = np.zeros(model.nbody)
    slid = np.zeros(model.nbody, dtype=bool)
    for body in range(1, model.nbody):
        parent = int(model.body_parentid[body])
        reach[body] = reach[parent] + np.linalg.norm(model.body_pos[body])
        own = model.jnt_type[model.body_jntadr[body]] if model.body_jntnum[body] else None
        # A slide at the end of a chain is a finger.
        slid[body] = slid[parent] or own == mujoco.mjtJoint.mjJNT_SLIDE
    best = max(
        range(1, model.nbody),
        key=lambda body: (not slid[body], len(ancestors(model, body)), round(float(reach[body]), 9), -body),
    )
    return str(model.body(best).name)


def for_parts(design: Design) -> Design:
    """The design without the limits that stand for what a part says itself: how far a coil may be stretched."""
    return replace(design, limits=tuple(one for one in design.limits if not isinstance(one, Elongation | Extension)))


def design_problem(design: Design, problem: Problem) -> Problem:
    """The problem file of a found design: it says what was found, for `verify`, `report` and `shape`."""
    found = plain_problem(problem.raw, design.balancers, design.limits, design.bounds)
    return problem_of(Document(problem.document.name, found), problem.folder)
