"""The band in which a design's residual lies when parts and robot are as they come."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from statistics import NormalDist
from typing import Any

import numpy as np

from equipoise.affine import Array
from equipoise.design import Design
from equipoise.errors import InputError
from equipoise.objective import JOINT_GOALS, Aim
from equipoise.scattering.scatter import Scatter
from equipoise.scattering.sources import Source, sources
from equipoise.seeding import generator
from equipoise.solve.program import Norm, Term, norm_value
from equipoise.states import States
from equipoise.sweep import Sweep

LEVELS = (5.0, 50.0, 95.0)
SAMPLES, POSES = 100_000, 200
TUNED = 400
"""Samples in which every adjuster is tried."""
LADDER = 81
"""Values of one error from which its own band is read."""
TRAVEL = {"": 0.25, "m": 0.05, "rad": 0.25}
"""How far an adjuster goes to either side: a share of a force, of the mechanism's size, an angle, rad."""
AT_ONCE = 500_000
FAR = 6.0
"""Standard deviations beyond which nothing is expected."""
GOLDEN = (5**0.5 - 1) / 2
NARROWINGS = 40


@dataclass(frozen=True)
class Band:
    """The 5, 50 and 95 % values of a norm, beside its value without errors."""

    nominal: float
    low: float
    median: float
    high: float

    def json(self) -> dict[str, float]:
        """The band as design.json holds it."""
        return dict(vars(self))


@dataclass(frozen=True)
class Alone:
    """A source of errors by itself: its tolerance in `unit`, and the 95 % value where nothing else is off."""

    name: str
    tolerance: float
    unit: str
    high: float


@dataclass(frozen=True)
class Retuned:
    """What one adjuster, set anew for every specimen, leaves; travel, in `unit`, from end to end serves 95 % of them.

    It goes no further than a screw would: 5 % of the mechanism's size, a quarter of a force or of a radian.
    """

    name: str
    unit: str
    travel: float
    band: Band

    def json(self) -> dict[str, Any]:
        """The adjuster as design.json holds it."""
        return dict(vars(self)) | {"band": self.band.json()}


@dataclass(frozen=True)
class Tolerance:
    """How a design's residual scatters: its band, who is to blame (worst first), and the best adjuster.

    norm and unit are those of the objective; samples specimens over `poses` rows of states, drawn from `seed`.
    """

    norm: str
    unit: str
    band: Band
    alone: tuple[Alone, ...]
    adjuster: Retuned | None
    samples: int
    poses: int
    seed: int
    scatter: Scatter = field(default_factory=Scatter)

    @property
    def worst(self) -> Alone | None:
        """The most sensitive parameter."""
        return self.alone[0] if self.alone else None

    def json(self) -> dict[str, Any]:
        """The tolerance as design.json holds it."""
        return {
            "norm": self.norm,
            "unit": self.unit,
            "band": self.band.json(),
            "alone": [dict(vars(one)) for one in self.alone],
            "adjuster": None if self.adjuster is None else self.adjuster.json(),
            "samples": self.samples,
            "poses": self.poses,
            "seed": self.seed,
            "scatter": dict(vars(self.scatter)),
        }


def followed(design: Design) -> bool:
    """Whether errors can be followed: the objective is the joints' effort."""
    return next(aim for aim in design.objective if aim.cap is None).goal in JOINT_GOALS


def tolerance(
    design: Design, scatter: Scatter | None = None, *, samples: int = SAMPLES, poses: int = POSES, seed: int = 0
) -> Tolerance:
    """Draw specimens of a design and say how well they balance.

        r = r0 + sum_p e_p dr/dp,   e_p ~ N(0, (tolerance_p / 2)^2)

    The slopes are exact (complex step, differences of linear answers); the norm is taken of every specimen's own
    residual r (N, R). Poses are an even choice from the design's states and, for the peak, the most loaded ones.
    Raises InputError where the objective is not the joints' effort (`hold`, `drive`), or nothing scatters.
    """
    scatter = scatter or Scatter()
    aim = next(aim for aim in design.objective if aim.cap is None)
    if aim.goal not in JOINT_GOALS:
        raise InputError(
            f"errors of the goal {aim.goal} are not followed", where="tolerances", hint="use hold or drive"
        )
    if samples < 1 or poses < 1:
        raise InputError(f"{samples} samples of {poses} poses", where="tolerances", hint="use at least one of each")
    few = _few(design, aim, poses)
    states = design.mechanism.states(few)
    values = dict(design.values)
    found = sources(design.mechanism, design.balancers, few, states, aim.goal, values, scatter)
    whole = _Specimen.of(design, aim, states, found)
    specimen, unit = whole.fewer(), aim.unit(design.mechanism)
    # An adjuster may raise rows that errors alone never make the largest.
    tuned = whole if aim.norm == "peak" else specimen
    nominal = float(specimen.values(np.zeros((1, len(found))))[0])
    if not found:
        still = Band(nominal, nominal, nominal, nominal)
        return Tolerance(aim.norm, unit, still, (), None, samples, len(states), seed, scatter)
    errors = generator(seed).standard_normal((samples, len(found)))
    chunks = np.array_split(errors, max(1, samples * specimen.nominal.size // AT_ONCE))
    drawn = np.concatenate([specimen.values(chunk) for chunk in chunks])
    alone = [Alone(s.name, s.tolerance, s.unit, high) for s, high in zip(found, specimen.alone(), strict=True)]
    alone.sort(key=lambda one: -one.high)
    most = TRAVEL | {"m": TRAVEL["m"] * design.mechanism.size}
    adjusters = [
        tuned.retuned(index, errors[:TUNED], most[source.unit]) for index, source in enumerate(found) if source.tunable
    ]
    best = min(adjusters, key=lambda one: (one.band.high, one.travel), default=None)
    return Tolerance(aim.norm, unit, _band(nominal, drawn), tuple(alone), best, samples, len(states), seed, scatter)


def _band(nominal: float, values: Array) -> Band:
    low, median, high = (float(value) for value in np.percentile(values, LEVELS))
    return Band(nominal, low, median, high)


def _few(design: Design, aim: Aim, count: int) -> Sweep:
    """At most `count` of the sweep's poses: half of them even, half the most loaded ones, which count for the peak."""
    sweep = design.sweep
    total = len(sweep.poses)
    count = max(1, count // len(sweep.scenarios))
    if total <= count:
        return sweep
    left = np.abs(design.residual(design.states, aim.goal))[:, aim.columns(design.mechanism)[0]]
    left = left.reshape(len(sweep.scenarios), total, -1).max(axis=(0, 2))
    share = count // 2 if aim.norm == "peak" else count
    counted = np.flatnonzero(sweep.weight > 0)
    even = counted[np.linspace(0, len(counted) - 1, max(1, share)).astype(int)]
    heavy = np.argsort(-left, kind="stable")[: count - share]
    return sweep.thinned(np.union1d(even, heavy))


@dataclass(frozen=True, eq=False)
class _Specimen:
    """The counted rows of the residual (N, R) with every source's pull on them (P, N, R) per standard deviation."""

    norm: Norm
    nominal: Array
    pull: Array
    weight: Array
    sizes: tuple[int, ...]
    sources: tuple[Source, ...]

    @staticmethod
    def of(design: Design, aim: Aim, states: States, found: tuple[Source, ...]) -> _Specimen:
        columns, scale = aim.columns(design.mechanism)
        rows = design.residual(states, aim.goal)[:, columns]
        weight = states.weight / states.weight.sum()
        if aim.divisor == "before":
            bare = design.mechanism.effort(states, aim.goal)
            scale = scale / aim.before(design.mechanism, weight, bare)
        slopes = [source.slope[:, columns] * scale * source.tolerance / 2 for source in found]
        pull = np.array(slopes).reshape(len(found), *rows.shape)
        return _Specimen(aim.norm, rows * scale, pull, weight, (1,) * rows.shape[1], found)

    def fewer(self) -> _Specimen:
        """The same norms from fewer rows: a triangle for rms, the rows that can be the largest for the peak."""
        if self.norm == "rms":
            both = np.concatenate([self.pull, self.nominal[None]]) * np.sqrt(self.weight)[:, None]
            triangle: Array = np.linalg.qr(both.reshape(len(both), -1).T, mode="r")  # type: ignore[assignment]
            last, pull = triangle[:, -1:], triangle.T[:-1, :, None]
            return replace(self, nominal=last, pull=pull, weight=np.ones(len(last)), sizes=(1,))
        if self.norm == "peak":
            size, spread = np.abs(self.nominal), FAR * np.sqrt((self.pull**2).sum(axis=0))
            may = size + spread >= (size - spread).max()
            nominal, pull = self.nominal[may][:, None], self.pull[:, may][..., None]
            return replace(self, nominal=nominal, pull=pull, weight=np.full(len(nominal), 1 / len(nominal)), sizes=(1,))
        return self

    def norms(self, rows: Array) -> Array:
        """The norm (S,) of residuals (S, N, R)."""
        term = Term("tolerance", self.norm, self.nominal, np.zeros((*self.nominal.shape, 0)), self.weight, self.sizes)
        return norm_value(self.norm, term.magnitudes(rows), self.weight)

    def rows(self, errors: Array) -> Array:
        """Residuals (S, N, R) of specimens with errors (S, P) in standard deviations."""
        flat = self.pull.reshape(len(self.pull), self.nominal.size)
        return self.nominal + (errors @ flat).reshape(len(errors), *self.nominal.shape)

    def values(self, errors: Array) -> Array:
        """The norm (S,) of specimens."""
        return self.norms(self.rows(errors))

    def alone(self) -> list[float]:
        """The 95 % value (P,) that each source leaves by itself."""
        ladder = np.array([NormalDist().inv_cdf((i + 0.5) / LADDER) for i in range(LADDER)])
        return [
            float(np.percentile(self.norms(self.nominal + ladder[:, None, None] * pull), LEVELS[-1]))
            for pull in self.pull
        ]

    def retuned(self, index: int, errors: Array, most: float) -> Retuned:
        """The band when one source serves as adjuster up to `most`, by golden sections of the norm, which is convex."""
        pull, source = self.pull[index], self.sources[index]
        rows = self.rows(errors)
        reach = 2 * self.norms(rows) / max(float(self.norms(pull[None])[0]), 1e-300)
        reach = np.minimum(reach, most / (source.tolerance / 2))
        low, high = -reach, reach

        def left(setting: Array) -> Array:
            return self.norms(rows + setting[:, None, None] * pull)

        one, two = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        at_one, at_two = left(one), left(two)
        for _ in range(NARROWINGS):
            lower = at_one < at_two
            low, high = np.where(lower, low, one), np.where(lower, two, high)
            kept, value = np.where(lower, one, two), np.where(lower, at_one, at_two)
            fresh = np.where(lower, high - GOLDEN * (high - low), low + GOLDEN * (high - low))
            new = left(fresh)
            one, at_one = np.where(lower, fresh, kept), np.where(lower, new, value)
            two, at_two = np.where(lower, kept, fresh), np.where(lower, value, new)
        setting, best = (one + two) / 2, np.minimum(at_one, at_two)
        nominal = float(self.norms(self.nominal[None])[0])
        travel = 2 * float(np.percentile(np.abs(setting), LEVELS[-1])) * source.tolerance / 2
        return Retuned(source.name, source.unit, travel, _band(nominal, best))
