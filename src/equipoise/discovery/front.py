"""The front: the best design with 1, 2, 3, ... parts, what was considered, and the floors beside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from equipoise.affine import Array, Block
from equipoise.design import Design
from equipoise.discovery.alternative import Alternative
from equipoise.discovery.collect import Collection
from equipoise.interference.findings import Clash
from equipoise.objective import Aim
from equipoise.states import States
from equipoise.sweep import Sweep
from equipoise.verbs.analyze import table

BETTER = 5e-3
"""Share by which a further part must lower the objective to be worth a place on the front."""
FAINT = 1e-9


@dataclass(frozen=True)
class Bound:
    """What no fixed part can go below: row, value and cause (`payload`, `own` or `dictionary`)."""

    row: str
    value: float
    unit: str
    cause: str


@dataclass(frozen=True, eq=False)
class Discovery:
    """Designs in order of their number of parts, each better than the one before.

    before is the objective without parts; bounds the floors; candidates, poses, rank, lost, spacing (m) and margin (m)
    describe the dictionary, refused {reason: count} what its filters removed;
    notes say how the search went, clashes what the springs of each design run into;
    stopped says that Ctrl-C cut the search short.
    """

    designs: tuple[Design, ...]
    aim: Aim
    unit: str
    before: float
    bounds: tuple[Bound, ...]
    candidates: int
    poses: int
    rank: int
    lost: float
    spacing: float
    margin: float
    refused: Mapping[str, int]
    pairs: tuple[str, ...]
    notes: tuple[str, ...] = ()
    clashes: tuple[tuple[Clash, ...], ...] = ()
    stopped: bool = False
    values: tuple[float, ...] = field(default=())

    @property
    def highs(self) -> tuple[float, ...]:
        """The 95 % value of every design's band; nothing where bands are not known."""
        bands = [design.tolerance.band for design in self.designs if design.tolerance is not None]
        return tuple(band.high for band in bands) if len(bands) == len(self.designs) else ()

    @property
    def alternatives(self) -> tuple[Alternative, ...]:
        """The choices that lost, which the designs hold."""
        return tuple(one for design in self.designs for one in design.alternatives)

    @property
    def recommended(self) -> int:
        """Number of the design with the fewest parts that meets the target, else of the last."""
        for index, design in enumerate(self.designs):
            if self.aim.target is not None and not design.missed:
                return index
        return len(self.designs) - 1

    @staticmethod
    def folder(design: Design) -> str:
        """The folder of a design beside the others."""
        return f"springs_{len(design.balancers)}"

    def with_designs(self, designs: tuple[Design, ...]) -> Discovery:
        """The same front with its designs verified, or told their problem."""
        return replace(self, designs=designs)

    def json(self) -> dict[str, Any]:
        """The front as `discover --json` prints it: `front` holds whole designs in order of springs."""
        return {
            "front": [design.json() for design in self.designs],
            "recommended": self.recommended,
            "norm": self.aim.norm,
            "unit": self.unit,
            "before": self.before,
            "values": list(self.values),
            "highs": list(self.highs),
            "judged": self.aim.judged,
            "masses": [design.added_mass for design in self.designs],
            "floors": [vars(bound) for bound in self.bounds],
            "dictionary": {
                "candidates": self.candidates,
                "poses": self.poses,
                "rank": self.rank,
                "lost": self.lost,
                "spacing": self.spacing,
                "margin": self.margin,
                "pairs": list(self.pairs),
                "refused": dict(self.refused),
            },
            "notes": list(self.notes),
            "clashes": [[vars(clash) for clash in found] for found in self.clashes],
            "stopped": self.stopped,
        }

    def __str__(self) -> str:
        from equipoise.discovery.words import summary

        return summary(self)


def bounds_of(collection: Collection, sweep: Sweep, aim: Aim) -> tuple[Bound, ...]:
    """Floors of a peak: half of what payload scenarios differ by, and loads that no candidate reaches.

    |r_1 - r_0| / 2 <= max(|r_1|, |r_0|) for the efforts of two payloads at one pose, whatever fixed parts serve both.
    """
    mechanism = collection.scene.ground.mechanism
    if aim.norm != "peak":
        return ()
    scale = dict(zip(aim.counted(mechanism), aim.scales(mechanism), strict=True))
    units = {block.name: aim.unit(mechanism) if aim.divisor else block.unit for block in aim.blocks(mechanism)}
    found = []
    if len(sweep.scenarios) > 1:
        lightest = int(sweep.scenarios.sum(axis=1).argmin())

        def half(states: States) -> tuple[Sequence[Block], Array]:
            effort = states.holding.reshape(len(sweep.scenarios), -1, len(mechanism.driven))
            return mechanism.driven_blocks, (0.5 * (effort - effort[lightest])).reshape(states.holding.shape)

        rows = table(mechanism, sweep, mechanism.states(sweep), half)
        floor = FAINT * max(row.peak for row in rows.values())
        found += [
            Bound(name, rows[name].peak * scale[name], units[name], "payload")
            for name in scale
            if rows[name].peak > floor
        ]
    own = collection.analysis.rows
    floor = FAINT * max(own[name].peak for name in scale)
    found += [
        Bound(name, own[name].peak * scale[name], units[name], "own")
        for name in scale
        if own[name].peak > floor and mechanism.joint_id(name) not in collection.reached
    ]
    return tuple(found)
