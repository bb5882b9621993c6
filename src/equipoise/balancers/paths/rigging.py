"""Cables in a MuJoCo model: sites, cylinders to wrap around, and guides that follow common tangents."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import bodies
from equipoise.balancers.paths.mount import Mount, along_mount
from equipoise.balancers.paths.pulley import Pulley
from equipoise.balancers.paths.swivel import Swivel, directions
from equipoise.balancers.paths.taut import Taut, tangent
from equipoise.errors import InputError
from equipoise.loops import ancestors
from equipoise.mechanism import Point
from equipoise.states import States

Item = Point | Pulley | Swivel
Items = Sequence[Item]
SHORT = np.radians(3.0)
"""How far from the ends of what is always wrapped an arc is split; the least play of a site beside a pulley."""

LOOSE = np.radians(75.0)
"""How far from a cable that has lifted off the site may stand that says on which side it runs."""

RIM = 1e-10
"""How far outside the rim the splitting site stands: MuJoCo wraps nothing from within; the detour is 1e-15 radii."""

BESIDE = 2.0
"""How many radii from a pulley's centre the site stands that says on which side the cable runs."""


def rig(spec: mujoco.MjSpec, name: str, through: Items, cable: Taut, states: States) -> mujoco.MjsTendon:
    """Add a tendon through points and over pulleys, and what guides it between two pulleys."""
    tendon = spec.add_tendon(name=name)
    for number, item in enumerate(through):
        if number and wraps(item) and wraps(through[number - 1]):
            tendon.wrap_site(_guide(spec, name, through, number - 1, cable, states))
        if isinstance(item, Point):
            tendon.wrap_site(bodies.add_site(spec, item, f"{name}_{number}").name)
            continue
        bodies.add_point_mass(spec, f"{name}_pulley_{number}", item.body, item.at, float(item.mass))
        if not wraps(item):
            tendon.wrap_site(bodies.add_site(spec, item.centre, f"{name}_{number}").name)
            continue
        if isinstance(item, Swivel):
            _swivel(spec, tendon, name, number, through, cable, states)
            continue
        neighbours = wraps(through[number - 1]) or wraps(through[number + 1])
        _over(spec, tendon, f"{name}_{number}", item, Bend.of(item, cable, number, states), neighbours)
    return tendon


def wraps(item: Item) -> bool:
    """Whether a cable lies around a place."""
    return not isinstance(item, Point) and bool(np.any(np.real(item.radius)))


def guides(through: Items, cable: Taut, states: States, name: str) -> dict[str, Array]:
    """Positions (N,) of the joints that guides between two pulleys add."""
    found: dict[str, Array] = {}
    for number, (one, other) in enumerate(pairwise(through)):
        if isinstance(other, Swivel) and wraps(other):
            found |= _swivelled(through, number + 1, cable, states, name)
        if not (wraps(one) and wraps(other)) or _as_one(one, other, states):
            continue
        assert isinstance(one, Pulley)
        turned = states.rotation(one.body)[0]
        e, f, _ = _mount(one).frame
        reach, along = tangent(cable.nodes[number], cable.nodes[number + 1])
        found[f"{name}_run_{number}"] = np.arctan2((along * (turned @ f)).sum(-1), (along * (turned @ e)).sum(-1))
        found[f"{name}_far_{number}"] = reach
        found[f"{name}_half_{number}"] = 0.5 * reach
    return found


def _guide(spec: mujoco.MjSpec, name: str, through: Items, number: int, cable: Taut, states: States) -> str:
    """A site in the middle of the run between two pulleys."""
    one, other = through[number], through[number + 1]
    assert isinstance(one, Pulley)
    assert isinstance(other, Pulley)
    radius = one.sense * float(one.radius)
    if _as_one(one, other, states):
        turned, node = states.rotation(one.body)[0], cable.nodes[number]
        reach, along = (value[0] for value in tangent(node, cable.nodes[number + 1]))
        assert node.normal is not None
        middle = 0.5 * reach * along - radius * np.cross(node.normal[0], along)
        local = turned[0].T @ middle + np.asarray(one.at, dtype=float)
        return str(bodies.add_site(spec, Point.of(one.body, local), f"{name}_guide_{number}").name)
    facing = float(
        np.sign(states.rotation(one.body)[0][0] @ one.axis @ (states.rotation(other.body)[0][0] @ other.axis))
    )
    step = facing * other.sense * float(other.radius) - radius
    frame = bodies.add_frame(spec, _mount(one), f"{name}_frame_{number}")
    run = bodies.add_body(frame, f"{name}_run_{number}", bodies.NOTHING)
    bodies.add_joint(run, f"{name}_run_{number}")
    far = bodies.add_body(run, f"{name}_far_{number}", bodies.NOTHING, pos=(0.0, 0.0, step))
    bodies.add_joint(far, f"{name}_far_{number}", axis=bodies.SLIDING, slide=True)
    half = bodies.add_body(run, f"{name}_half_{number}", bodies.NOTHING, pos=(0.0, 0.0, -radius))
    bodies.add_joint(half, f"{name}_half_{number}", axis=bodies.SLIDING, slide=True)
    spec.add_equality(
        name=f"{name}_half_{number}",
        type=mujoco.mjtEq.mjEQ_JOINT,
        objtype=mujoco.mjtObj.mjOBJ_JOINT,
        name1=f"{name}_half_{number}",
        name2=f"{name}_far_{number}",
    ).data[:5] = [0.0, 0.5, 0.0, 0.0, 0.0]
    place = (spec.body(other.body), tuple(float(v) for v in other.at))
    bodies.add_pin(spec, f"{name}_tangent_{number}", (far, (0.0, 0.0, 0.0)), place)
    site = half.add_site(name=f"{name}_guide_{number}")
    return str(site.name)


def _as_one(one: Item, other: Item, states: States) -> bool:
    """Whether two bodies never move against each other."""
    mechanism = states.mechanism
    lead, follow = (ancestors(mechanism.model, mechanism.body_id(item.body)) for item in (one, other))
    return lead == follow


def _mount(pulley: Pulley) -> Mount:
    """A frame at a pulley, square to its axis."""
    sideways = along_mount(pulley.centre, np.asarray(pulley.axis, dtype=float))
    return Mount(pulley.centre, sideways.axis, sideways.direction)


def _swivel_mount(item: Swivel, before: Array, states: States) -> Mount:
    """A frame where a run (from a place (N, 3) before) meets a swivel, whose axis is the run."""
    along = states.rotation(item.body)[0][0].T @ (states.point(item.centre)[0][0] - before[0])
    sideways = along_mount(item.centre, along)
    return Mount(item.centre, sideways.axis, sideways.direction)


def _swivelled(through: Items, number: int, cable: Taut, states: States, name: str) -> dict[str, Array]:
    """Positions (N,) of a swivel's joints: its angle, how far aside and ahead the cable's next place is."""
    item = through[number]
    assert isinstance(item, Swivel)
    before, after = cable.nodes[number - 1].position, cable.nodes[number + 1].position
    position, turned = states.point(item.centre)[0], states.rotation(item.body)[0]
    e, f, _ = _swivel_mount(item, before, states).frame
    along, aside = directions(before, position, after)
    return {
        f"{name}_swivel_{number}": np.arctan2((aside * (turned @ f)).sum(-1), (aside * (turned @ e)).sum(-1)),
        f"{name}_aside_{number}": (aside * (after - position)).sum(-1),
        f"{name}_ahead_{number}": (along * (after - position)).sum(-1),
    }


def _swivel(
    spec: mujoco.MjSpec, tendon: Any, name: str, number: int, through: Items, cable: Taut, states: States
) -> None:
    """Lead a tendon over a pulley on a fork that hinges about the run before it and follows the place behind it."""
    item, after = through[number], through[number + 1]
    assert isinstance(item, Swivel)
    frame = bodies.add_frame(spec, _swivel_mount(item, cable.nodes[number - 1].position, states), f"{name}_at_{number}")
    fork = bodies.add_body(frame, f"{name}_swivel_{number}", bodies.NOTHING)
    bodies.add_joint(fork, f"{name}_swivel_{number}")
    # In the fork's frame x leads aside and -y ahead.
    aside = bodies.add_body(fork, f"{name}_aside_{number}", bodies.NOTHING)
    bodies.add_joint(aside, f"{name}_aside_{number}", axis=bodies.SLIDING, slide=True)
    ahead = bodies.add_body(aside, f"{name}_ahead_{number}", bodies.NOTHING)
    bodies.add_joint(ahead, f"{name}_ahead_{number}", axis=(0.0, -1.0, 0.0), slide=True)
    place = after if isinstance(after, Point) else after.centre
    hook = (spec.body(place.body), tuple(float(v) for v in place.at))
    bodies.add_pin(spec, f"{name}_follow_{number}", (ahead, (0.0, 0.0, 0.0)), hook)
    radius, wrap = float(item.radius), cable.wrap[:, number]
    wheel = Pulley(f"{name}_swivel_{number}", (radius, 0.0, 0.0), radius, axis=(0.0, 0.0, 1.0))
    bend = Bend(wrap, np.array([-1.0, 0.0, 0.0]), np.array([0.0, -1.0, 0.0]), 0.5 * wrap)
    _over(spec, tendon, f"{name}_{number}", wheel, bend, neighbours=False)


@dataclass(frozen=True, eq=False)
class Bend:
    """How a cable lies on a pulley over many states: wrap (N,) and, in the pulley's body, the mean direction (3,) from
    the centre to the middle of the arc, and how far each middle is from it, away (N,), rad in the cable's sense."""

    wrap: Array
    middle: Array
    across: Array
    away: Array

    @staticmethod
    def of(pulley: Pulley, cable: Taut, number: int, states: States) -> Bend:
        """The bend at a place of a cable."""
        turned, _ = states.rotation(pulley.body)
        node, wrap = cable.nodes[number], cable.wrap[:, number]
        assert node.normal is not None
        start = -pulley.sense * np.cross(node.normal, cable.direction[:, number - 1])
        half = (0.5 * pulley.sense * wrap)[:, None]
        middle = np.cos(half) * start + np.sin(half) * np.cross(node.normal, start)
        local = np.einsum("nji,nj->ni", turned, middle)
        mean = local.mean(axis=0)
        mean = mean / np.linalg.norm(mean) if np.linalg.norm(mean) > 1e-6 else local[0]
        axis = np.asarray(pulley.axis, dtype=float) / np.linalg.norm(pulley.axis)
        across = pulley.sense * np.real(np.cross(axis, mean))
        return Bend(wrap, mean, across, np.arctan2(local @ across, local @ mean))

    def at(self, angle: float) -> Array:
        """The direction (3,) at an angle from the mean middle along the cable."""
        return np.cos(angle) * self.middle + np.sin(angle) * self.across

    @property
    def ends(self) -> tuple[float, float]:
        """The arc that is wrapped in every state: from and to, rad from the mean middle."""
        return float((self.away - 0.5 * self.wrap).max()), float((self.away + 0.5 * self.wrap).min())

    def split(self, angle: float) -> tuple[Bend, Bend]:
        """What lies before and behind an angle that is wrapped in every state."""
        first, last = self.away - 0.5 * self.wrap, self.away + 0.5 * self.wrap
        before, behind = 0.5 * (first + angle), 0.5 * (angle + last)
        return replace(self, wrap=angle - first, away=before), replace(self, wrap=last - angle, away=behind)

    @property
    def side(self) -> float | None:
        """Where a site tells the cable's way around the pulley in every state, rad from the mean middle, if anywhere.

        MuJoCo takes the way around on which the site lies opposite to the angle between the two runs.
        """
        room = np.where(self.wrap > 0, 0.5 * (np.pi - self.wrap), LOOSE)
        low, high = float((self.away - room).max()), float((self.away + room).min())
        return 0.5 * (low + high) if high - low >= SHORT else None


def _over(spec: mujoco.MjSpec, tendon: Any, name: str, pulley: Pulley, bend: Bend, neighbours: bool) -> None:
    """Lead a tendon over a pulley: a cylinder with a site on the cable's side; two arcs where no site tells it."""
    geom = pulley.install(spec, name)
    lifted = bool((bend.wrap <= 0).any())
    if lifted and neighbours:
        raise InputError(
            f"the cable of {name.rsplit('_', 1)[0]} lifts off a pulley beside another, which no model file can hold",
            where="cable",
            hint="let it bear on the pulley at every pose, or put a point or an eye between the two",
        )

    def site(angle: float, radii: float, word: str) -> str:
        at = np.asarray(pulley.at, dtype=float) + radii * float(pulley.radius) * bend.at(angle)
        return str(bodies.add_site(spec, Point.of(pulley.body, at), f"{name}_{word}").name)

    if bend.side is not None:
        tendon.wrap_geom(geom.name, site(bend.side, BESIDE, "side"))
        return
    low, high = bend.ends
    middle = 0.5 * (low + high)
    before, behind = (half.side for half in bend.split(middle))
    if high - low < 2 * SHORT or before is None or behind is None:
        raise InputError(
            f"the cable wraps the pulley {name} by {np.degrees(max(bend.wrap.min(), 0)):.4g} to "
            f"{np.degrees(bend.wrap.max()):.4g} deg on changing sides, which no model file can hold",
            where="cable",
            hint="lead the cable through an eye before or behind the pulley, sweep less, or limit `wrap`",
        )
    tendon.wrap_geom(geom.name, site(before, BESIDE, "side"))
    tendon.wrap_site(site(middle, 1.0 + RIM, "rim"))
    tendon.wrap_geom(geom.name, site(behind, BESIDE, "other_side"))
