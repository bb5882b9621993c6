"""The affine residual r(x; theta) = b(x) + A(x) theta: what every mechanism and balancer answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from equipoise.errors import InputError

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Mask = NDArray[np.bool_]
Geometry = NDArray[np.float64] | NDArray[np.complex128]  # complex where a derivative is taken by complex step


@dataclass(frozen=True)
class Unknown:
    """One number that the program finds, called `owner.parameter`, with its SI unit and the bounds nature sets."""

    name: str
    unit: str
    lower: float = -np.inf
    upper: float = np.inf


@dataclass(frozen=True)
class Block:
    """Rows that are judged together by their Euclidean norm: one for a joint, two or three for a force."""

    name: str
    unit: str
    size: int = 1


@dataclass(frozen=True)
class Affine:
    """r = b + A theta over N states and R rows grouped in blocks.

    b (..., N, R) and A (..., N, R, P); leading axes are candidate geometries. Sums of affines stack
    their unknowns; the same unknown in both is one unknown.
    """

    blocks: tuple[Block, ...]
    b: Array
    unknowns: tuple[Unknown, ...]
    A: Array

    @staticmethod
    def known(blocks: Sequence[Block], b: Array) -> Affine:
        """An affine without unknowns."""
        return Affine(tuple(blocks), b, (), np.zeros((*b.shape, 0), dtype=b.dtype))

    def __add__(self, other: Affine) -> Affine:
        if self.blocks != other.blocks:
            raise InputError(f"cannot add an effort on {_names(other)} to one on {_names(self)}")
        unknowns = merge_unknowns((self.unknowns, other.unknowns))
        mine, theirs = self.expand(unknowns), other.expand(unknowns)
        return Affine(self.blocks, mine.b + theirs.b, unknowns, mine.A + theirs.A)

    @staticmethod
    def total(parts: Sequence[Affine]) -> Affine:
        """The sum of affines on the same blocks."""
        unknowns = merge_unknowns([part.unknowns for part in parts])
        place = {unknown.name: index for index, unknown in enumerate(unknowns)}
        for part in parts:
            if part.blocks != parts[0].blocks:
                raise InputError(f"cannot add an effort on {_names(part)} to one on {_names(parts[0])}")
        kind = np.result_type(*[part.b for part in parts], *[part.A for part in parts])
        shapes = [shape for part in parts for shape in (part.b.shape, part.A.shape[:-1])]
        b = np.zeros(np.broadcast_shapes(*shapes), dtype=kind)
        A = np.zeros((*b.shape, len(unknowns)), dtype=kind)
        for part in parts:
            b += part.b
            columns = [place[unknown.name] for unknown in part.unknowns]
            if columns and columns == list(range(columns[0], columns[0] + len(columns))):
                A[..., columns[0] : columns[0] + len(columns)] += part.A
            elif columns:
                A[..., columns] += part.A
        return Affine(parts[0].blocks, b, unknowns, A)

    def expand(self, unknowns: Sequence[Unknown]) -> Affine:
        """The same affine written over a longer list of unknowns."""
        if tuple(unknowns) == self.unknowns:
            return self
        place = {unknown.name: index for index, unknown in enumerate(unknowns)}
        wide = np.zeros((*self.A.shape[:-1], len(unknowns)), dtype=self.A.dtype)
        wide[..., [place[unknown.name] for unknown in self.unknowns]] = self.A
        return replace(self, unknowns=tuple(unknowns), A=wide)

    def at(self, theta: Array) -> Array:
        """The residual (..., N, R) for one theta (P,), or for candidates' thetas (..., P)."""
        return self.b + np.einsum("...nrp,...p->...nr", self.A, np.asarray(theta))

    def rows(self, block: str) -> slice:
        """The columns of b that belong to a block."""
        start = 0
        for candidate in self.blocks:
            if candidate.name == block:
                return slice(start, start + candidate.size)
            start += candidate.size
        raise InputError(f"there is no row {block!r}; rows are {_names(self)}")


def magnitudes(r: Array, sizes: Sequence[int]) -> Array:
    """Euclidean norms (..., B) of the blocks of rows (..., R)."""
    if all(size == 1 for size in sizes):
        return np.abs(r)
    return np.sqrt(np.add.reduceat(r * r, np.cumsum((0, *sizes[:-1])), axis=-1))


def merge_unknowns(groups: Sequence[Sequence[Unknown]]) -> tuple[Unknown, ...]:
    """The union of unknowns in order of appearance; a shared one takes the tighter bounds."""
    merged: dict[str, Unknown] = {}
    for group in groups:
        for unknown in group:
            known = merged.get(unknown.name)
            if known is None:
                merged[unknown.name] = unknown
            elif known.unit != unknown.unit:
                raise InputError(f"unknown {unknown.name} is used with two units, {known.unit} and {unknown.unit}")
            else:
                lower, upper = max(known.lower, unknown.lower), min(known.upper, unknown.upper)
                merged[unknown.name] = replace(known, lower=lower, upper=upper)
    return tuple(merged.values())


def _names(affine: Affine) -> str:
    return ", ".join(block.name for block in affine.blocks)
