"""compare: a working member of every family of balancers for one joint, side by side."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from equipoise.affine import Indices
from equipoise.comparing import Comparing
from equipoise.design import Design
from equipoise.errors import EquipoiseError, InputError, nearest
from equipoise.families import HINGE, SLIDE, Family, Site, site_of
from equipoise.families.judge import Chance, Facts, bare_torque, facts, fault
from equipoise.mechanism import Mechanism
from equipoise.motion.drivers import Cycloidal
from equipoise.objective import Aim, Judged
from equipoise.solve.program import Norm
from equipoise.states import States
from equipoise.sweep import Sweep
from equipoise.verbs.balance import balance
from equipoise.verbs.shape import shape

if TYPE_CHECKING:
    from equipoise.row import Row

STARTS = 4
ROWS = 181
INSTANTS = 181
EXACT = 1e-9
SCHEME = "underspecified"
"""What is known of a scheme's number in Table 1 of Arakelian & Ghazaryan 2008, whose figure is lost."""


@dataclass(frozen=True)
class Entry:
    """One row: the family, its member's facts and design, its rank (1 is best) and why; without a design, why not."""

    family: Family
    rank: int
    reason: str
    realisable: bool
    facts: Facts | None = None
    design: Design | None = None

    def json(self) -> dict[str, Any]:
        """The row as plain data, SI."""
        family = self.family
        count = family.parts * (len(self.design.balancers) if self.design and self.design.sweep else 1)
        return {
            "rank": self.rank,
            "family": family.name,
            "class": family.code or None,
            "scheme": SCHEME if family.code else None,
            "references": list(family.sources),
            "realisable": self.realisable,
            "reason": self.reason,
            "parts": count,
            **({} if self.facts is None else vars(self.facts)),
            "certificate": None if self.design is None else self.design.certificate.kind,
        }


@dataclass(frozen=True, eq=False)
class Comparison:
    """All families for one joint, ranked; before is the bare joint, torque its rms over the motion."""

    site: Site
    norm: Norm
    judged: Judged
    before: Row
    torque: float
    motion: str
    sweep: Sweep
    entries: tuple[Entry, ...] = field(default=())

    def json(self) -> dict[str, Any]:
        """The comparison as plain data."""
        return {
            "joint": self.site.joint,
            "unit": self.before.unit,
            "norm": self.norm,
            "judged": self.judged,
            "before": self.before.json() | {"torque": self.torque},
            "motion": self.motion,
            "room": self.site.room,
            "rows": [entry.json() for entry in self.entries],
        }

    def __str__(self) -> str:
        from equipoise.reporting.comparison import text

        return text(self)


def compare(
    mechanism: Mechanism,
    sweep: Sweep,
    comparing: Comparing | None = None,
    *,
    norm: Norm = "rms",
    judged: Judged = "nominal",
    chance: Chance | None = None,
    starts: int = STARTS,
    progress: Callable[[str], None] | None = None,
) -> Comparison:
    """Design a working member of every family for one joint and rank them.

    Rows that cannot be had come last, then the norm of what is left to hold decides (judged `band`: its 95 % value
    under the scatter of `chance`), then the number of parts, then the room. Raises InputError for a joint without a
    load, a family that is none, and a scheme's number.
    """
    asked = comparing or Comparing()
    states = mechanism.states(sweep)
    site = site_of(states, asked.joint, asked.room)
    known = SLIDE if site.slide else HINGE
    families = [family for family in known if not asked.families or _asked(family, asked.families)]
    _insist_on_names(known, asked.families)
    motion, words = _motion(mechanism, site, asked)
    over = sweep.thinned(_few(len(sweep.poses))) if len(sweep.poses) > ROWS else sweep
    found = []
    for family in families:
        if progress:
            progress(family.name)
        found.append(_entry(family, site, over, norm, starts, motion, chance or Chance()))
    before = _before(mechanism, sweep, site)
    load = getattr(before, norm)
    by = "high" if judged == "band" else norm
    ranked = sorted(found, key=lambda entry: _key(entry, by, load))
    entries = tuple(_told(entry, index, norm, before) for index, entry in enumerate(ranked, 1))
    return Comparison(site, norm, judged, before, bare_torque(site, motion), words, sweep, entries)


def _few(count: int) -> Indices:
    return np.unique(np.linspace(0, count - 1, ROWS).astype(int))


def _asked(family: Family, names: Sequence[str]) -> bool:
    return any(name == family.code or name.lower() in family.name.lower() for name in names)


def _insist_on_names(known: Sequence[Family], names: Sequence[str]) -> None:
    codes = sorted({family.code for family in known if family.code})
    for name in names:
        if any(_asked(family, [name]) for family in known):
            continue
        bare = name.replace(" ", "").upper()
        if bare[:1] in ("A", "B", "C") and bare[1:].isdigit():
            raise InputError(
                f"scheme {name} is {SCHEME}: the drawings of Table 1 are lost, only its groups are known",
                where="compare.families",
                hint=f"name a group: {', '.join(codes)}",
            )
        raise InputError(
            f"there is no family {name!r}",
            where="compare.families",
            hint=nearest(name, [*codes, *(family.name for family in known)]),
        )


def _motion(mechanism: Mechanism, site: Site, asked: Comparing) -> tuple[States, str]:
    given = asked.motion or {site.joint: Cycloidal(site.low, site.high)}
    sweep = Sweep.motion(mechanism, given, duration=asked.duration, samples=INSTANTS)
    words = "the given motion" if asked.motion else f"{site.joint} once through its range, cycloidal"
    return mechanism.states(sweep), f"{words}, {asked.duration:g} s"


def _before(mechanism: Mechanism, sweep: Sweep, site: Site) -> Row:
    from equipoise.verbs.analyze import analyze

    return analyze(mechanism, sweep).rows[site.joint]


def _entry(family: Family, site: Site, sweep: Sweep, norm: Norm, starts: int, motion: States, chance: Chance) -> Entry:
    try:
        trial = family.make(site)
        aim = Aim(norm=norm, joints=None if trial.whole else (site.joint,))
        pieces = (site.mechanism, trial.balancers, sweep)
        if trial.free:
            found = shape(*pieces, trial.free, objective=aim, limits=trial.limits, starts=starts)
        else:
            found = balance(*pieces, objective=aim, limits=trial.limits)
        judged = facts(found, site, motion, chance)
    except EquipoiseError as error:
        return Entry(family, 0, f"no design: {error.message}", realisable=False)
    why = family.unreal or fault(found)
    return Entry(family, 0, why, not why, judged, found)


def _key(entry: Entry, by: str, load: float) -> tuple[Any, ...]:
    if entry.facts is None:
        return (2, math.inf, 0, 0.0)
    left = getattr(entry.facts, by) / load
    return (0 if entry.realisable else 1, _rounded(left), entry.family.parts, max(entry.facts.room))


def _rounded(left: float) -> float:
    """Shares of the load to two digits; what is at rounding level is none."""
    return 0.0 if left < EXACT else float(f"{left:.2g}")


def _told(entry: Entry, rank: int, norm: Norm, before: Row) -> Entry:
    """The row with its rank and the reason for it in words."""
    if entry.facts is None:
        return replace(entry, rank=rank)
    left = getattr(entry.facts, norm) / getattr(before, norm)
    share = "nothing is left to hold" if left < EXACT else f"{100 * left:.3g} % of the {norm} is left"
    why = share if entry.realisable else f"{share}, but {entry.reason}"
    return replace(entry, rank=rank, reason=why)
