"""What a problem file may say, field by field."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from equipoise.comparing import Comparing
from equipoise.discovery.request import Discover
from equipoise.friction import Friction
from equipoise.objective import Aim
from equipoise.parts.request import Pick
from equipoise.placement.request import Placing
from equipoise.scattering.scatter import Scatter
from equipoise.tags import BALANCER, LIMIT, MAKE, MECHANISM, START, SWEEP
from equipoise.tilt import Tilt


@dataclass(frozen=True)
class Search:
    """How `shape` searches: the number of starts and the seed that makes it repeatable."""

    starts: int = 24
    seed: int = 0


@dataclass(frozen=True)
class ProblemFile:
    """A problem: what moves, over which poses, what is added, what may change shape, what must hold, what counts.

    mechanism is a robot file `{model: path}` or a builder; branch names the assembly of its loops at the sweep's first
    pose or instant, where that is not the reference's (an unknown name is answered by the choices); sweep the poses
    that matter (default: 2048 Sobol poses over the joint limits); start {spring: {prescribed: ...}} derives a spring's
    geometry, from which shape then starts; shape {parameter: [low, high]} frees geometry such as `s1.path.line.0.z`;
    adjust {parameter: [low, high]} is set anew for every payload or case, null leaves an unknown its natural bounds;
    cases list mechanisms that one design serves, each with what differs from the `mechanism`: `{mass: 50 kg}`; tilt is
    how the base leans; compare says which joint `equipoise compare` looks at; placement which zones springs must keep
    out of; make lists cams and drums that `equipoise make` cuts; trajectory, a motion or poses in order, is what a
    cable platform's motors are judged on;
    tolerances says how far parts and robot may be off, friction how much they rub.
    With discover in the place of balancers it says how `equipoise discover` looks for them; pick asks for real parts in
    the place of ideal springs.
    Bare numbers are SI, angles rad; text carries its unit: `12 kg`, `30 deg`, `0.4 N/mm`. An unknown that the
    program finds is written by leaving its field out.
    """

    mechanism: Annotated[Any, MECHANISM]
    branch: str | None = None
    sweep: Annotated[Any, SWEEP] | None = None
    balancers: tuple[Annotated[Any, BALANCER], ...] = ()
    start: Mapping[str, Annotated[Any, START]] | None = None
    shape: Mapping[str, tuple[Any, Any]] | None = None
    adjust: Mapping[str, tuple[Any, Any] | None] | None = None
    cases: tuple[Mapping[str, Any | tuple[Any, ...]], ...] = ()
    tilt: Tilt | None = None
    search: Search = field(default_factory=Search)
    compare: Comparing | None = None
    placement: Placing | None = None
    limits: tuple[Annotated[Any, LIMIT], ...] = ()
    objective: Aim | tuple[Aim, ...] = field(default_factory=Aim)
    make: tuple[Annotated[Any, MAKE], ...] = ()
    discover: Discover | None = None
    tolerances: Scatter = field(default_factory=Scatter)
    friction: Friction = field(default_factory=Friction)
    trajectory: Annotated[Any, SWEEP] | None = None
    pick: Pick | None = None
