"""The answer: what to add, what it does, and how good it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from equipoise import __version__
from equipoise.assemble import Balancer
from equipoise.balancers.flywheel import Flywheel, FlywheelLaw
from equipoise.cases import Settings
from equipoise.certificate import Certificate
from equipoise.friction import Friction
from equipoise.limits import Limit
from equipoise.mechanism import Mechanism
from equipoise.objective import Aim, leading, pole_of
from equipoise.partrecords import part_records
from equipoise.row import Row
from equipoise.states import States
from equipoise.sweep import Sweep

if TYPE_CHECKING:
    from equipoise.cables.behaviour import Behaviour
    from equipoise.discovery.alternative import Alternative
    from equipoise.machinery import Machine
    from equipoise.make.synthesis import Part as MadePart
    from equipoise.parts.choice import Choice
    from equipoise.rubbing import DeadBand
    from equipoise.scattering import Tolerance
    from equipoise.verbs.place import Placed
    from equipoise.verification.findings import Verification


@dataclass(frozen=True, eq=False)
class Design:
    """A mechanism with its balancers found: values of all unknowns, rows before and after, certificate.

    values {name: SI value} and units {name: unit} of the unknowns; geometry {parameter: value} that shape
    moved within bounds {parameter: (low, high)}; sweep and states are those the program saw, `refined` of
    whose poses were found between the samples; problem is the file it came from, where there was one; settings say
    what is adjusted from case to case, where a design serves several; places are where springs were put among equals;
    cables says how a cable platform behaves with its springs, made are the cams and drums cut for them; tolerance says
    how it scatters when parts are as they come, dead_band what friction covers, choices which parts were picked,
    alternatives what a discovery considered in its place; friction are the coefficients of what rubs.
    """

    mechanism: Mechanism
    balancers: tuple[Balancer, ...]
    sweep: Sweep
    states: States
    objective: tuple[Aim, ...]
    limits: tuple[Limit, ...]
    values: Mapping[str, float]
    units: Mapping[str, str]
    before: Mapping[str, Row]
    after: Mapping[str, Row]
    certificate: Certificate
    geometry: Mapping[str, float] = field(default_factory=dict)
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    seed: int = 0
    refined: int = 0
    verification: Verification | None = None
    problem: Mapping[str, Any] | None = None
    cables: Behaviour | None = None
    made: tuple[MadePart, ...] = ()
    settings: Settings | None = None
    places: Mapping[str, Placed] = field(default_factory=dict)
    tolerance: Tolerance | None = None
    dead_band: DeadBand | None = None
    choices: tuple[Choice, ...] = ()
    alternatives: tuple[Alternative, ...] = ()
    friction: Friction = field(default_factory=Friction)

    @property
    def norm(self) -> str:
        """The norm that was made small."""
        return leading(self.objective).norm

    def residual(self, states: States, goal: str = "hold") -> np.ndarray:
        """A goal's residual (N, R) with the balancers, at any states; of `hold` (N, nd)."""
        from equipoise.assemble import effort

        total = effort(self.mechanism, self.balancers, states, goal)
        return total.at(np.array([self.values[unknown.name] for unknown in total.unknowns]))

    def account(self, states: States, *, bare: bool = False) -> dict[str, np.ndarray]:
        """Rows (N, size) by name at any states, with the balancers or bare: joints and, in motion, force and moment."""
        from equipoise.assemble import account

        balancers = () if bare else self.balancers
        blocks, values = account(self.mechanism, balancers, states, self.objective, self.values)
        cuts = np.cumsum([block.size for block in blocks])[:-1]
        return {block.name: part for block, part in zip(blocks, np.split(values, cuts, axis=1), strict=True)}

    @property
    def added_mass(self) -> float:
        """Mass of everything that is added, kg."""
        from equipoise.assemble import effort

        states = self.states
        total = effort(self.mechanism, self.balancers, states, "mass")
        return float(total.at(np.array([self.values[unknown.name] for unknown in total.unknowns]))[0, 0])

    def reached(self, aim: Aim) -> float:
        """The value of an aim's norm, in its unit."""
        if aim.goal == "mass":
            return self.added_mass
        rows = aim.counted(self.mechanism)

        def norm(table: Mapping[str, Row]) -> float:
            values = np.array([getattr(table[name], aim.norm) for name in rows])
            values = values * aim.scales(self.mechanism)
            return float({"peak": values.max, "rms": lambda: np.linalg.norm(values), "mean": values.sum}[aim.norm]())

        return norm(self.after) / (norm(self.before) if aim.divisor == "before" else 1.0)

    def bare(self, aim: Aim) -> float:
        """The value of an aim's norm without balancers, in its unit."""
        return replace(self, after=self.before).reached(aim)

    @property
    def judged(self) -> float:
        """What choices and the target look at: the first aim's value, or the 95 % value of its band where asked for.

        The band counts once it is known (`tolerance`).
        """
        aim = leading(self.objective)
        found = self.tolerance if aim.judged == "band" else None
        return self.reached(aim) if found is None else found.band.high

    def parts(self) -> list[dict[str, Any]]:
        """One entry per part: what it is, where it goes, and what it does over the sweep, SI units."""
        return part_records(self)

    def flywheel_law(self, wheel: Flywheel) -> FlywheelLaw | None:
        """How a flywheel must turn over the motion; None without a motion in time."""
        from equipoise.assemble import settled, without_wheels

        instants = self.sweep.instants
        if instants is None:
            return None
        order = np.argsort(instants.time, kind="stable")
        pole = pole_of(self.objective)
        fixed = settled(self.balancers, self.values)
        moment, momentum = without_wheels(self.mechanism, fixed, self.states, self.values, pole)
        rows = order  # scenarios follow one another; the law is that of the first
        turning, form = self._rotations(wheel, pole)
        return wheel.law(
            instants.time[rows], moment[rows], momentum[rows], None if turning is None else turning[rows], form
        )

    def _rotations(self, wheel: Flywheel, pole: Sequence[float]) -> tuple[np.ndarray | None, Mapping[str, float]]:
        """The sum of rotations (N,) whose rate is the momentum about a flywheel's axis, where it is one."""
        from equipoise.regressor import frame
        from equipoise.spins import spin_form, turned

        plane = frame(self.mechanism).plane
        along = 0.0 if plane is None else float(plane @ wheel.normal)
        form = spin_form(self.mechanism, self.balancers, self.values, self.sweep) if abs(along) > 1 - 1e-9 else None
        if form is None or any(pole):
            return None, {}
        sense = float(np.sign(along))
        turning = sense * turned(self.mechanism, self.states.kin.q, form)
        return turning, {body: sense * K for body, K in form.items()}

    @cached_property
    def machine(self) -> tuple[Machine, Machine] | None:
        """Motors and bearings over the motion, before and after; None for poses at rest."""
        from equipoise.machinery import machine

        before = machine(self.mechanism, self.sweep, self.states, friction=self.friction)
        after = machine(self.mechanism, self.sweep, self.states, self.balancers, self.values, self.friction)
        return (before, after) if before and after else None

    @property
    def missed(self) -> str:
        """Why `objective.target` is missed, or nothing."""
        for aim in self.objective:
            banded = aim.judged == "band" and self.tolerance is not None
            value = self.judged if banded else self.reached(aim)
            if aim.target is not None and value > aim.target:
                unit, what = aim.unit(self.mechanism), f"95 % value of the {aim.norm}" if banded else aim.norm
                return f"the {what} is {value:.4g} {unit}, the target {aim.target:.4g} {unit}"
        return ""

    def json(self) -> dict[str, Any]:
        """The design as design.json holds it."""
        return {
            "equipoise": __version__,
            "problem": self.problem,
            "mechanism": {"name": self.mechanism.name, "mass": self.mechanism.mass, "driven": self.mechanism.driven},
            "sweep": self.sweep.describe(),
            "refined": self.refined,
            "seed": self.seed,
            "unknowns": {name: {"value": value, "unit": self.units[name]} for name, value in self.values.items()},
            "geometry": {name: {"value": value, "unit": self.units[name]} for name, value in self.geometry.items()},
            "norm": self.norm,
            "before": {name: row.json() for name, row in self.before.items()},
            "after": {name: row.json() for name, row in self.after.items()},
            "machine": dict(zip(("before", "after"), (one.json() for one in self.machine), strict=True))
            if self.machine
            else None,
            "certificate": self.certificate.json(),
            "verification": self.verification.json() if self.verification else None,
            "parts": self.parts(),
            "cables": None if self.cables is None else self.cables.json(),
            "made": [part.facts() for part in self.made],
            "places": {name: placed.json() for name, placed in self.places.items()},
            "settings": self.settings.json() if self.settings else None,
            "tolerance": self.tolerance.json() if self.tolerance else None,
            "dead_band": self.dead_band.json() if self.dead_band else None,
            "choices": [choice.json() for choice in self.choices],
            "alternatives": [one.json() for one in self.alternatives],
            "cite": self.cite(),
        }

    def cite(self) -> list[str]:
        """Keys in references.bib of what the design relies on."""
        vertices = any(aim.norm != "rms" for aim in self.objective)
        keys = ["mujoco", "clarabel", *(["highs"] if vertices else []), *self.mechanism.sources]
        for balancer in self.balancers:
            keys += _sources(balancer)
        return list(dict.fromkeys(keys))

    def __str__(self) -> str:
        from equipoise.reporting.words import summary

        return summary(self)


def _sources(item: Any) -> list[str]:
    """The sources that a balancer and all it is made of name."""
    if isinstance(item, tuple):
        return [key for entry in item for key in _sources(entry)]
    if not is_dataclass(item):
        return []
    inner = [key for part in fields(item) for key in _sources(getattr(item, part.name))]
    return [*getattr(type(item), "sources", ()), *inner]
