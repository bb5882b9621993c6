"""What is asked of a discovery: how many springs, of which kinds, between which places."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from equipoise.discovery.kinds import Ideal, Kind
from equipoise.discovery.lattice import KeepOut
from equipoise.errors import InputError
from equipoise.parts.makeable import Makeable
from equipoise.units import Length


@dataclass(frozen=True)
class Discover:
    """How springs are looked for: kinds of candidates, places, limits of the search.

    springs is the largest number of them; kinds what is tried (default: zero free length). pairs are the bodies to
    join, by name (default: those whose joints are worth a spring), forbid pairs to leave out; points {body: [[x, y,
    z], ...]} replaces the lattice on a body, keep_out are boxes in which nothing may be attached. The lattice has
    `spacing` (default: as fine as `candidates` admits) within `margin` of a link's box (default: a tenth of the
    mechanism's size), m; planar pairs lie in the plane `aside` from their joint, m (default: 0, or a margin to both
    sides where bodies are avoided). avoid forbids lines that run into the capsules about `bodies`, or pass joint
    `axes` at some pose; radius, m, is that of capsules drawn where no collision shape is found. candidates is the most
    couples of points, poses the most poses of the search, contenders how many subsets per number of springs are
    refined. make asks for springs that can be wound: of every coil and cable (which an ideal spring becomes) wire,
    diameter, coils and initial tension are found and rounded. Raises InputError for counts below 1 and lengths that
    are not positive.
    """

    springs: int = 3
    kinds: tuple[Kind, ...] = (Ideal(),)
    pairs: tuple[tuple[str, str], ...] | None = None
    forbid: tuple[tuple[str, str], ...] = ()
    points: Mapping[str, tuple[tuple[Length, Length, Length], ...]] | None = None
    keep_out: tuple[KeepOut, ...] = ()
    spacing: Length | None = None
    margin: Length | None = None
    aside: Length | None = None
    avoid: Literal["nothing", "bodies", "axes", "both"] = "nothing"
    radius: Length | None = None
    candidates: int = 4000
    poses: int = 1000
    contenders: int = 3
    make: Makeable | None = None

    @property
    def tried(self) -> tuple[Kind, ...]:
        """The kinds as they are tried: of what can be wound where that is asked for."""
        if self.make is None:
            return self.kinds
        made = [kind.made(self.make) for kind in self.kinds]
        return tuple(kind for place, kind in enumerate(made) if kind not in made[:place])

    def avoids(self, what: str) -> bool:
        """Whether `bodies` or `axes` are avoided."""
        return self.avoid in (what, "both")

    def __post_init__(self) -> None:
        for name in ("springs", "candidates", "poses", "contenders"):
            if getattr(self, name) < 1:
                raise InputError(f"{name} is {getattr(self, name)}, it must be at least 1", where="discover")
        for name in ("spacing", "margin", "radius"):
            value = getattr(self, name)
            if value is not None and not value > 0:
                raise InputError(f"{name} is {value:g} m, it must be positive", where="discover")
        if not self.kinds:
            raise InputError("no kind of spring is asked for", where="discover.kinds", hint="for example [coil]")
