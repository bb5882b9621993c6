"""What a paper's module offers: claims, improved results, drawings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from equipoise.claim import Claim

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Improvement:
    """What the same parts can do: a design found over a stated sweep, beside the published one.

    what says what is free, over the sweep, norm which norm was made small; published and ours are that norm's
    values of the published design (None where there is none to compare) and of ours, both judged over the same
    sweep; values {name: text with unit} is our design; certificate its kind.
    """

    what: str
    over: str
    norm: str
    published: float | None
    ours: float
    unit: str
    values: Mapping[str, str] = field(default_factory=dict)
    certificate: str = ""
    note: str = ""

    def json(self) -> dict[str, Any]:
        """The improvement as `improved.json` holds it."""
        return dict(vars(self)) | {"values": dict(self.values)}


@dataclass(frozen=True)
class Drawing:
    """A figure of the paper, drawn from our computation; name is the paper's own (`Figure 2`)."""

    name: str
    caption: str
    draw: Callable[[], Figure]


@dataclass(frozen=True)
class Paper:
    """A paper examined: its claims, what can be improved, its figures.

    about says in our words what the paper does; given lists the printed data that are taken as they are;
    findings are what a reader should know before using the paper's results.
    """

    slug: str
    about: str
    given: str
    findings: Sequence[str]
    claims: Callable[[], Sequence[Claim]]
    improved: Callable[[], Sequence[Improvement]] = tuple
    drawings: Sequence[Drawing] = ()

    @property
    def key(self) -> str:
        """The key in references.bib."""
        return self.slug.replace("-", "_")
