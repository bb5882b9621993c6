"""Residuals over boxes of geometry: what `shape --certify` bounds, for paths and laws in closed form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.assemble import Balancer
from equipoise.balancers.laws import Coil, Constant, Linear, Torsion, WireMass, ZeroFreeLength
from equipoise.balancers.paths import InvertedSliderCrank, Line, ScotchYoke
from equipoise.balancers.spring import Spring
from equipoise.errors import InputError
from equipoise.limits import Length, Limit
from equipoise.mechanism import Point
from equipoise.parameters import tag, write
from equipoise.solve.bracket import Enclosed
from equipoise.solve.jets import Jet, total
from equipoise.states import States

PLAIN = (ZeroFreeLength, Linear, Coil, Constant, Torsion)
"""Laws whose shares are sums and products, which jets follow."""


@dataclass(frozen=True, eq=False)
class Enclosing:
    """The residual of a task over boxes (low, high) of its free geometry: joints (R,) that count, with their scales."""

    balancers: tuple[Balancer, ...]
    names: tuple[str, ...]
    states: States
    columns: Indices
    scale: Array
    limits: tuple[Limit, ...] = ()

    def __call__(self, low: Array, high: Array) -> Enclosed:
        """b, A and rows as jets over (C, R N)."""
        G = len(self.names)
        moved = write(self.balancers, {n: Jet.variable(i, low[:, i], high[:, i], G) for i, n in enumerate(self.names)})
        b = [Jet.constant(self.states.holding[:, c], G) for c in self.columns]
        A: dict[str, list[Jet]] = {}
        rows: list[Jet] = []
        for balancer in moved:
            if not _free(balancer):
                self._known(balancer, b, A, G)
                continue
            if not isinstance(balancer, Spring):
                raise _unbounded(f"a {tag(type(balancer)).replace('_', ' ')} whose place is free")
            length, rates = _path(balancer.path, self.states, self.columns, G)
            force, shares = _law(balancer, length, G)
            weight = self._weight(balancer, G)
            for i, rate in enumerate(rates):
                b[i] = b[i] + force * rate + weight[i]
                for name, basis in shares.items():
                    A.setdefault(name, [Jet.constant(0.0, G)] * len(rates))
                    A[name][i] = A[name][i] + basis * rate
            rows += self._rows(balancer, length)
        zero = Jet.constant(0.0, G)
        columns = [A.get(u.name, [zero] * len(b)) for u in self.unknowns]
        return Enclosed(self._stacked(b), tuple(self._stacked(part) for part in columns), tuple(rows))

    @property
    def unknowns(self) -> list[Any]:
        """The program's unknowns in order."""
        from equipoise.affine import merge_unknowns

        return list(merge_unknowns([balancer.unknowns for balancer in self.balancers]))

    def _known(self, balancer: Balancer, b: list[Jet], A: dict[str, list[Jet]], G: int) -> None:
        share = balancer.effort(self.states, "hold")
        for i, c in enumerate(self.columns):
            b[i] = b[i] + Jet.constant(np.broadcast_to(share.b[..., c], (len(self.states),)), G)
            for p, unknown in enumerate(share.unknowns):
                A.setdefault(unknown.name, [Jet.constant(0.0, G)] * len(self.columns))
                A[unknown.name][i] = A[unknown.name][i] + Jet.constant(share.A[:, c, p], G)

    def _weight(self, spring: Spring, G: int) -> list[Jet]:
        """The weight of the spring's own mass at its two ends."""
        mass, none = spring.mass, [Jet.constant(0.0, G)] * len(self.columns)
        if isinstance(mass, WireMass):
            rate = Jet.constant(0.0, G) + spring.law.k  # type: ignore[attr-defined]
            mass = rate.sqrt() * mass.of(1.0)
        elif not mass:
            return none
        if not isinstance(spring.path, Line):
            raise _unbounded(f"the own mass of a spring on path {tag(type(spring.path))}")
        gravity, found = -self.states.mechanism.gravity, none
        ends = ((spring.path.a, 1 - spring.mass_at), (spring.path.b, spring.mass_at))
        for point, share in ends:
            _, jacobian = _point(point, self.states, self.columns, G)
            lift = [total([jacobian[k][i] * float(gravity[k]) for k in range(3)]) for i in range(len(none))]
            found = [known + mass * share * one for known, one in zip(found, lift, strict=True)]
        return found

    def _rows(self, spring: Spring, length: Jet) -> list[Jet]:
        low, high = spring.law.span
        ends = [(low, -1.0), (high, 1.0)]
        for limit in self.limits:
            if isinstance(limit, Length) and limit.spring == spring.name:
                ends += [(limit.min, -1.0), (limit.max, 1.0)]
        return [(length - end) * side for end, side in ends if end is not None]

    def _stacked(self, parts: Sequence[Jet]) -> Jet:
        """Joints beside each other, scaled."""
        lead = np.broadcast_shapes(*[part.low.shape[:2] for part in parts])
        shape = (*lead, len(self.states))
        low = [np.broadcast_to(part.low, shape) * s for part, s in zip(parts, self.scale, strict=True)]
        high = [np.broadcast_to(part.high, shape) * s for part, s in zip(parts, self.scale, strict=True)]
        return Jet(np.concatenate(low, axis=-1), np.concatenate(high, axis=-1))


def _free(item: Any) -> bool:
    """Whether a jet stands anywhere in it."""
    if isinstance(item, Jet):
        return True
    if isinstance(item, tuple):
        return any(_free(entry) for entry in item)
    return is_dataclass(item) and any(_free(getattr(item, field.name)) for field in fields(item))


def _path(path: Any, states: States, columns: Indices, G: int) -> tuple[Jet, list[Jet]]:
    """Length and its slope along every joint."""
    if not _free(path):
        length, rate = path.deform(states)
        return Jet.constant(length, G), [Jet.constant(rate[:, c], G) for c in columns]
    if isinstance(path, Line):
        (a, ja), (b, jb) = (_point(point, states, columns, G) for point in (path.a, path.b))
        gap = [a[k] - b[k] for k in range(3)]
        length = total([part.square() for part in gap]).sqrt()
        inverse = length.inverse()
        pulls = [total([gap[k] * (ja[k][i] - jb[k][i]) for k in range(3)]) for i in range(len(columns))]
        return length, [pull * inverse for pull in pulls]
    if isinstance(path, InvertedSliderCrank | ScotchYoke) and not _free(path.input):
        angle, rate = path.input.deform(states)
        u = Jet.constant(angle, G) + path.phase
        if isinstance(path, ScotchYoke):
            length, slope = u.sin() * path.radius + path.offset, u.cos() * path.radius
        else:
            apart = ((path.crank - path.distance + Jet.constant(0.0, G)).square()
                     + (u * 0.5).sin().square() * (path.crank * path.distance) * 4.0).sqrt()  # fmt: skip
            slope = u.sin() * (path.crank * path.distance) * apart.inverse()
            length = apart if path.rod is None else path.rod - apart
            slope = slope if path.rod is None else -slope
        return length, [slope * Jet.constant(rate[:, c], G) for c in columns]
    raise _unbounded(f"path {tag(type(path))}")


def _point(point: Point, states: States, columns: Indices, G: int) -> tuple[list[Jet], list[list[Jet]]]:
    """World position (3) and Jacobian (3, R) of a point whose coordinates may be jets: affine in them."""
    place, slope = states.point(Point(point.body))
    units = [states.point(Point.of(point.body, row)) for row in np.eye(3).tolist()]
    slope = _wide(slope, states)
    turned = [(u[0] - place, _wide(u[1], states) - slope) for u in units]

    def affine(start: Array, ways: list[Array]) -> Jet:
        """start + sum of coordinate times way, numbers added up before jets."""
        known, found = start, None
        for way, coordinate in zip(ways, point.at, strict=True):
            if not isinstance(coordinate, Jet):
                known = known + way * coordinate
            elif np.any(way):
                found = coordinate * way if found is None else found + coordinate * way
        return Jet.constant(known, G) if found is None else found + known

    where = [affine(place[:, axis], [turn[0][:, axis] for turn in turned]) for axis in range(3)]
    moves = [
        [affine(slope[:, axis, column], [turn[1][:, axis, column] for turn in turned]) for column in columns]
        for axis in range(3)
    ]
    return where, moves


def _wide(jacobian: Array, states: States) -> Array:
    return np.broadcast_to(jacobian, (len(states), *jacobian.shape[1:]))


def _law(spring: Spring, length: Jet, G: int) -> tuple[Jet, dict[str, Jet]]:
    """The known part of the force, and what every unknown adds per unit."""
    law = spring.law
    if type(law) not in PLAIN:
        raise _unbounded(f"law {tag(type(law))}")
    force, shares = Jet.constant(0.0, G), {}
    for share in law.shares(length):  # type: ignore[arg-type]
        basis = share.basis if isinstance(share.basis, Jet) else Jet.constant(float(share.basis), G)
        if share.given is None:
            shares[f"{spring.owner}.{share.parameter}"] = basis
        else:
            force = force + basis * share.given
    return force, shares


def _unbounded(what: str) -> InputError:
    return InputError(
        f"there is no bound over geometry for {what}",
        where="shape --certify",
        hint="bounds are known for line, inverted_slider_crank and scotch_yoke with coil, zero_free_length, linear, "
        "constant and torsion; without --certify the answer is local",
    )
