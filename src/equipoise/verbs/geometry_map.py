"""A norm over two geometry parameters: what every place allows, the optimum, and where limits conflict."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from equipoise.affine import Array, Indices
from equipoise.design import Design
from equipoise.errors import EquipoiseError, InfeasibleError, InputError, nearest
from equipoise.objective import leading
from equipoise.parameters import candidates
from equipoise.solve.exchange import Solution, solve
from equipoise.solve.program import NORMS, Norm, Program
from equipoise.tasks import task_of

POINTS = 41
POSES = 400


@dataclass(frozen=True, eq=False)
class GeometryMap:
    """The least norm Z (ny, nx) over parameters x (nx,) and y (ny,), nan where no values keep the limits.

    names and units are those of x and y; norm and unit those of Z; optimum (x, y) is the design's own place,
    at which the other parameters are held; poses is how many of the sweep's poses each value stands for.
    """

    x: Array
    y: Array
    Z: Array
    names: tuple[str, str]
    units: tuple[str, str]
    optimum: tuple[float, float]
    norm: str
    unit: str
    poses: int

    def write(self, folder: Path) -> tuple[Path, Path]:
        """Write `map.svg` and `map.csv` (x, y, norm in SI; empty where limits conflict)."""
        from equipoise.reporting.maps import draw_map
        from equipoise.reporting.style import figure, styled

        picture, table = folder / "map.svg", folder / "map.csv"
        scales = [1e3 if unit == "m" else 1.0 for unit in self.units]
        shown = ["mm" if unit == "m" else unit for unit in self.units]
        labels = [f"{name} [{unit}]" if unit else name for name, unit in zip(self.names, shown, strict=True)]
        with styled():
            made = figure(7.2, 5.6)
            place = (self.optimum[0] * scales[0], self.optimum[1] * scales[1])
            value = f"{self.norm} [{self.unit}]"
            x, y = self.x * scales[0], self.y * scales[1]
            draw_map(made.subplots(), x, y, self.Z, labels=(labels[0], labels[1]), optimum=place, unit=value)
            made.savefig(picture, metadata={"Date": None, "Creator": None})
        heads = [f"{name} [{unit}]" for name, unit in zip(self.names, self.units, strict=True)]
        rows = [
            f"{x!r},{y!r},{'' if np.isnan(z) else repr(z)}\n"
            for y, line in zip(self.y.tolist(), self.Z.tolist(), strict=True)
            for x, z in zip(self.x.tolist(), line, strict=True)
        ]
        table.write_text(f"{heads[0]},{heads[1]},{self.norm} [{self.unit}]\n" + "".join(rows), encoding="utf-8")
        return picture, table


def geometry_map(
    design: Design,
    first: str,
    second: str,
    *,
    norm: Norm | None = None,
    points: int = POINTS,
    progress: Callable[[int, int, float], None] | None = None,
) -> GeometryMap:
    """The best norm at every place of two parameters between their bounds, the other geometry as designed.

    Each of the points^2 values is an exact convex solution over up to 400 of the sweep's poses, the most loaded
    among them; norm (default: the design's own) replaces that of the first aim without a cap. progress is
    called with (lines done, lines, best value). Raises InputError for parameters that the design did not shape.
    """
    for name in (first, second):
        if name not in design.bounds:
            raise InputError(
                f"{name!r} is no free parameter of this design", where="map", hint=nearest(name, list(design.bounds))
            )
    if first == second:
        raise InputError(f"both parameters are {first}", where="map", hint="name two different ones")
    if norm is not None and norm not in NORMS:
        raise InputError(f"there is no norm {norm!r}", where="map", hint=nearest(norm, NORMS))
    if points < 2:
        raise InputError(f"{points} points make no map", where="map", hint="use at least two")
    first_aim = leading(design.objective)
    aims = tuple(replace(aim, norm=norm) if norm and aim is first_aim else aim for aim in design.objective)
    mechanism, sweep = design.mechanism, design.sweep
    task = task_of(mechanism, design.balancers, sweep, None, aims, design.limits)
    few = sweep if len(sweep.poses) <= POSES else sweep.thinned(_most_telling(design))
    states = mechanism.states(few)
    x, y = (np.linspace(*design.bounds[name], points) for name in (first, second))
    Z = np.full((points, points), np.nan)
    best = np.inf
    for row, value in enumerate(y):
        gamma = np.stack([x, np.full(points, value)], axis=1)
        whole = task.program(states, candidates(design.balancers, (first, second), gamma))
        Z[row] = _line(whole, points)
        best = np.nanmin([best, *Z[row]])
        if progress:
            progress(row + 1, points, float(best))
    names = (first, second)
    return GeometryMap(
        x=x,
        y=y,
        Z=Z,
        names=names,
        units=(design.units[first], design.units[second]),
        optimum=(design.geometry[first], design.geometry[second]),
        norm=leading(aims).norm,
        unit=leading(aims).unit(mechanism),
        poses=len(few.poses),
    )


def _line(whole: Program, count: int) -> Array:
    values = np.full(count, np.nan)
    warm: Solution | None = None
    for index in range(count):
        program = whole.take(index)
        try:
            warm = solve(program, warm=warm.working if warm else None)
            values[index] = warm.objective
        except InfeasibleError:
            warm = None
        except EquipoiseError:
            # A warm start that led nowhere; from scratch the exchange either converges or the place is left out.
            warm = None
    return values


def _most_telling(design: Design) -> Indices:
    """Numbers of poses for a quick look: an even choice, and those with the largest effort before and after."""
    sweep, states = design.sweep, design.states
    even = np.linspace(0, len(sweep.poses) - 1, POSES // 2).astype(int)
    shape = (len(sweep.scenarios), len(sweep.poses), -1)
    loads = [np.abs(effort).reshape(shape).max(axis=(0, 2)) for effort in (states.holding, design.residual(states))]
    heavy = [np.argsort(-load)[: POSES // 4] for load in loads]
    return np.unique(np.concatenate([even, *heavy]))
