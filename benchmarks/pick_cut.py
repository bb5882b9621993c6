"""What `pick` loses by working on 200 candidates alone: the same survey with and without that cut.

Run: python benchmarks/pick_cut.py            minutes; no table that it prints is timed
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import synthetic_catalogue

import equipoise as eq
from equipoise.verbs.pick import MOST

KEPT = 3
"""Candidates that `pick` shapes around by default."""


def problems() -> Iterator[tuple[str, eq.Mechanism, list[eq.Spring], eq.Sweep, dict[str, tuple[float, float]]]]:
    """One link with four free coordinates, and a planar arm whose second spring is ideal."""
    link = eq.chain([eq.Link("arm", length=0.5, mass=4.0, com=(0.3, 0.05, 0))])
    spring = eq.Spring("s1", eq.Line(eq.Point("world", (0, 0, 0.3)), link.at("arm", 0.2)), eq.ZeroFreeLength())
    lines = [f"s1.path.line.{end}.{axis}" for end in "01" for axis in "xz"]
    free = dict(zip(lines, ((-0.3, 0.1), (0.05, 0.6), (0.05, 0.5), (-0.1, 0.1)), strict=True))
    yield "one link", link, [spring], eq.Sweep.grid(link, {"arm_joint": (-1.2, 1.5, 46)}), free
    arm = eq.chain(
        [eq.Link("upper", length=0.5, mass=3.0), eq.Link("fore", length=0.4, mass=2.0, com=(0.15, 0.02))],
        base=(0, 0, 0.3),
    )
    ends = (arm.at("upper", 0.2), arm.at("fore", 0.1))
    pair = [
        eq.Spring(f"s{n}", eq.Line(eq.Point("world", (0, 0, 0.5)), end), eq.ZeroFreeLength())
        for n, end in enumerate(ends, 1)
    ]
    free = dict(zip(lines, ((-0.2, 0.1), (0.35, 0.9), (0.05, 0.5), (-0.1, 0.1)), strict=True))
    yield "two links, one ideal spring", arm, pair, eq.Sweep.sobol(arm, 96), free


def main() -> None:
    """A line per problem, norm and number in parallel: the best values without the cut, and with it."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "springs.csv"
        file.write_text(synthetic_catalogue.text(1300, 1), encoding="utf-8")
        stock = eq.read_catalogue(file)
    for name, mechanism, springs, sweep, free in problems():
        for norm, parallel in (("peak", 1), ("peak", 2), ("mean", 1)):
            found = [
                eq.survey_catalogue(
                    mechanism, springs, sweep, free, stock, spring="s1", parallel=parallel, norm=norm, most=most
                ).ranked[:KEPT]
                for most in (None, MOST)
            ]
            whole, cut = ([f"{line.value:.5g}" for line in lines] for lines in found)
            of = f"{parallel * len(stock)} candidates, {norm}"
            print(f"{name:<30}{of:<26}all: {', '.join(whole)}   {MOST}: {', '.join(cut)}", flush=True)


if __name__ == "__main__":
    main()
