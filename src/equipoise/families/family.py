"""A family of balancers: its class, where it is described, and a working member for a joint."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from equipoise.assemble import Balancer
from equipoise.families.site import Site
from equipoise.limits import Limit

QUAGLIA = ("quaglia_yin_2015",)
ARAKELIAN = ("arakelian_ghazaryan_2008",)
ZHANG = ("zhang_arakelian_2023",)


@dataclass(frozen=True)
class Trial:
    """Balancers of a family with the geometry that `shape` may move and the limits that make them real.

    whole says that all driven joints count, for arrangements that balance several at once.
    """

    balancers: tuple[Balancer, ...]
    free: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    limits: tuple[Limit, ...] = ()
    whole: bool = False


@dataclass(frozen=True)
class Family:
    """One row of a comparison.

    code is the group of Arakelian & Ghazaryan 2008, Table 1 (A, B, C I, C II, C III), or empty where the family is
    none of theirs; the schemes' numbers in that table are lost. parts counts what is added: springs, cables, pulleys,
    cranks, rods, sliders, cams, gears, weights. unreal says why its member cannot be bought or made as it stands.
    """

    name: str
    code: str
    parts: int
    make: Callable[[Site], Trial]
    sources: tuple[str, ...] = ()
    unreal: str = ""
    words: str = ""
