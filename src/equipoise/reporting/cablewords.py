"""Cable platforms in words, for the terminal and the report."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from equipoise.reporting.numbers import percent, plain, quantity, sig

if TYPE_CHECKING:
    from equipoise.cables.survey import Survey
    from equipoise.design import Design
    from equipoise.mechanism import Mechanism

NAMED = 3
LEAST_WORDS = {"norm": "least norm", "peak": "least peak"}


def survey_lines(survey: Survey) -> list[tuple[str, str]]:
    """Label and words: closure, feasibility, clearance, stiffness; poses outside are named."""
    mechanism = survey.states.mechanism
    count = len(survey.states)
    found = []
    for label, reach, what in (
        ("closure", survey.closure, "any load can be held"),
        ("feasible", survey.feasible, f"{_tensions(mechanism)} {'carry the weight' if mechanism.mass else 'hold it'}"),
    ):
        words = f"{what} at {percent(reach.share)} of {count} poses"
        outside = reach.outside
        if outside:
            words += "; not at " + _named(mechanism, outside)
        found.append((label, words))
    found.append(("clearance", _clearance(survey)))
    stiff = survey.stiffness[:, 0]
    if np.isfinite(stiff).any():
        row = int(np.nanargmin(stiff))
        where = pose_words(mechanism, survey.pose(row))
        found.append(
            (
                "stiffness",
                f"at tensions of least norm {sig(float(stiff[row]), 3)} to {sig(float(np.nanmax(survey.stiffness)), 3)}"
                f" N/m over all poses and directions, least at {where}",
            )
        )
    return found


def behaviour_lines(design: Design) -> list[tuple[str, str]]:
    """Label and words: where it rests, how stiffly, what the motors still do, and the floor of all springs."""
    b = design.cables
    assert b is not None
    found = survey_lines(b.survey)
    found.append(("rests", rest_words(design)))
    if b.stiffness is not None:
        alone, helped = (f"{sig(b.stiffness[key][0], 3)} N/m" for key in ("alone", "helped"))
        words = f"least, in the middle of the sweep: {helped} with the springs, {alone} with motors alone"
        found.append(("stiffness", words))
    found.append(("tension", f"of the springs at most {sig(max(b.peak.values()), 4)} N"))
    if b.motors is not None:
        for least, words in LEAST_WORDS.items():
            found.append(("motors", f"{words}: {saved_words(b.motors.json()[least])}"))
    elif b.unheld:
        found.append(("motors", b.unheld))
    if b.floor is not None:
        found.append(("floor", floor_words(design)))
    return found


def rest_words(design: Design) -> str:
    """How many equilibria of which kind, and the first of them."""
    b = design.cables
    assert b is not None
    if not b.equilibria:
        return "nowhere in the sweep: with the motors off the platform leaves it"
    kinds = Counter(one.kind for one in b.equilibria)
    words = ", ".join(f"{count} {plural(kind, count)}" for kind, count in kinds.items())
    first = b.equilibria[0]
    where = f"{first.kind} at {pose_words(design.mechanism, first.pose)}"
    stiff = f", {sig(first.stiffness[0], 3)} to {sig(first.stiffness[-1], 3)} N/m" if first.stiffness else ""
    return f"motors off: {words}; the first, a {where}{stiff}"


def plural(kind: str, count: int) -> str:
    """`minima` for two of a minimum."""
    many = {"minimum": "minima", "maximum": "maxima", "saddle": "saddles", "corner sink": "corner sinks"}
    return kind if count == 1 else many.get(kind, kind)


def saved_words(told: Mapping[str, Any]) -> str:
    """Energy and peak tension without and with springs."""
    alone, helped, saved = told["alone"], told["helped"], told["saved"]
    return (
        f"{sig(alone['energy'], 3)} → {sig(helped['energy'], 3)} J ({_share(saved['energy'], alone['energy'])}), "
        f"peak {sig(alone['peak'], 3)} → {sig(helped['peak'], 3)} N ({_share(saved['peak'], alone['peak'])})"
    )


def _share(saved: float, whole: float) -> str:
    if whole <= 0:
        return "nothing to save"
    return f"{plain(100 * saved / whole, 3)} % saved" if saved >= 0 else f"{plain(-100 * saved / whole, 3)} % more"


def floor_words(design: Design) -> str:
    """What fine splines on the same reels reach, beside the design."""
    b = design.cables
    assert b is not None
    assert b.floor is not None
    floor, here = b.floor, design.certificate.primal
    above = f"{plain(100 * (here / floor.value - 1), 3)} % above it" if floor.value > 1e-9 * max(here, 1e-300) else ""
    words = f"no springs shared alike come below {sig(floor.value)} {floor.unit} (splines of {floor.pieces} pieces)"
    return f"{words}; this design {sig(here)} {floor.unit}" + (f", {above}" if above else "")


def pose_words(mechanism: Mechanism, pose: Mapping[str, float]) -> str:
    """`x 12 mm, z 40 mm, turn 3 deg`."""
    units = dict(zip(mechanism.driven, mechanism.driven_units, strict=True))
    return ", ".join(
        f"{joint} {quantity(round(value, 9) + 0.0, 'm' if units[joint] == 'N' else 'rad', 3)}"
        for joint, value in pose.items()
    )


def _named(mechanism: Mechanism, poses: Sequence[Mapping[str, float]]) -> str:
    more = f" and {len(poses) - NAMED} more" if len(poses) > NAMED else ""
    return "; ".join(f"({pose_words(mechanism, pose)})" for pose in poses[:NAMED]) + more


def _tensions(mechanism: Mechanism) -> str:
    platform = mechanism.platform
    assert platform is not None
    low, high = max(platform.t_min, default=0.0), min(platform.t_max, default=np.inf)
    if not np.isfinite(high):
        return f"tensions of {plain(low)} N or more" if low else "taut cables"
    return f"tensions from {plain(low)} to {plain(high)} N"


def _clearance(survey: Survey) -> str:
    found = survey.clearance
    words = []
    if found.pairs:
        pair, least = found.closest
        where = pose_words(survey.states.mechanism, survey.pose(found.pairs[pair].argmin()))
        words.append(f"{pair[0]} and {pair[1]} come within {quantity(least, 'm', 3)} ({where})")
    if found.platform:
        cable = min(found.platform, key=lambda one: float(found.platform[one].min()))
        least = float(found.platform[cable].min())
        where = pose_words(survey.states.mechanism, survey.pose(found.platform[cable].argmin()))
        words.append(f"{cable} comes within {quantity(least, 'm', 3)} of the platform ({where})")
    return "; ".join(words) or "all cables end at one point, so they meet nowhere else"
