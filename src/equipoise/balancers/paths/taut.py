"""A taut cable: straight runs between points and tangents, arcs around pulleys, exact."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.errors import InputError

PLANE = 1e-7
"""How far, in lengths of a run, a cable may leave a pulley's plane: what the digits of a robot file leave."""

UNSURE = np.radians(170.0)
"""How far a wrap may be from its nominal value before one cannot tell it from a turn more or less."""

CLOSE = 1e-3
"""How near, in shares of its distance, a point that `shape` chooses may come to a pulley's rim."""

ARC = 13


@dataclass(frozen=True, eq=False)
class Node:
    """A place that a cable passes: position (..., N, 3) and Jacobian (..., N, 3, nd); a pulley's signed radius.

    turn is the radius, positive where the cable turns counter-clockwise about normal (N, 3), zero for points;
    nominal is the wrap, rad, near which the true one lies.
    """

    position: Array
    jacobian: Array
    turn: Any = 0.0
    normal: Array | None = None
    nominal: float = 0.0

    @property
    def wraps(self) -> bool:
        """Whether the cable lies on a pulley here."""
        return self.normal is not None and bool(np.any(np.real(self.turn)))


@dataclass(frozen=True, eq=False)
class Taut:
    """A taut cable: length (..., N), rate dL/dq (..., N, nd), direction (..., N, M - 1, 3) of each run.

    Where the cable has lifted off a pulley, the runs to both its sides have the direction of the whole.
    """

    nodes: list[Node]
    length: Array
    rate: Array
    direction: Array
    wrap: Array

    def outline(self, row: int) -> Array:
        """The cable in one state, (P, 3)."""
        points = []
        for index, node in enumerate(self.nodes):
            centre = node.position[row]
            if not node.wraps or np.real(self.wrap[row, index]) <= 0:
                if not node.wraps:
                    points.append(centre)
                continue
            assert node.normal is not None
            sense = float(np.sign(node.turn))
            start = -float(node.turn) * np.cross(node.normal[row], self.direction[row, index - 1])
            side = np.cross(node.normal[row], start)
            for share in np.linspace(0.0, 1.0, ARC):
                angle = sense * share * float(self.wrap[row, index])
                points.append(centre + np.cos(angle) * start + np.sin(angle) * side)
        return np.stack(points)


def taut(nodes: list[Node]) -> Taut:
    """The cable through all nodes; raises InputError where it leaves a pulley's plane or starts inside one."""
    shape = np.broadcast_shapes(*(node.position.shape[:-1] for node in nodes), *(np.shape(n.turn) for n in nodes))
    kept: NDArray[np.bool_] = np.ones((*shape, len(nodes)), dtype=bool)
    found = _through(nodes, list(range(len(nodes))), shape)
    if len(shape) == 1:
        _sure(nodes, found[3])
    while True:
        loose = np.where(kept, np.real(found[3]), 0.0)
        lifted = np.asarray((loose < 0).any(axis=-1))
        if not lifted.any():
            return Taut(nodes, *found)
        worst = loose.argmin(axis=-1)
        kept = kept & ~(lifted[..., None] & (np.arange(len(nodes)) == worst[..., None]))
        found = _laid(nodes, kept, shape)


def embraces(nodes: list[Node]) -> list[tuple[int, Array, Array]]:
    """Number, wrap (..., N), rad, and its rate (..., N, nd) of every pulley, the cable bearing on all of them.

        w' = sense (n x u_i . (J_i+1 - J_i) / t_i - n x u_i-1 . (J_i - J_i-1) / t_i-1)

    n is the pulley's axis, u the directions and t the lengths of the runs to both sides. Where the cable would lift
    off, the wrap is negative and smooth.
    """
    runs = [tangent(a, b) for a, b in pairwise(nodes)]
    found = []
    for number in range(1, len(nodes) - 1):
        node = nodes[number]
        if not node.wraps:
            continue
        assert node.normal is not None
        turning = []
        for (length, along), (a, b) in zip(
            runs[number - 1 : number + 1], pairwise(nodes[number - 1 : number + 2]), strict=True
        ):
            aside = np.cross(node.normal, along) / length[..., None]
            turning.append(np.einsum("...i,...ij->...j", aside, b.jacobian - a.jacobian))
        wrap = _turned(runs[number - 1][1], runs[number][1], node)
        found.append((number, wrap, np.sign(np.real(node.turn))[..., None] * (turning[1] - turning[0])))
    return found


def _laid(nodes: list[Node], kept: NDArray[np.bool_], shape: tuple[int, ...]) -> tuple[Array, Array, Array, Array]:
    """As `_through`, over the nodes kept (..., N, M): states that touch the same ones go together."""
    patterns = np.unique(kept.reshape(-1, len(nodes)), axis=0)
    parts = [_through(nodes, [int(i) for i in np.flatnonzero(pattern)], shape) for pattern in patterns]
    length, rate, direction, wrap = parts[0]
    for pattern, part in zip(patterns[1:], parts[1:], strict=True):
        here = (kept == pattern).all(axis=-1)
        length, wrap = np.where(here, part[0], length), np.where(here[..., None], part[3], wrap)
        rate = np.where(here[..., None], part[1], rate)
        direction = np.where(here[..., None, None], part[2], direction)
    return length, rate, direction, wrap


def _sure(nodes: list[Node], wrap: Array) -> None:
    """Raise InputError where a wrap is so far from its nominal value that a turn more or less is as likely."""
    for index, node in enumerate(nodes):
        off = np.abs(np.real(wrap[:, index]) - node.nominal)
        if node.wraps and off.max() > UNSURE:
            worst = np.degrees(float(np.real(wrap[int(off.argmax()), index])))
            raise InputError(
                f"the cable wraps pulley {index + 1} by {worst:.4g} deg, too far from {np.degrees(node.nominal):.4g} "
                "deg to be told from a turn more or less",
                where="cable",
                hint="say `nominal` of the pulley: the wrap near which it works, 0 deg where the cable may stand off",
            )


def _through(nodes: list[Node], index: list[int], shape: tuple[int, ...]) -> tuple[Array, Array, Array, Array]:
    """Length, rate, direction per run of all nodes, and wrap per node, with the cable on some nodes only."""
    runs = [tangent(nodes[i], nodes[j]) for i, j in pairwise(index)]
    length = sum(size for size, _ in runs)
    rate = sum(
        np.einsum("...i,...ij->...j", u, nodes[j].jacobian - nodes[i].jacobian)
        for (_, u), (i, j) in zip(runs, pairwise(index), strict=True)
    )
    wrap = np.zeros((*shape, len(nodes)), dtype=np.result_type(*(size.dtype for size, _ in runs)))
    for place, (before, after) in enumerate(pairwise(runs), 1):
        node = nodes[index[place]]
        if node.wraps:
            angle = _turned(before[1], after[1], node)
            wrap[..., index[place]] = angle
            length = length + _size(node) * angle
    ends = [next(k for k in range(len(runs)) if index[k + 1] > step) for step in range(len(nodes) - 1)]
    wide = np.stack([np.broadcast_to(runs[k][1], (*shape, 3)) for k in ends], axis=-2)
    joints = nodes[0].jacobian.shape[-1]
    return np.broadcast_to(length, shape), np.broadcast_to(rate, (*shape, joints)), wide, wrap


def _size(node: Node) -> Any:
    return node.turn * np.sign(np.real(node.turn))


def tangent(a: Node, b: Node) -> tuple[Array, Array]:
    """Length (..., N) and direction (..., N, 3) of the straight run between two nodes: their common tangent."""
    gap = b.position - a.position
    if not a.wraps and not b.wraps:
        length = np.sqrt((gap * gap).sum(-1))
        return length, gap / np.where(length == 0, 1.0, length)[..., None]
    normal, step = _step(a, b)
    _in_plane(gap, normal)
    square = (gap * gap).sum(-1)
    free = square - step * step
    if free.ndim > 1:
        # Candidates that run a point into a pulley get a short run, and a limit that says so.
        free = np.where(np.real(free) > CLOSE**2 * np.real(square), free, CLOSE**2 * square)
    elif (np.real(free) <= 0).any():
        raise InputError(
            f"two places of the cable come within {np.sqrt(np.real(square).min()) * 1e3:.4g} mm, closer than the "
            f"pulley's radius allows ({np.abs(np.real(step)).max() * 1e3:.4g} mm)",
            where="cable",
            hint="move the point away from the pulley, or make the pulley smaller",
        )
    length = np.sqrt(free)
    left = np.cross(normal, gap)
    return length, (length[..., None] * gap - np.asarray(step)[..., None] * left) / square[..., None]


def _step(a: Node, b: Node) -> tuple[Array, Any]:
    """The normal (N, 3) of the plane of a run that touches a pulley, and how far it steps aside from a to b, m."""
    normal = a.normal if a.wraps else b.normal
    assert normal is not None
    turn = b.turn
    if a.wraps and b.wraps:
        assert b.normal is not None
        cosine = (normal * b.normal).sum(-1)
        if (np.abs(np.abs(cosine) - 1.0) > PLANE).any():
            raise InputError(
                "two pulleys that follow each other have axes that are not parallel",
                where="cable",
                hint="put a guide (a pulley of radius 0) between them",
            )
        turn = turn * np.sign(cosine)
    return normal, turn - a.turn


def clearances(nodes: list[Node]) -> list[tuple[Array, Array]]:
    """How far, m, neighbours are from running into each other's pulleys, and their distances, (..., N)."""
    found = []
    for a, b in pairwise(nodes):
        if a.wraps or b.wraps:
            gap = b.position - a.position
            distance, (_, step) = np.sqrt((gap * gap).sum(-1)), _step(a, b)
            found.append((distance - step * np.where(np.real(step) < 0, -1.0, 1.0), distance))
    return found


def _in_plane(gap: Array, normal: Array) -> None:
    off = np.abs(np.real((gap * normal).sum(-1)))
    if (off > PLANE * np.sqrt((np.real(gap) ** 2).sum(-1))).any():
        raise InputError(
            f"the cable leaves the plane of a pulley by {off.max() * 1e3:.4g} mm",
            where="cable",
            hint="keep neighbours in the pulley's plane, or lead the cable through an eye (a pulley of radius 0)",
        )


def _turned(before: Array, after: Array, node: Node) -> Array:
    """The angle wrapped about a pulley, rad, within half a turn of the nominal one; negative where it lifted off."""
    assert node.normal is not None
    sense = np.sign(np.real(node.turn))
    sine = sense * (np.cross(before, after) * node.normal).sum(-1)
    cosine = (before * after).sum(-1)
    angle = _arctan2(sine, cosine)
    return angle + 2 * np.pi * np.round((node.nominal - np.real(angle)) / (2 * np.pi))


def _arctan2(y: Any, x: Any) -> Any:
    """arctan2 whose imaginary part is its derivative, as complex steps want it."""
    angle = np.arctan2(np.real(y), np.real(x))
    if not (np.iscomplexobj(y) or np.iscomplexobj(x)):
        return angle
    square = np.real(x) ** 2 + np.real(y) ** 2
    return angle + 1j * (np.real(x) * np.imag(y) - np.real(y) * np.imag(x)) / square
